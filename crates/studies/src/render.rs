//! Render: a picture of one given surface and the medium below it.

mod colour;
mod config;
mod files;
mod text;
mod wavelength_stage;

use std::time::Duration;

use asperity_render::{RenderError, RenderOutcome, RenderSettings, ToneCurve, denoise, render};
use asperity_simulate::{Cells, Deadline, Observer, Shape, StoppedBy};
use asperity_tracer::{AcceleratorKind, Branching, PathSettings};

pub use self::config::{
    CameraConfig, CameraKind, LightingConfig, PictureConfig, RenderConfig, RenderRun, ViewConfig,
};
use self::files::relative_errors;
pub use self::text::RenderedPicture;
use self::wavelength_stage::WavelengthStage;
use crate::config::error::ConfigError;
use crate::config::medium::MediumConfig;
use crate::config::values::Seconds;
use crate::error::StudyError;
use crate::given::GivenSurface;
use crate::settings::Document;

/// Throughput below which roulette decides: pictures are noisy by other causes, and weak paths take long.
const ROULETTE: f64 = 0.2;

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
        let config = RenderConfig::new(&document.clone().in_unit(surfaces.first.unit)?)?;
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
    /// Several wavelengths are rendered one after the other, by the same random numbers, each in an equal part of the time.
    ///
    /// # Errors
    /// [`StudyError`] if a stop comes before the first pass of the last wavelength is finished, the layer does not fit below the surface, a ray
    /// is too grazing, or a file cannot be written.
    pub fn render(&self, observer: &dyn Observer) -> Result<RenderedPicture, StudyError> {
        let config = &self.config;
        let mut outcome = self.outcome(observer)?;
        let errors = relative_errors(&outcome.picture);
        if config.picture.denoise {
            denoise(&mut outcome.picture);
        }
        let is_left_to_chance = config.surface.cells.of_given() == Cells::Smooth
            && config.medium.is_some()
            && config.lights.sun > 0.0;
        let notes = is_left_to_chance.then(|| SUN_BY_CHANCE.to_owned());
        let compass = config.lights.compass.sun_azimuth.is_some();
        let is_mirrored = compass && !self.surface.y_is_north;
        let notes = notes.into_iter();
        let notes = notes.chain(is_mirrored.then(|| MIRRORED_MAP.to_owned()));
        let picture = &config.picture;
        let tone = ToneCurve::new(picture.tone, &outcome.picture, picture.exposure);
        files::write(
            picture,
            &outcome.picture,
            &errors,
            &tone,
            &self.surface.name,
        )?;
        Ok(RenderedPicture {
            tone,
            denoised: picture.denoise,
            wavelengths: config.wavelengths()?.len(),
            outcome,
            files: picture.output.as_slice().to_vec(),
            error_image: picture.error_image.clone(),
            name: self.surface.name.clone(),
            notes: self.surface.notes.iter().cloned().chain(notes).collect(),
        })
    }

    /// The picture at the wavelength, or in colour that of all wavelengths.
    fn outcome(&self, observer: &dyn Observer) -> Result<RenderOutcome, StudyError> {
        let config = &self.config;
        let time = config.run.max_time.and_then(Seconds::duration);
        let wavelengths = config.wavelengths()?;
        let count = wavelengths.len();
        let whole = Deadline::new(observer, time);
        let mut sum: Option<RenderOutcome> = None;
        for (number, wavelength) in wavelengths.into_iter().enumerate() {
            let resolved = config.material.resolved(wavelength.nm)?;
            let layers = resolved.layers(config.medium.as_ref(), self.surface.unit)?;
            // Of integers, since a fraction of the longest time may overflow
            let part = |time: Duration| time / count as u32 * (number + 1) as u32;
            let stage = WavelengthStage {
                observer: &whole,
                number,
                count,
            };
            let observer = Deadline::new(&stage, time.map(part));
            let one = render(
                &self.shape,
                resolved.material,
                &layers,
                &self.settings,
                &observer,
            );
            let one = match one {
                Err(RenderError::Interrupted) if count > 1 => {
                    return Err(StudyError::ColourInterrupted);
                }
                one => one?,
            };
            let is_last = number + 1 == count;
            if one.stopped_by == Some(StoppedBy::Interrupt) && !is_last {
                return Err(StudyError::ColourInterrupted);
            }
            sum = Some(match wavelength.xyz {
                Some(xyz) => in_colour(sum, one, xyz, count),
                None => one,
            });
        }
        sum.ok_or(StudyError::ColourInterrupted)
    }
}

/// Adds the outcome at one of `count` wavelengths. Fractions of lost light are averaged; samples are the fewest of all.
fn in_colour(
    sum: Option<RenderOutcome>,
    mut one: RenderOutcome,
    xyz: [f64; 3],
    count: usize,
) -> RenderOutcome {
    let losses = [&mut one.truncated, &mut one.left_patch, &mut one.lost];
    losses.into_iter().for_each(|loss| *loss /= count as f64);
    let Some(sum) = sum else {
        one.picture = colour::add(None, one.picture, xyz);
        return one;
    };
    RenderOutcome {
        picture: colour::add(Some(sum.picture), one.picture, xyz),
        samples: sum.samples.min(one.samples),
        truncated: sum.truncated + one.truncated,
        left_patch: sum.left_patch + one.left_patch,
        lost: sum.lost + one.lost,
        seconds: [0, 1].map(|i| sum.seconds[i] + one.seconds[i]),
        stopped_by: one.stopped_by.or(sum.stopped_by),
    }
}
