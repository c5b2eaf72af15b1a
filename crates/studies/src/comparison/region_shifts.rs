//! Region shifts: what the slopes of each region of a surface explain of the light that it scatters.
//!
//! Models of a given surface are made for the slope covariance `c` that it has, which is itself an estimate of that of the ensemble
//! it comes from. Where `c` happens to be large, so is the light at large angles: both are known by the same surface. With `c_b` the
//! covariance in region `b` and `M(c)` what a model expects,
//!
//! ```text
//! M(c_b) = M(c) + J (c_b - c) + ...
//! ```
//!
//! to first order, and the tally of region `b` less `J (c_b - c)` is compared with `M(c)`. The mean over regions stays as it is, since
//! the differences cancel, and what is left of the scatter is the error of `mean - M(c)`, with that of `c` in it.
//!
//! The mean slope of a region is no part of this: models have a level mean plane. It scatters the light of the region, while the mean slopes of
//! all regions add to zero and leave the mean as it is. It is therefore taken out by regression over the regions, and the deviations from
//! the mean are multiplied by the root of `(R - 1) / (R - 3)` for the two coefficients of `R` regions.
//!
//! Neighbouring regions share the surface along their edges, so that their scatter is below that of surfaces of this size. For what
//! depends on the power `k` of slopes with the autocorrelation `c`, that of heights being `exp(-r^2 / tau^2)`, the variance of the mean over
//! regions of widths `X` and `Y` is that of their scatter over `1 - a tau / X - b tau / Y`, where `a` and `b` are the means of `|x|` and `|y|`
//! over `c^k`: 0.53 and 0.40 for squares, -0.08 and 0.33 for cubes, 0.24 and 0.28 for fourth powers. Means and squares are taken
//! out, and all deviations from the mean are stretched as those of fourth powers: by the root of `1 / (1 - 0.26 (tau / X + tau / Y))`.

use asperity_analysis::{SlopeCovariance, SlopeError};
use asperity_surface::RegionSlopes;
use asperity_tally::{Estimate, TallyValues};

/// Step of the differences that stand for derivatives, as a fraction of the covariance: the terms left out are 1 % of its square
/// times the third derivative by the logarithm.
const STEP: f64 = 0.1;

/// Width, in correlation lengths, by which regions that share their edges are effectively narrower, for squares of slopes.
const OF_SQUARES: f64 = 0.5;

/// Width by which regions are effectively narrower for fourth powers of slopes, in correlation lengths.
const OF_FOURTH_POWERS: f64 = 0.26;

/// Mean slopes of regions below which they are no more than rounding, over the root mean square slope.
const LEVEL: f64 = 1e-9;

/// Slopes of one surface and of its regions.
#[derive(Clone, Debug)]
pub(crate) struct RegionShifts {
    covariance: SlopeCovariance,
    /// Cholesky factor of the covariance: elements xx, xy and yy.
    factor: [f64; 3],
    /// For each region, elements xx, xy and yy of its covariance less that of the surface, in units in which that is one.
    shifts: Vec<[f64; 3]>,
    /// Mean slopes of the regions less that of the surface: up to two directions among the regions, orthogonal and of unit length.
    tilts: Vec<Vec<f64>>,
    /// Standard errors of the elements xx, xy and yy of the covariance.
    errors: [f64; 3],
    /// Factor by which the scatter between regions is increased.
    stretch: f64,
}

impl RegionShifts {
    /// `regions`: slopes of each, whose `second` moments are about the mean slope of the surface. `widths`: of a region along x and y,
    /// in correlation lengths, above 1.
    ///
    /// # Errors
    /// [`SlopeError`] if the slopes of the surface have no density.
    pub(crate) fn new(regions: &[RegionSlopes], widths: [f64; 2]) -> Result<Self, SlopeError> {
        let [xx, xy, yy] = RegionSlopes::mean_of(regions).second;
        let covariance = SlopeCovariance::new(xx, yy, xy)?;
        let stretch = |of: f64| 1.0 / (1.0 - of * (1.0 / widths[0] + 1.0 / widths[1])).sqrt();
        let a = xx.sqrt();
        let b = xy / a;
        let factor = [a, b, (yy - b * b).sqrt()];
        let count = regions.len() as f64;
        let differences = regions.iter().map(|region| {
            let [rxx, rxy, ryy] = region.second;
            [rxx - xx, rxy - xy, ryy - yy]
        });
        let differences: Vec<[f64; 3]> = differences.collect();
        let errors = [0, 1, 2].map(|i| {
            let squares: f64 = differences.iter().map(|d| d[i] * d[i]).sum();
            stretch(OF_SQUARES) * (squares / (count * (count - 1.0))).sqrt()
        });
        let shifts = differences.iter().map(|&d| whitened(factor, d));
        Ok(Self {
            covariance,
            factor,
            shifts: shifts.collect(),
            tilts: tilts(regions, (xx + yy).sqrt()),
            errors,
            stretch: stretch(OF_FOURTH_POWERS),
        })
    }

    /// The slopes of the whole surface.
    pub(crate) const fn covariance(&self) -> SlopeCovariance {
        self.covariance
    }

    /// The elements xx, xy and yy of the covariance, with their errors as estimates of those of the ensemble.
    pub(crate) fn elements(&self) -> [Estimate; 3] {
        let c = self.covariance;
        let means = [c.xx(), c.xy(), c.yy()];
        [0, 1, 2].map(|i| Estimate {
            mean: means[i],
            se: Some(self.errors[i]),
        })
    }

    /// Factor by which the scatter between regions is increased, since neighbours share the surface along their edges.
    pub(crate) const fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Derivatives of what a model expects by the three elements, given what it `expects` of other slopes.
    pub(crate) fn derivatives<E>(
        &self,
        expects: impl Fn(SlopeCovariance) -> Result<TallyValues, E> + Sync,
    ) -> Result<[TallyValues; 3], E>
    where
        E: From<SlopeError> + Send,
    {
        let derivative = |element: usize| -> Result<TallyValues, E> {
            let at = |step: f64| expects(self.stepped(element, step)?);
            let (above, below) = rayon::join(|| at(STEP), || at(-STEP));
            Ok(above?.zip_map(&below?, |a, b| (a - b) / (2.0 * STEP)))
        };
        let (first, (second, third)) = rayon::join(
            || derivative(0),
            || rayon::join(|| derivative(1), || derivative(2)),
        );
        Ok([first?, second?, third?])
    }

    /// The tallies of the regions less what their slopes explain, with deviations from the mean stretched.
    pub(crate) fn adjusted(
        &self,
        tallies: &[TallyValues],
        derivatives: &[TallyValues; 3],
    ) -> Vec<TallyValues> {
        let less_explained = tallies.iter().zip(&self.shifts).map(|(tally, shift)| {
            let mut left = tally.clone();
            for (derivative, shift) in derivatives.iter().zip(shift) {
                left.update(derivative, |value, slope| *value -= shift * slope);
            }
            left
        });
        let mut adjusted: Vec<TallyValues> = less_explained.collect();
        self.take_out_tilts(&mut adjusted);
        self.stretched(adjusted)
    }

    /// Takes from the tallies what their regression on the mean slopes of the regions explains.
    fn take_out_tilts(&self, tallies: &mut [TallyValues]) {
        let Some(first) = tallies.first() else {
            return;
        };
        let spec = *first.spec();
        let (regions, taken) = (tallies.len() as f64, self.tilts.len() as f64);
        for tilt in &self.tilts {
            let mut explained = TallyValues::zeros(spec);
            for (tally, part) in tallies.iter().zip(tilt) {
                explained.update(tally, |sum, value| *sum += part * value);
            }
            for (tally, part) in tallies.iter_mut().zip(tilt) {
                tally.update(&explained, |value, slope| *value -= part * slope);
            }
        }
        let wider = ((regions - 1.0) / (regions - 1.0 - taken)).sqrt();
        stretch_about_mean(tallies, wider);
    }

    /// `adjusted`, with their deviations from their mean stretched.
    pub(crate) fn stretched(&self, mut adjusted: Vec<TallyValues>) -> Vec<TallyValues> {
        stretch_about_mean(&mut adjusted, self.stretch);
        adjusted
    }

    /// The covariance with one of its three elements changed by `step`, in units in which it is one.
    fn stepped(&self, element: usize, step: f64) -> Result<SlopeCovariance, SlopeError> {
        let [a, b, c] = self.factor;
        let mut change = [0.0; 3];
        change[element] = step;
        let [xx, xy, yy] = change;
        // L (1 + change) L^T
        let [xx, yy] = [1.0 + xx, 1.0 + yy];
        SlopeCovariance::new(
            a * a * xx,
            b * b * xx + 2.0 * b * c * xy + c * c * yy,
            a * (b * xx + c * xy),
        )
    }
}

/// Multiplies the deviations of tallies from their mean by `factor`.
fn stretch_about_mean(tallies: &mut [TallyValues], factor: f64) {
    let Some(first) = tallies.first() else {
        return;
    };
    let mut mean = TallyValues::zeros(*first.spec());
    tallies.iter().for_each(|tally| mean += tally);
    let mean = mean.map(|sum| sum / tallies.len() as f64);
    for tally in tallies {
        tally.update(&mean, |value, mean| {
            *value = mean + factor * (*value - mean)
        });
    }
}

/// Mean slopes of regions along x and y less those of the surface, made orthogonal and of unit length; none that is rounding, or if fewer
/// than four regions leave no scatter beside them. `spread`: root mean square slope.
fn tilts(regions: &[RegionSlopes], spread: f64) -> Vec<Vec<f64>> {
    let mean = RegionSlopes::mean_of(regions).mean;
    let mut found: Vec<Vec<f64>> = Vec::new();
    for axis in [0, 1].into_iter().filter(|_| regions.len() > 3) {
        let deviations = regions.iter().map(|region| region.mean[axis] - mean[axis]);
        let mut tilt: Vec<f64> = deviations.collect();
        for other in &found {
            let common: f64 = tilt.iter().zip(other).map(|(a, b)| a * b).sum();
            tilt.iter_mut()
                .zip(other)
                .for_each(|(a, b)| *a -= common * b);
        }
        let length = tilt.iter().map(|a| a * a).sum::<f64>().sqrt();
        if length > LEVEL * spread {
            tilt.iter_mut().for_each(|a| *a /= length);
            found.push(tilt);
        }
    }
    found
}

/// `L^-1 D L^-T` for the symmetric matrix `D`; elements xx, xy and yy.
fn whitened([a, b, c]: [f64; 3], [xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    // Rows of L^-1: (1 / a, 0) and (-b / (a c), 1 / c)
    let (p, q, r) = (1.0 / a, -b / (a * c), 1.0 / c);
    [
        p * p * xx,
        p * (q * xx + r * xy),
        q * q * xx + 2.0 * q * r * xy + r * r * yy,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_tally::{TallyResult, TallySpec};

    fn regions() -> Vec<RegionSlopes> {
        let of = |second| RegionSlopes {
            mean: [0.0; 2],
            second,
        };
        vec![
            of([0.3, 0.10, 0.2]),
            of([0.5, 0.16, 0.1]),
            of([0.4, 0.05, 0.3]),
            of([0.2, -0.03, 0.4]),
        ]
    }

    /// A "model" whose tallies are linear in the covariance explains regions of the same law entirely, whatever the axes.
    #[test]
    fn slopes_explain_all_of_what_is_linear_in_them() {
        let regions = regions();
        let shifts = RegionShifts::new(&regions, [5.0, 5.0]).unwrap();
        let spec = TallySpec::default();
        let linear = |xx: f64, xy: f64, yy: f64| {
            let mut number = 0.0;
            TallyValues::from_fn(spec, |_| {
                number += 1.0;
                0.1 + xx * number + xy * (3.0 + number) - 0.5 * yy * number
            })
        };
        let expects = |c: SlopeCovariance| Ok::<_, SlopeError>(linear(c.xx(), c.xy(), c.yy()));
        let derivatives = shifts.derivatives(expects).unwrap();
        let tallies: Vec<TallyValues> = regions
            .iter()
            .map(|region| {
                let [xx, xy, yy] = region.second;
                linear(xx, xy, yy)
            })
            .collect();
        let c = shifts.covariance();
        let expected = linear(c.xx(), c.xy(), c.yy());
        for tally in shifts.adjusted(&tallies, &derivatives) {
            for (found, expected) in tally.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0));
            }
        }
    }

    /// The mean stays as it is; deviations that slopes do not explain are stretched: of regions of two correlation lengths by the
    /// root of 1 / 0.74.
    #[test]
    fn the_mean_stays_and_deviations_are_stretched() {
        let regions = regions();
        let shifts = RegionShifts::new(&regions, [2.0, 2.0]).unwrap();
        let spec = TallySpec::default();
        let zeros = || TallyValues::zeros(spec);
        let tallies: Vec<TallyValues> = [0.1, 0.4, 0.3, 0.4]
            .map(|flux| TallyValues::from_fn(spec, |_| flux))
            .to_vec();
        let entry = TallySpec::BUDGET.reflected;
        let found = shifts.adjusted(&tallies, &[zeros(), zeros(), zeros()]);
        for (found, flux) in found.iter().zip([0.1, 0.4, 0.3, 0.4]) {
            let expected = 0.3 + (flux - 0.3) / 0.74_f64.sqrt();
            assert!((found.at(entry) - expected).abs() < 1e-12);
        }
        let derivatives = [0.2, -0.3, 0.7].map(|x| TallyValues::from_fn(spec, |_| x));
        let adjusted = shifts.adjusted(&tallies, &derivatives);
        let mean = adjusted.iter().map(|tally| tally.at(entry)).sum::<f64>() / 4.0;
        assert!((mean - 0.3).abs() < 1e-12);
        assert!((adjusted[0].at(entry) - found[0].at(entry)).abs() > 1e-3);
        // The error of xx, of differences -0.05, 0.15, 0.05, -0.15, whose squares are stretched by the root of 2
        let expected = 2.0_f64.sqrt() * (0.05_f64 / 12.0).sqrt();
        assert!((shifts.errors[0] / expected - 1.0).abs() < 1e-12);
    }

    /// What is linear in the mean slopes of regions is taken out, and the scatter that is left is that of fewer degrees of freedom.
    #[test]
    fn mean_slopes_of_regions_are_taken_out() {
        let spec = TallySpec::default();
        // The third number is orthogonal to the two mean slopes.
        let numbers = [
            ([1.0, 1.0], 1.0),
            ([1.0, -1.0], 1.0),
            ([-1.0, 1.0], 1.0),
            ([-1.0, -1.0], 1.0),
            ([2.0, 0.0], -1.0),
            ([-2.0, 0.0], -1.0),
            ([0.0, 2.0], -1.0),
            ([0.0, -2.0], -1.0),
        ];
        let region = |(mean, _): ([f64; 2], f64)| RegionSlopes {
            mean,
            second: [10.0, 0.0, 10.0],
        };
        let regions = numbers.map(region);
        let shifts = RegionShifts::new(&regions, [1e9; 2]).unwrap();
        let tallies = numbers.map(|([x, y], rest)| {
            TallyValues::from_fn(spec, |_| 7.0 + 3.0 * x - 0.5 * y + 0.1 * rest)
        });
        let zeros = || TallyValues::zeros(spec);
        let found = shifts.adjusted(&tallies, &[zeros(), zeros(), zeros()]);
        let entry = TallySpec::BUDGET.reflected;
        for (found, (_, rest)) in found.iter().zip(numbers) {
            let expected = 7.0 + (7.0 / 5.0_f64).sqrt() * 0.1 * rest;
            assert!((found.at(entry) - expected).abs() < 1e-7, "{found:?}");
        }
    }
}
