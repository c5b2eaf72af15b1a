//! Slopes of random surfaces as models take them.

use asperity_analysis::{Ggx, SlopeCovariance, SlopeDistribution, SlopeError};
use asperity_synthesis::SurfaceRecipe;

/// Covariance of the slopes of the continuous surface; if they are Gaussian, it determines their distribution.
///
/// # Errors
/// [`SlopeError`] if the slopes have no density.
pub fn slopes(recipe: &SurfaceRecipe) -> Result<SlopeCovariance, SlopeError> {
    of_covariance(recipe.slope_covariance(), recipe.is_isotropic())
}

/// The slopes of the continuous surface as far as a formula has them: GGX, or Gaussian ones of the covariance.
///
/// # Errors
/// Same as [`slopes`].
pub fn slope_distribution(recipe: &SurfaceRecipe) -> Result<SlopeDistribution, SlopeError> {
    let covariance = slopes(recipe)?;
    let SurfaceRecipe::StudentSlopes(student) = recipe else {
        return Ok(covariance.into());
    };
    let beckmann = of_covariance(student.base().slope_covariance(), recipe.is_isotropic())?;
    Ok(SlopeDistribution::Ggx {
        ggx: Ggx::new(beckmann),
        surface: None,
        covariance,
    })
}

/// Makes the covariance of `[xx, xy, yy]`, equal along all axes for isotropic surfaces, where rounding would differ.
pub(crate) fn of_covariance(
    [xx, xy, yy]: [f64; 3],
    isotropic: bool,
) -> Result<SlopeCovariance, SlopeError> {
    if isotropic {
        return SlopeCovariance::new(xx, xx, 0.0);
    }
    SlopeCovariance::new(xx, yy, xy)
}
