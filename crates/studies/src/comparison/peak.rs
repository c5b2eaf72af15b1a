//! Peak: the direction in the plane of incidence in which a lobe is brightest, against a model.

use asperity_numerics::elementary::ln;
use serde::{Deserialize, Serialize};

/// Part of the highest bin below which a neighbour counts as this part: logarithms of less say nothing.
const FLOOR: f64 = 0.01;

/// A lobe is narrower than its bin if neither neighbour reaches this part of it.
const NARROW: f64 = 0.1;

/// Standard errors by which the highest bin must exceed one that is no neighbour to be told from it.
const TOLD_APART: f64 = 2.0;

/// Part of the highest bin that is rounding.
const ROUNDING: f64 = 1e-9;

/// Peaks of the in-plane intensity of a side, on explicit surfaces and by a model.
///
/// Angles are signed degrees from the side's own normal, positive forward.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeakDifference {
    /// On explicit surfaces.
    pub explicit_deg: f64,
    /// By the model.
    pub model_deg: f64,
    /// Distance from its peak at which the explicit lobe falls to half of it, on the side where it is broader.
    pub half_width_deg: f64,
    /// Standard error of their difference, by the jackknife over surfaces; `None` for one surface.
    pub se_deg: Option<f64>,
    /// Resolution of the difference by the bins, degrees: half a bin for each lobe that is narrower
    /// than one, and the way to the farthest bin that is as bright within the error.
    pub unresolved_deg: f64,
}

/// Bins of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Span {
    /// From -90 to 90 degrees.
    Both,
    /// From 0 to 90 degrees, the other half being its mirror image.
    Forward,
}

impl Span {
    /// The intensity in the bin before the first.
    fn before(self, profile: &[f64]) -> f64 {
        match self {
            // Nothing lies beyond the horizon.
            Self::Both => 0.0,
            Self::Forward => profile[0],
        }
    }
}

/// The bins of a profile.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ProfileBins {
    span: Span,
    /// Middles, degrees, ascending.
    centres: Vec<f64>,
    /// Widths, degrees.
    widths: Vec<f64>,
}

impl ProfileBins {
    /// Bins between these edges, degrees.
    pub(crate) fn new(span: Span, edges: impl Iterator<Item = [f64; 2]>) -> Self {
        let (centres, widths) = edges
            .map(|[from, to]| (0.5 * (from + to), to - from))
            .unzip();
        Self {
            span,
            centres,
            widths,
        }
    }

    /// The angle of a place counted in bins, from the middle of the first: in equal parts between the middles of neighbours.
    fn degrees(&self, place: f64) -> f64 {
        let last = self.centres.len() - 1;
        let middle = |i: isize| match usize::try_from(i) {
            Ok(i) if i <= last => self.centres[i],
            // Beyond the ends bins go on as wide as the last ones.
            Ok(i) => self.centres[last] + (i - last) as f64 * self.widths[last],
            Err(_) => self.centres[0] + i as f64 * self.widths[0],
        };
        let before = place.floor();
        let [from, to] = [before as isize, before as isize + 1].map(middle);
        from + (place - before) * (to - from)
    }
}

/// Compares where lobes peak.
///
/// `surfaces`: in-plane intensities of one side, a profile per surface. `model`: one profile that is
/// exact, or one per surface. `None` where either is nowhere above zero.
///
/// The place is that of a parabola through the logarithms of the highest bin and its neighbours, which
/// is exact for Gaussian lobes as far as a bin is narrow. It is the same for both, so that what bins do
/// to it largely cancels.
pub(crate) fn peak_difference(
    bins: &ProfileBins,
    surfaces: &[Vec<f64>],
    model: &[Vec<f64>],
) -> Option<PeakDifference> {
    let span = bins.span;
    let profile = mean((!surfaces.is_empty()).then_some(surfaces)?, None);
    let explicit = Peak::of(span, &profile)?;
    let expected = Peak::of(span, &mean(model, None))?;
    let unresolved = [(explicit, surfaces), (expected, model)]
        .map(|(peak, profiles)| peak.unresolved(bins, profiles))
        .iter()
        .sum::<f64>();
    let count = surfaces.len();
    let se_deg = (count > 1).then(|| {
        let paired = model.len() == count;
        let without = |r: usize| -> Option<f64> {
            let model = mean(model, Some(r).filter(|_| paired));
            let explicit = Peak::of(span, &mean(surfaces, Some(r)))?;
            let model = Peak::of(span, &model)?;
            Some(bins.degrees(explicit.place) - bins.degrees(model.place))
        };
        // A lobe that is gone without one surface is known to no better than all angles.
        let Some(left_out) = (0..count).map(without).collect::<Option<Vec<f64>>>() else {
            return 180.0;
        };
        let centre = left_out.iter().sum::<f64>() / count as f64;
        let squares: f64 = left_out.iter().map(|x| (x - centre).powi(2)).sum();
        (squares * (count - 1) as f64 / count as f64).sqrt()
    });
    Some(PeakDifference {
        explicit_deg: bins.degrees(explicit.place),
        model_deg: bins.degrees(expected.place),
        half_width_deg: explicit.half_width(bins, &profile),
        se_deg,
        unresolved_deg: unresolved,
    })
}

/// The peak of one profile.
#[derive(Clone, Copy, Debug)]
struct Peak {
    /// The highest bin.
    highest: usize,
    /// Position of the peak, in bins.
    place: f64,
    /// `true` if the lobe lies within one bin.
    narrow: bool,
}

impl Peak {
    fn of(span: Span, profile: &[f64]) -> Option<Self> {
        // The first of equals, in any order of evaluation.
        let highest =
            (0..profile.len()).reduce(|a, b| if profile[b] > profile[a] { b } else { a })?;
        let top = profile[highest];
        if top <= 0.0 {
            return None;
        }
        let left = match highest {
            0 => span.before(profile),
            i => profile[i - 1],
        };
        let right = profile.get(highest + 1).copied().unwrap_or(0.0);
        let [l, r] = [left, right].map(|y| ln((y / top).max(FLOOR)));
        let bend = l + r;
        let shift = if bend < 0.0 {
            0.5 * (l - r) / bend
        } else {
            0.0
        };
        Some(Self {
            highest,
            place: highest as f64 + shift,
            narrow: left.max(right) < NARROW * top,
        })
    }

    /// Distance from the peak at which its lobe falls to half of it, on the side where it is broader, degrees.
    fn half_width(self, bins: &ProfileBins, profile: &[f64]) -> f64 {
        let span = bins.span;
        let half = 0.5 * profile[self.highest];
        let at = |i: isize| match usize::try_from(i) {
            Ok(i) => profile.get(i).copied().unwrap_or(0.0),
            // Bin -1 is the mirror image of bin 0.
            Err(_) if span == Span::Forward => profile.get(!i as usize).copied().unwrap_or(0.0),
            Err(_) => 0.0,
        };
        let crossing = |step: isize| {
            let mut i = self.highest as isize;
            while at(i + step) >= half {
                i += step;
            }
            let (inside, outside) = (at(i), at(i + step));
            let beyond = (inside - half) / (inside - outside);
            let place = i as f64 + step as f64 * beyond;
            (bins.degrees(place) - bins.degrees(self.place)).abs()
        };
        crossing(-1).max(crossing(1))
    }

    /// Resolution of the position by the bins of these profiles, degrees.
    fn unresolved(self, bins: &ProfileBins, profiles: &[Vec<f64>]) -> f64 {
        let top = mean(profiles, None)[self.highest];
        let count = profiles.len() as f64;
        let as_bright = |j: &usize| {
            let less = |profile: &Vec<f64>| profile[self.highest] - profile[*j];
            let centre = profiles.iter().map(less).sum::<f64>() / count;
            let squares: f64 = profiles.iter().map(|p| (less(p) - centre).powi(2)).sum();
            let se = match profiles.len() {
                1 => 0.0,
                _ => (squares / (count * (count - 1.0))).sqrt(),
            };
            centre <= TOLD_APART * se + ROUNDING * top
        };
        let farthest = (0..profiles[0].len())
            .filter(|j| j.abs_diff(self.highest) > 1)
            .filter(as_bright)
            .map(|j| (bins.centres[j] - bins.degrees(self.place)).abs())
            .fold(0.0, f64::max);
        let half_bin = 0.5 * bins.widths[self.highest];
        farthest + if self.narrow { half_bin } else { 0.0 }
    }
}

/// The mean of all profiles but one.
fn mean(profiles: &[Vec<f64>], but: Option<usize>) -> Vec<f64> {
    let mut sum = vec![0.0; profiles.first().map_or(0, Vec::len)];
    let mut count = 0.0;
    for (r, profile) in profiles.iter().enumerate() {
        if Some(r) != but {
            sum.iter_mut().zip(profile).for_each(|(s, y)| *s += y);
            count += 1.0;
        }
    }
    sum.iter_mut().for_each(|s| *s /= count);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal bins, the forward half of them or all.
    fn equal(span: Span, count: usize) -> ProfileBins {
        let (first, all) = match span {
            Span::Both => (-90.0, 180.0),
            Span::Forward => (0.0, 90.0),
        };
        let edge = move |i: usize| first + all * i as f64 / count as f64;
        ProfileBins::new(span, (0..count).map(|i| [edge(i), edge(i + 1)]))
    }

    /// Means over bins of `width` degrees of a Gaussian lobe.
    fn lobe(centre: f64, rms: f64, bins: usize) -> Vec<f64> {
        let width = 180.0 / bins as f64;
        (0..bins)
            .map(|i| {
                let at = |k: usize| {
                    let x = -90.0 + width * (i as f64 + (k as f64 + 0.5) / 64.0);
                    (-0.5 * ((x - centre) / rms).powi(2)).exp()
                };
                (0..64).map(at).sum::<f64>() / 64.0
            })
            .collect()
    }

    fn exact(explicit: Vec<f64>, model: Vec<f64>) -> PeakDifference {
        let surfaces = vec![explicit; 8];
        peak_difference(&equal(Span::Both, 36), &surfaces, &[model]).unwrap()
    }

    /// A bin average of a Gaussian is nearly a Gaussian; half a bin of rms leaves 3 % of a bin.
    #[test]
    fn the_peak_of_a_lobe_is_found_to_a_part_of_a_bin() {
        for (centre, rms, within) in [
            (33.0, 15.0, 0.05),
            (-12.4, 6.0, 0.05),
            (41.3, 2.5, 0.15),
            (0.0, 4.0, 0.01),
        ] {
            let found = exact(lobe(centre, rms, 36), lobe(centre + 2.0, rms, 36));
            println!("{found:?}");
            assert!((found.explicit_deg - centre).abs() < within);
            let difference = found.model_deg - found.explicit_deg;
            assert!((difference - 2.0).abs() < 2.0 * within, "{difference}");
            assert!(found.se_deg.unwrap() < 1e-9);
            assert_eq!(found.unresolved_deg, 0.0);
        }
    }

    #[test]
    fn a_lobe_within_one_bin_is_known_to_half_a_bin() {
        let found = exact(lobe(42.0, 0.5, 36), lobe(42.5, 15.0, 36));
        assert_eq!((found.explicit_deg, found.unresolved_deg), (42.5, 2.5));
        let found = exact(lobe(42.0, 0.5, 36), lobe(42.5, 0.5, 36));
        assert_eq!(found.unresolved_deg, 5.0);
    }

    #[test]
    fn at_the_edge_nothing_lies_beyond() {
        // Rising to the horizon: the peak is near the inner edge of the last bin, and never outside.
        let mut rising: Vec<f64> = (0..36).map(|i| f64::from(i).powi(6)).collect();
        let found = exact(rising.clone(), rising.clone());
        assert!(
            found.explicit_deg > 85.0 && found.explicit_deg < 86.0,
            "{found:?}"
        );
        rising.reverse();
        let found = exact(rising.clone(), rising);
        assert!(found.explicit_deg < -85.0 && found.explicit_deg > -86.0);
    }

    #[test]
    fn a_model_without_a_peak_is_not_resolved() {
        let found = exact(lobe(10.0, 20.0, 36), vec![1.0; 36]);
        assert!(found.unresolved_deg >= 90.0, "{found:?}");
    }

    /// A Gaussian falls to half at 1.1774 of its rms; bins of 5 degrees see that to a tenth of one. What is
    /// highest at the horizon falls to nothing there, and to half of it far away on the other side.
    #[test]
    fn lobes_have_their_half_widths_and_dark_profiles_no_peak() {
        let of = |explicit: Vec<f64>| exact(explicit, lobe(0.0, 10.0, 36)).half_width_deg;
        for (centre, rms) in [(0.0, 20.0), (21.0, 12.0), (-33.0, 25.0)] {
            let found = of(lobe(centre, rms, 36));
            println!("{found}, expected {}", 1.1774 * rms);
            assert!((found - 1.1774 * rms).abs() < 0.5);
        }
        assert!(of(vec![1.0; 36]) > 90.0);
        let rising: Vec<f64> = (0..36).map(f64::from).collect();
        assert!((of(rising) - 85.0).abs() < 5.0);
        let half = lobe(0.0, 20.0, 36)[18..].to_vec();
        let forward = peak_difference(
            &equal(Span::Forward, 18),
            std::slice::from_ref(&half),
            std::slice::from_ref(&half),
        )
        .unwrap();
        assert!((forward.half_width_deg - 1.1774 * 20.0).abs() < 0.5);
        for dark in [vec![0.0; 36], vec![-1e-9; 36]] {
            assert_eq!(
                peak_difference(&equal(Span::Both, 36), &[dark], &[vec![1.0; 36]]),
                None
            );
        }
    }

    #[test]
    fn bins_below_zero_are_no_logarithms() {
        let mut noisy = lobe(20.0, 3.0, 36);
        for (i, y) in noisy.iter_mut().enumerate() {
            *y -= if i % 2 == 0 { 1e-3 } else { 0.0 };
        }
        let found = exact(noisy, lobe(20.0, 3.0, 36));
        assert!((found.explicit_deg - 20.0).abs() < 0.2, "{found:?}");
    }

    /// Two lobes whose heights scatter by more than they differ are as bright within the error.
    #[test]
    fn of_two_equal_lobes_either_may_be_the_higher() {
        let two = |a: f64, b: f64| -> Vec<f64> {
            let (first, second) = (lobe(-40.0, 8.0, 36), lobe(30.0, 8.0, 36));
            first
                .iter()
                .zip(&second)
                .map(|(x, y)| a * x + b * y)
                .collect()
        };
        let noisy: Vec<Vec<f64>> = (0..16)
            .map(|r| two(1.0, if r % 2 == 0 { 1.08 } else { 0.9 }))
            .collect();
        let found = peak_difference(&equal(Span::Both, 36), &noisy, &[two(1.0, 0.99)]).unwrap();
        println!("{found:?}");
        assert!(found.unresolved_deg > 60.0);
        let apart = peak_difference(
            &equal(Span::Both, 36),
            &vec![two(1.0, 0.9); 16],
            &[two(1.0, 0.9)],
        )
        .unwrap();
        assert_eq!(apart.unresolved_deg, 0.0);
    }

    /// The jackknife of a mean is its standard error. Here the peak is the mean of shifts that scatter
    /// by 1 degree; heights are equal, so that the peak of the mean is that mean to 1 %.
    #[test]
    fn the_jackknife_gives_the_scatter_of_the_mean() {
        let shifts: Vec<f64> = (0..20)
            .map(|r| if r % 2 == 0 { 1.0 } else { -1.0 })
            .collect();
        let surfaces: Vec<Vec<f64>> = shifts.iter().map(|x| lobe(22.0 + x, 10.0, 36)).collect();
        let found =
            peak_difference(&equal(Span::Both, 36), &surfaces, &[lobe(22.0, 10.0, 36)]).unwrap();
        let expected = 1.0 / 19.0_f64.sqrt();
        let se = found.se_deg.unwrap();
        println!("{se}, expected {expected}");
        assert!((se / expected - 1.0).abs() < 0.01);
        // Models with the same shifts surface by surface take the scatter away.
        let paired = peak_difference(&equal(Span::Both, 36), &surfaces, &surfaces).unwrap();
        assert!(paired.se_deg.unwrap() < 1e-12);
    }

    #[test]
    fn half_a_profile_goes_on_as_its_mirror_image() {
        let half = |centre: f64| -> Vec<f64> {
            let all = lobe(centre, 12.0, 36);
            (18..36).map(|i| all[i] + all[35 - i]).collect()
        };
        let found =
            peak_difference(&equal(Span::Forward, 18), &[half(0.0)], &[half(37.0)]).unwrap();
        assert!(found.explicit_deg.abs() < 1e-9, "{found:?}");
        assert!((found.model_deg - 37.0).abs() < 0.2);
        assert_eq!(found.se_deg, None);
    }

    /// Bins that grow from 0.1 degrees about 33.2 on: a lobe of 0.5 degrees has its place and width there, in equal bins it would not.
    #[test]
    fn bins_that_refine_resolve_a_narrow_lobe() {
        let mut edges = vec![33.15_f64, 33.25];
        let mut width = 0.1;
        while edges[0] > -90.0 {
            width *= 1.3;
            edges.insert(0, (edges[0] - width).max(-90.0));
        }
        width = 0.1;
        while edges[edges.len() - 1] < 90.0 {
            width *= 1.3;
            edges.push((edges[edges.len() - 1] + width).min(90.0));
        }
        let bins = ProfileBins::new(Span::Both, edges.windows(2).map(|pair| [pair[0], pair[1]]));
        let lobe = |centre: f64| -> Vec<f64> {
            let mean = |pair: &[f64]| {
                let at = |k: i32| {
                    let x = pair[0] + (pair[1] - pair[0]) * (f64::from(k) + 0.5) / 64.0;
                    (-0.5 * ((x - centre) / 0.5).powi(2)).exp()
                };
                (0..64).map(at).sum::<f64>() / 64.0
            };
            edges.windows(2).map(mean).collect()
        };
        let found = peak_difference(&bins, &vec![lobe(33.2); 3], &[lobe(33.26)]).unwrap();
        println!("{found:?}");
        assert!((found.explicit_deg - 33.2).abs() < 0.01);
        assert!((found.model_deg - 33.26).abs() < 0.02);
        assert!((found.half_width_deg - 1.1774 * 0.5).abs() < 0.06);
        assert_eq!(found.unresolved_deg, 0.0);
    }
}
