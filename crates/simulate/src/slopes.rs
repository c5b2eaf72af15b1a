//! Slopes of random surfaces as models take them.

use asperity_analysis::{SlopeCovariance, SlopeError, SlopeMixture};
use asperity_surface::SurfaceRecipe;

use crate::input::random_surfaces::RandomSurfaces;

/// Slopes of the continuous surface: their covariance, which is all there is to tell of them if they are Gaussian.
///
/// # Errors
/// [`SlopeError`] if the slopes have no density.
pub fn slopes(recipe: &SurfaceRecipe) -> Result<SlopeCovariance, SlopeError> {
    of_covariance(recipe.slope_covariance(), recipe.is_isotropic())
}

impl RandomSurfaces {
    /// The distribution of the slopes of the continuous surface at a point; `None` where it is not known.
    ///
    /// # Errors
    /// As [`slopes`].
    pub fn slope_mixture(&self) -> Result<Option<SlopeMixture>, SlopeError> {
        let recipe = self.recipe();
        let Self::Fields(fields) = self else {
            return Ok(Some(slopes(recipe)?.into()));
        };
        let Some(mixture) = fields.synthesis.slope_mixture() else {
            return Ok(None);
        };
        let slopes = of_covariance(mixture.covariance(), recipe.is_isotropic())?;
        let components = mixture.components().iter();
        let factors: Vec<[f64; 2]> = components.map(|one| [one.factor, one.weight]).collect();
        Ok(Some(SlopeMixture::scaled(&slopes, &factors)?))
    }
}

/// Of `[xx, xy, yy]`; of isotropic surfaces the same along all axes, which rounding would tell apart.
fn of_covariance([xx, xy, yy]: [f64; 3], isotropic: bool) -> Result<SlopeCovariance, SlopeError> {
    if isotropic {
        return SlopeCovariance::new(xx, xx, 0.0);
    }
    SlopeCovariance::new(xx, yy, xy)
}
