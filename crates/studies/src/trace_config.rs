//! The configuration of `asperity trace`: one given surface, one material, one direction.

use asperity_optics::{Incidence, Layer, Material};
use asperity_simulate::{BottomSurface, RaySettings, Scene};
use serde::{Deserialize, Serialize};

use crate::cases::{check_light, check_sides};
use crate::config::{Azimuth, LightConfig, MaterialConfig, OutputConfig, RunConfig};
use crate::config_error::ConfigError;
use crate::gonio::MeasuredConfig;
use crate::medium::MediumConfig;
use crate::settings::{Command, Document};

/// Light on one given surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceConfig {
    /// The surface.
    pub measured: MeasuredConfig,
    /// What it is made of.
    pub material: MaterialConfig,
    /// What lies below, if there is anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumConfig>,
    /// Where the light comes from.
    pub light: LightConfig,
    /// How much is traced.
    pub run: RunConfig,
    /// What is written.
    pub output: OutputConfig,
}

impl TraceConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        Ok(Document::of_text(Command::Trace, text)?.read()?)
    }

    /// The material.
    ///
    /// # Errors
    /// [`ConfigError`] if a key is missing, superfluous or out of range.
    pub fn material(&self) -> Result<Material, ConfigError> {
        self.material.material()
    }

    /// The layer below, if there is one.
    ///
    /// # Errors
    /// [`ConfigError`] if two values contradict each other.
    pub fn layer(&self) -> Result<Option<Layer>, ConfigError> {
        let material = self.material()?;
        self.medium
            .as_ref()
            .map(|medium| medium.layer(material))
            .transpose()
    }

    /// The material, what lies below it, and the light.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn scene(&self) -> Result<Scene, ConfigError> {
        let scene = Scene {
            material: self.material()?,
            layer: self.layer()?,
            incidence: self.incidence()?,
            incident: self.light.from.into(),
            any_azimuth: self.light.azimuth == Some(Azimuth::Random),
        };
        if scene.layer.is_some() {
            check_light(scene.incident, self.run.estimator)?;
        }
        check_sides(self.run.side, scene.material, scene.layer.as_ref())?;
        Ok(scene)
    }

    /// The settings of the rays.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn ray_settings(&self) -> Result<RaySettings, ConfigError> {
        let mut settings = self.run.ray_settings()?;
        if let Some(medium) = &self.medium {
            settings.spec = settings.spec.with_medium();
            settings.bottom = medium.bottom_surface.named();
            settings.most_scatterings = medium.max_scatterings;
        }
        if settings.bottom == BottomSurface::Independent {
            return Err(ConfigError::Contradiction(
                "--bottom-surface independent: a single surface is traced and none is drawn; take flat, same or a file"
                    .into(),
            ));
        }
        if let Some(target) = settings.target {
            let layer = self.layer()?;
            target.check(&settings.spec, self.material()?, layer.as_ref())?;
        }
        Ok(settings)
    }

    fn incidence(&self) -> Result<Incidence, ConfigError> {
        let (theta, phi) = (self.light.theta.one("theta")?, self.light.phi.one("phi")?);
        Ok(Incidence::from_degrees(theta.0, phi.0)?)
    }
}
