//! Slopes of random surfaces as models take them.

use asperity_analysis::{SlopeCovariance, SlopeError};
use asperity_surface::Psd;

/// Slopes of the continuous surface.
///
/// # Errors
/// [`SlopeError`] if the slopes have no density.
pub fn slopes(psd: &Psd) -> Result<SlopeCovariance, SlopeError> {
    let [xx, xy, yy] = psd.slope_covariance();
    if psd.is_isotropic() {
        // Whatever the axes, which rounding would tell apart.
        return SlopeCovariance::new(xx, xx, 0.0);
    }
    SlopeCovariance::new(xx, yy, xy)
}
