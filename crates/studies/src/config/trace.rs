//! The configuration of `asperity trace`: given surfaces, one material, one direction.

use asperity_analysis::SlopeCovariance;
use asperity_optics::{Incidence, Layer, Material};
use asperity_simulate::{Case, Coordinates, CoreSlopes, Light, Lobe, Settings, SurfaceSource};
use asperity_surface::LengthUnit;
use serde::{Deserialize, Serialize};

use super::measured::MeasuredConfig;
use crate::config::case_model::ModelledSurface;
use crate::config::cases::{
    check_estimator, check_models, check_one_direction, check_sides, check_unpolarised,
};
use crate::config::error::ConfigError;
use crate::config::media::Resolved;
use crate::config::medium::MediumConfig;
use crate::config::surface::CellsChoice;
use crate::config::sweep::{Dimension, LitSample, expanded_by_side};
use crate::config::{
    Azimuth, CompareConfig, Incident, LightConfig, MaterialConfig, OutputConfig, RunConfig,
};
use crate::settings::{Command, Document};

/// `[surface]`, of which a given surface has the cells alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellsConfig {
    /// Cells between the heights of the grid.
    #[serde(default)]
    pub cells: CellsChoice,
}

/// Light on given surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceConfig {
    /// Cells between the heights of the surface.
    pub surface: CellsConfig,
    /// The surfaces.
    pub measured: MeasuredConfig,
    /// The material.
    pub material: MaterialConfig,
    /// The medium below, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumConfig>,
    /// The light.
    pub light: LightConfig,
    /// The effort, and the methods.
    pub run: RunConfig,
    /// Models with the slopes of this surface; none by default.
    pub compare: CompareConfig,
    /// The files.
    pub output: OutputConfig,
}

/// The lists that are expanded into cases, the last one fastest.
const DIMENSIONS: [(&str, Dimension<TraceConfig>); 3] = [
    ("eta", |config| config.material.eta_mut()),
    ("kappa", |config| config.material.kappa_mut()),
    ("wavelength", |config| {
        config.light.wavelength_of(&config.material)
    }),
];

fn lit_sample(config: &mut TraceConfig) -> LitSample<'_> {
    LitSample {
        material: &mut config.material,
        medium: config.medium.as_ref(),
        light: &mut config.light,
    }
}

impl TraceConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        Ok(Document::of_text(Command::Trace, text)?.read()?)
    }

    /// The configurations of every combination of the lists, each with one value per list.
    ///
    /// # Errors
    /// [`ConfigError`] if a list is empty or makes no difference, or there are too many combinations.
    pub fn singles(&self) -> Result<Vec<Self>, ConfigError> {
        expanded_by_side(self, lit_sample, &DIMENSIONS)
    }

    /// The material of a configuration without lists, and the layers below it, in lengths of `unit`.
    fn resolved(&self, unit: LengthUnit) -> Result<(Resolved, Vec<Layer>), ConfigError> {
        let resolved = self.material.resolved(self.light.wavelength_nm())?;
        resolved.over_layers(self.medium.as_ref(), unit, self.light.from.into())
    }

    /// The case of this configuration without lists on `surface`, whose lengths are in `unit`, in bins around the lobes of `slopes`.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub(crate) fn case(
        &self,
        surface: SurfaceSource,
        slopes: Option<CoreSlopes>,
        unit: LengthUnit,
    ) -> Result<Case, ConfigError> {
        self.check_in(unit)?;
        let (material, layers) = self.resolved(unit)?;
        let at = Coordinates {
            unit,
            ..Coordinates::default()
        };
        let mut case = Case {
            bins: None,
            at: material.coordinates(at),
            surface,
            material: material.material,
            layers,
            light: Light {
                incidence: self.incidence()?,
                from: self.light.from.into(),
                spread: self.light.spread(self.incidence()?)?,
                random_azimuth: self.light.azimuth == Some(Azimuth::Random),
                stokes: self.light.stokes(self.run.polarisation)?,
            },
        };
        case.bins = self.run.bins_around(Lobe::of_slopes(&case, slopes));
        Ok(case)
    }

    /// Checks everything that can be known before the surface is read.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn check(&self) -> Result<(), ConfigError> {
        // The unit of the surface is not known yet: no slab is too thin in the longest.
        let check = |single: Self| single.check_in(LengthUnit::Kilometre);
        self.singles()?.into_iter().try_for_each(check)
    }

    /// Checks a configuration without lists for surfaces with lengths in `unit`.
    fn check_in(&self, unit: LengthUnit) -> Result<(), ConfigError> {
        let (Resolved { material, .. }, layers) = self.resolved(unit)?;
        self.light.spread(self.incidence()?)?;
        self.light.stokes(self.run.polarisation)?;
        if !layers.is_empty() {
            check_estimator(self.run.estimator)?;
        }
        if self.output.paths.is_some() && self.light.from == Incident::Below {
            let reason = "follows light from above alone; leave out from below, or paths";
            return Err(ConfigError::unsuitable("paths", reason));
        }
        check_sides(self.run.side, material, &layers)?;
        self.check_absorbed_map(material, !layers.is_empty())?;
        self.check_comparison(material, &layers)?;
        let settings = self.ray_settings()?;
        if let Some(target) = settings.target() {
            target.check(&settings.tally, material, &layers)?;
        }
        Ok(())
    }

    /// Checks that facets absorb light whose map is requested, on the mesh that is given.
    fn check_absorbed_map(&self, material: Material, has_layer: bool) -> Result<(), ConfigError> {
        let reason = if !self.output.absorbed_map {
            return Ok(());
        } else if has_layer {
            "maps the light that facets absorb, not a medium or body below them; take an opaque one, or leave out absorbed_map"
        } else if !material.absorbs() {
            "maps the light that facets absorb, and these absorb none; take a conductor, or lambertian with a reflectance below 1"
        } else if self.run.refine {
            "maps the cells of the given mesh; leave out refine, or absorbed_map"
        } else {
            return Ok(());
        };
        Err(ConfigError::unsuitable("absorbed_map", reason))
    }

    /// Checks the models and the light that they are compared with, as far as the slopes of the surface do not matter.
    fn check_comparison(&self, material: Material, layers: &[Layer]) -> Result<(), ConfigError> {
        if self.compare.models.is_empty() {
            return Ok(());
        }
        if self.light.azimuth == Some(Azimuth::Random) {
            let needed = "light from one azimuth; leave out azimuth random, or the models";
            return Err(ConfigError::missing("a comparison with models", needed));
        }
        check_one_direction(self.light.spread.is_some())?;
        check_unpolarised(self.light.stokes(self.run.polarisation)?)?;
        let any = ModelledSurface {
            slopes: SlopeCovariance::isotropic(1.0).map(Into::into),
            is_nearly_isotropic: false,
            material,
            layers: layers.to_vec(),
        };
        check_models(&self.compare.models, &any, self.run.side)
    }

    /// The settings of the rays.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn ray_settings(&self) -> Result<Settings, ConfigError> {
        let mut settings = self.run.ray_settings()?;
        if let Some(medium) = &self.medium {
            settings.tally = settings.tally.with_medium();
            settings.max_scatterings = medium.max_scatterings;
        }
        Ok(settings)
    }

    pub(crate) fn incidence(&self) -> Result<Incidence, ConfigError> {
        let (theta, phi) = (self.light.theta.one("theta")?, self.light.phi.one("phi")?);
        Ok(Incidence::from_degrees(theta.0, phi.0)?)
    }
}
