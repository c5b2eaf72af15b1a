//! Gaussian power spectral density, the transform of a Gaussian autocorrelation.

use std::f64::consts::PI;

use asperity_numerics::elementary::{exp, ln, sin_cos};
use serde::{Deserialize, Serialize};

use super::axes::Axes;

/// Gaussian autocorrelation `C = sigma^2 exp(-u^2 / tau_x^2 - v^2 / tau_y^2)`, where `(u, v)` are the
/// coordinates of the lag in axes turned by `azimuth` from `(x, y)`.
///
/// Made by [`Psd::gaussian`](super::psd::Psd::gaussian) and
/// [`Psd::anisotropic_gaussian`](super::psd::Psd::anisotropic_gaussian), which check its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct GaussianPsd {
    /// Root mean square height, length units, above zero.
    pub sigma: f64,
    /// 1/e correlation length along the first principal axis, length units, above zero.
    pub tau_x: f64,
    /// 1/e correlation length along the second principal axis, length units, above zero.
    pub tau_y: f64,
    /// Angle from +x to the first principal axis, radians.
    pub azimuth: f64,
}

/// The methods of [`Psd`](super::psd::Psd), where they are documented.
impl GaussianPsd {
    pub(super) fn density(&self, kx: f64, ky: f64) -> f64 {
        self.prepared().at(kx, ky)
    }

    pub(crate) fn prepared(&self) -> PreparedGaussian {
        let Self {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        } = *self;
        let (sin, cos) = sin_cos(azimuth);
        let (uu, vv) = (tau_x * tau_x / 4.0, tau_y * tau_y / 4.0);
        PreparedGaussian {
            peak: sigma * sigma * tau_x * tau_y / (4.0 * PI),
            xx: uu * cos * cos + vv * sin * sin,
            xy: (uu - vv) * 2.0 * sin * cos,
            yy: uu * sin * sin + vv * cos * cos,
        }
    }

    pub(crate) fn reach(&self, fraction: f64) -> [f64; 2] {
        // The contour of exponent E reaches k = 2 sqrt(E) / length along an axis, where length is
        // that at which the autocorrelation is 1/e along this axis: the two are polar to each other.
        self.axes()
            .axis_lengths()
            .map(|length| 2.0 * (-ln(fraction)).sqrt() / length)
    }

    pub(super) const fn axes(&self) -> Axes {
        Axes::new(self.tau_x, self.tau_y, self.azimuth)
    }

    pub(super) const fn sigma(&self) -> f64 {
        self.sigma
    }

    pub(super) fn curvature(&self) -> f64 {
        // The fourth derivative of sigma^2 exp(-u^2 / tau^2) at zero is 12 sigma^2 / tau^4
        let tau = self.tau_x.min(self.tau_y);
        12_f64.sqrt() * self.sigma / (tau * tau)
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self {
            sigma: convert(self.sigma),
            tau_x: convert(self.tau_x),
            tau_y: convert(self.tau_y),
            azimuth: self.azimuth,
        }
    }

    pub(super) fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        let Self {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        } = *self;
        let (sin, cos) = sin_cos(azimuth);
        let u = x * cos + y * sin;
        let v = y * cos - x * sin;
        sigma * sigma * exp(-(u / tau_x).powi(2) - (v / tau_y).powi(2))
    }

    pub(super) fn slope_covariance(&self) -> [f64; 3] {
        let Self {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        } = *self;
        let (sin, cos) = sin_cos(azimuth);
        let along_u = 2.0 * (sigma / tau_x).powi(2);
        let along_v = 2.0 * (sigma / tau_y).powi(2);
        [
            along_u * cos * cos + along_v * sin * sin,
            (along_u - along_v) * sin * cos,
            along_u * sin * sin + along_v * cos * cos,
        ]
    }
}

/// `W(k) = peak exp(-(xx kx^2 + xy kx ky + yy ky^2))`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedGaussian {
    peak: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl PreparedGaussian {
    /// `W(kx, ky)`, as [`Psd::density`](super::psd::Psd::density).
    pub(crate) fn at(&self, kx: f64, ky: f64) -> f64 {
        self.peak * exp(-(self.xx * kx * kx + self.xy * kx * ky + self.yy * ky * ky))
    }

    /// Returns `true` if `W` is a function of `kx` times a function of `ky`.
    pub(crate) fn is_separable(&self) -> bool {
        self.xy == 0.0
    }

    /// The factor of a separable `W` that depends on `ky`, 1 at `ky = 0`.
    pub(crate) fn factor_along_y(&self, ky: f64) -> f64 {
        debug_assert!(self.is_separable());
        exp(-self.yy * ky * ky)
    }

    /// Largest `|ky|` at which, for this `kx`, the density is `fraction` of its peak; none if it
    /// stays below.
    pub(crate) fn reach_along_y(&self, kx: f64, fraction: f64) -> Option<f64> {
        // The larger root of yy ky^2 - |xy kx| ky + xx kx^2 + ln(fraction) = 0
        let b = (self.xy * kx).abs();
        let discriminant = b * b - 4.0 * self.yy * (self.xx * kx * kx + ln(fraction));
        (discriminant >= 0.0).then(|| (b + discriminant.sqrt()) / (2.0 * self.yy))
    }
}
