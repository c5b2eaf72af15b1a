//! Lobe: where a level surface would send the light of a side, and how wide the light of a rough one spreads about that.
//!
//! A facet whose slope along the plane of incidence is `p` turns reflected light by `2 p`, one whose slope across it is `q` moves it
//! sideways by `2 q cos(theta_i)`. Refracted light is turned by `p (1 - cos(theta_i) / (eta cos(theta_t)))` and moved sideways by
//! `q (cos(theta_t) - cos(theta_i) / eta)`: Snell's law, to first order in the slopes. The lobe of Gaussian slopes is then a Gaussian
//! to first order too, and falls to half at `sqrt(2 ln 2)` deviations. A level bottom of the same index refracts the light of a slab once more, into the
//! medium that it came from: angles along the plane of incidence grow by `eta cos(theta_t) / cos(theta_i)`, across it by `eta`.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_numerics::elementary::{asin, cos, sin};
use asperity_optics::{Incidence, Material, from_spherical};
use asperity_tally::{HemisphereGrid, Side};
use serde::Serialize;

use super::core_slopes::CoreSlopes;
use crate::input::case::{Case, Light};

/// Deviations of a Gaussian after which it has fallen to half: `sqrt(2 ln 2)`.
const HALF_MAXIMUM: f64 = 1.177_410_022_515_474_7;

/// Half width below which a lobe is that of a mirror, degrees: no bins resolve it.
const MIN_HALF_WIDTH_DEG: f64 = 0.002;

/// Largest shortfall of the mean over a bin below the peak of a lobe, as a fraction of the peak, before the bin counts as wider than the lobe.
pub const MAX_SHORTFALL: f64 = 0.04;

/// The lobe of light that is scattered once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Lobe {
    /// The side.
    pub side: Side,
    /// Polar angle of its middle from +z, degrees: the mirror direction of the mean plane, or the refracted one.
    pub theta_deg: f64,
    /// Azimuth of its middle, degrees.
    pub phi_deg: f64,
    /// Half widths at half maximum of a Gaussian lobe, degrees of arc: along the polar angle, and across.
    pub half_width_deg: [f64; 2],
}

impl Lobe {
    /// The lobes of light that falls on a surface of these slopes, reflected and transmitted; `None` where no light leaves, where
    /// refraction ends at total reflection, or where facets reflect diffusely.
    #[must_use]
    pub fn of(light: &Light, material: &Material, slopes: CoreSlopes) -> [Option<Self>; 2] {
        if material.is_diffuse() {
            return [None; 2];
        }
        let slopes = if light.random_azimuth {
            slopes.over_azimuth()
        } else {
            slopes
        };
        Side::BOTH.map(|side| Self::of_side(light.incidence, material, side, slopes))
    }

    /// The lobes of a case. Light that is transmitted through several layers, or into another medium than it came from, has none, and none are known of a surface that is only described.
    #[must_use]
    pub fn of_case(case: &Case) -> [Option<Self>; 2] {
        Self::of_slopes(case, CoreSlopes::of_source(&case.surface))
    }

    /// The lobes of a case whose surface has these slopes.
    #[must_use]
    pub fn of_slopes(case: &Case, slopes: Option<CoreSlopes>) -> [Option<Self>; 2] {
        // Of layers that are lit from below the lowest bottom reflects first; light of several directions has wider lobes.
        let is_known = !case.is_turned_over() && case.light.spread.is_none();
        let Some(slopes) = slopes.filter(|_| is_known) else {
            return [None; 2];
        };
        let [reflected, transmitted] = Self::of(&case.light, &case.material, slopes);
        let transmitted = match case.layers.as_slice() {
            [] => transmitted,
            [_] if case.passes_on() => {
                transmitted.and_then(|lobe| lobe.through_slab(&case.light, &case.material))
            }
            _ => None,
        };
        [reflected, transmitted]
    }

    fn of_side(
        incidence: Incidence,
        material: &Material,
        side: Side,
        slopes: CoreSlopes,
    ) -> Option<Self> {
        let forward = incidence.phi() + PI;
        let deviations = [forward, forward + FRAC_PI_2].map(|azimuth| slopes.deviation(azimuth));
        let cos_i = cos(incidence.theta());
        let (theta, turns) = match side {
            // Equal indices reflect nothing.
            Side::Reflected if *material == Material::Dielectric { eta: 1.0 } => return None,
            Side::Reflected => (incidence.theta(), [2.0, 2.0 * cos_i]),
            Side::Transmitted => {
                let eta = material.transmitting_index()?;
                let sin_t = sin(incidence.theta()) / eta;
                if sin_t >= 1.0 {
                    return None;
                }
                let cos_t = (1.0 - sin_t * sin_t).sqrt();
                // The difference of the cosines, without cancellation: zero of equal indices
                let across = (1.0 - eta.powi(-2)).abs() / (cos_t + cos_i / eta);
                (PI - asin(sin_t), [across / cos_t, across])
            }
        };
        let half_width = |i: usize| (HALF_MAXIMUM * deviations[i] * turns[i]).to_degrees();
        Some(Self {
            side,
            theta_deg: theta.to_degrees(),
            phi_deg: forward.to_degrees().rem_euclid(360.0),
            half_width_deg: [half_width(0), half_width(1)],
        })
    }

    /// The lobe of transmitted light behind a level bottom, on the other side of which is the medium that the light came from.
    fn through_slab(self, light: &Light, material: &Material) -> Option<Self> {
        let eta = material.transmitting_index()?;
        let cos_t = -cos(self.theta_deg.to_radians());
        let [along, across] = self.half_width_deg;
        Some(Self {
            theta_deg: 180.0 - light.incidence.theta_deg(),
            half_width_deg: [
                along * eta * cos_t / cos(light.incidence.theta()),
                across * eta,
            ],
            ..self
        })
    }

    /// The smaller of its half widths, degrees.
    #[must_use]
    pub fn narrowest_deg(&self) -> f64 {
        let [along, across] = self.half_width_deg;
        along.min(across)
    }

    /// Returns `true` if it is as narrow as that of a mirror, which no bins resolve.
    #[must_use]
    pub fn is_mirror_like(&self) -> bool {
        self.narrowest_deg() <= MIN_HALF_WIDTH_DEG
    }

    /// Sine of the polar angle of its middle.
    pub(crate) fn sin_theta(&self) -> f64 {
        sin(self.theta_deg.to_radians())
    }

    /// Widths of the bin that holds its middle, degrees of arc: along the polar angle, and across.
    #[must_use]
    pub fn bin_deg(&self, grid: &HemisphereGrid) -> [f64; 2] {
        let middle = from_spherical(self.theta_deg.to_radians(), self.phi_deg.to_radians());
        let bin = grid.bin(grid.index_of(self.side, middle));
        let [theta, phi] = [bin.theta, bin.phi].map(|[from, to]| (to - from).to_degrees());
        let sin_theta = sin(0.5 * (bin.theta[0] + bin.theta[1]));
        [theta, phi * sin_theta]
    }

    /// Shortfall of the mean over the bin that holds its middle below its peak, as a fraction of the peak.
    ///
    /// To second order, a bin of width `w` anywhere about the peak of a Gaussian of deviation `d` misses `w^2 / (12 d^2)` on average: half of
    /// that if the peak is in its middle, and twice as much at its edge.
    #[must_use]
    pub fn shortfall(&self, grid: &HemisphereGrid) -> f64 {
        let widths = self.bin_deg(grid);
        let parts = widths.iter().zip(self.half_width_deg).map(|(bin, half)| {
            let deviations = bin * HALF_MAXIMUM / half;
            deviations * deviations / 12.0
        });
        parts.sum::<f64>().min(1.0)
    }

    /// Returns `true` if bins of a grid tell its peak.
    #[must_use]
    pub fn is_resolved(&self, grid: &HemisphereGrid) -> bool {
        self.shortfall(grid) <= MAX_SHORTFALL
    }
}
