//! Slopes of random surfaces as models take them.

use asperity_analysis::{SlopeCovariance, SlopeError, SlopeMixture};
use asperity_surface::SurfaceRecipe;

use crate::input::random_surfaces::RandomSurfaces;

/// Covariance of the slopes of the continuous surface; if they are Gaussian, it determines their distribution.
///
/// # Errors
/// [`SlopeError`] if the slopes have no density.
pub fn slopes(recipe: &SurfaceRecipe) -> Result<SlopeCovariance, SlopeError> {
    of_covariance(recipe.slope_covariance(), recipe.is_isotropic())
}

/// The distribution of the slopes of the continuous surface at a point; `None` where it is not known.
///
/// # Errors
/// As [`slopes`].
pub(crate) fn slope_mixture(surfaces: &RandomSurfaces) -> Result<Option<SlopeMixture>, SlopeError> {
    let recipe = surfaces.recipe();
    let RandomSurfaces::Fields(fields) = surfaces else {
        return Ok(Some(slopes(recipe)?.into()));
    };
    let Some(mixture) = fields.synthesis.slope_mixture() else {
        return Ok(None);
    };
    let components = mixture.components().iter().map(|one| {
        let slopes = of_covariance(one.covariance, recipe.is_isotropic())?;
        Ok((one.weight, slopes))
    });
    let components = components.collect::<Result<Vec<_>, SlopeError>>()?;
    Ok(Some(SlopeMixture::new(components)))
}

/// Of `[xx, xy, yy]`; of isotropic surfaces the same along all axes, which rounding would tell apart.
fn of_covariance([xx, xy, yy]: [f64; 3], isotropic: bool) -> Result<SlopeCovariance, SlopeError> {
    if isotropic {
        return SlopeCovariance::new(xx, xx, 0.0);
    }
    SlopeCovariance::new(xx, yy, xy)
}
