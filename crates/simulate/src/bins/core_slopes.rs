//! Core slopes: the slopes of most facets, which set the width of a lobe about its peak.
//!
//! The root mean square of slopes says little of the peak where a few facets are much steeper than all others, as on most measured
//! surfaces. The core of a distribution is the Gaussian that has as many facets near the mean plane.

use asperity_numerics::elementary::{ln, sin_cos};
use asperity_surface::Border;
use asperity_synthesis::SurfaceRecipe;
use asperity_tracer::{Geometry, Shape};
use rayon::prelude::*;

use crate::input::surface_source::SurfaceSource;

/// Facets that are looked at, of those of a given surface.
const MOST_FACETS: usize = 1 << 20;

/// Part of the projected area whose slopes are the smallest ones; of a Gaussian they are within `sqrt(-2 ln(1 - part))` deviations.
const CORE: f64 = 0.02;

/// Variances and covariance of slopes about zero: `[xx, xy, yy]`.
///
/// # Examples
/// ```
/// use asperity_simulate::CoreSlopes;
/// use asperity_synthesis::Psd;
///
/// // sigma = 1, tau = 10: a slope variance of 2 / 10^2 along each axis
/// let slopes = CoreSlopes::of_recipe(&Psd::gaussian(1.0, 10.0)?.into());
/// assert!((slopes.deviation(0.3) - 0.02_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoreSlopes([f64; 3]);

impl CoreSlopes {
    /// Core slopes of random surfaces.
    #[must_use]
    pub fn of_recipe(recipe: &SurfaceRecipe) -> Self {
        Self(recipe.slope_covariance())
    }

    /// Core slopes of the upward facets of a given surface, of which at most a million are counted.
    #[must_use]
    pub fn of_shape(shape: &Shape) -> Self {
        match shape {
            Shape::HeightField { top, .. } => Self::of_facets(&**top),
            Shape::Smooth { top, .. } => Self::of_facets(&**top),
            Shape::TriangleMesh { top, .. } => Self::of_facets(&**top),
        }
    }

    /// Core slopes of a surface source, of several given surfaces the mean; `None` of a surface that is only described.
    #[must_use]
    pub fn of_source(source: &SurfaceSource) -> Option<Self> {
        match source {
            SurfaceSource::Random(surfaces) => Some(Self::of_recipe(surfaces.recipe())),
            SurfaceSource::Given(shapes) => {
                let all = shapes.iter().map(|shape| Self::of_shape(shape).0);
                let sum = all.fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
                Some(Self(sum.map(|sum| sum / shapes.len() as f64)))
            }
            SurfaceSource::Described(_) => None,
        }
    }

    /// The mean over all azimuths.
    pub(crate) fn over_azimuth(self) -> Self {
        let [xx, _, yy] = self.0;
        Self([0.5 * (xx + yy), 0.0, 0.5 * (xx + yy)])
    }

    /// Deviation of the slope along an azimuth, radians, of facets that have none across it.
    #[must_use]
    pub fn deviation(self, azimuth: f64) -> f64 {
        let (sin, cos) = sin_cos(azimuth);
        let (along, across) = ([cos, sin], [-sin, cos]);
        let [xx, xy, yy] = self.0;
        let form = |a: [f64; 2], b: [f64; 2]| {
            a[0] * (xx * b[0] + xy * b[1]) + a[1] * (xy * b[0] + yy * b[1])
        };
        let [aa, ac, cc] = [
            form(along, along),
            form(along, across),
            form(across, across),
        ];
        let explained = if cc > 0.0 { ac * ac / cc } else { 0.0 };
        (aa - explained).max(0.0).sqrt()
    }

    /// Slopes of the upward facets of a surface.
    fn of_facets<G: Geometry>(surface: &G) -> Self {
        let facets = surface.facet_count();
        let step = facets.div_ceil(MOST_FACETS).max(1);
        let counted = (0..facets.div_ceil(step)).into_par_iter();
        let seen = counted.filter_map(|number| {
            let facet = surface.facet(number * step);
            let [low, high] = surface.bounds(facet);
            let normal = surface.normal_at(facet, surface.snap(facet, 0.5 * (low + high)));
            let size = high - low;
            // Where facets differ in size, the box stands for the projected area.
            (normal.z > 0.0).then(|| WeightedSlope {
                slope: [-normal.x / normal.z, -normal.y / normal.z],
                weight: size.x * size.y,
            })
        });
        let is_mirrored = surface.border() == Border::Mirrored;
        Self::of_slopes(&seen.collect::<Vec<_>>(), is_mirrored)
    }

    /// `is_mirrored`: whether every slope stands for its mirror images along x and y too.
    fn of_slopes(slopes: &[WeightedSlope], is_mirrored: bool) -> Self {
        let all: f64 = slopes.iter().map(|one| one.weight).sum();
        if all == 0.0 {
            return Self([0.0; 3]);
        }
        let mean = |of: fn([f64; 2]) -> f64| {
            let sum: f64 = slopes.iter().map(|one| one.weight * of(one.slope)).sum();
            sum / all
        };
        let [xx, yy] = [mean(|[x, _]| x * x), mean(|[_, y]| y * y)];
        let xy = if is_mirrored {
            0.0
        } else {
            mean(|[x, y]| x * y)
        };
        let whole = [xx, xy, yy];
        let core = core_factor(slopes, whole, all);
        Self(whole.map(|moment| moment * core * core))
    }
}

/// The slope of a facet, and its part of the area.
#[derive(Clone, Copy)]
struct WeightedSlope {
    slope: [f64; 2],
    weight: f64,
}

/// The deviation of the core over that of all slopes, whose second moments are `[xx, xy, yy]` and whose weights add to `all`; at most 1.
fn core_factor(slopes: &[WeightedSlope], [xx, xy, yy]: [f64; 3], all: f64) -> f64 {
    let determinant = xx * yy - xy * xy;
    let square = |[x, y]: [f64; 2]| {
        if determinant > 1e-10 * xx * yy {
            (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant
        } else {
            2.0 * (x * x + y * y) / (xx + yy)
        }
    };
    let mut squares: Vec<[f64; 2]> = slopes
        .iter()
        .map(|one| [square(one.slope), one.weight])
        .collect();
    let of_gaussian = -2.0 * ln(1.0 - CORE);
    match first_to_reach(&mut squares, CORE * all) {
        Some(square) if square > 0.0 => (square / of_gaussian).sqrt().min(1.0),
        // Most of the surface is level: what is not says how wide the lobe is.
        _ => 1.0,
    }
}

/// The smallest value, of pairs of a value and its weight, up to which, itself included, the weights add up to `part`.
fn first_to_reach(pairs: &mut [[f64; 2]], part: f64) -> Option<f64> {
    if pairs.is_empty() {
        return None;
    }
    let by_value = |a: &[f64; 2], b: &[f64; 2]| a[0].total_cmp(&b[0]);
    // Few are as small as that: only these are put in order.
    let mut few = (4.0 * CORE * pairs.len() as f64) as usize;
    loop {
        few = few.clamp(1, pairs.len());
        pairs.select_nth_unstable_by(few - 1, by_value);
        pairs[..few].sort_unstable_by(by_value);
        let mut below = 0.0;
        let reached = pairs[..few].iter().find(|[_, weight]| {
            below += weight;
            below >= part
        });
        match reached {
            None if few < pairs.len() => few *= 2,
            _ => return reached.map(|[value, _]| *value),
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_surface::{Border, HeightField};
    use asperity_synthesis::{Psd, Synthesis};
    use asperity_tracer::Surface;

    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    fn near(found: f64, expected: f64, within: f64) {
        assert!(
            (found / expected - 1.0).abs() < within,
            "{found}, {expected}"
        );
    }

    /// Ten thousand slopes in two dimensions by a quasi-random sequence, `radius(u)` long.
    fn slopes(radius: impl Fn(f64) -> f64) -> Vec<WeightedSlope> {
        (0..10_000)
            .map(|i| {
                let u = (f64::from(i) + 0.5) / 1e4;
                let turn = std::f64::consts::TAU * (f64::from(i) * 0.618_033_988_7).fract();
                WeightedSlope {
                    slope: [radius(u) * turn.cos(), radius(u) * turn.sin()],
                    weight: 1.0,
                }
            })
            .collect()
    }

    /// Radii of a normal distribution of unit deviation.
    fn gaussian(u: f64) -> f64 {
        (-2.0 * (1.0 - u).ln()).sqrt()
    }

    #[test]
    fn the_core_of_gaussian_slopes_is_all_of_them() {
        let found = CoreSlopes::of_slopes(&slopes(|u| 0.03 * gaussian(u)), false);
        for along in [0.0, FRAC_PI_2, 1.0] {
            // Sums over 10,000 points of low discrepancy.
            near(found.deviation(along), 0.03, 0.01);
        }
    }

    /// One facet in five is ten times as steep: the peak is that of the others, of whose area 0.8 is left.
    #[test]
    fn steep_facets_that_are_rare_leave_the_core_as_it_is() {
        let mut all = slopes(|u| 0.03 * gaussian(u));
        for one in all.iter_mut().step_by(5) {
            one.slope = one.slope.map(|slope| 10.0 * slope);
        }
        let found = CoreSlopes::of_slopes(&all, false).deviation(0.0);
        // What is a part of all is a larger one of the others.
        let expected = 0.03 * ((1.0 - CORE / 0.8).ln() / (1.0 - CORE).ln()).sqrt();
        near(found, expected, 0.03);
    }

    #[test]
    fn slopes_along_one_axis_have_no_deviation_across() {
        let mut all = slopes(gaussian);
        all.iter_mut().for_each(|one| one.slope[1] = 0.0);
        let found = CoreSlopes::of_slopes(&all, false);
        assert!(found.deviation(FRAC_PI_2) < 1e-15);
        assert!(found.deviation(0.0) > 0.1);
        let level = CoreSlopes::of_slopes(&slopes(|_| 0.0), false);
        assert_eq!(level.deviation(0.0), 0.0);
    }

    #[test]
    fn values_that_reach_a_part_of_the_weight_are_found_among_the_smallest() {
        // Weights that lie where values are large, small, or anywhere
        for exponent in [-8, 0, 8] {
            let weight = |i: usize| ((i as f64 + 0.5) / 1000.0).powi(exponent);
            let value = |i: usize| ((i * 607) % 1000) as f64;
            let mut pairs: Vec<[f64; 2]> = (0..1000)
                .map(|i| [value(i), weight(value(i) as usize)])
                .collect();
            let all: f64 = (0..1000).map(weight).sum();
            for part in [1e-3, CORE, 0.5, 0.999] {
                let mut below = 0.0;
                let expected = (0..1000).find(|&i| {
                    below += weight(i);
                    below >= part * all
                });
                let found = first_to_reach(&mut pairs, part * all);
                assert_eq!(found, expected.map(|i| i as f64), "{exponent} {part}");
            }
            assert_eq!(first_to_reach(&mut pairs, 2.0 * all), None);
        }
        assert_eq!(first_to_reach(&mut [[3.0, 1.0]], 0.5), Some(3.0));
        assert_eq!(first_to_reach(&mut [], 0.5), None);
    }

    /// Facets without a slope across deviate less where slopes are correlated: the deviation is that of the section through zero.
    #[test]
    fn correlated_slopes_have_the_width_of_their_section() {
        let slopes = CoreSlopes([1.0, 0.6, 1.0]);
        near(slopes.deviation(0.0), 0.8, 1e-12);
        near(slopes.deviation(FRAC_PI_4), 1.6_f64.sqrt(), 1e-12);
    }

    #[test]
    fn facets_of_a_drawn_surface_have_the_slopes_of_its_spectrum() {
        let psd = Psd::gaussian(0.5, 12.0).unwrap();
        let synthesis = Synthesis::new(psd, [192, 192], [1.0, 1.0], false).unwrap();
        let field = synthesis.draw(5, 0).unwrap();
        let expected = (2.0_f64).sqrt() * 0.5 / 12.0;
        for border in [Border::Periodic, Border::Mirrored] {
            let surface = Surface::new(field.clone().with_border(border));
            let found = CoreSlopes::of_facets(&surface).deviation(0.0);
            // 256 correlation areas: how many facets are nearly level is known to some ten per cent.
            near(found, expected, 0.2);
        }
        let flat = HeightField::new(vec![1.0; 16], [4, 4], [1.0, 1.0]).unwrap();
        assert_eq!(
            CoreSlopes::of_facets(&Surface::new(flat)),
            CoreSlopes([0.0; 3])
        );
    }
}
