//! Power spectral densities of random surfaces.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

/// A two-sided power spectral density of surface height over the angular wave vector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Psd {
    /// Gaussian autocorrelation `C = sigma^2 exp(-u^2 / tau_x^2 - v^2 / tau_y^2)`, where `(u, v)`
    /// are the coordinates of the lag in axes turned by `azimuth` from `(x, y)`.
    Gaussian {
        /// Root mean square height, length units, above zero.
        sigma: f64,
        /// 1/e correlation length along the first principal axis, length units, above zero.
        tau_x: f64,
        /// 1/e correlation length along the second principal axis, length units, above zero.
        tau_y: f64,
        /// Angle from +x to the first principal axis, radians.
        azimuth: f64,
    },
}

/// Why a power spectral density is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PsdError {
    /// A parameter is zero, negative or not finite.
    #[error("{name} is {value}; it must be {allowed}")]
    BadParameter {
        /// Name of the parameter.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
}

impl Psd {
    /// The isotropic Gaussian: root mean square height `sigma`, 1/e correlation length `tau`.
    ///
    /// # Errors
    /// [`PsdError::BadParameter`] unless both are positive and finite.
    pub fn gaussian(sigma: f64, tau: f64) -> Result<Self, PsdError> {
        Self::anisotropic_gaussian(sigma, tau, tau, 0.0)
    }

    /// The anisotropic Gaussian; `azimuth` in radians from +x to the axis of `tau_x`.
    ///
    /// # Errors
    /// [`PsdError::BadParameter`] unless the lengths are positive and finite and the azimuth finite.
    pub fn anisotropic_gaussian(
        sigma: f64,
        tau_x: f64,
        tau_y: f64,
        azimuth: f64,
    ) -> Result<Self, PsdError> {
        for (name, value) in [("sigma", sigma), ("tau_x", tau_x), ("tau_y", tau_y)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(PsdError::BadParameter {
                    name,
                    value,
                    allowed: "positive and finite",
                });
            }
        }
        if !azimuth.is_finite() {
            return Err(PsdError::BadParameter {
                name: "azimuth",
                value: azimuth,
                allowed: "finite",
            });
        }
        Ok(Self::Gaussian {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        })
    }

    /// `W(kx, ky)` in length units to the fourth; `kx`, `ky` in radians a length unit.
    #[must_use]
    pub fn density(&self, kx: f64, ky: f64) -> f64 {
        let Self::Gaussian {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        } = *self;
        let (sin, cos) = azimuth.sin_cos();
        let ku = kx * cos + ky * sin;
        let kv = ky * cos - kx * sin;
        let exponent = ((ku * tau_x).powi(2) + (kv * tau_y).powi(2)) / 4.0;
        sigma * sigma * tau_x * tau_y / (4.0 * PI) * (-exponent).exp()
    }

    /// Root mean square height.
    #[must_use]
    pub const fn sigma(&self) -> f64 {
        let Self::Gaussian { sigma, .. } = *self;
        sigma
    }

    /// 1/e correlation lengths along the two principal axes.
    #[must_use]
    pub const fn correlation_lengths(&self) -> [f64; 2] {
        let Self::Gaussian { tau_x, tau_y, .. } = *self;
        [tau_x, tau_y]
    }

    /// Whether the statistics do not depend on azimuth.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        let [tau_x, tau_y] = self.correlation_lengths();
        tau_x == tau_y
    }

    /// Autocorrelation `C(x, y)` at the lag `(x, y)`, length units squared.
    #[must_use]
    pub fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        let Self::Gaussian {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        } = *self;
        let (sin, cos) = azimuth.sin_cos();
        let u = x * cos + y * sin;
        let v = y * cos - x * sin;
        sigma * sigma * (-(u / tau_x).powi(2) - (v / tau_y).powi(2)).exp()
    }

    /// Slope variances along x and y, `[-C_xx(0), -C_yy(0)]`, of the continuous surface.
    #[must_use]
    pub fn slope_variance(&self) -> [f64; 2] {
        let Self::Gaussian {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        } = *self;
        let (sin, cos) = azimuth.sin_cos();
        let along_u = 2.0 * (sigma / tau_x).powi(2);
        let along_v = 2.0 * (sigma / tau_y).powi(2);
        [
            along_u * cos * cos + along_v * sin * sin,
            along_u * sin * sin + along_v * cos * cos,
        ]
    }
}

/// How a surface was generated: what was asked for, and from which random stream it came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The power spectral density asked for.
    pub psd: Psd,
    /// The seed.
    pub seed: u64,
    /// The realisation drawn from that seed, counted from zero.
    pub realisation: u64,
}
