//! Spread: directions about one of incidence that light comes from, uniformly in projected solid angle.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use asperity_numerics::elementary::{cos, sin};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{Incidence, around, from_spherical};

/// The directions that light comes from, in place of the one of incidence.
///
/// Flux is uniform in projected solid angle `cos(theta) dOmega`: radiance is the same from all of them. Two-sided results of patches are
/// then reciprocal patch by patch.
///
/// # Examples
/// ```
/// use asperity_optics::{Incidence, Spread};
///
/// // The patch of the Klems basis around 30 degrees: 25 to 35 degrees, a twentieth of the azimuths
/// let incidence = Incidence::from_degrees(30.0, 0.0)?;
/// let spread = Spread::klems(incidence)?;
/// let ring = 25_f64.to_radians().cos().powi(2) - 35_f64.to_radians().cos().powi(2);
/// let patch = std::f64::consts::PI * ring / 20.0;
/// assert!((spread.projected_solid_angle(incidence) / patch - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Spread {
    /// A cone about the direction of incidence.
    Cone {
        /// Half angle, radians.
        half_angle: f64,
    },
    /// A patch of the hemisphere.
    Patch {
        /// Bounds of the polar angle, radians.
        theta: [f64; 2],
        /// Bounds of the azimuth, radians, at most a turn apart.
        phi: [f64; 2],
    },
}

/// Error of directions that are no spread of light.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpreadError {
    /// A cone that reaches the horizon.
    #[error(
        "a cone of {half_angle} deg about theta {theta} deg reaches the horizon; give a smaller angle"
    )]
    BelowHorizon {
        /// Half angle, degrees.
        half_angle: f64,
        /// Polar angle of its axis, degrees.
        theta: f64,
    },
    /// A direction that is not the centre of a patch of the Klems basis.
    #[error(
        "theta {theta}, phi {phi} deg is not the centre of a patch of the Klems basis; the nearest is theta {}, phi {} deg",
        centre[0], centre[1]
    )]
    OffCentre {
        /// Polar angle, degrees.
        theta: f64,
        /// Azimuth, degrees.
        phi: f64,
        /// The centre of the patch that it lies in.
        centre: [f64; 2],
    },
    /// Widths out of range.
    #[error(
        "a patch is {0} x {1} deg wide; theta must be above 0 and at most 180, phi above 0 and at most 360"
    )]
    BadWidth(f64, f64),
}

/// Upper bounds of the polar angle of the rings of the full Klems basis, degrees, and the number of patches in each.
///
/// # Source
/// J. H. Klems, ASHRAE Transactions 100 (1994); the bounds are those of LBNL's Window.
pub const KLEMS: [(f64, f64); 9] = [
    (5.0, 1.0),
    (15.0, 8.0),
    (25.0, 16.0),
    (35.0, 20.0),
    (45.0, 24.0),
    (55.0, 24.0),
    (65.0, 24.0),
    (75.0, 16.0),
    (90.0, 12.0),
];

/// Centres of the patches of the full Klems basis, polar angle and azimuth in degrees, ring by ring: 145.
///
/// # Examples
/// ```
/// use asperity_optics::klems_centres;
///
/// let centres: Vec<[f64; 2]> = klems_centres().collect();
/// assert_eq!(centres.len(), 145);
/// assert_eq!(centres[..3], [[0.0, 0.0], [10.0, 0.0], [10.0, 45.0]]);
/// ```
pub fn klems_centres() -> impl Iterator<Item = [f64; 2]> {
    let lower = std::iter::once(0.0).chain(KLEMS.map(|(upper, _)| upper));
    lower.zip(KLEMS).flat_map(|(lower, (upper, count))| {
        // The first patch is about the normal
        let theta = if lower == 0.0 {
            0.0
        } else {
            0.5 * (lower + upper)
        };
        (0..count as usize).map(move |k| [theta, k as f64 * 360.0 / count])
    })
}

impl Spread {
    /// A cone of `half_angle` degrees about the direction of `incidence`.
    ///
    /// # Errors
    /// [`SpreadError::BelowHorizon`] unless it is above zero and the cone above the horizon.
    pub fn cone(half_angle: f64, incidence: Incidence) -> Result<Self, SpreadError> {
        let theta = incidence.theta_deg();
        if !(half_angle > 0.0 && theta + half_angle < 90.0) {
            return Err(SpreadError::BelowHorizon { half_angle, theta });
        }
        Ok(Self::Cone {
            half_angle: half_angle.to_radians(),
        })
    }

    /// A patch of these widths in polar angle and azimuth, degrees, about the direction of `incidence`, as far as it is above the horizon.
    ///
    /// # Errors
    /// [`SpreadError::BadWidth`].
    pub fn patch([theta, phi]: [f64; 2], incidence: Incidence) -> Result<Self, SpreadError> {
        if !(theta > 0.0 && theta <= 180.0 && phi > 0.0 && phi <= 360.0) {
            return Err(SpreadError::BadWidth(theta, phi));
        }
        let [half_theta, half_phi] = [theta, phi].map(|width| 0.5 * width.to_radians());
        Ok(Self::Patch {
            theta: [
                (incidence.theta() - half_theta).max(0.0),
                (incidence.theta() + half_theta).min(FRAC_PI_2),
            ],
            phi: [incidence.phi() - half_phi, incidence.phi() + half_phi],
        })
    }

    /// The patch of the full Klems basis about the direction of `incidence`.
    ///
    /// # Errors
    /// [`SpreadError::OffCentre`] unless that is the centre of a patch.
    pub fn klems(incidence: Incidence) -> Result<Self, SpreadError> {
        let theta = incidence.theta_deg();
        let below = KLEMS.iter().take_while(|(bound, _)| theta >= *bound);
        let ring = below.count().min(KLEMS.len() - 1);
        let (upper, count) = KLEMS[ring];
        let lower = ring.checked_sub(1).map_or(0.0, |inner| KLEMS[inner].0);
        // Patches are centred on multiples of their width
        let width = TAU / count;
        let middle = (incidence.phi() / width).round() * width;
        // The first patch is about the normal
        let centre = if ring == 0 {
            0.0
        } else {
            0.5 * (lower + upper)
        };
        let phi = incidence.phi_deg();
        let is_off = |a: f64, b: f64| (a - b).abs() > 1e-6;
        if is_off(theta, centre) || ring > 0 && is_off(phi, middle.to_degrees()) {
            let centre = [centre, middle.to_degrees().round().rem_euclid(360.0)];
            return Err(SpreadError::OffCentre { theta, phi, centre });
        }
        Ok(Self::Patch {
            theta: [lower, upper].map(f64::to_radians),
            phi: [middle - 0.5 * width, middle + 0.5 * width],
        })
    }

    /// Projected solid angle, steradians.
    #[must_use]
    pub fn projected_solid_angle(&self, incidence: Incidence) -> f64 {
        match *self {
            Self::Cone { half_angle } => PI * sin(half_angle).powi(2) * incidence.wi().z,
            Self::Patch { theta, phi } => {
                let [a, b] = theta.map(|theta| sin(theta).powi(2));
                0.5 * (phi[1] - phi[0]) * (b - a)
            }
        }
    }

    /// A direction towards the light, by uniform numbers in `[0, 1)`.
    pub fn sample(&self, incidence: Incidence, mut uniform: impl FnMut() -> f64) -> DVec3 {
        match *self {
            Self::Cone { half_angle } => {
                let axis = incidence.wi();
                let highest = cos((incidence.theta() - half_angle).max(0.0));
                // 1 - cos without loss of digits
                let depth = 2.0 * sin(0.5 * half_angle).powi(2);
                loop {
                    let w = around(axis, 1.0 - depth * uniform(), uniform());
                    if uniform() * highest < w.z {
                        return w;
                    }
                }
            }
            Self::Patch { theta, phi } => {
                let [a, b] = theta.map(|theta| sin(theta).powi(2));
                let sin = (a + (b - a) * uniform()).sqrt();
                let azimuth = phi[0] + (phi[1] - phi[0]) * uniform();
                let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
                // The horizon itself sends no flux
                let cos = cos.max(f64::EPSILON);
                let flat = from_spherical(FRAC_PI_2, azimuth);
                DVec3::new(sin * flat.x, sin * flat.y, cos)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SplitMix64.
    fn uniforms() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// In projected solid angle a cone is an ellipse, and uniform there: its mean is its axis, and its second moments are those of an
    /// ellipse, a quarter of the squared half axes. A patch is a sector of a ring.
    #[test]
    fn directions_are_uniform_in_projected_solid_angle() {
        let incidence = Incidence::from_degrees(50.0, 0.0).unwrap();
        let mut uniform = uniforms();
        let count = 200_000;
        let cone = Spread::cone(20.0, incidence).unwrap();
        let directions = |spread: Spread, uniform: &mut dyn FnMut() -> f64| -> Vec<DVec3> {
            (0..count)
                .map(|_| spread.sample(incidence, &mut *uniform))
                .collect()
        };
        let all = directions(cone, &mut uniform);
        let mean = all.iter().sum::<DVec3>() / f64::from(count);
        let (sin, cos) = 20_f64.to_radians().sin_cos();
        let [tilt_sin, tilt_cos] = [50_f64.to_radians().sin(), 50_f64.to_radians().cos()];
        assert!((mean.x - cos * tilt_sin).abs() < 1e-3 && mean.y.abs() < 1e-3);
        let square = |of: fn(&DVec3) -> f64, about: f64| {
            all.iter().map(|w| (of(w) - about).powi(2)).sum::<f64>() / f64::from(count)
        };
        let across = square(|w| w.y, 0.0);
        let along = square(|w| w.x, mean.x);
        assert!((across / (0.25 * sin * sin) - 1.0).abs() < 0.01, "{across}");
        assert!((along / (0.25 * (sin * tilt_cos).powi(2)) - 1.0).abs() < 0.01);
        assert!(all.iter().all(|w| w.dot(incidence.wi()) >= cos - 1e-12));
        assert!(all.iter().all(|w| (w.length() - 1.0).abs() < 1e-14));

        let klems = Spread::klems(incidence).unwrap();
        let Spread::Patch { theta, phi } = klems else {
            panic!("{klems:?}")
        };
        assert_eq!(theta, [45.0, 55.0].map(f64::to_radians));
        assert!((phi[0] + 7.5_f64.to_radians()).abs() < 1e-12);
        let all = directions(klems, &mut uniform);
        // The square of the sine is uniform: 0.0494 wide, its mean to 0.0494 / sqrt(12 * count)
        let [a, b] = theta.map(|theta| theta.sin().powi(2));
        let squares = all.iter().map(|w| w.x * w.x + w.y * w.y).sum::<f64>() / f64::from(count);
        let se = (b - a) / (12.0 * f64::from(count)).sqrt();
        assert!((squares - 0.5 * (a + b)).abs() < 4.0 * se, "{squares}");
        let azimuths = all.iter().map(|w| w.y.atan2(w.x));
        let square = azimuths.clone().map(|phi| phi * phi).sum::<f64>() / f64::from(count);
        assert!(
            azimuths
                .clone()
                .all(|azimuth| azimuth.abs() <= phi[1] + 1e-12)
        );
        assert!(
            (3.0 * square / phi[1].powi(2) - 1.0).abs() < 0.02,
            "{square}"
        );
    }

    #[test]
    fn the_patches_of_klems_fill_the_hemisphere() {
        let mut sum = 0.0;
        let mut lower = 0.0;
        for (upper, count) in KLEMS {
            let theta = if lower == 0.0 {
                0.0
            } else {
                0.5 * (lower + upper)
            };
            let incidence = Incidence::from_degrees(theta, 360.0 - 360.0 / count).unwrap();
            let patch = Spread::klems(incidence).unwrap();
            sum += count * patch.projected_solid_angle(incidence);
            lower = upper;
        }
        assert!((sum - PI).abs() < 1e-12);
    }

    #[test]
    fn patches_of_klems_are_named_by_their_centres() {
        let patch = |theta, phi| Spread::klems(Incidence::from_degrees(theta, phi).unwrap());
        assert!(patch(82.5, 330.0).is_ok() && patch(0.0, 77.0).is_ok());
        for (theta, phi) in [(33.0, 0.0), (30.0, 3.0), (1.0, 0.0)] {
            let error = patch(theta, phi).unwrap_err().to_string();
            assert!(error.contains("the nearest is"), "{error}");
        }
    }

    #[test]
    fn cones_below_the_horizon_and_patches_without_width_are_refused() {
        let incidence = Incidence::from_degrees(80.0, 0.0).unwrap();
        for half_angle in [0.0, -1.0, 10.0, f64::NAN] {
            assert!(Spread::cone(half_angle, incidence).is_err(), "{half_angle}");
        }
        for widths in [[0.0, 10.0], [10.0, 0.0], [10.0, 361.0], [f64::NAN, 1.0]] {
            assert!(Spread::patch(widths, incidence).is_err(), "{widths:?}");
        }
        let patch = Spread::patch([30.0, 360.0], incidence).unwrap();
        assert!(matches!(patch, Spread::Patch { theta: [_, top], .. } if top == FRAC_PI_2));
    }
}
