//! Every case of a verification as a verification of its own, so that a piece of a long run is the same
//! whatever it stands beside.

use crate::case::Case;
use crate::config::{ConfigError, VerifyConfig};
use crate::values::OneOrMany;

impl VerifyConfig {
    /// The cases, each with the configuration that has it alone.
    ///
    /// # Errors
    /// As [`VerifyConfig::cases`].
    pub(crate) fn each_alone(&self) -> Result<Vec<(Case, Self)>, ConfigError> {
        // As they are written: a height that became a smoothness need not come back as it was.
        let surface = &self.surface;
        let (smoothness, sigma) = (&surface.smoothness, &surface.sigma);
        let heights = match (smoothness, sigma) {
            (Some(list), _) => list.values("smoothness")?,
            (None, Some(list)) => list.values("sigma")?,
            (None, None) => Vec::new(),
        };
        let etas = match &self.material.eta {
            Some(list) => list.values("eta")?,
            None => Vec::new(),
        };
        let thetas = self.light.theta.values("theta")?;
        let of_material = thetas.len();
        let of_height = of_material * etas.len().max(1);
        let alone = self.cases()?.into_iter().enumerate().map(|(i, case)| {
            let mut config = self.clone();
            let height = heights.get(i / of_height).map(|h| OneOrMany::One(*h));
            config.surface.smoothness = height.clone().filter(|_| smoothness.is_some());
            config.surface.sigma = height.filter(|_| smoothness.is_none());
            let eta = etas.get(i % of_height / of_material);
            config.material.eta = eta.map(|eta| OneOrMany::One(*eta));
            config.light.theta = OneOrMany::One(thetas[i % of_material]);
            (case, config)
        });
        Ok(alone.collect())
    }
}
