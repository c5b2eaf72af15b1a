//! The configuration of a map: what `asperity map` reads from a file.

use asperity_simulate::check_results;
use asperity_tracer::Polarisation;
use serde::{Deserialize, Serialize};

use crate::config::default_models::Described;
use crate::config::error::ConfigError;
use crate::config::sweep::SweptCase;
use crate::config::sweep_case::SweepCase;
use crate::config::values::Number;
use crate::config::{
    CompareConfig, LightConfig, MaterialConfig, MaterialKind, OutputConfig, RunConfig,
    SurfaceConfig, VerifyConfig,
};
use crate::settings::{Command, Document, defaults};
use crate::verify::error::VerifyError;

/// `[map]`: the tolerances of the distances between a model and the explicit result.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToleranceConfig {
    /// Total variation: the part of the incident flux that may have to move.
    pub total_variation: Number,
    /// Energy of a side, of the incident flux.
    pub energy: Number,
    /// Direction of the peak of a side, degrees.
    pub peak: Number,
}

impl Default for ToleranceConfig {
    fn default() -> Self {
        MapConfig::default().map
    }
}

/// A map: surfaces, materials, light, models and tolerances. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapConfig {
    /// The random surfaces.
    pub surface: SurfaceConfig,
    /// What they are made of.
    pub material: MaterialConfig,
    /// Where the light comes from.
    pub light: LightConfig,
    /// How much is traced for each cell.
    pub run: RunConfig,
    /// The models.
    pub compare: CompareConfig,
    /// How far they may be off.
    pub map: ToleranceConfig,
    /// What is written.
    pub output: OutputConfig,
}

/// One cell: a case, and the verification that fills it.
#[derive(Clone, Debug)]
pub(super) struct CellPlan {
    pub(super) case: SweepCase,
    pub(super) config: VerifyConfig,
}

impl Default for MapConfig {
    fn default() -> Self {
        defaults(Command::Map)
    }
}

impl MapConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let document = Document::of_text(Command::Map, text)?;
        let mut config: Self = document.read()?;
        config.choose_models(&document);
        Ok(config)
    }

    /// Chooses the default models, as [`VerifyConfig::choose_models`] does.
    pub fn choose_models(&mut self, document: &Document) {
        let described = Described {
            surface: &self.surface,
            material: self.material.kind,
            medium: None,
        };
        described.choose(&mut self.compare, document);
    }

    /// Checks everything that can be known before a ray is traced.
    ///
    /// # Errors
    /// [`VerifyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn check(&self) -> Result<(), VerifyError> {
        let cells = self.cells()?;
        let settings = self.run.ray_settings()?;
        check_results(&settings.tally, self.run.realisations.0, 1, settings.refine)?;
        cells
            .iter()
            .try_for_each(|cell| cell.config.check_surfaces())
    }

    /// How many cells there are.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn count(&self) -> Result<usize, ConfigError> {
        self.cells().map(|cells| cells.len())
    }

    /// The cells, in the order of [`VerifyConfig::cases`].
    pub(super) fn cells(&self) -> Result<Vec<CellPlan>, ConfigError> {
        if self.run.polarisation == Polarisation::Mueller {
            return Err(ConfigError::MapOfMatrices);
        }
        if self.compare.models.is_empty() {
            let is_lambertian = self.material.kind == MaterialKind::Lambertian;
            return Err(match is_lambertian && !self.surface.is_isotropic() {
                true => ConfigError::NoModelToMap,
                false => ConfigError::MapWithoutModels,
            });
        }
        for (name, tolerance) in [
            ("total_variation", self.map.total_variation.0),
            ("energy", self.map.energy.0),
            ("peak", self.map.peak.0),
        ] {
            if !(tolerance.is_finite() && tolerance > 0.0) {
                return Err(ConfigError::Tolerance { name, tolerance });
            }
        }
        let all = VerifyConfig {
            surface: self.surface.clone(),
            material: self.material.clone(),
            medium: None,
            light: self.light.clone(),
            run: RunConfig {
                // The time is that of the map.
                max_time: None,
                ..self.run.clone()
            },
            compare: self.compare.clone(),
            output: OutputConfig { plots: true },
        };
        let cells = all.sweep()?.cases.into_iter();
        let cells = cells.map(|SweptCase { case, config }| CellPlan { case, config });
        Ok(cells.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_the_configuration_of_its_case_alone() {
        for text in [
            "[surface]\nsmoothness = [6, 3, 1]\n[material]\neta = [1.4, \"1/1.4\"]\n[light]\ntheta = [0, 30]",
            "[surface]\nsigma = [3, 7]\n[material]\nkind = \"mirror\"\n[light]\ntheta = [0, 30, 40]",
            "[light]\ntheta = 20\n[material]\nkind = \"conductor\"\neta = [0.2, 0.3]\nkappa = 3",
            "",
        ] {
            let config = MapConfig::from_toml(text).unwrap();
            let cells = config.cells().unwrap();
            let all = VerifyConfig::from_toml(text).unwrap().cases().unwrap();
            assert_eq!(cells.len(), all.len());
            for (cell, case) in cells.iter().zip(all) {
                assert_eq!(cell.case, case);
                assert_eq!(cell.config.cases().unwrap(), [case]);
            }
        }
    }

    /// Defaults can be run: of every structure, material and medium.
    #[test]
    fn default_models_describe_their_surfaces() {
        let structures = [
            "pits",
            "caps",
            "v-grooves",
            "sine-grooves",
            "blazed-grooves",
            "scratches",
            "cracks",
            "pyramids",
            "inverted-pyramids",
        ];
        let structures =
            structures.map(|name| format!("[surface]\nstructure = \"{name}\"\nsize = 384\n"));
        let spectra = [
            "",
            "[surface]\ntau_y = 8\n",
            "[surface]\npsd = \"exponential\"\ncut_off = 4\ntau_y = 32\n",
        ];
        for surface in structures.into_iter().chain(spectra.map(str::to_owned)) {
            let of = |rest: &str| format!("{surface}{rest}");
            let verify = |rest: &str| {
                let config = VerifyConfig::from_toml(&of(rest)).unwrap();
                config.cases().map(|_| config.compare.models).unwrap()
            };
            let map = |rest: &str| {
                let config = MapConfig::from_toml(&of(rest)).unwrap();
                config.count().map(|_| config.compare.models)
            };
            let glass = verify("");
            assert!(glass.contains(&"smith".to_owned()), "{surface}");
            assert_eq!(map("").unwrap(), glass, "{surface}");
            let white = "[material]\nkind = \"lambertian\"\nreflectance = 0.8";
            match (verify(white), map(white)) {
                (models, Ok(of_map)) => {
                    assert_eq!([models, of_map], [["oren-nayar"], ["oren-nayar"]])
                }
                (models, Err(error)) => {
                    assert!(models.is_empty(), "{surface}");
                    assert!(error.to_string().contains("no model"), "{surface}: {error}");
                }
            }
            assert_eq!(
                verify("[medium]\nscattering = 1"),
                ["flat-layer"],
                "{surface}"
            );
        }
    }

    #[test]
    fn bad_values_get_a_sentence() {
        for (text, expected) in [
            ("[map]\nenergie = 1", "energie"),
            ("[map]\nenergy = 0", "energy = 0: must be a number above 0"),
            ("[map]\npeak = -1", "peak = -1: must be a number above 0"),
            (
                "[map]\ntotal_variation = nan",
                "total_variation = nan: must be a number above 0",
            ),
            ("[compare]\nmodels = []", "needs models"),
            (
                "[compare]\nlevel = 0.05",
                "compare.level is for trace and verify, not for map",
            ),
            ("[compare]\nmodels = [\"ggx\"]", "ggx"),
            ("[surface]\nsmoothness = []", "one or several"),
            ("[surface]\nsmoothness = [3, 3]", "same folder"),
            ("[run]\ntarget_error = 1e-3\nrays = 1e5", "excludes"),
        ] {
            let error = MapConfig::from_toml(text)
                .and_then(|config| config.cells().map(|_| ()))
                .unwrap_err()
                .to_string();
            assert!(error.contains(expected), "{text}: {error}");
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
