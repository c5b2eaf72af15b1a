//! Student slopes: surfaces whose slopes have the distribution of GGX.

use serde::{Deserialize, Serialize};

use crate::{GaussianPsd, Psd, PsdError};
use asperity_numerics::elementary::{exp, sin_cos};
use asperity_numerics::exponential_integral;

/// Added to the exponentially distributed number whose inverse is the variance of the slopes, so that it is finite.
pub(crate) const FLOOR: f64 = 1e-3;

/// Surfaces whose slopes have the distribution of GGX: Student's of two degrees of freedom, in the plane.
///
/// Heights are `G(x, y) / sqrt(E(x, y) + floor)`: a Gaussian surface `G` of the spectrum `base`, times an amplitude that
/// varies slowly. `E` is exponentially distributed with mean 1, and is `-ln Phi(n)` of a normal number `n(x, y)` whose
/// correlation lengths are [`StudentSlopes::amplitude_ratio`] times those of `base`. For a given `E` slopes are Gaussian;
/// over all `E`, with isotropic slopes of `base` of Beckmann's roughness `alpha = sqrt(2) (rms slope per axis)`, the
/// gradient exceeds `t` with the probability `exp(-floor t^2 / alpha^2) / (1 + t^2 / alpha^2)`. Without the floor of 0.001
/// this is GGX of the same `alpha`, whose slope variance is infinite: the floor ends the tail beyond `32 alpha` and takes no
/// more than 0.001 from any probability.
///
/// # Source
/// Distribution: T. S. Trowbridge, K. P. Reitz, J. Opt. Soc. Am. 65 (1975) 531; B. Walter et al., *Microfacet models for
/// refraction through rough surfaces*, Eurographics Symposium on Rendering 2007, Eq. 33. As a mixture of Gaussians whose
/// inverse variance is exponentially distributed it is the special case of Student's distribution for two degrees of
/// freedom.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudentSlopes {
    /// The Gaussian surface.
    base: Psd,
    /// Correlation length of the amplitude over that of the surface.
    amplitude_ratio: f64,
}

impl StudentSlopes {
    /// Fewest correlation lengths of the surface within one of the amplitude.
    pub const MIN_AMPLITUDE_RATIO: f64 = 2.0;

    /// Slopes of GGX whose `alpha` is `sqrt(2)` times the root mean square slope per axis of `base`. `amplitude_ratio`:
    /// correlation length of the amplitude over that of `base`; the longer, the closer slopes come to their distribution.
    ///
    /// # Errors
    /// [`PsdError::BadParameter`] unless the ratio is finite and at least [`StudentSlopes::MIN_AMPLITUDE_RATIO`].
    pub fn new(base: Psd, amplitude_ratio: f64) -> Result<Self, PsdError> {
        if !(amplitude_ratio.is_finite() && amplitude_ratio >= Self::MIN_AMPLITUDE_RATIO) {
            return Err(PsdError::BadParameter {
                name: "amplitude_ratio",
                value: amplitude_ratio,
                allowed: "2 or more, and finite",
            });
        }
        Ok(Self {
            base,
            amplitude_ratio,
        })
    }

    /// The Gaussian surface that is multiplied by the amplitude.
    #[must_use]
    pub const fn base(&self) -> &Psd {
        &self.base
    }

    /// Correlation length of the amplitude over that of [`StudentSlopes::base`].
    #[must_use]
    pub const fn amplitude_ratio(&self) -> f64 {
        self.amplitude_ratio
    }

    /// GGX's `alpha` along the two principal axes: `sqrt(2)` times the root mean square slope of `base`.
    #[must_use]
    pub fn alpha(&self) -> [f64; 2] {
        let [xx, xy, yy] = self.base.slope_covariance();
        let (sin, cos) = sin_cos(self.azimuth());
        let cross = 2.0 * xy * sin * cos;
        [
            xx * cos * cos + yy * sin * sin + cross,
            xx * sin * sin + yy * cos * cos - cross,
        ]
        .map(|variance| (2.0 * variance).sqrt())
    }

    /// Angle from +x to the first principal axis, radians.
    fn azimuth(&self) -> f64 {
        self.base.anisotropy().map_or(0.0, |[_, azimuth]| azimuth)
    }

    /// Square of a gradient in units of `alpha` along each axis.
    pub(crate) fn square_in_alpha(&self) -> impl Fn([f64; 2]) -> f64 + use<> {
        let [xx, xy, yy] = self.base.slope_covariance();
        let determinant = xx * yy - xy * xy;
        move |[x, y]| 0.5 * (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant
    }

    /// Probability that the gradient, in units of `alpha` along each axis, exceeds `t`.
    #[must_use]
    pub fn exceedance(t: f64) -> f64 {
        let square = t * t;
        exp(-FLOOR * square) / (1.0 + square)
    }

    /// Mean of the square of the amplitude: `exp(floor) E_1(floor)`.
    pub(crate) fn mean_square_amplitude() -> f64 {
        exp(FLOOR) * exponential_integral(FLOOR)
    }

    /// The power spectral density of the normal numbers behind the amplitude, of unit variance.
    pub(crate) fn amplitude_psd(&self) -> Psd {
        let [first, second] = self.base.correlation_lengths();
        let azimuth = self.azimuth();
        let ratio = self.amplitude_ratio;
        Psd::Gaussian(GaussianPsd {
            sigma: 1.0,
            tau_x: ratio * first,
            tau_y: ratio * second,
            azimuth,
        })
    }

    pub(super) fn sigma(&self) -> f64 {
        self.base.sigma() * Self::mean_square_amplitude().sqrt()
    }

    pub(super) fn slope_covariance(&self) -> [f64; 3] {
        let square = Self::mean_square_amplitude();
        self.base.slope_covariance().map(|term| square * term)
    }

    pub(super) fn curvature(&self) -> f64 {
        self.base.curvature() * Self::mean_square_amplitude().sqrt()
    }

    pub(super) fn is_valid(&self) -> bool {
        self.base.is_valid() && Self::new(self.base.clone(), self.amplitude_ratio).is_ok()
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self {
            base: self.base.converted(convert),
            amplitude_ratio: self.amplitude_ratio,
        }
    }
}
