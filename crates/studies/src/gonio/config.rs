//! The configuration of a virtual gonioreflectometer: what `asperity gonio` reads from a file.

use asperity_optics::{Incidence, klems_centres};
use asperity_results::Header;
use asperity_simulate::{check_memory, check_results};
use asperity_tally::HemisphereGrid;
use serde::{Deserialize, Serialize};

use super::sample::Sample;
use crate::config::error::ConfigError;
use crate::config::measured::MeasuredConfig;
use crate::config::medium::MediumConfig;
use crate::config::sun::SunConfig;
use crate::config::values::{Number, OneOrMany};
use crate::config::{
    Azimuth, Coherent, CompareConfig, Incident, LightConfig, MaterialConfig, OutputConfig,
    RunConfig, SurfaceConfig, VerifyConfig,
};
use crate::error::StudyError;
use crate::settings::spread_text::SpreadText;
use crate::settings::{Command, Document, defaults};
use crate::verify::plan::Plan;

/// Parts of a hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum LightDirections {
    /// Patches of the full Klems basis.
    Named(PatchBasis),
    /// Bins, `THETAxPHI`.
    Grid(HemisphereGrid),
}

/// Basis of patches by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PatchBasis {
    /// The full Klems basis.
    Klems,
}

/// `[light]`: the directions that light comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GonioLight {
    /// Polar angle of the direction towards the light, degrees, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theta: Option<OneOrMany<Number>>,
    /// Azimuth of the direction towards the light, degrees, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phi: Option<OneOrMany<Number>>,
    /// Centres of the parts of a hemisphere, instead of `theta` and `phi`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub directions: Option<LightDirections>,
    /// Random or fixed azimuth; random by default where surfaces are drawn and isotropic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<Azimuth>,
    /// The side that it comes from.
    pub from: Incident,
    /// Directions around each, in place of it alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<SpreadText>,
    /// Wavelength in vacuum, nanometres, one or several: that of named materials, against which lengths of the surface are judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength: Option<OneOrMany<Number>>,
    /// Stokes vector, `I, Q, U, V`; unpolarised by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stokes: Option<OneOrMany<Number>>,
    /// Directions towards the sun on a given surface, in place of `theta` and `phi`.
    #[serde(flatten)]
    pub sun: SunConfig,
}

impl GonioLight {
    /// Takes the directions towards the sun, if they are given, for `theta` and `phi`.
    pub(super) fn take_sun(&mut self, y_is_north: bool) {
        if let Some([theta, phi]) = self.sun.take(y_is_north) {
            (self.theta, self.phi) = (Some(theta), Some(phi));
        }
    }

    /// The first wavelength, nanometres, if one is given.
    pub(super) fn wavelength_nm(&self) -> Option<f64> {
        Some(self.wavelength.as_ref()?.first()?.0)
    }

    /// Returns `true` if light comes from patches of the full Klems basis.
    fn is_of_patches(&self) -> bool {
        matches!(self.directions, Some(LightDirections::Named(_)))
    }

    /// The pairs of polar angle and azimuth that light comes from, where these are not all.
    fn pairs(&self) -> Option<Vec<[f64; 2]>> {
        self.is_of_patches().then(|| klems_centres().collect())
    }

    /// Polar angles and azimuths, degrees; every pair is a direction, of patches every pair that is the centre of one.
    ///
    /// # Errors
    /// [`ConfigError`] if a list is empty, holds a value twice, or an angle is out of range.
    pub fn angles(&self) -> Result<[Vec<f64>; 2], ConfigError> {
        let given = |list: &Option<OneOrMany<Number>>, name| {
            let list = list
                .as_ref()
                .ok_or_else(|| ConfigError::missing("gonio", name))?;
            let numbers = list.values(name)?.into_iter().map(|number| number.0);
            Ok::<Vec<f64>, ConfigError>(numbers.collect())
        };
        let [thetas, phis] = match &self.directions {
            Some(LightDirections::Named(PatchBasis::Klems)) => {
                let all = |axis: usize| {
                    let mut angles: Vec<f64> = klems_centres().map(|one| one[axis]).collect();
                    angles.sort_by(f64::total_cmp);
                    angles.dedup();
                    angles
                };
                [all(0), all(1)]
            }
            Some(LightDirections::Grid(grid)) => {
                let centres = |n: usize, span: f64| {
                    (0..n)
                        .map(|i| span * (i as f64 + 0.5) / n as f64)
                        .collect::<Vec<f64>>()
                };
                [centres(grid.n_theta(), 90.0), centres(grid.n_phi(), 360.0)]
            }
            None => [given(&self.theta, "theta")?, given(&self.phi, "phi")?],
        };
        for theta in &thetas {
            for phi in &phis {
                Incidence::from_degrees(*theta, *phi)?;
            }
        }
        for (list, angles) in [("theta", &thetas), ("phi", &phis)] {
            let mut sorted = angles.clone();
            sorted.sort_by(f64::total_cmp);
            if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(ConfigError::GivenTwice {
                    list,
                    value: pair[0].to_string(),
                });
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
    /// Discs of a row, which is an angle of incidence.
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
    /// Coherent light in the specular directions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coherent: Option<Coherent>,
}

/// A measurement: surfaces, materials, directions and effort. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GonioConfig {
    /// The random surfaces.
    pub surface: SurfaceConfig,
    /// Given surfaces in their place.
    pub measured: MeasuredConfig,
    /// Their material.
    pub material: MaterialConfig,
    /// The medium below, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumConfig>,
    /// The directions that light comes from.
    pub light: GonioLight,
    /// Effort for each direction.
    pub run: RunConfig,
    /// Files to write.
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

    /// Returns `true` if every ray comes from an azimuth of its own, so that the azimuth of the light has no meaning.
    #[must_use]
    pub fn any_azimuth(&self) -> bool {
        let verification = self.as_verification();
        verification.is_ok_and(|config| config.any_azimuth())
    }

    /// Polar angles and azimuths of the light, degrees. Of patches one azimuth stands for all where it is random.
    ///
    /// # Errors
    /// [`ConfigError`] as of [`GonioLight::angles`].
    pub(super) fn angles(&self) -> Result<[Vec<f64>; 2], ConfigError> {
        let [thetas, phis] = self.light.angles()?;
        let is_random = self
            .azimuth()
            .map_or(self.surface.is_isotropic(), |one| one == Azimuth::Random);
        Ok(match self.light.is_of_patches() && is_random {
            true => [thetas, vec![0.0]],
            false => [thetas, phis],
        })
    }

    /// Numbers of the polar angle and of the azimuth of each direction.
    ///
    /// # Errors
    /// [`ConfigError`] as of [`GonioLight::angles`].
    pub(super) fn pairs(&self) -> Result<Vec<[usize; 2]>, ConfigError> {
        let [thetas, phis] = self.angles()?;
        let all = (0..thetas.len()).flat_map(|theta| (0..phis.len()).map(move |phi| [theta, phi]));
        let lit = self.light.pairs();
        let is_lit = |&[theta, phi]: &[usize; 2]| {
            let pair = [thetas[theta], phis[phi]];
            lit.as_ref().is_none_or(|lit| lit.contains(&pair))
        };
        Ok(all.filter(is_lit).collect())
    }

    /// Results on a given surface hold for one azimuth.
    fn azimuth(&self) -> Option<Azimuth> {
        match self.measured.is_given() {
            true => self.light.azimuth.or(Some(Azimuth::Fixed)),
            false => self.light.azimuth,
        }
    }

    /// The verification of all settings and directions, without models.
    fn as_verification(&self) -> Result<VerifyConfig, ConfigError> {
        let numbers = |list: Vec<f64>| OneOrMany::Many(list.into_iter().map(Number).collect());
        let [theta, phi] = self.angles()?.map(numbers);
        Ok(VerifyConfig {
            surface: self.surface.clone(),
            material: self.material.clone(),
            medium: self.medium.clone(),
            light: LightConfig {
                theta,
                phi,
                azimuth: self.azimuth(),
                from: self.light.from,
                spread: self.light.spread,
                wavelength: self.light.wavelength.clone(),
                stokes: self.light.stokes.clone(),
                sun: SunConfig::default(),
                pairs: self.light.pairs(),
            },
            run: self.run.clone(),
            compare: CompareConfig::none(),
            output: OutputConfig {
                plots: true,
                paths: None,
                absorbed_map: false,
                coherent: None,
            },
        })
    }

    /// Identity of the results of this configuration; `sample` holds the given surfaces, if there are any.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn header(&self, sample: Option<&Sample>) -> Result<Header, ConfigError> {
        let measured = sample.map(|sample| &sample.description);
        let document = self.as_verification()?.document_of_cases(measured);
        Ok(Header::new("gonio", self.run.seed, document))
    }

    /// The cases, checked as far as possible before a ray is traced; `sample` holds the given surfaces, if there are any.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn plan(&self, sample: Option<&Sample>) -> Result<Plan, StudyError> {
        let verification = self.as_verification()?;
        let plan = match sample {
            None if self.measured.is_given() => {
                return Err(ConfigError::Unread("the measured surface").into());
            }
            None => verification.plan()?,
            Some(sample) => verification.plan_on(&sample.shapes, sample.unit)?,
        };
        let specs = plan.cases.iter().map(|case| plan.settings.spec_of(case));
        for spec in specs.clone() {
            check_results(&spec, self.run.realisations.0, 1, plan.settings.refine)?;
        }
        let values = 2.0 * specs.map(|spec| spec.len()).sum::<usize>() as f64;
        check_memory("the table of all directions", (8.0 * values) as usize)?;
        Ok(plan)
    }
}
