//! The configuration of a picture: surface, medium, camera and lights.

use std::path::PathBuf;

use asperity_optics::Incidence;
use asperity_plot::BrightnessScale;
use asperity_render::{Lights, Patch, Projection, RenderError, Sun, Tone, View};
use asperity_simulate::check_memory;
use asperity_surface::LengthUnit;
use serde::Deserialize;

use crate::config::MaterialConfig;
use crate::config::error::ConfigError;
use crate::config::measured::MeasuredConfig;
use crate::config::medium::MediumConfig;
use crate::config::sun::SunConfig;
use crate::config::trace::CellsConfig;
use crate::config::values::{Number, OneOrMany, Seconds};
use crate::error::StudyError;
use crate::render::colour;
use crate::settings::Document;

/// A picture of one given surface.
#[derive(Clone, Debug, Deserialize)]
pub struct RenderConfig {
    /// The cells between heights.
    pub surface: CellsConfig,
    /// The surface.
    pub measured: MeasuredConfig,
    /// The material of the surface.
    pub material: MaterialConfig,
    /// The medium below, if there is one.
    pub medium: Option<MediumConfig>,
    /// The wavelengths of named materials.
    pub light: WavelengthConfig,
    /// The direction towards the camera.
    pub view: ViewConfig,
    /// The camera.
    pub camera: CameraConfig,
    /// The lights.
    pub lights: LightingConfig,
    /// The picture.
    pub picture: PictureConfig,
    /// The effort.
    pub run: RenderRun,
}

/// `[light]` of a picture.
#[derive(Clone, Debug, Deserialize)]
pub struct WavelengthConfig {
    /// Wavelength in vacuum of named materials, nanometres; several give a picture in colour.
    pub wavelength: Option<OneOrMany<Number>>,
}

/// A wavelength that is rendered.
pub(super) struct RenderedWavelength {
    /// Nanometres; `None` if it is not given.
    pub(super) nm: Option<f64>,
    /// Weights of its radiance in X, Y and Z, of a picture in colour.
    pub(super) xyz: Option<[f64; 3]>,
}

/// `[view]`: the direction towards the camera, degrees.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct ViewConfig {
    /// Polar angle.
    pub theta: f64,
    /// Azimuth.
    pub phi: f64,
}

/// Kinds of camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraKind {
    /// Perspective.
    Pinhole,
    /// Parallel lines of sight.
    Orthographic,
}

/// `[camera]`: the camera.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct CameraConfig {
    /// Its kind.
    pub projection: CameraKind,
    /// Field of view of a pinhole camera, degrees.
    pub fov: f64,
    /// Point of the mean plane that it looks at; the middle of the tile unless given.
    pub look_at: Option<[f64; 2]>,
    /// Width of the picture at that point; that of the tile unless given.
    pub width: Option<f64>,
}

/// `[lights]`: radiances, and the sun.
#[derive(Clone, Debug, Deserialize)]
pub struct LightingConfig {
    /// Radiance of the zenith.
    pub sky: f64,
    /// Radiance of the horizon over that of the zenith.
    pub horizon: f64,
    /// Irradiance of the sun.
    pub sun: f64,
    /// Polar angle of the direction towards the sun, degrees.
    pub sun_theta: f64,
    /// Azimuth of that direction, degrees.
    pub sun_phi: f64,
    /// Direction towards the sun by elevation and compass, in place of these two.
    #[serde(flatten)]
    pub compass: SunConfig,
    /// Angular radius of the sun, degrees.
    pub sun_radius: f64,
    /// Rectangle of the mean plane that the sun lights, `x0, y0, x1, y1`; all of it unless given.
    pub patch: Option<[f64; 4]>,
    /// Radiance from below.
    pub below: f64,
}

/// `[picture]`: the picture and its files.
#[derive(Clone, Debug, Deserialize)]
pub struct PictureConfig {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Camera rays per pixel.
    pub samples: u64,
    /// Factor from radiance to the brightness of a PNG; chosen by the picture unless given.
    pub exposure: Option<f64>,
    /// Curve from radiance to the brightness of a PNG.
    #[serde(with = "ToneText")]
    pub tone: Tone,
    /// A scale of the brightness below a PNG.
    #[serde(default)]
    pub scale_bar: bool,
    /// Denoising by non-local means.
    #[serde(default)]
    pub denoise: bool,
    /// The figure of the errors, if it is requested.
    pub error_image: Option<PathBuf>,
    /// The files.
    pub output: OneOrMany<PathBuf>,
}

/// Names of tones.
#[derive(Deserialize)]
#[serde(remote = "Tone", rename_all = "lowercase")]
enum ToneText {
    Reinhard,
    Linear,
    Log,
}

/// `[run]` of a picture.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct RenderRun {
    /// Seed of camera rays and paths.
    pub seed: u64,
    /// Time after which no further pass begins; several wavelengths have equal parts of it.
    pub max_time: Option<Seconds>,
}

impl RenderConfig {
    /// Reads the configuration of a document, and checks what does not depend on the surface.
    ///
    /// # Errors
    /// [`StudyError`] if a value is invalid or two contradict each other.
    pub fn new(document: &Document) -> Result<Self, StudyError> {
        let mut config: Self = document.read()?;
        config.lights.lights(false)?;
        config.check_picture()?;
        if let Some(wavelengths) = &config.light.wavelength {
            let medium = config.medium.as_ref();
            config.material.prepare(Some(wavelengths), medium)?;
        }
        Ok(config)
    }

    /// The wavelengths: several for a picture in colour, one otherwise.
    pub(super) fn wavelengths(&self) -> Result<Vec<RenderedWavelength>, ConfigError> {
        let grey = |nm| vec![RenderedWavelength { nm, xyz: None }];
        let Some(given) = &self.light.wavelength else {
            return Ok(grey(None));
        };
        let nm: Vec<f64> = given
            .values("wavelength")?
            .iter()
            .map(|one| one.0)
            .collect();
        if let [one] = nm[..] {
            return Ok(grey(Some(one)));
        }
        let weights = colour::weights(&nm)?;
        let weighted = nm.into_iter().zip(weights);
        let coloured = weighted.map(|(nm, xyz)| RenderedWavelength {
            nm: Some(nm),
            xyz: Some(xyz),
        });
        Ok(coloured.collect())
    }

    /// Refuses colours of a spectrum with gaps, a scale that is too narrow, and pictures in colour that need more memory than there is.
    fn check_picture(&self) -> Result<(), StudyError> {
        let is_colour = self.wavelengths()?.len() > 1;
        let [columns, rows] = self.picture.size;
        let least = BrightnessScale::MIN_WIDTH;
        if self.picture.scale_bar && columns < least as usize {
            let given = format!("a scale bar for a picture of {columns} columns");
            let reason = format!("needs {least} columns or more");
            return Err(ConfigError::unsuitable(given, reason).into());
        }
        // What rendering one picture takes, and the sum over wavelengths, which is kept meanwhile.
        if is_colour {
            let pixels = columns.saturating_mul(rows);
            check_memory("this picture", pixels.saturating_mul(192))?;
        }
        Ok(())
    }

    /// The view of a tile of that extent, lengths in `unit`.
    pub(super) fn view(&self, extent: [f64; 2], unit: LengthUnit) -> Result<View, StudyError> {
        let camera = &self.camera;
        let projection = match camera.projection {
            CameraKind::Orthographic => Projection::Orthographic,
            CameraKind::Pinhole => Projection::Pinhole {
                field_of_view: camera.fov.to_radians(),
            },
        };
        let target = camera
            .look_at
            .unwrap_or_else(|| extent.map(|length| 0.5 * length));
        let towards = direction(self.view.theta, self.view.phi)?;
        let width = camera.width.unwrap_or(extent[0]);
        let view = View::new(projection, towards, target, width);
        Ok(view.map_err(RenderError::from)?.in_unit(unit))
    }
}

impl LightingConfig {
    /// The lights above a surface, of which +y is the north or -y.
    pub(super) fn lights(&self, y_is_north: bool) -> Result<Lights, StudyError> {
        let (theta, phi) = match self.compass.clone().take(y_is_north) {
            Some([theta, phi]) => (theta.one("sun_elevation")?.0, phi.one("sun_azimuth")?.0),
            None => (self.sun_theta, self.sun_phi),
        };
        let towards = direction(theta, phi)?;
        let lights = || {
            let patch = self
                .patch
                .map(|[x0, y0, x1, y1]| Patch::new([x0, y0], [x1, y1]));
            let patch = patch.transpose()?;
            let sun = Sun::new(towards, self.sun, self.sun_radius.to_radians(), patch)?;
            let sun = (self.sun > 0.0).then_some(sun);
            Lights::new(self.sky, self.below, sun)?.with_horizon(self.horizon)
        };
        Ok(lights().map_err(RenderError::from)?)
    }
}

fn direction(theta: f64, phi: f64) -> Result<Incidence, ConfigError> {
    Ok(Incidence::from_degrees(theta, phi)?)
}
