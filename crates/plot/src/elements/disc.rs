//! A hemisphere of bins as a disc of equal areas, and the scale of its colours.

use std::f64::consts::SQRT_2;
use std::iter::once;

use super::colour_scale::ColourScale;
use super::disc_bins::DiscBins;
use super::rgb::Rgb;
use super::theme;

/// Fraction of the solid angle that may outshine the rest on a linear scale, and how many times brighter it then is: lobes that fill
/// less are not to hide all else.
const OUTSHINING: f64 = 0.2;
const FAR_ABOVE: f64 = 6.0;
/// Most decades of a logarithmic scale.
const DECADES: i32 = 4;
/// Colours of a disc.
const COLOURS: usize = 255;

/// The scale that hemispheres share, each with its bins: from zero to the largest value, or, where that is six
/// times above what all but a fifth of the solid angle stays below, logarithmic. `None` if no value is above zero.
pub(crate) fn scale<'a>(
    hemispheres: impl Iterator<Item = (&'a DiscBins, &'a [Option<f64>])>,
) -> Option<ColourScale> {
    let mut bins: Vec<(f64, f64)> = hemispheres
        .flat_map(|(bins, values)| {
            let values = values.iter().enumerate();
            values.filter_map(|(bin, value)| Some(((*value)?, bins.solid_angle(bin))))
        })
        .collect();
    bins.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = bins.first().map(|bin| bin.0).filter(|most| *most > 0.0)?;
    let all: f64 = bins.iter().map(|bin| bin.1).sum();
    let mut above = 0.0;
    let typical = bins.iter().find(|bin| {
        above += bin.1;
        above > OUTSHINING * all
    });
    match typical {
        Some(bin) if most > FAR_ABOVE * bin.0 => {
            let least = bins.iter().rev().map(|bin| bin.0).find(|v| *v > 0.0);
            Some(ColourScale::decades(least.unwrap_or(most), most, DECADES))
        }
        _ => Some(ColourScale::linear(0.0, most)),
    }
}

/// The disc over a square of `n` by `n` pixels, for [`palette`]: 0 outside and where there is no value, 1 to 255 along the
/// scale.
pub(crate) fn pixels(
    bins: &DiscBins,
    values: &[Option<f64>],
    n: usize,
    scale: &ColourScale,
) -> Vec<u8> {
    let colours: Vec<u8> = values
        .iter()
        .map(|value| value.filter(|_| is_shown(*value, Some(*scale))))
        .map(|value| value.map_or(0, |value| 1 + scale.index(value, COLOURS)))
        .collect();
    let place = |i: usize| 2.0 * (i as f64 + 0.5) / n as f64 - 1.0;
    let pixel = |i: usize| {
        let (x, y) = (place(i % n), -place(i / n));
        let r = x.hypot(y);
        if r >= 1.0 {
            return 0;
        }
        // Lambert's azimuthal projection of a hemisphere onto the unit disc.
        let theta = 2.0 * (r / SQRT_2).asin();
        colours[bins.bin_of(theta, y.atan2(x))]
    };
    (0..n * n).map(pixel).collect()
}

/// Returns `true` if a value has a colour: a logarithmic scale has none for what is not above zero.
pub(crate) fn is_shown(value: Option<f64>, scale: Option<ColourScale>) -> bool {
    let above = |value: f64| value > 0.0 || scale.is_none_or(|scale| !scale.log);
    value.is_some_and(above)
}

/// White for what lies outside of a disc or has no value, then the colours of the scale.
pub(crate) fn palette(scale: &ColourScale) -> Vec<Rgb> {
    once(theme::WHITE)
        .chain(scale.colours.palette(COLOURS))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bins of equal solid angle get equal areas: rings of 45 degrees hold 1 - cos 45 and cos 45. A picture of
    /// 400 x 400 tells areas to a thousandth: its outline of 1257 pixels over 125664.
    #[test]
    fn discs_have_equal_areas_and_azimuth_runs_counterclockwise() {
        let n = 400;
        let values = [0.0, 0.25, 0.5, 0.75, 1.0, 0.0, 0.0, 0.0].map(Some);
        let pixels = pixels(
            &DiscBins::equal([2, 4]),
            &values,
            n,
            &ColourScale::linear(0.0, 1.0),
        );
        let inside = pixels.iter().filter(|p| **p > 0).count() as f64;
        assert!((inside / (n * n) as f64 - 0.25 * std::f64::consts::PI).abs() < 1e-3);
        // A quarter of the inner cap: (1 - cos 45 deg) / 4 of the disc.
        let of = |t: f64| {
            let index = 1 + (254.0 * t).round() as u8;
            pixels.iter().filter(|p| **p == index).count() as f64 / inside
        };
        let cap = 0.25 * (1.0 - 0.5_f64.sqrt());
        assert!((of(0.5) - cap).abs() < 1e-3, "{}", of(0.5));
        assert!((of(1.0) - 0.25 * 0.5_f64.sqrt()).abs() < 1e-3);
        // The first sector of the outer ring is at the upper right.
        let at = |x: f64, y: f64| {
            let [column, row] = [x, -y].map(|v| ((0.5 * (v + 1.0)) * n as f64) as usize);
            pixels[row * n + column]
        };
        assert_eq!(at(0.6, 0.6), 255);
        assert_eq!([at(-0.6, 0.6), at(-0.6, -0.6), at(0.6, -0.6)], [1; 3]);
        assert_eq!(at(-0.1, 0.1), 1 + (254.0_f64 * 0.25).round() as u8);
    }

    #[test]
    fn bins_without_a_value_have_no_colour() {
        let n = 40;
        let bins = DiscBins::equal([1, 2]);
        let zero = pixels(&bins, &[Some(0.0), None], n, &ColourScale::RATIOS);
        let [upper, lower] = [&zero[..n * n / 2], &zero[n * n / 2..]];
        assert!(lower.iter().all(|pixel| *pixel == 0));
        assert!(upper.contains(&128) && upper.iter().all(|pixel| [0, 128].contains(pixel)));
        assert_eq!(palette(&ColourScale::RATIOS)[0], theme::WHITE);
        assert_ne!(palette(&ColourScale::RATIOS)[128], theme::WHITE);
        assert_eq!(scale(once((&bins, [None, None].as_slice()))), None);
    }

    #[test]
    fn nothing_has_a_colour_on_a_linear_scale_alone() {
        let bins = DiscBins::equal([1, 2]);
        let first = |scale: &ColourScale| {
            let pixels = pixels(&bins, &[Some(0.0), Some(0.1)], 8, scale);
            [pixels[8 + 4], pixels[6 * 8 + 4]]
        };
        assert_eq!(first(&ColourScale::linear(0.0, 10.0)), [1, 4]);
        assert_eq!(first(&ColourScale::decades(0.1, 10.0, 2)), [0, 1]);
    }

    #[test]
    fn a_logarithmic_scale_gives_equal_ratios_equal_steps() {
        let scale = ColourScale::decades(1e-3, 10.0, DECADES);
        assert!((scale.lo / 1e-3 - 1.0).abs() < 1e-12 && (scale.hi / 10.0 - 1.0).abs() < 1e-12);
        for (value, t) in [(1e-3, 0.0), (1e-2, 0.25), (0.1, 0.5), (10.0, 1.0)] {
            assert!((scale.fraction(value) - t).abs() < 1e-12, "{value}");
        }
        // Zero and values below the scale have the colour of its lower end.
        assert_eq!([0.0, -1.0, 1e-9].map(|v| scale.fraction(v)), [0.0; 3]);
        // Ten decades are too many to tell colours apart.
        assert!((ColourScale::decades(1e-9, 10.0, DECADES).lo / 1e-3 - 1.0).abs() < 1e-12);
        assert_eq!(palette(&scale).len(), 256);
    }

    #[test]
    fn few_bins_that_outshine_all_make_the_scale_logarithmic() {
        let of = |values: &[f64]| {
            let values: Vec<Option<f64>> = values.iter().copied().map(Some).collect();
            scale(once((&DiscBins::equal([18, 36]), values.as_slice())))
        };
        let linear = |hi| Some(ColourScale::linear(0.0, hi));
        // One bin of the innermost of 18 rings holds 0.01 % of the solid angle.
        let mut values = vec![0.3; 18 * 36];
        values[0] = 0.4;
        assert_eq!(of(&values), linear(0.4));
        values[0] = 30.0;
        let log = Some(ColourScale::decades(0.3, 30.0, DECADES));
        assert_eq!(of(&values), log);
        // Half of the outer ring, as bright as a lobe at grazing angles, holds 4 %; three rings hold 26 %.
        values[17 * 36..17 * 36 + 18].fill(20.0);
        assert_eq!(of(&values), log);
        values[15 * 36..].fill(20.0);
        assert_eq!(of(&values), linear(30.0));
        // Two bright patches at the rim, five times what lies below: the point of a figure, and no mirror peak.
        let mut ears = vec![0.1; 18 * 36];
        for bin in [10, 11, 24, 25] {
            ears[17 * 36 + bin] = 0.5;
        }
        assert_eq!(of(&ears), linear(0.5));
        // A mirror peak alone, and nothing at all.
        let mut peak = vec![0.0; 18 * 36];
        peak[0] = 5.0;
        assert!(of(&peak).unwrap().log);
        assert_eq!(of(&[-1.0; 18 * 36]), None);
    }

    /// Sectors from 350 degrees on, and a narrow ring: the pixel just above the axis lies in the first sector.
    #[test]
    fn bins_between_edges_are_found_by_their_edges() {
        let bins = DiscBins {
            rings_deg: vec![0.0, 29.0, 31.0, 90.0],
            sectors_deg: vec![350.0, 370.0, 710.0],
        };
        let at = |theta: f64, phi: f64| bins.bin_of(theta.to_radians(), phi.to_radians());
        let found = [
            (10.0, 5.0),
            (30.0, -5.0),
            (30.0, 15.0),
            (90.0, 349.0),
            (0.0, 180.0),
        ];
        assert_eq!(found.map(|(theta, phi)| at(theta, phi)), [0, 2, 3, 5, 1]);
        let all: f64 = (0..bins.len()).map(|bin| bins.solid_angle(bin)).sum();
        assert!((all - 2.0 * std::f64::consts::PI).abs() < 1e-12);
    }
}
