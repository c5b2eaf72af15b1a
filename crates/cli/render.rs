//! `asperity render`: a picture of one surface.

use std::path::{Path, PathBuf};

use asperity_io::{PictureFormat, write_picture};
use asperity_optics::Incidence;
use asperity_render::{
    Lights, Patch, Projection, RenderError, RenderOutcome, RenderSettings, Sun, View, exposure,
    render,
};
use asperity_simulate::{BottomSurface, Cells, Deadline, Observer, Shape, counted, short};
use asperity_studies::settings::Document;
use asperity_studies::{
    CellsConfig, GivenShape, GivenSurface, MaterialConfig, MeasuredConfig, MediumConfig, OneOrMany,
    Seconds, TraceError, wrapped,
};
use asperity_surface::LengthUnit;
use asperity_tracer::{AcceleratorKind, Branching, PathSettings};
use serde::Deserialize;

use crate::common::Common;
use crate::end::{Again, End, EndedRun};
use crate::failure::Failure;
use crate::given::{read_like, required_surfaces, settings_for};
use crate::input::refuse_simulation;
use crate::output::{note_lines, print};
use crate::output_files::check_outputs;
use crate::progress::Progress;

/// What the values of an EXR are.
const COMMENT: &str = "Y: radiance, linear, in the unit in which the lights were given; error: its standard error, NaN where unknown; A: fraction of the pixel that shows the surface";

/// Throughput below which roulette decides: pictures are noisy by other causes, and weak paths take long.
const ROULETTE: f64 = 0.2;

/// Said where cells are smooth: light beams need flat facets.
const SUN_BY_CHANCE: &str = "below smooth cells sunlight is found by random paths alone, which takes many samples or a wide sun";

/// What is rendered, and how.
#[derive(Deserialize)]
struct Settings {
    surface: CellsConfig,
    measured: MeasuredConfig,
    material: MaterialConfig,
    medium: Option<MediumConfig>,
    view: ViewDirection,
    camera: Camera,
    lights: Lighting,
    picture: Picture,
    run: Run,
}

/// The direction towards the camera, degrees.
#[derive(Deserialize)]
struct ViewDirection {
    theta: f64,
    phi: f64,
}

/// The cameras.
#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum CameraKind {
    Pinhole,
    Orthographic,
}

/// The camera.
#[derive(Deserialize)]
struct Camera {
    projection: CameraKind,
    fov: f64,
    look_at: Option<[f64; 2]>,
    width: Option<f64>,
}

/// What shines.
#[derive(Deserialize)]
struct Lighting {
    sky: f64,
    horizon: f64,
    sun: f64,
    sun_theta: f64,
    sun_phi: f64,
    sun_radius: f64,
    patch: Option<[f64; 4]>,
    below: f64,
}

/// The picture itself.
#[derive(Deserialize)]
struct Picture {
    size: [usize; 2],
    samples: u64,
    exposure: Option<f64>,
    output: OneOrMany<PathBuf>,
}

/// The effort.
#[derive(Deserialize)]
struct Run {
    seed: u64,
    max_time: Option<Seconds>,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let settings: Settings = document.read().map_err(Failure::usage)?;
    if settings.camera.projection == CameraKind::Orthographic && document.is_given("camera.fov") {
        return Err(Failure::usage(
            "--fov is only for --camera pinhole; for others --width sets what the picture shows",
        ));
    }
    let lights = settings.lights.lights()?;
    settings.check_bottom()?;
    let picture = &settings.picture;
    for path in picture.output.as_slice() {
        PictureFormat::from_path(path).map_err(Failure::usage)?;
    }
    settings.check_outputs(document)?;
    let surface = required_surfaces(&settings.measured, document, common)?.first;
    let settings: Settings = settings_for(document, surface.unit)?;
    let picture = &settings.picture;
    let render_settings = settings.render_settings(settings.view(surface.extent())?, lights)?;
    let shape = settings.shape(&surface, common)?;

    let progress = Progress::begin_run(common);
    let progress = Deadline::new(&progress, settings.run.max_time.and_then(Seconds::duration));
    let outcome = settings.rendered(&shape, &render_settings, &progress, surface.unit)?;
    let factor = picture
        .exposure
        .unwrap_or_else(|| exposure(&outcome.picture));
    for path in picture.output.as_slice() {
        write_picture(path, &outcome.picture, factor, COMMENT).map_err(Failure::failed)?;
    }
    let ended = EndedRun {
        stopped_by: outcome.stopped_by,
        so_far: &format!(
            "the picture of {} per pixel is written",
            counted(outcome.samples, "camera ray")
        ),
        again: Again::Restarts,
    };
    let end = ended.close(None)?;
    if common.quiet {
        return Ok(end);
    }
    let mut text = report(&surface.name, &outcome, factor);
    text.push_str(&note_lines(surface.notes.iter().chain(&settings.notes())));
    for path in picture.output.as_slice() {
        text.push_str(&format!("picture in {}\n", path.display()));
    }
    print(&wrapped(&text))?;
    Ok(end)
}

impl Settings {
    /// Checks that the pictures can be written.
    fn check_outputs(&self, document: &Document) -> Result<(), Failure> {
        let outputs = self.picture.output.as_slice();
        let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
        let bottom = self.medium.as_ref().and_then(|m| m.bottom_surface.file());
        let surface = self.measured.files().next();
        check_outputs(&outputs, &[surface, bottom, document.file()])
    }

    fn check_bottom(&self) -> Result<(), Failure> {
        match self.bottom_surface() {
            BottomSurface::Independent => Err(Failure::usage(
                "--bottom-surface independent: a single surface is rendered and none is drawn; take flat, same or a file",
            )),
            _ => Ok(()),
        }
    }

    fn bottom_surface(&self) -> BottomSurface {
        let medium = self.medium.as_ref();
        medium.map_or(BottomSurface::Flat, |medium| medium.bottom_surface.named())
    }

    /// The view of a tile of that extent.
    fn view(&self, extent: [f64; 2]) -> Result<View, Failure> {
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
        let towards =
            Incidence::from_degrees(self.view.theta, self.view.phi).map_err(Failure::usage)?;
        let width = camera.width.unwrap_or(extent[0]);
        View::new(projection, towards, target, width).map_err(Failure::usage)
    }

    /// The bottom of the layer, if it is given as a file.
    fn bottom(
        &self,
        surface: &GivenSurface,
        common: &Common,
    ) -> Result<Option<GivenShape>, Failure> {
        let medium = self.medium.as_ref();
        medium
            .and_then(|medium| medium.bottom_surface.file())
            .map(|path| Ok(read_like(surface, path, &self.measured, common)?.shape))
            .transpose()
    }

    fn render_settings(&self, view: View, lights: Lights) -> Result<RenderSettings, Failure> {
        let medium = self.medium.as_ref();
        Ok(RenderSettings {
            view,
            lights,
            size: self.picture.size,
            samples: self.picture.samples,
            seed: self.run.seed,
            paths: PathSettings::new(Branching::Pick, ROULETTE, PathSettings::DEFAULT_MAX_ORDER)
                .map_err(Failure::usage)?,
            accelerator: AcceleratorKind::Auto,
            bottom: self.bottom_surface(),
            most_scatterings: medium.map_or(0, |medium| medium.max_scatterings),
        })
    }

    /// The surface over the bottom of the layer, if that is given as a file.
    fn shape(&self, surface: &GivenSurface, common: &Common) -> Result<Shape, Failure> {
        let cells = self.surface.cells.of_given();
        let refuse = |error| refuse_simulation(surface.unit, error);
        let top = surface.shape.clone().simulated(cells).map_err(refuse)?;
        let Some(bottom) = self.bottom(surface, common)? else {
            return Ok(top);
        };
        let bottom = bottom.simulated(cells).map_err(refuse)?;
        let both = top.over(bottom);
        both.ok_or_else(|| Failure::usage(TraceError::OtherBottom))
    }

    /// Renders the surface of that shape.
    fn rendered(
        &self,
        shape: &Shape,
        settings: &RenderSettings,
        observer: &dyn Observer,
        unit: LengthUnit,
    ) -> Result<RenderOutcome, Failure> {
        let material = self.material.material().map_err(Failure::usage)?;
        let layer = self.medium.as_ref().map(|medium| medium.layer(material));
        let layer = layer.transpose().map_err(Failure::usage)?;
        render(shape, material, layer.as_ref(), settings, observer)
            .map_err(|error| refuse_render(unit, error))
    }

    /// What a reader of the picture should know about its light.
    fn notes(&self) -> Option<String> {
        let is_left_to_chance = self.surface.cells.of_given() == Cells::Smooth
            && self.medium.is_some()
            && self.lights.sun > 0.0;
        is_left_to_chance.then(|| SUN_BY_CHANCE.to_owned())
    }
}

/// The refusal of settings, or the failure to render by them; lengths are in `unit`.
fn refuse_render(unit: LengthUnit, error: RenderError) -> Failure {
    match error {
        RenderError::View(error) => Failure::usage(error.in_unit(unit.suffix())),
        RenderError::Layer(_) | RenderError::TooGrazing { .. } | RenderError::BadSize(..) => {
            Failure::usage(error)
        }
        _ => Failure::failed(error),
    }
}

impl Lighting {
    fn lights(&self) -> Result<Lights, Failure> {
        let patch = self
            .patch
            .map(|[x0, y0, x1, y1]| Patch::new([x0, y0], [x1, y1]))
            .transpose()
            .map_err(Failure::usage)?;
        let towards =
            Incidence::from_degrees(self.sun_theta, self.sun_phi).map_err(Failure::usage)?;
        let radius = self.sun_radius.to_radians();
        let sun = Sun::new(towards, self.sun, radius, patch).map_err(Failure::usage)?;
        let sun = (self.sun > 0.0).then_some(sun);
        let lights = Lights::new(self.sky, self.below, sun).map_err(Failure::usage)?;
        lights.with_horizon(self.horizon).map_err(Failure::usage)
    }
}

/// What was rendered, and what of its light is missing.
fn report(name: &str, outcome: &RenderOutcome, factor: f64) -> String {
    let picture = &outcome.picture;
    let [columns, rows] = picture.size;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let [build, follow] = outcome.seconds;
    let rays = outcome.samples as f64 * (columns * rows) as f64;
    let error = match outcome.passes {
        1 => "of unknown error, from a single pass".to_owned(),
        passes => format!(
            "standard error of a pixel {:.2e} on average, from {passes} passes",
            mean(&picture.error)
        ),
    };
    let mut text = format!(
        "{name}, {columns} x {rows} pixels of {}, {} rays in {:.1} s\nmean radiance {:.5}, {error}\nexposure {factor:.4}\n",
        counted(outcome.samples, "camera ray"),
        short(rays),
        build + follow,
        mean(&picture.radiance),
    );
    for (fraction, what) in [
        (outcome.truncated, "was truncated by a limit of the paths"),
        (outcome.left_patch, "left the open patch past its rim"),
        (outcome.lost, "failed numerically"),
    ] {
        if fraction > 0.0 {
            text.push_str(&format!(
                "note: a fraction of {fraction:.1e} of the light {what} and is missing from the picture\n"
            ));
        }
    }
    text
}
