//! Power spectral densities of random surfaces.

mod gaussian;

use serde::{Deserialize, Serialize};

pub use self::gaussian::GaussianPsd;
pub(crate) use self::gaussian::PreparedDensity;

/// A two-sided power spectral density of surface height over the angular wave vector.
///
/// # Examples
/// ```
/// use asperity_surface::Psd;
///
/// // Root mean square height 0.5, correlation length 2: smoothness tau / sigma = 4
/// let psd = Psd::gaussian(0.5, 2.0)?;
/// // Slope variance per axis 2 / s^2
/// assert_eq!(psd.slope_variance(), [0.125, 0.125]);
/// # Ok::<(), asperity_surface::PsdError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Psd {
    /// Gaussian, isotropic or anisotropic.
    Gaussian(GaussianPsd),
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
        for (name, value) in [("tau", tau_x), ("tau_y", tau_y), ("sigma", sigma)] {
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
        Ok(Self::Gaussian(GaussianPsd {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        }))
    }

    /// `W(kx, ky)` in length units to the fourth; `kx`, `ky` in radians per length unit.
    #[must_use]
    pub fn density(&self, kx: f64, ky: f64) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.density(kx, ky),
        }
    }

    /// The density, with everything precomputed that does not depend on the wave vector.
    pub(crate) fn prepared(&self) -> PreparedDensity {
        match self {
            Self::Gaussian(gaussian) => gaussian.prepared(),
        }
    }

    /// Largest `[|kx|, |ky|]` at which the density is `fraction` of its peak, radians per length unit.
    pub(crate) fn reach(&self, fraction: f64) -> [f64; 2] {
        match self {
            Self::Gaussian(gaussian) => gaussian.reach(fraction),
        }
    }

    /// Root mean square height.
    #[must_use]
    pub const fn sigma(&self) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.sigma(),
        }
    }

    /// 1/e correlation lengths along the two principal axes.
    #[must_use]
    pub const fn correlation_lengths(&self) -> [f64; 2] {
        match self {
            Self::Gaussian(gaussian) => gaussian.correlation_lengths(),
        }
    }

    /// The correlation length along the second principal axis over that along the first, and the angle from +x
    /// to the first, radians; `None` if it [is isotropic](Self::is_isotropic).
    #[must_use]
    pub fn anisotropy(&self) -> Option<[f64; 2]> {
        match self {
            Self::Gaussian(gaussian) => gaussian.anisotropy(),
        }
    }

    /// Whether the statistics do not depend on azimuth.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Gaussian(gaussian) => gaussian.is_isotropic(),
        }
    }

    /// Lags along x and along y at which the autocorrelation is 1/e of its peak, length units:
    /// `[tau_x, tau_y]` if the azimuth is zero. Along an axis, the slope variance is
    /// `2 sigma^2 / length^2`.
    #[must_use]
    pub fn axis_correlation_lengths(&self) -> [f64; 2] {
        match self {
            Self::Gaussian(gaussian) => gaussian.axis_correlation_lengths(),
        }
    }

    /// Farthest reach along x and along y of the contour on which the autocorrelation is 1/e of its
    /// peak, length units: `[tau_x, tau_y]` if the azimuth is zero.
    #[must_use]
    pub fn correlation_extents(&self) -> [f64; 2] {
        match self {
            Self::Gaussian(gaussian) => gaussian.correlation_extents(),
        }
    }

    /// Whether the statistics are the same on either side of the x axis, and so of the y axis.
    #[must_use]
    pub fn is_mirror_symmetric(&self) -> bool {
        match self {
            Self::Gaussian(gaussian) => gaussian.is_mirror_symmetric(),
        }
    }

    /// Largest root mean square second derivative along a line, per length unit: `sqrt(12) sigma / tau^2` of a
    /// Gaussian, `tau` being the shorter correlation length.
    #[must_use]
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.curvature(),
        }
    }

    /// The same with all lengths converted.
    pub(crate) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        match self {
            Self::Gaussian(gaussian) => Self::Gaussian(gaussian.converted(convert)),
        }
    }

    /// Autocorrelation `C(x, y)` at the lag `(x, y)`, length units squared.
    #[must_use]
    pub fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.autocorrelation(x, y),
        }
    }

    /// Slope variances along x and y, `[-C_xx(0), -C_yy(0)]`, of the continuous surface.
    #[must_use]
    pub fn slope_variance(&self) -> [f64; 2] {
        match self {
            Self::Gaussian(gaussian) => gaussian.slope_variance(),
        }
    }

    /// Covariance `[xx, xy, yy]` of the slopes of the continuous surface, dimensionless:
    /// `[-C_xx(0), -C_xy(0), -C_yy(0)]`. Along a principal axis of correlation length `tau` it is
    /// `2 sigma^2 / tau^2`.
    ///
    /// Of the facets of a mesh it is
    /// [`Synthesis::facet_slope_covariance`](crate::Synthesis::facet_slope_covariance).
    #[must_use]
    pub fn slope_covariance(&self) -> [f64; 3] {
        match self {
            Self::Gaussian(gaussian) => gaussian.slope_covariance(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn refuses_lengths_that_are_not_positive() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Psd::gaussian(bad, 1.0).is_err());
            assert!(Psd::gaussian(1.0, bad).is_err());
        }
        assert!(Psd::anisotropic_gaussian(1.0, 1.0, 1.0, f64::NAN).is_err());
    }

    /// The trapezium rule converges faster than any power for a Gaussian; at 24 correlation lengths
    /// and steps of a quarter of the narrower width only rounding is left.
    #[test]
    fn density_integrates_to_variance_and_to_slope_covariance() {
        let psd = Psd::anisotropic_gaussian(0.3, 2.0, 0.7, 0.4).unwrap();
        let step = 0.1;
        let (mut variance, mut slopes) = (0.0, [0.0; 3]);
        for i in -250..=250 {
            for j in -250..=250 {
                let (kx, ky) = (f64::from(i) * step, f64::from(j) * step);
                let power = psd.density(kx, ky) * step * step;
                variance += power;
                for (sum, square) in slopes.iter_mut().zip([kx * kx, kx * ky, ky * ky]) {
                    *sum += square * power;
                }
            }
        }
        assert!((variance / 0.09 - 1.0).abs() < 1e-12, "{variance}");
        for (sum, expected) in slopes.into_iter().zip(psd.slope_covariance()) {
            assert!((sum / expected - 1.0).abs() < 1e-12, "{sum}");
        }
        let [xx, _, yy] = psd.slope_covariance();
        assert_eq!(psd.slope_variance(), [xx, yy]);
    }

    #[test]
    fn density_falls_to_the_fraction_at_its_reach_and_not_beyond() {
        let psd = Psd::anisotropic_gaussian(0.3, 2.0, 0.7, 0.4).unwrap();
        let [reach_x, reach_y] = psd.reach(1e-6);
        let peak = psd.density(0.0, 0.0);
        let reach_along_y = |kx| psd.prepared().reach_along_y(kx, 1e-6);
        for kx in [0.0, 0.3, -0.7 * reach_x] {
            let ky = reach_along_y(kx).unwrap();
            let at = |ky| psd.density(kx, ky).max(psd.density(kx, -ky)) / peak;
            assert!((at(ky) / 1e-6 - 1.0).abs() < 1e-9, "{}", at(ky));
            assert!(at(1.01 * ky) < 1e-6);
        }
        assert_eq!(reach_along_y(1.001 * reach_x), None);
        let largest = |density: &dyn Fn(f64) -> f64| {
            (-100_000..=100_000)
                .map(|i| density(f64::from(i) * 1e-3) / peak)
                .fold(0.0, f64::max)
        };
        let along_x = largest(&|ky| psd.density(reach_x, ky));
        let along_y = largest(&|kx| psd.density(kx, reach_y));
        assert!((along_x / 1e-6 - 1.0).abs() < 1e-4, "{along_x}");
        assert!((along_y / 1e-6 - 1.0).abs() < 1e-4, "{along_y}");
    }

    #[test]
    fn axis_lengths_are_where_the_autocorrelation_is_one_over_e() {
        let psd = Psd::anisotropic_gaussian(1.0, 2.0, 0.7, 0.4).unwrap();
        let [x, y] = psd.axis_correlation_lengths();
        let e = (-1.0_f64).exp();
        assert!((psd.autocorrelation(x, 0.0) - e).abs() < 1e-15);
        assert!((psd.autocorrelation(0.0, y) - e).abs() < 1e-15);
        // The contour's farthest reach, by walking around it.
        let (mut reach_x, mut reach_y) = (0.0_f64, 0.0_f64);
        for i in 0..10_000 {
            let (sin, cos) = (f64::from(i) * 2.0 * PI / 1e4).sin_cos();
            let length = (-psd.autocorrelation(cos, sin).ln()).sqrt().recip();
            reach_x = reach_x.max(length * cos);
            reach_y = reach_y.max(length * sin);
        }
        let [extent_x, extent_y] = psd.correlation_extents();
        assert!((extent_x / reach_x - 1.0).abs() < 1e-6, "{extent_x}");
        assert!((extent_y / reach_y - 1.0).abs() < 1e-6, "{extent_y}");
    }
}
