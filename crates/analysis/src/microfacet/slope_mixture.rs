//! Slope mixture: Gaussian slopes that are steeper in some places than in others.

use glam::DVec3;

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::lambda_curve::LambdaCurve;
use crate::microfacet::slopes::{SlopeCovariance, SlopeError};

/// A mixture of Gaussian distributions of slopes, whose covariances are multiples of one.
///
/// # Examples
/// ```
/// use asperity_analysis::{SlopeCovariance, SlopeMixture};
///
/// // A quarter of the surface is steep
/// let gentle = SlopeCovariance::isotropic(10.0)?;
/// let slopes = SlopeMixture::scaled(&gentle, &[[1.0, 0.75], [100.0, 0.25]])?;
/// assert!((slopes.covariance()?.xx() - (0.75 * 0.02 + 0.25 * 2.0)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeMixture {
    /// Weights, whose sum is one, and covariances.
    components: Vec<(f64, SlopeCovariance)>,
    /// Lambda by the cotangent over the deviation of the first component along the azimuth; none of one component.
    lambda: Option<LambdaCurve>,
}

impl From<SlopeCovariance> for SlopeMixture {
    fn from(slopes: SlopeCovariance) -> Self {
        Self {
            components: vec![(1.0, slopes)],
            lambda: None,
        }
    }
}

impl SlopeMixture {
    /// Pairs of a factor of the covariance `base`, and its weight; weights are divided by their sum.
    ///
    /// # Errors
    /// [`SlopeError`] unless factors are positive and finite, as covariances must be.
    ///
    /// # Panics
    /// Without factors, and unless weights are above zero.
    pub fn scaled(base: &SlopeCovariance, factors: &[[f64; 2]]) -> Result<Self, SlopeError> {
        let total: f64 = factors.iter().map(|[_, weight]| weight).sum();
        assert!(
            total > 0.0 && factors.iter().all(|[_, weight]| *weight > 0.0),
            "weights of a mixture are above zero"
        );
        let factors: Vec<[f64; 2]> = factors.iter().map(|[f, w]| [*f, w / total]).collect();
        let component = |[factor, weight]: &[f64; 2]| {
            let [xx, yy, xy] = [base.xx(), base.yy(), base.xy()].map(|term| factor * term);
            Ok((*weight, SlopeCovariance::new(xx, yy, xy)?))
        };
        let relative: Vec<[f64; 2]> = factors
            .iter()
            .map(|[f, w]| [f / factors[0][0], *w])
            .collect();
        Ok(Self {
            components: factors.iter().map(component).collect::<Result<_, _>>()?,
            lambda: (factors.len() > 1).then(|| LambdaCurve::new(&relative)),
        })
    }

    /// Weights, which add to one, and covariances.
    #[must_use]
    pub fn components(&self) -> &[(f64, SlopeCovariance)] {
        &self.components
    }

    /// Returns `true` if all slopes are isotropic.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.components[0].1.is_isotropic()
    }

    /// Covariance of all slopes.
    ///
    /// # Errors
    /// [`SlopeError`] where rounding leaves none.
    pub fn covariance(&self) -> Result<SlopeCovariance, SlopeError> {
        let [xx, yy, xy] = [
            SlopeCovariance::xx,
            SlopeCovariance::yy,
            SlopeCovariance::xy,
        ]
        .map(|term| self.mean(term));
        SlopeCovariance::new(xx, yy, xy)
    }

    /// Smith's Lambda, the mean of [`Beckmann::lambda`] over components, to 1e-9 of one over the cotangent.
    #[must_use]
    pub fn lambda(&self, w: DVec3) -> f64 {
        let slopes = &self.components[0].1;
        let Some(lambda) = &self.lambda else {
            return Beckmann::new(*slopes).lambda(w);
        };
        let variance =
            slopes.xx() * w.x * w.x + 2.0 * slopes.xy() * w.x * w.y + slopes.yy() * w.y * w.y;
        lambda.at(w.z.abs() / variance.sqrt())
    }

    /// Density of facet normals in 1/sr, as [`Beckmann::d`].
    #[must_use]
    pub fn d(&self, m: DVec3) -> f64 {
        self.mean(|slopes| Beckmann::new(*slopes).d(m))
    }

    /// The mean over components.
    pub(crate) fn mean(&self, value: impl Fn(&SlopeCovariance) -> f64) -> f64 {
        let terms = self.components.iter();
        terms.map(|(weight, slopes)| weight * value(slopes)).sum()
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::from_spherical;

    use super::*;

    #[test]
    fn lambda_is_the_mean_over_components() {
        let base = SlopeCovariance::new(0.02, 0.05, 0.01).unwrap();
        let mixture =
            SlopeMixture::scaled(&base, &[[0.01, 0.3], [1.0, 0.5], [900.0, 0.2]]).unwrap();
        for theta in [0.0, 1e-3, 0.3, 0.9, 1.4, 1.56, 1.565, 2.0, 3.0] {
            for phi in [0.0, 0.6, 2.0] {
                let w = from_spherical(theta, phi);
                let expected = mixture.mean(|slopes| Beckmann::new(*slopes).lambda(w));
                let found = mixture.lambda(w);
                assert!(
                    (found - expected).abs() <= 1e-9 * (1.0 + expected),
                    "{theta}: {found} {expected}"
                );
            }
        }
        assert_eq!(mixture.lambda(DVec3::X), f64::INFINITY);
        let one = SlopeMixture::from(base);
        let w = from_spherical(1.2, 0.4);
        assert_eq!(one.lambda(w), Beckmann::new(base).lambda(w));
    }
}
