//! Slopes of random surfaces as models take them.

use asperity_analysis::{SlopeCovariance, SlopeError};
use asperity_surface::SurfaceRecipe;

/// Slopes of the continuous surface: their covariance, which is all there is to tell of them if they are Gaussian.
///
/// # Errors
/// [`SlopeError`] if the slopes have no density.
pub fn slopes(recipe: &SurfaceRecipe) -> Result<SlopeCovariance, SlopeError> {
    let [xx, xy, yy] = recipe.slope_covariance();
    if recipe.is_isotropic() {
        // Whatever the axes, which rounding would tell apart.
        return SlopeCovariance::new(xx, xx, 0.0);
    }
    SlopeCovariance::new(xx, yy, xy)
}
