//! The distribution of the slopes of random surfaces, where it is known.

use asperity_analysis::{SlopeError, SlopeMixture};

use crate::input::random_surfaces::RandomSurfaces;
use crate::slopes::{of_covariance, slopes};

impl RandomSurfaces {
    /// The distribution of the slopes of the continuous surface at a point; `None` where it is not known.
    ///
    /// # Errors
    /// Same as [`slopes`].
    pub fn slope_mixture(&self) -> Result<Option<SlopeMixture>, SlopeError> {
        let recipe = self.recipe();
        let Some(synthesis) = self.other_heights() else {
            return Ok(Some(slopes(recipe)?.into()));
        };
        let Some(mixture) = synthesis.slope_mixture() else {
            return Ok(None);
        };
        let slopes = of_covariance(mixture.covariance(), recipe.is_isotropic())?;
        let components = mixture.components().iter();
        let factors: Vec<[f64; 2]> = components.map(|one| [one.factor, one.weight]).collect();
        Ok(Some(SlopeMixture::scaled(&slopes, &factors)?))
    }
}
