//! The configuration of a virtual gonioreflectometer: what `asperity gonio` reads from a file.

use asperity_simulate::Settings;

use asperity_optics::Incidence;
use asperity_tally::HemisphereGrid;
use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;
use crate::config::measured::MeasuredConfig;
use crate::config::medium::MediumConfig;
use crate::config::values::{Number, OneOrMany};
use crate::config::{
    Azimuth, CompareConfig, Incident, LightConfig, MaterialConfig, OutputConfig, RunConfig,
    SurfaceConfig, VerifyConfig,
};
use crate::settings::{Command, Document, defaults};

/// `[light]`: the directions that light comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GonioLight {
    /// Polar angle of the direction towards the light, degrees, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theta: Option<OneOrMany<Number>>,
    /// Azimuth of the direction towards the light, degrees, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phi: Option<OneOrMany<Number>>,
    /// The centres of the bins of a hemisphere, `THETAxPHI`, instead of `theta` and `phi`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub directions: Option<HemisphereGrid>,
    /// Random or fixed azimuth; random by default where surfaces are drawn and isotropic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<Azimuth>,
    /// The side that it comes from.
    pub from: Incident,
    /// Wavelength, nanometres, against which lengths of the surface are judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength: Option<Number>,
}

impl GonioLight {
    /// The wavelength, nanometres, if one is given.
    pub(super) fn wavelength_nm(&self) -> Option<f64> {
        self.wavelength.map(|wavelength| wavelength.0)
    }

    /// Polar angles and azimuths, degrees; every pair is a direction.
    ///
    /// # Errors
    /// [`ConfigError`] if a list is empty, both a grid and a list are given, or an angle is out of range.
    pub fn angles(&self) -> Result<[Vec<f64>; 2], ConfigError> {
        let plain = |list: Vec<Number>| list.into_iter().map(|n| n.0).collect::<Vec<f64>>();
        let [thetas, phis] = match (&self.directions, &self.theta, &self.phi) {
            (Some(grid), None, None) => {
                let centres = |n: usize, span: f64| {
                    (0..n)
                        .map(|i| span * (i as f64 + 0.5) / n as f64)
                        .collect::<Vec<f64>>()
                };
                [centres(grid.n_theta(), 90.0), centres(grid.n_phi(), 360.0)]
            }
            (None, Some(thetas), Some(phis)) => {
                [plain(thetas.values("theta")?), plain(phis.values("phi")?)]
            }
            _ => {
                return Err(ConfigError::Contradiction(
                    "give either directions, a grid, or both theta and phi".into(),
                ));
            }
        };
        for theta in &thetas {
            for phi in &phis {
                Incidence::from_degrees(*theta, *phi)?;
            }
        }
        for (name, angles) in [("theta", &thetas), ("phi", &phis)] {
            let mut sorted = angles.clone();
            sorted.sort_by(f64::total_cmp);
            if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
                let text = format!("{name} has a value twice; give each once");
                return Err(ConfigError::Contradiction(text));
            }
        }
        Ok([thetas, phis])
    }
}

/// The discs of a plot that share their colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlotScale {
    /// All discs.
    Common,
    /// Those of a row: of an angle of incidence.
    #[default]
    Rows,
}

/// `[output]`: what is written in addition to the tables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GonioOutput {
    /// Draw plots.
    pub plots: bool,
    /// The discs that share their colours.
    pub scale: PlotScale,
}

/// A measurement: surfaces, materials, directions and effort. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GonioConfig {
    /// The random surfaces.
    pub surface: SurfaceConfig,
    /// One given surface in their place.
    pub measured: MeasuredConfig,
    /// What they are made of.
    pub material: MaterialConfig,
    /// What lies below, if there is anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumConfig>,
    /// The directions that light comes from.
    pub light: GonioLight,
    /// How much is traced for each direction.
    pub run: RunConfig,
    /// What is written.
    pub output: GonioOutput,
}

impl Default for GonioConfig {
    fn default() -> Self {
        defaults(Command::Gonio)
    }
}

impl GonioConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        Ok(Document::of_text(Command::Gonio, text)?.read()?)
    }

    /// Whether every ray comes from an azimuth of its own, so that the azimuth of the light has no meaning.
    #[must_use]
    pub fn any_azimuth(&self) -> bool {
        match self.light.azimuth {
            None if self.measured.is_given() => false,
            _ => (self.as_verification()).is_ok_and(|config| config.any_azimuth()),
        }
    }

    /// The settings of the rays of a direction.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn ray_settings(&self) -> Result<Settings, ConfigError> {
        self.as_verification()?.ray_settings()
    }

    /// The verification of all settings and directions, without models.
    pub(super) fn as_verification(&self) -> Result<VerifyConfig, ConfigError> {
        let numbers = |list: Vec<f64>| OneOrMany::Many(list.into_iter().map(Number).collect());
        let [theta, phi] = self.light.angles()?.map(numbers);
        Ok(VerifyConfig {
            surface: self.surface.clone(),
            material: self.material.clone(),
            medium: self.medium.clone(),
            light: LightConfig {
                theta,
                phi,
                azimuth: self.light.azimuth,
                from: self.light.from,
                wavelength: None,
                stokes: None,
            },
            run: self.piece_run(),
            compare: CompareConfig::none(),
            output: OutputConfig { plots: true },
        })
    }

    /// The effort of one direction: the time is that of all.
    pub(super) fn piece_run(&self) -> RunConfig {
        RunConfig {
            max_time: None,
            ..self.run.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_values_get_a_sentence() {
        for (text, expected) in [
            ("[light]\ntheta = []", "one or several"),
            ("[light]\ntheta = [0, 90]", "below 90"),
            ("[light]\nphi = [0, inf]", "must be a number"),
            ("[light]\ntheta = [1, 1]", "theta has a value twice"),
            ("[light]\ndirections = \"0x4\"", "THETAxPHI"),
            ("[light]\ndirections = \"3x4\"\ntheta = 3", "excludes"),
            ("[light]\ntehta = 3", "tehta"),
            ("[compare]\nmodels = []", "compare"),
            ("[output]\nscale = \"log\"", "log"),
            ("[measured]\nflat = true\nfile = \"a.exr\"", "excludes"),
            ("[measured]\nborder = \"open\"", "no file is given"),
            ("[measured]\nremove = \"plane\"", "no file is given"),
            ("[measured]\nmissing = \"guess\"", "guess"),
            (
                "[measured]\nflat = true\n[run]\nrealisations = 3",
                "excludes",
            ),
            (
                "[run]\ntarget_error = 1e-3\nrays = 10",
                "run.target_error is for trace, verify and map, not for gonio",
            ),
            (
                "[run]\nof = \"bins\"",
                "run.of is for trace, verify and map",
            ),
            (
                "[run]\nrefine = true",
                "run.refine is for trace, verify and map",
            ),
            ("[surface]\nsmoothness = [3, 3]", "same folder"),
        ] {
            let error = GonioConfig::from_toml(text)
                .and_then(|config| config.plans(None).map(|_| ()))
                .unwrap_err()
                .to_string();
            assert!(error.contains(expected), "{text}: {error}");
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
