//! Every case of a verification as a verification of its own, so that a piece of a long run is the same
//! whatever it stands beside.

use crate::config::{ConfigError, VerifyConfig};
use crate::medium::MediumConfig;
use crate::values::{Number, OneOrMany};
use asperity_simulate::Case;

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
        let media = match &self.medium {
            Some(medium) => each_medium(medium).into_iter().map(Some).collect(),
            None => vec![None],
        };
        let thetas = self.light.theta.values("theta")?;
        let of_medium = thetas.len();
        let of_material = of_medium * media.len();
        let of_height = of_material * etas.len().max(1);
        let alone = self.cases()?.into_iter().enumerate().map(|(i, case)| {
            let mut config = self.clone();
            let height = heights.get(i / of_height).map(|h| OneOrMany::One(*h));
            config.surface.smoothness = height.clone().filter(|_| smoothness.is_some());
            config.surface.sigma = height.filter(|_| smoothness.is_none());
            let eta = etas.get(i % of_height / of_material);
            config.material.eta = eta.map(|eta| OneOrMany::One(*eta));
            config.medium = media[i % of_material / of_medium].clone();
            config.light.theta = OneOrMany::One(thetas[i % of_medium]);
            (case, config)
        });
        Ok(alone.collect())
    }
}

/// A medium for each combination of its lists, in the order of [`MediumConfig::layers`].
fn each_medium(medium: &MediumConfig) -> Vec<MediumConfig> {
    type Place = fn(&mut MediumConfig) -> &mut Option<OneOrMany<Number>>;
    // Of the two pairs of names for a medium one is empty.
    let places: [Place; 6] = [
        |m| &mut m.mean_free_path,
        |m| &mut m.albedo,
        |m| &mut m.absorption,
        |m| &mut m.scattering,
        |m| &mut m.g,
        |m| &mut m.thickness,
    ];
    places
        .into_iter()
        .fold(vec![medium.clone()], |media, place| {
            let each_value = |mut medium: MediumConfig| match place(&mut medium).clone() {
                Some(OneOrMany::Many(list)) => list
                    .into_iter()
                    .map(|value| {
                        let mut one = medium.clone();
                        *place(&mut one) = Some(OneOrMany::One(value));
                        one
                    })
                    .collect(),
                _ => vec![medium],
            };
            media.into_iter().flat_map(each_value).collect()
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_of_several_media_is_that_of_its_configuration_alone() {
        for medium in [
            "mean_free_path = [1, 10]\nalbedo = [0.5, 1]\ng = [0.1, -0.1]\nthickness = [50, 60]",
            "absorption = [0.1, 0.2]\nscattering = [1, 2]",
        ] {
            let text = format!(
                "[surface]\nsmoothness = [3, 2]\n[material]\neta = [1.3, 1.5]\n[light]\ntheta = [0, 30]\n[compare]\nmodels = []\n[medium]\n{medium}"
            );
            let config = VerifyConfig::from_toml(&text).unwrap();
            let cases = config.cases().unwrap();
            let alone = config.each_alone().unwrap();
            assert_eq!(alone.len(), cases.len());
            for ((case, alone), expected) in alone.iter().zip(&cases) {
                assert_eq!(case, expected);
                assert_eq!(alone.cases().unwrap(), [*expected]);
            }
        }
    }
}
