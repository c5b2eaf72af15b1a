//! Axes: correlation lengths along two principal axes, and the angle to the first.

use asperity_numerics::elementary::{hypot, sin, sin_cos};
use serde::{Deserialize, Serialize};

use super::error::positive;

/// 1/e correlation lengths along two principal axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Axes {
    tau_x: f64,
    tau_y: f64,
    /// Angle from +x to the first axis, radians.
    azimuth: f64,
}

impl Axes {
    pub(super) const fn new(tau_x: f64, tau_y: f64, azimuth: f64) -> Self {
        Self {
            tau_x,
            tau_y,
            azimuth,
        }
    }

    pub(super) const fn isotropic(tau: f64) -> Self {
        Self::new(tau, tau, 0.0)
    }

    pub(super) const fn lengths(&self) -> [f64; 2] {
        [self.tau_x, self.tau_y]
    }

    pub(super) fn is_isotropic(&self) -> bool {
        self.tau_x == self.tau_y
    }

    pub(super) fn anisotropy(&self) -> Option<[f64; 2]> {
        (!self.is_isotropic()).then(|| [self.tau_y / self.tau_x, self.azimuth])
    }

    pub(super) fn is_mirror_symmetric(&self) -> bool {
        self.is_isotropic() || sin(2.0 * self.azimuth).abs() < 1e-9
    }

    /// Lags along x and y of the 1/e contour.
    pub(super) fn axis_lengths(&self) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.azimuth);
        [
            hypot(cos / self.tau_x, sin / self.tau_y).recip(),
            hypot(sin / self.tau_x, cos / self.tau_y).recip(),
        ]
    }

    /// Farthest reach of that contour along x and y.
    pub(super) fn extents(&self) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.azimuth);
        [
            hypot(cos * self.tau_x, sin * self.tau_y),
            hypot(sin * self.tau_x, cos * self.tau_y),
        ]
    }

    /// Length of a lag in correlation lengths.
    pub(super) fn distance(&self, x: f64, y: f64) -> f64 {
        let (sin, cos) = sin_cos(self.azimuth);
        let (u, v) = (x * cos + y * sin, y * cos - x * sin);
        hypot(u / self.tau_x, v / self.tau_y)
    }

    /// `[xx, xy, yy]` of `(tau_x k_u)^2 + (tau_y k_v)^2 = xx kx^2 + xy kx ky + yy ky^2`.
    pub(super) fn square_form(&self) -> [f64; 3] {
        let (sin, cos) = sin_cos(self.azimuth);
        let (uu, vv) = (self.tau_x * self.tau_x, self.tau_y * self.tau_y);
        [
            uu * cos * cos + vv * sin * sin,
            (uu - vv) * 2.0 * sin * cos,
            uu * sin * sin + vv * cos * cos,
        ]
    }

    /// Covariance `[xx, xy, yy]` of a vector whose variance along an axis is `unit` over the square of its length.
    pub(super) fn covariance(&self, unit: f64) -> [f64; 3] {
        let (sin, cos) = sin_cos(self.azimuth);
        let [along_u, along_v] = self.lengths().map(|tau| unit / (tau * tau));
        [
            along_u * cos * cos + along_v * sin * sin,
            (along_u - along_v) * sin * cos,
            along_u * sin * sin + along_v * cos * cos,
        ]
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self::new(convert(self.tau_x), convert(self.tau_y), self.azimuth)
    }

    pub(super) fn is_valid(&self) -> bool {
        let lengths = self.lengths().map(|tau| positive("tau", tau));
        lengths.iter().all(Result::is_ok) && self.azimuth.is_finite()
    }
}
