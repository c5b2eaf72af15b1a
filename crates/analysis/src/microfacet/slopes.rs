//! Covariance of Gaussian facet slopes: the parameter of every model of a rough surface.

use std::f64::consts::PI;

use glam::DVec2;

/// Variances and covariance of the slopes `(dh/dx, dh/dy)` of Gaussian facets, whose means are zero.
///
/// Slopes have no unit; x and y are the axes of the mean plane.
///
/// # Examples
/// ```
/// use asperity_analysis::SlopeCovariance;
///
/// // A smoothness of 3 gives a slope variance of 2 / 3^2 along each axis.
/// let slopes = SlopeCovariance::isotropic(3.0)?;
/// assert!(slopes.is_isotropic() && (slopes.xx() - 2.0 / 9.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeCovariance {
    xx: f64,
    yy: f64,
    xy: f64,
    /// Elements xx, yy and xy of the inverse matrix.
    inverse: [f64; 3],
    /// Density of slopes at zero.
    peak: f64,
}

/// Error of an invalid slope covariance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlopeError {
    /// The smoothness is zero, negative or not finite, or its square is.
    #[error("smoothness is {0:?}; tau / sigma must be positive and finite")]
    BadSmoothness(f64),
    /// The matrix is not positive definite.
    #[error(
        "slope variances {xx:?} and {yy:?} with covariance {xy:?} are invalid; the variances must be positive and finite, and the square of the covariance below their product"
    )]
    NotPositiveDefinite {
        /// Variance of `dh/dx`.
        xx: f64,
        /// Variance of `dh/dy`.
        yy: f64,
        /// Their covariance.
        xy: f64,
    },
}

impl SlopeCovariance {
    /// Slopes of variance `2 / s^2` per axis: those of a surface of smoothness `s = tau / sigma` with
    /// autocorrelation `sigma^2 exp(-r^2 / tau^2)`.
    ///
    /// # Errors
    /// [`SlopeError::BadSmoothness`] unless `s` and `2 / s^2` are positive and finite.
    pub fn isotropic(smoothness: f64) -> Result<Self, SlopeError> {
        let variance = 2.0 / (smoothness * smoothness);
        if !(smoothness > 0.0 && variance > 0.0 && variance.is_finite()) {
            return Err(SlopeError::BadSmoothness(smoothness));
        }
        Self::new(variance, variance, 0.0).map_err(|_| SlopeError::BadSmoothness(smoothness))
    }

    /// Slopes of variances `xx` of `dh/dx` and `yy` of `dh/dy`, and of covariance `xy`.
    ///
    /// # Errors
    /// [`SlopeError::NotPositiveDefinite`] unless all are finite, `xx, yy > 0` and
    /// `xy^2 < (1 - 1e-10) xx yy`. Beyond that limit the difference loses its digits. The deviations
    /// along the two principal directions may differ by a factor of 2e5.
    pub fn new(xx: f64, yy: f64, xy: f64) -> Result<Self, SlopeError> {
        // One minus the squared correlation.
        let rest = 1.0 - (xy / xx) * (xy / yy);
        let inverse = [
            1.0 / (xx * rest),
            1.0 / (yy * rest),
            -(xy / xx) / (yy * rest),
        ];
        let peak = 1.0 / (2.0 * PI * xx.sqrt() * yy.sqrt() * rest.sqrt());
        let finite = [xx, yy, xy, inverse[0], inverse[1], inverse[2], peak]
            .iter()
            .all(|v| v.is_finite());
        if !(finite && xx > 0.0 && yy > 0.0 && rest > 1e-10) {
            return Err(SlopeError::NotPositiveDefinite { xx, yy, xy });
        }
        Ok(Self {
            xx,
            yy,
            xy,
            inverse,
            peak,
        })
    }

    /// Variance of `dh/dx`.
    #[must_use]
    pub const fn xx(&self) -> f64 {
        self.xx
    }

    /// Variance of `dh/dy`.
    #[must_use]
    pub const fn yy(&self) -> f64 {
        self.yy
    }

    /// Covariance of `dh/dx` and `dh/dy`.
    #[must_use]
    pub const fn xy(&self) -> f64 {
        self.xy
    }

    /// Returns `true` if the slopes are isotropic: equal variances and no covariance.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.xx == self.yy && self.xy == 0.0
    }
    /// `v^T C^-1 v / 2`: the exponent of the density of slopes at `v`.
    #[inline(always)]
    pub(crate) fn exponent(&self, v: DVec2) -> f64 {
        0.5 * self.inverse_form(v, v)
    }

    /// Density of slopes at zero.
    pub(crate) const fn peak(&self) -> f64 {
        self.peak
    }

    /// `a^T C^-1 b`.
    #[inline(always)]
    pub(crate) fn inverse_form(&self, a: DVec2, b: DVec2) -> f64 {
        let [xx, yy, xy] = self.inverse;
        xx * a.x * b.x + yy * a.y * b.y + xy * (a.x * b.y + a.y * b.x)
    }

    /// `C v`.
    #[inline(always)]
    pub(crate) fn times(&self, v: DVec2) -> DVec2 {
        DVec2::new(self.xx * v.x + self.xy * v.y, self.xy * v.x + self.yy * v.y)
    }

    /// `v^T C v`: for a unit vector the variance of the slope along it.
    #[inline(always)]
    pub(crate) fn variance_along(&self, v: DVec2) -> f64 {
        v.dot(self.times(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_covariances_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200, 1e200] {
            assert!(SlopeCovariance::isotropic(bad).is_err(), "{bad}");
        }
        for (xx, yy, xy) in [
            (0.0, 1.0, 0.0),
            (1.0, -1.0, 0.0),
            (1.0, 1.0, 1.0),
            (4.0, 1.0, -2.1),
            (-1.0, -1.0, 0.5),
            (1.0, f64::NAN, 0.0),
            (1.0, 1.0, f64::INFINITY),
            (f64::INFINITY, 1.0, 0.0),
        ] {
            assert!(SlopeCovariance::new(xx, yy, xy).is_err(), "{xx} {yy} {xy}");
        }
        let good = SlopeCovariance::new(4.0, 1.0, -1.9).unwrap();
        assert!(!good.is_isotropic() && SlopeCovariance::isotropic(2.0).unwrap().is_isotropic());
    }
}
