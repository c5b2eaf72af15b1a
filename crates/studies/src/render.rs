//! Render: a picture of one given surface and the medium below it.

mod config;
mod text;

use asperity_io::write_picture;
use asperity_render::{RenderSettings, render};
use asperity_simulate::{Cells, Deadline, Observer, Shape};
use asperity_tracer::{AcceleratorKind, Branching, PathSettings};

pub use self::config::{
    CameraConfig, CameraKind, LightingConfig, PictureConfig, RenderConfig, RenderRun, ViewConfig,
};
pub use self::text::RenderedPicture;
use crate::config::error::ConfigError;
use crate::config::medium::MediumConfig;
use crate::config::values::Seconds;
use crate::error::StudyError;
use crate::given::{GivenError, GivenSurface};
use crate::settings::Document;

/// Throughput below which roulette decides: pictures are noisy by other causes, and weak paths take long.
const ROULETTE: f64 = 0.2;

/// Comment on the channels of an EXR.
const COMMENT: &str = "Y: radiance, linear, in the unit in which the lights were given; error: its standard error, NaN where unknown; A: fraction of the pixel that shows the surface";

/// Note on smooth cells: light beams need flat facets.
const SUN_BY_CHANCE: &str = "below smooth cells sunlight is found by random paths alone, which takes many samples or a wide sun";

/// Note on a map whose rows go from north to south, so that its x, y and z are left-handed.
const MIRRORED_MAP: &str = "the first row of the map, at y = 0, is its north, so the picture shows its mirror image; with --flip north is along +y and up in the picture";

/// A picture that is planned: the surface is read, and all settings are checked.
pub struct RenderPlan {
    /// The configuration, with lengths in the unit of the surface.
    config: RenderConfig,
    surface: GivenSurface,
    settings: RenderSettings,
    shape: Shape,
}

impl RenderPlan {
    /// Reads the surface of a configuration that was read from `document`, and checks all settings.
    ///
    /// # Errors
    /// [`StudyError`] if a value is invalid, a file cannot be read, or the camera lies below the surface.
    pub fn new(
        config: &RenderConfig,
        document: &Document,
        observer: &dyn Observer,
    ) -> Result<Self, StudyError> {
        let medium = config.medium.as_ref();
        let (surfaces, bottom) = config
            .measured
            .read_with_bottom(medium, document, observer)?;
        let config: RenderConfig = document.clone().in_unit(surfaces.first.unit)?.read()?;
        let medium = config.medium.as_ref();
        let surface = surfaces.first.clone();
        let paths = PathSettings::new(Branching::Pick, ROULETTE, PathSettings::DEFAULT_MAX_ORDER);
        let settings = RenderSettings {
            view: config.view(surface.extent(), surface.unit)?,
            lights: config.lights.lights(surface.y_is_north)?,
            size: config.picture.size,
            samples: config.picture.samples,
            seed: config.run.seed,
            paths: paths.map_err(ConfigError::from)?,
            accelerator: AcceleratorKind::Auto,
            most_scatterings: medium.map_or(0, |medium| medium.max_scatterings),
        };
        let lowest = medium.map_or(0, MediumConfig::lowest);
        let mut shapes = surfaces.simulated(bottom, lowest, config.surface.cells.of_given())?;
        Ok(Self {
            shape: shapes.swap_remove(0),
            config,
            surface,
            settings,
        })
    }

    /// Renders the picture until the time of the configuration is over, and writes it.
    ///
    /// # Errors
    /// [`StudyError`] if the layer does not fit below the surface, a ray is too grazing, a stop comes before the first pass is finished, or
    /// a file cannot be written.
    pub fn render(&self, observer: &dyn Observer) -> Result<RenderedPicture, StudyError> {
        let config = &self.config;
        let time = config.run.max_time.and_then(Seconds::duration);
        let resolved = config.material.resolved(config.light.wavelength)?;
        let material = resolved.material;
        let layers = resolved.layers(config.medium.as_ref(), self.surface.unit)?;
        let observer = Deadline::new(observer, time);
        let outcome = render(&self.shape, material, &layers, &self.settings, &observer)?;
        let is_left_to_chance = config.surface.cells.of_given() == Cells::Smooth
            && config.medium.is_some()
            && config.lights.sun > 0.0;
        let notes = is_left_to_chance.then(|| SUN_BY_CHANCE.to_owned());
        let compass = config.lights.compass.sun_azimuth.is_some();
        let is_mirrored = compass && !self.surface.y_is_north;
        let notes = notes.into_iter();
        let notes = notes.chain(is_mirrored.then(|| MIRRORED_MAP.to_owned()));
        let exposure = config.picture.exposure;
        let exposure = exposure.unwrap_or_else(|| asperity_render::exposure(&outcome.picture));
        let files = config.picture.output.as_slice();
        for path in files {
            write_picture(path, &outcome.picture, exposure, COMMENT).map_err(GivenError::from)?;
        }
        Ok(RenderedPicture {
            exposure,
            outcome,
            files: files.to_vec(),
            name: self.surface.name.clone(),
            notes: self.surface.notes.iter().cloned().chain(notes).collect(),
        })
    }
}
