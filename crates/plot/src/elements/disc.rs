//! A hemisphere of bins as a disc of equal areas, and the scale of its colours.

use std::f64::consts::{FRAC_PI_2, SQRT_2, TAU};

use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

use crate::elements::theme;

/// Share of the solid angle that may lie beyond a scale, and how many times above its end something must: lobes
/// of rough surfaces are to be seen whole, mirror peaks are not to hide all else.
const OUTSHINING: f64 = 0.02;
const FAR_ABOVE: f64 = 8.0;
/// Times that value up to which bins are still within a scale that is cut off.
const NOISE: f64 = 2.0;

/// Colour of values beyond a scale; *viridis* has none like it.
pub(crate) const BEYOND: RGBColor = RGBColor(230, 60, 160);

/// Where a scale from zero ends that hemispheres of `[rings, sectors]` bins share, and whether values lie beyond:
/// at the largest value, or, where that is eight times above what all but a fiftieth of the solid angle stays below,
/// at the largest that is at most twice that.
pub(crate) fn scale_end<'a>(
    [rings, sectors]: [usize; 2],
    hemispheres: impl Iterator<Item = &'a [f64]>,
) -> (f64, bool) {
    let edge = |ring: usize| (FRAC_PI_2 * ring as f64 / rings as f64).cos();
    let areas: Vec<f64> = (0..rings).map(|ring| edge(ring) - edge(ring + 1)).collect();
    let mut bins: Vec<(f64, f64)> = hemispheres
        .flat_map(|values| values.iter().enumerate())
        .map(|(bin, value)| (*value, areas[bin / sectors]))
        .collect();
    bins.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = bins.first().map_or(0.0, |bin| bin.0);
    if most <= 0.0 {
        return (1.0, false);
    }
    let all: f64 = bins.iter().map(|bin| bin.1).sum();
    let mut beyond = 0.0;
    let below = bins.iter().find(|bin| {
        beyond += bin.1;
        beyond > OUTSHINING * all
    });
    match below {
        // Up to what is no peak but the noise of all others.
        Some(bin) if bin.0 > 0.0 && most > FAR_ABOVE * bin.0 => {
            let others = bins.iter().find(|other| other.0 <= NOISE * bin.0);
            (others.unwrap_or(bin).0, true)
        }
        _ => (most, false),
    }
}

/// The disc over a square of `n` by `n` pixels, for [`palette`]: 0 outside, 1 to 254 from zero to `most`, and 255
/// beyond.
pub(crate) fn disc_pixels(
    [rings, sectors]: [usize; 2],
    values: &[f64],
    n: usize,
    most: f64,
) -> Vec<u8> {
    let place = |i: usize| 2.0 * (i as f64 + 0.5) / n as f64 - 1.0;
    let pixel = |i: usize| {
        let (x, y) = (place(i % n), -place(i / n));
        let r = x.hypot(y);
        if r >= 1.0 {
            return 0;
        }
        // Lambert's azimuthal projection of a hemisphere onto the unit disc.
        let theta = 2.0 * (r / SQRT_2).asin();
        let phi = y.atan2(x).rem_euclid(TAU);
        let ring = ((theta / FRAC_PI_2 * rings as f64) as usize).min(rings - 1);
        let sector = ((phi / TAU * sectors as f64) as usize).min(sectors - 1);
        let t = values[ring * sectors + sector] / most;
        match t > 1.0 {
            true => 255,
            false => 1 + (253.0 * t.max(0.0)).round() as u8,
        }
    };
    (0..n * n).map(pixel).collect()
}

/// White for what lies outside of a disc, then *viridis*, and last the colour of what lies beyond the scale.
pub(crate) fn palette() -> Vec<RGBColor> {
    let colours = (0..=253u8).map(|i| ViridisRGB.get_color(f64::from(i) / 253.0));
    let outside = std::iter::once(theme::WHITE);
    outside.chain(colours).chain([BEYOND]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bins of equal solid angle get equal areas: rings of 45 degrees hold 1 - cos 45 and cos 45. A picture of
    /// 400 x 400 tells areas to a thousandth: its outline of 1257 pixels over 125664.
    #[test]
    fn discs_have_equal_areas_and_azimuth_runs_counterclockwise() {
        let n = 400;
        let pixels = disc_pixels([2, 4], &[0.0, 0.25, 0.5, 0.75, 1.0, 0.0, 0.0, 0.0], n, 1.0);
        let inside = pixels.iter().filter(|p| **p > 0).count() as f64;
        assert!((inside / (n * n) as f64 - 0.25 * std::f64::consts::PI).abs() < 1e-3);
        // A quarter of the inner cap: (1 - cos 45 deg) / 4 of the disc.
        let of = |t: f64| {
            let index = 1 + (253.0 * t).round() as u8;
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
        assert_eq!(at(0.6, 0.6), 254);
        assert_eq!([at(-0.6, 0.6), at(-0.6, -0.6), at(0.6, -0.6)], [1; 3]);
        assert_eq!(at(-0.1, 0.1), 1 + (253.0_f64 * 0.25).round() as u8);
    }

    #[test]
    fn what_lies_beyond_has_a_colour_of_its_own() {
        let pixels = disc_pixels([1, 2], &[1.0, 1.01], 20, 1.0);
        // The first sector is the upper half.
        assert_eq!([pixels[5 * 20 + 10], pixels[15 * 20 + 10]], [254, 255]);
        let palette = palette();
        assert_eq!(palette.len(), 256);
        assert_eq!(palette[255], BEYOND);
        let least = palette[1..255].iter().map(|c| {
            let d = |a: u8, b: u8| i32::from(a.abs_diff(b));
            d(c.0, BEYOND.0) + d(c.1, BEYOND.1) + d(c.2, BEYOND.2)
        });
        assert!(least.min().unwrap() > 100);
    }

    #[test]
    fn few_bins_that_outshine_all_do_not_make_the_scale() {
        let end = |values: &[f64]| scale_end([18, 36], std::iter::once(values));
        // One bin of the innermost of 18 rings holds 0.01 % of the solid angle.
        let mut values = vec![0.3; 18 * 36];
        values[0] = 0.4;
        assert_eq!(end(&values), (0.4, false));
        values[0] = 30.0;
        assert_eq!(end(&values), (0.3, true));
        // Noise is no peak.
        values[1] = 0.5;
        assert_eq!(end(&values), (0.5, true));
        // Half of the outer ring holds 4 %.
        values[17 * 36..17 * 36 + 18].fill(20.0);
        assert_eq!(end(&values), (30.0, false));
        // Two bright patches at the rim, five times what lies below: the point of a figure, and no mirror peak.
        let mut ears = vec![0.1; 18 * 36];
        for bin in [10, 11, 24, 25] {
            ears[17 * 36 + bin] = 0.5;
        }
        assert_eq!(end(&ears), (0.5, false));
        assert_eq!(end(&[-1.0; 18 * 36]), (1.0, false));
    }
}
