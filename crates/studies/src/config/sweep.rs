//! Sweep: expands the lists of a configuration into cases, each with one value.
//!
//! [`DIMENSIONS`] names the lists in their order of nesting: the last one changes fastest. A further dimension is a
//! further row there.

use crate::config::sweep_case::SweepCase;
use asperity_optics::{Incidence, Material};

use crate::config::VerifyConfig;
use crate::config::error::ConfigError;
use crate::config::values::{Number, OneOrMany};

/// Most cases of a sweep.
const MAX_CASES: f64 = 1e6;

/// Where a list stands.
type Dimension = fn(&mut VerifyConfig) -> Option<&mut OneOrMany<Number>>;

/// The lists that are expanded, the last one fastest. Of the two pairs of names for a medium one is missing.
const DIMENSIONS: [(&str, Dimension); 13] = [
    ("smoothness", |config| config.surface.smoothness.as_mut()),
    ("sigma", |config| config.surface.sigma.as_mut()),
    ("ggx_alpha", |config| config.surface.ggx_alpha.as_mut()),
    ("depth", |config| config.surface.structure.depth.as_mut()),
    ("eta", |config| config.material.eta.as_mut()),
    ("mean_free_path", |config| {
        config.medium.as_mut()?.mean_free_path.as_mut()
    }),
    ("albedo", |config| config.medium.as_mut()?.albedo.as_mut()),
    ("absorption", |config| {
        config.medium.as_mut()?.absorption.as_mut()
    }),
    ("scattering", |config| {
        config.medium.as_mut()?.scattering.as_mut()
    }),
    ("g", |config| config.medium.as_mut()?.g.as_mut()),
    ("thickness", |config| {
        config.medium.as_mut()?.thickness.as_mut()
    }),
    ("theta", |config| Some(&mut config.light.theta)),
    ("phi", |config| Some(&mut config.light.phi)),
];

/// One case of a sweep.
#[derive(Clone, Debug)]
pub(crate) struct SweptCase {
    /// The case.
    pub(crate) case: SweepCase,
    /// The configuration of this case alone, independent of the other cases.
    pub(crate) config: VerifyConfig,
}

/// The cases of a configuration with lists.
#[derive(Clone, Debug)]
pub(crate) struct Sweep {
    pub(crate) cases: Vec<SweptCase>,
}

impl Sweep {
    /// Expands every combination of the lists of `config`.
    ///
    /// # Errors
    /// [`ConfigError`] if a list is empty, there are more than [`MAX_CASES`], or a value is out of range.
    pub(crate) fn of(config: &VerifyConfig) -> Result<Self, ConfigError> {
        let mut lists = Vec::new();
        for (name, dimension) in DIMENSIONS {
            if let Some(list) = dimension(&mut config.clone()) {
                lists.push((dimension, list.values(name)?));
            }
        }
        let count: f64 = lists
            .iter()
            .map(|(_, values)| values.len() as f64)
            .product();
        if count > MAX_CASES {
            return Err(ConfigError::TooManyCases {
                count,
                most: MAX_CASES,
            });
        }
        let configs =
            lists
                .into_iter()
                .fold(vec![config.clone()], |configs, (dimension, values)| {
                    let with = |config: VerifyConfig| {
                        let values = values.iter().map(move |value| (config.clone(), *value));
                        values.map(|(mut config, value)| {
                            if let Some(list) = dimension(&mut config) {
                                *list = OneOrMany::One(value);
                            }
                            config
                        })
                    };
                    configs.into_iter().flat_map(with).collect()
                });
        let case = |config: VerifyConfig| {
            let case = config.single_case()?;
            Ok::<_, ConfigError>(SweptCase { case, config })
        };
        let cases = configs.into_iter().map(case).collect::<Result<_, _>>()?;
        Ok(Self { cases })
    }
}

impl VerifyConfig {
    /// The case of a configuration without lists.
    fn single_case(&self) -> Result<SweepCase, ConfigError> {
        let (smoothness, recipe) = self.surface.recipe()?;
        let material: Material = self.material.material()?;
        let layer = self.medium.as_ref().map(|medium| medium.layer(material));
        let (theta, phi) = (self.light.theta.one("theta")?, self.light.phi.one("phi")?);
        Ok(SweepCase {
            smoothness,
            recipe,
            unit: self.surface.unit,
            material,
            layer: layer.transpose()?,
            incidence: Incidence::from_degrees(theta.0, phi.0)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_that_of_its_configuration_alone() {
        for text in [
            "mean_free_path = [1, 10]\nalbedo = [0.5, 1]\ng = [0.1, -0.1]\nthickness = [50, 60]",
            "absorption = [0.1, 0.2]\nscattering = [1, 2]",
        ] {
            let text = format!(
                "[surface]\nsmoothness = [3, 2]\n[material]\neta = [1.3, 1.5]\n[light]\ntheta = [0, 30]\n[compare]\nmodels = []\n[medium]\n{text}"
            );
            let config = VerifyConfig::from_toml(&text).unwrap();
            let cases = config.cases().unwrap();
            let sweep = Sweep::of(&config).unwrap();
            assert_eq!(sweep.cases.len(), cases.len());
            for (swept, expected) in sweep.cases.iter().zip(&cases) {
                assert_eq!(swept.case, *expected);
                assert_eq!(
                    swept.config.cases().unwrap(),
                    std::slice::from_ref(expected)
                );
            }
        }
    }

    #[test]
    fn the_last_dimension_changes_fastest() {
        let text = "[surface]\nsmoothness = [3, 2]\n[material]\neta = [1.3, 1.5]\n[medium]\nscattering = [1, 2]\n[light]\ntheta = [0, 30]";
        let sweep = Sweep::of(&VerifyConfig::from_toml(text).unwrap()).unwrap();
        let names: Vec<String> = sweep
            .cases
            .iter()
            .map(|swept| swept.case.folder())
            .collect();
        assert_eq!(
            names[..5],
            [
                "s3_n1.3_theta0_mfp1_albedo1",
                "s3_n1.3_theta30_mfp1_albedo1",
                "s3_n1.3_theta0_mfp0.5_albedo1",
                "s3_n1.3_theta30_mfp0.5_albedo1",
                "s3_n1.5_theta0_mfp1_albedo1",
            ]
        );
        assert_eq!(names[15], "s2_n1.5_theta30_mfp0.5_albedo1");
    }

    #[test]
    fn roughness_of_ggx_slopes_and_depths_of_structures_are_lists_too() {
        for (surface, folders) in [
            (
                "slopes = \"ggx\"\nggx_alpha = [0.4, 0.1]",
                ["s1.98609_n1.5_theta30", "s7.94435_n1.5_theta30"],
            ),
            (
                "structure = \"v-grooves\"\ndepth = [4, 2]",
                ["s4_n1.5_theta30", "s8_n1.5_theta30"],
            ),
        ] {
            let text = format!("[surface]\nsize = 128\n{surface}\n[compare]\nmodels = []");
            let sweep = Sweep::of(&VerifyConfig::from_toml(&text).unwrap()).unwrap();
            let found: Vec<String> = sweep
                .cases
                .iter()
                .map(|swept| swept.case.folder())
                .collect();
            assert_eq!(found, folders);
        }
    }

    #[test]
    fn too_many_cases_are_refused_before_they_are_made() {
        let list = vec!["1"; 20_000].join(", ");
        let text = format!(
            "[surface]\nsmoothness = [{list}]\n[material]\neta = [{list}]\n[light]\ntheta = [{list}]"
        );
        let config = VerifyConfig::from_toml(&text).unwrap();
        let error = Sweep::of(&config).unwrap_err().to_string();
        assert_eq!(error, "the lists make 8e12 cases; at most 1e6 are possible");
    }
}
