//! Phase functions: the directions into which a medium scatters light.

use std::f64::consts::PI;

use asperity_numerics::elementary::{asinh, sinh};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::direction::around;

/// Phase function: the distribution of light scattered inside a medium, by the angle between the directions before and
/// after.
///
/// # Examples
/// ```
/// use asperity_optics::{PhaseFunction, from_spherical};
///
/// let forward = PhaseFunction::henyey_greenstein(0.9)?;
/// assert!(forward.density(1.0) > forward.density(-1.0));
/// let scattered = forward.sample(from_spherical(0.3, 0.0), [0.5, 0.25]);
/// assert!((scattered.length() - 1.0).abs() < 1e-15);
/// # Ok::<(), asperity_optics::PhaseFunctionError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum PhaseFunction {
    /// Evenly into all directions.
    #[default]
    Isotropic,
    /// Henyey and Greenstein 1941: `g` is the mean cosine, forwards above zero, `-1 < g < 1`.
    HenyeyGreenstein {
        /// Mean cosine of the angle of scattering.
        g: f64,
    },
    /// By particles far smaller than the wavelength, unpolarised: `3 / (16 pi) (1 + cos^2)`.
    Rayleigh,
}

/// Error of an invalid phase function.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PhaseFunctionError {
    /// The mean cosine is out of range.
    #[error("g is {0:?}; the mean cosine of scattering must lie between -1 and 1, both excluded")]
    BadMeanCosine(f64),
}

impl PhaseFunction {
    /// Henyey-Greenstein of mean cosine `g`; isotropic for zero.
    ///
    /// # Errors
    /// [`PhaseFunctionError::BadMeanCosine`] unless `-1 < g < 1`.
    pub fn henyey_greenstein(g: f64) -> Result<Self, PhaseFunctionError> {
        if !(g > -1.0 && g < 1.0) {
            return Err(PhaseFunctionError::BadMeanCosine(g));
        }
        Ok(if g == 0.0 {
            Self::Isotropic
        } else {
            Self::HenyeyGreenstein { g }
        })
    }

    /// Mean cosine of the angle of scattering.
    #[must_use]
    pub const fn mean_cosine(self) -> f64 {
        match self {
            Self::Isotropic | Self::Rayleigh => 0.0,
            Self::HenyeyGreenstein { g } => g,
        }
    }

    /// Density per solid angle, 1/sr, at the cosine `mu` of the angle between the directions of travel
    /// before and after; its integral over the sphere is one.
    #[must_use]
    pub fn density(self, mu: f64) -> f64 {
        match self {
            Self::Isotropic => 0.25 / PI,
            Self::HenyeyGreenstein { g } => {
                // 1 + g^2 - 2 g mu, without cancellation where g is near one and mu too.
                let denominator = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - mu);
                0.25 / PI * (1.0 - g) * (1.0 + g) / (denominator * denominator.sqrt())
            }
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + mu * mu),
        }
    }

    /// The direction after scattering of light that travels along the unit vector `d`, by two uniform
    /// numbers in `[0, 1)`.
    #[must_use]
    #[inline(always)]
    pub fn sample(self, d: DVec3, [u, v]: [f64; 2]) -> DVec3 {
        let s = 2.0 * u - 1.0;
        match self {
            // Any frame does.
            Self::Isotropic => around(DVec3::Z, s, v),
            Self::HenyeyGreenstein { g } => around(d, henyey_greenstein_cosine(g, s), v),
            Self::Rayleigh => around(d, rayleigh_cosine(s), v),
        }
    }
}

/// Inverse of the cumulative distribution of the cosine for Henyey-Greenstein at `(1 + s) / 2`, expanded so
/// that nothing cancels for small `g`.
#[inline(always)]
fn henyey_greenstein_cosine(g: f64, s: f64) -> f64 {
    let g2 = g * g;
    let numerator = 2.0 * s * (1.0 + g2) + g * (s * s * (1.0 + g2) + 3.0 - g2);
    let root = 1.0 + g * s;
    (numerator / (2.0 * root * root)).clamp(-1.0, 1.0)
}

/// Cosine of the Rayleigh scattering angle: the real root of `mu^3 + 3 mu = 4 s`. See [`henyey_greenstein_cosine`].
#[inline(always)]
fn rayleigh_cosine(s: f64) -> f64 {
    (2.0 * sinh(asinh(2.0 * s) / 3.0)).clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::from_spherical;

    const ALL: [PhaseFunction; 6] = [
        PhaseFunction::Isotropic,
        PhaseFunction::Rayleigh,
        PhaseFunction::HenyeyGreenstein { g: 0.9 },
        PhaseFunction::HenyeyGreenstein { g: -0.5 },
        PhaseFunction::HenyeyGreenstein { g: 1e-9 },
        PhaseFunction::HenyeyGreenstein { g: 0.99 },
    ];

    /// Integral over `mu` from -1 to 1, in steps that shrink towards both ends as those of a peak do.
    fn integral(f: impl Fn(f64) -> f64) -> f64 {
        let n = 200_000;
        (0..n)
            .map(|i| {
                let t = PI * (f64::from(i) + 0.5) / f64::from(n);
                f(t.cos()) * t.sin() * PI / f64::from(n)
            })
            .sum()
    }

    #[test]
    fn density_is_normalised_and_has_its_mean_cosine() {
        for phase in ALL {
            // The midpoint rule: 1e-10 of a peak that is 1e-2 wide and cut into 3000 steps.
            let whole = 2.0 * PI * integral(|mu| phase.density(mu));
            let mean = 2.0 * PI * integral(|mu| mu * phase.density(mu));
            assert!((whole - 1.0).abs() < 1e-6, "{phase:?} {whole}");
            assert!(
                (mean - phase.mean_cosine()).abs() < 1e-6,
                "{phase:?} {mean}"
            );
        }
    }

    #[test]
    fn directions_follow_the_density() {
        // The cosine at the quantile u leaves the fraction u of the density below it.
        let d = from_spherical(1.1, 2.0);
        for phase in ALL {
            for u in [0.001, 0.1, 0.4, 0.5, 0.9, 0.999] {
                let w = phase.sample(d, [u, 0.3]);
                assert!((w.length() - 1.0).abs() < 1e-14);
                let mu = if phase == PhaseFunction::Isotropic {
                    w.z
                } else {
                    w.dot(d)
                };
                let below = 2.0 * PI * integral(|x| if x < mu { phase.density(x) } else { 0.0 });
                // One step of the rule, where the density is highest.
                assert!((below - u).abs() < 2e-3, "{phase:?} {u} {below}");
            }
        }
    }

    #[test]
    fn azimuths_about_the_old_direction_are_even() {
        for d in [DVec3::Z, DVec3::NEG_Z, from_spherical(0.7, 4.0)] {
            let phase = PhaseFunction::HenyeyGreenstein { g: 0.3 };
            let n = 16;
            let sum: DVec3 = (0..n)
                .map(|i| phase.sample(d, [0.3, f64::from(i) / f64::from(n)]))
                .sum();
            assert!((sum.normalize().dot(d).abs() - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn mean_cosines_out_of_range_are_refused() {
        for g in [-1.0, 1.0, 1.5, f64::NAN] {
            assert!(PhaseFunction::henyey_greenstein(g).is_err());
        }
        assert_eq!(
            PhaseFunction::henyey_greenstein(0.0),
            Ok(PhaseFunction::Isotropic)
        );
    }
}
