//! The configuration of `asperity model`.

use std::f64::consts::PI;
use std::path::PathBuf;

use asperity_analysis::{Ggx, Heitz, SlopeCovariance, SlopeDistribution, Smith, SmithSlopes};
use asperity_optics::Incidence;
use asperity_simulate::short;
use asperity_synthesis::Psd;
use asperity_tally::{Azimuth, HemisphereGrid, TallySpec};
use serde::Deserialize;

use super::error::EvaluationError;
use super::slopes_of::FileSlopes;
use crate::config::MaterialConfig;
use crate::config::error::ConfigError;
use crate::config::media::Resolved;
use crate::config::medium::MediumConfig;
use crate::config::sweep::{Dimension, expanded};
use crate::config::values::{Number, OneOrMany};

/// Models of GGX slopes.
const OF_GGX: [&str; 4] = [
    Smith::NAME_GGX,
    Smith::NAME_GGX_SEPARABLE,
    Heitz::NAME_GGX,
    SmithSlopes::NAME,
];

/// A model, and where it is evaluated.
#[derive(Clone, Debug, Deserialize)]
pub struct ModelConfig {
    pub(super) model: Selection,
    surface: Roughness,
    pub(super) material: MaterialConfig,
    pub(super) medium: Option<MediumConfig>,
    light: LightDirection,
    pub(super) run: Sampling,
}

/// The model and its directions.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Selection {
    name: Option<String>,
    list: bool,
    /// Distance between directions, degrees.
    pub(super) step: Option<f64>,
    /// `true` if they fill the sphere, and not only the plane of incidence.
    pub(super) sphere: bool,
    /// Table of the attenuation that replaces that of the model.
    pub(super) attenuation_of: Option<PathBuf>,
}

/// The roughness, if the model is of rough surfaces.
#[derive(Clone, Debug, Deserialize)]
struct Roughness {
    smoothness: Option<OneOrMany<Number>>,
    smoothness_y: Option<f64>,
    azimuth: Option<f64>,
    slopes_of: Option<PathBuf>,
    ggx_alpha: Option<f64>,
}

/// The direction towards the light, degrees.
#[derive(Clone, Debug, Deserialize)]
struct LightDirection {
    theta: OneOrMany<Number>,
    phi: OneOrMany<Number>,
    /// Wavelength in vacuum of named materials, nanometres.
    wavelength: Option<OneOrMany<Number>>,
}

/// Bins, and the effort of a model that follows rays.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Sampling {
    pub(super) rays: Option<u64>,
    pub(super) seed: Option<u64>,
    pub(super) bins: Option<HemisphereGrid>,
}

/// The lists that are expanded, by the names of their columns, the last one fastest.
const DIMENSIONS: [(&str, Dimension<ModelConfig>); 12] = [
    ("smoothness", |config| config.surface.smoothness.as_mut()),
    ("eta", |config| config.material.eta_mut()),
    ("kappa", |config| config.material.kappa_mut()),
    ("mean_free_path", |config| interactions(config)?[0].take()),
    ("albedo", |config| interactions(config)?[1].take()),
    ("absorption", |config| interactions(config)?[2].take()),
    ("scattering", |config| interactions(config)?[3].take()),
    ("g", |config| config.medium.as_mut()?.g.as_mut()),
    ("thickness", |config| {
        config.medium.as_mut()?.thickness.as_mut()
    }),
    ("wavelength_nm", |config| config.light.wavelength.as_mut()),
    ("theta_i_deg", |config| Some(&mut config.light.theta)),
    ("phi_i_deg", |config| Some(&mut config.light.phi)),
];

fn interactions(config: &mut ModelConfig) -> Option<[Option<&mut OneOrMany<Number>>; 4]> {
    Some(config.medium.as_mut()?.interactions.lists())
}

/// Configurations of every combination of lists.
pub(super) struct Combinations {
    /// Names of the lists with several values.
    pub(super) names: Vec<&'static str>,
    /// Configurations without lists, each with its values of these.
    pub(super) singles: Vec<(Vec<f64>, ModelConfig)>,
}

impl ModelConfig {
    /// Configurations of every combination of the lists.
    pub(super) fn combinations(&self) -> Result<Combinations, ConfigError> {
        let mut config = self.clone();
        let medium = config.medium.as_ref();
        config
            .material
            .prepare(config.light.wavelength.as_ref(), medium)?;
        let singles = expanded(&config, &DIMENSIONS)?;
        let mut varied = DIMENSIONS.to_vec();
        varied.retain(|(_, list)| list(&mut config).is_some_and(|list| list.as_slice().len() > 1));
        let with_values = |mut single: Self| {
            let value = |(_, list): &(_, Dimension<Self>)| Some(list(&mut single)?.first()?.0);
            (varied.iter().filter_map(value).collect(), single)
        };
        Ok(Combinations {
            singles: singles.into_iter().map(with_values).collect(),
            names: varied.into_iter().map(|(name, _)| name).collect(),
        })
    }

    /// Returns `true` if the models are to be listed, instead of one evaluated.
    #[must_use]
    pub const fn is_list(&self) -> bool {
        self.model.list
    }

    pub(super) fn name(&self) -> Result<&str, EvaluationError> {
        self.model.name.as_deref().ok_or(EvaluationError::NoName)
    }

    /// The material of a configuration without lists.
    pub(super) fn material(&self) -> Result<Resolved, ConfigError> {
        let wavelength = self.light.wavelength.as_ref();
        let wavelength = wavelength.map(|one| one.one("wavelength")).transpose()?;
        if let (Some(one), None) = (wavelength, self.material.media()) {
            let given = format!("wavelength {} nm", short(one.0));
            let reason = "changes nothing unless the material is a named one, such as gold";
            return Err(ConfigError::unsuitable(given, reason));
        }
        self.material.resolved(wavelength.map(|one| one.0))
    }

    pub(super) fn incidence(&self) -> Result<Incidence, ConfigError> {
        let (theta, phi) = (self.light.theta.one("theta")?, self.light.phi.one("phi")?);
        Ok(Incidence::from_degrees(theta.0, phi.0)?)
    }

    /// The bins, with the in-plane slice of other commands.
    pub(super) fn spec(&self) -> Result<TallySpec, ConfigError> {
        let grid = self.run.bins.unwrap_or_default();
        Ok(TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH)?)
    }

    /// The slopes of the rough surface that the model `name` is of, and what a reader of the results should know about them.
    pub(super) fn slopes(
        &self,
        name: &str,
    ) -> Result<(SlopeDistribution, Vec<String>), EvaluationError> {
        if let Some(alpha) = self.surface.ggx_alpha {
            return Ok((self.ggx_slopes(name, alpha)?, Vec::new()));
        }
        let Some(path) = &self.surface.slopes_of else {
            return Ok((self.gaussian_slopes(name)?.into(), Vec::new()));
        };
        let mut slopes = FileSlopes::read(path)?;
        Ok((slopes.of_model(name)?, slopes.notes))
    }

    /// GGX slopes of this roughness.
    fn ggx_slopes(&self, name: &str, alpha: f64) -> Result<SlopeDistribution, EvaluationError> {
        if !OF_GGX.contains(&name) {
            return Err(EvaluationError::Excludes {
                name: name.to_owned(),
                reason: "is of Gaussian slopes, and GGX slopes have no variance for it to take",
                advice: format!("give --smoothness, or take {}", OF_GGX.join(", ")),
            });
        }
        if self.surface.azimuth.is_some() {
            return Err(EvaluationError::NoSecondSmoothness);
        }
        let ggx = Ggx::isotropic(alpha)?;
        Ok(SlopeDistribution::Ggx {
            ggx,
            surface: None,
            covariance: *ggx.beckmann(),
        })
    }

    /// Gaussian slopes of the smoothness.
    fn gaussian_slopes(&self, name: &str) -> Result<SlopeCovariance, EvaluationError> {
        let roughness = &self.surface;
        let s = roughness.smoothness.as_ref();
        let s = s.ok_or_else(|| EvaluationError::Lacks {
            name: name.to_owned(),
            needs: match OF_GGX.contains(&name) {
                true => "a rough surface: give --smoothness, --slopes-of, or --slopes ggx with --ggx-alpha",
                false => "a rough surface: give --smoothness or --slopes-of",
            },
        })?;
        let s = s.one("smoothness")?.0;
        if roughness.azimuth.is_some() && roughness.smoothness_y.is_none() {
            return Err(EvaluationError::NoSecondSmoothness);
        }
        let Some(s_y) = roughness.smoothness_y.filter(|s_y| *s_y != s) else {
            return Ok(SlopeCovariance::isotropic(s)?);
        };
        for s in [s, s_y] {
            SlopeCovariance::isotropic(s)?;
        }
        let azimuth = roughness.azimuth.unwrap_or(0.0).to_radians();
        let psd = Psd::anisotropic_gaussian(1.0, s, s_y, azimuth).map_err(ConfigError::from)?;
        let [xx, xy, yy] = psd.slope_covariance();
        Ok(SlopeCovariance::new(xx, yy, xy)?)
    }
}

/// The azimuth by which bins are counted; free where nothing depends on it.
pub(super) fn azimuth(incidence: Incidence, is_isotropic: bool) -> Azimuth {
    match incidence.is_vertical() && is_isotropic {
        true => Azimuth::Free,
        false => Azimuth::From(incidence.phi() + PI),
    }
}
