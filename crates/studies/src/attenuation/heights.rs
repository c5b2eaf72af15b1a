//! The visibility of points by their height, against Smith and Xu and Sun.

use asperity_analysis::{smith_visibility, xu_sun_visibility};
use asperity_numerics::elementary::{exp, tan};
use asperity_optics::Incidence;
use asperity_tally::Estimate;

use super::counts::Counts;
use super::estimate::ratio;
use super::plan::RoughSurfaces;

/// Bins of heights over sigma; the middle one lies about zero.
pub(super) const BINS: usize = 29;

/// Width of a bin, in sigma.
const WIDTH: f64 = 0.25;

/// The bin that holds a height over sigma; `None` beyond the outermost.
pub(super) fn bin(height: f64) -> Option<usize> {
    let place = (height / WIDTH + 0.5 * BINS as f64).floor();
    (0.0..BINS as f64)
        .contains(&place)
        .then_some(place as usize)
}

/// Lower and upper end of a bin, in sigma.
fn ends(bin: usize) -> [f64; 2] {
    [bin, bin + 1].map(|end| (end as f64 - 0.5 * BINS as f64) * WIDTH)
}

/// The visibility of the points of some height that face the light.
#[derive(Clone, Debug)]
pub struct VisibilityRow {
    /// Root mean square height of the surfaces, length units.
    pub sigma: f64,
    /// Polar angle of the direction towards the light, degrees.
    pub theta: f64,
    /// `tan(theta) / s`, the only parameter of the models.
    pub x: f64,
    /// Lowest height, in sigma.
    pub height_min: f64,
    /// Highest height, in sigma.
    pub height_max: f64,
    /// Points of that height that face the light, a surface.
    pub points: f64,
    /// Fraction of them that see it; `None` where there are no such points.
    pub visibility: Option<Estimate>,
    /// Smith's `Phi(h)^Lambda`, the mean over the bin's three-point rule.
    pub smith: f64,
    /// Eq. 24 of Xu and Sun 2008, in the bin about height zero, for which alone it stands.
    pub xu_sun: Option<f64>,
}

/// The rows of one light, number `light`, on surfaces of one sigma.
pub(super) fn rows(
    surfaces: &RoughSurfaces,
    tau: f64,
    (light, incidence): (usize, &Incidence),
    counts: &[&Counts],
) -> Vec<VisibilityRow> {
    let wi = incidence.wi();
    let smoothness = tau / surfaces.sigma;
    let row = |bin: usize| {
        let seen = |counts: &&Counts| {
            let (seen, place) = (&counts.heights, light * BINS + bin);
            [seen.free[place], seen.facing[place]].map(|count| count as f64)
        };
        let points: f64 = counts.iter().map(|counts| seen(counts)[1]).sum();
        let [low, high] = ends(bin);
        let middle = 0.5 * (low + high);
        // Simpson's rule with the density of heights.
        let weighted = [(low, 1.0), (middle, 4.0), (high, 1.0)].map(|(h, weight)| {
            let weight = weight * exp(-0.5 * h * h);
            [weight * smith_visibility(&surfaces.slopes, wi, h), weight]
        });
        let sum = |i: usize| weighted.iter().map(|pair| pair[i]).sum::<f64>();
        VisibilityRow {
            sigma: surfaces.sigma,
            theta: incidence.theta_deg(),
            x: tan(incidence.theta()) / smoothness,
            height_min: low,
            height_max: high,
            points: points / counts.len() as f64,
            visibility: (points > 0.0).then(|| ratio(counts.iter().map(seen))),
            smith: sum(0) / sum(1),
            xu_sun: (bin == BINS / 2).then(|| xu_sun_visibility(wi, smoothness)),
        }
    };
    (0..BINS).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_lie_about_zero_and_hold_their_heights() {
        assert_eq!(bin(0.0), Some(BINS / 2));
        let [low, high] = ends(BINS / 2);
        assert_eq!(low, -high);
        for h in [-3.6, -1.01, 0.12, 0.13, 3.6] {
            let [low, high] = ends(bin(h).unwrap());
            assert!(low <= h && h < high, "{h}");
        }
        assert_eq!(bin(3.7), None);
        assert_eq!(bin(-3.7), None);
    }
}
