//! Slope mixture: Gaussian slopes whose covariance differs from place to place.

use glam::DVec3;

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::slopes::{SlopeCovariance, SlopeError};

/// A mixture of Gaussian distributions of slopes: of each its weight, and the covariance.
///
/// # Examples
/// ```
/// use asperity_analysis::{SlopeCovariance, SlopeMixture};
///
/// let flat = SlopeCovariance::isotropic(10.0)?;
/// let steep = SlopeCovariance::isotropic(1.0)?;
/// let slopes = SlopeMixture::new(vec![(0.75, flat), (0.25, steep)]);
/// assert!((slopes.covariance()?.xx() - (0.75 * 0.02 + 0.25 * 2.0)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeMixture {
    components: Vec<(f64, SlopeCovariance)>,
}

impl From<SlopeCovariance> for SlopeMixture {
    fn from(slopes: SlopeCovariance) -> Self {
        Self {
            components: vec![(1.0, slopes)],
        }
    }
}

impl SlopeMixture {
    /// Of weights, which are divided by their sum, and covariances.
    ///
    /// # Panics
    /// Without components, and unless weights are above zero.
    #[must_use]
    pub fn new(mut components: Vec<(f64, SlopeCovariance)>) -> Self {
        let total: f64 = components.iter().map(|(weight, _)| weight).sum();
        assert!(
            total > 0.0 && components.iter().all(|(weight, _)| *weight > 0.0),
            "weights of a mixture are above zero"
        );
        components
            .iter_mut()
            .for_each(|(weight, _)| *weight /= total);
        Self { components }
    }

    /// Weights, which add to one, and covariances.
    #[must_use]
    pub fn components(&self) -> &[(f64, SlopeCovariance)] {
        &self.components
    }

    /// Whether all components are isotropic.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        let mut components = self.components.iter();
        components.all(|(_, slopes)| slopes.is_isotropic())
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

    /// Smith's Lambda, the mean of [`Beckmann::lambda`] over components.
    #[must_use]
    pub fn lambda(&self, w: DVec3) -> f64 {
        self.mean(|slopes| Beckmann::new(*slopes).lambda(w))
    }

    /// The mean over components.
    pub(crate) fn mean(&self, value: impl Fn(&SlopeCovariance) -> f64) -> f64 {
        let terms = self.components.iter();
        terms.map(|(weight, slopes)| weight * value(slopes)).sum()
    }
}
