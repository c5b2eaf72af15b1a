//! `asperity render`: a picture of one surface.

use std::path::PathBuf;

use asperity_io::{PictureFormat, check_folder_of, write_picture};
use asperity_optics::Incidence;
use asperity_render::{
    Lights, Patch, Projection, RenderError, RenderOutcome, RenderSettings, Sun, View, exposure,
    render, render_mesh,
};
use asperity_simulate::{BottomSurface, Deadline};
use asperity_studies::settings::Document;
use asperity_studies::{MaterialConfig, MeasuredConfig, MediumConfig, Seconds};
use asperity_tracer::{AcceleratorKind, Branching, PathSettings};
use serde::Deserialize;

use crate::common::Common;
use crate::failure::Failure;
use crate::given::{GivenShape, GivenSurface};
use crate::interrupt;
use crate::output::{print, say};
use crate::progress::{Bar, duration};

/// What the values of an EXR are.
const COMMENT: &str = "Y: radiance, linear, in the unit in which the lights were given; error: its standard error; A: fraction of the pixel that shows the surface";

/// Throughput below which roulette decides: pictures are noisy by other causes, and weak paths take long.
const ROULETTE: f64 = 0.2;

/// What is rendered, and how.
#[derive(Deserialize)]
struct Settings {
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
    output: Vec<PathBuf>,
}

/// The effort.
#[derive(Deserialize)]
struct Run {
    seed: u64,
    max_time: Option<Seconds>,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<(), Failure> {
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
    for path in &picture.output {
        PictureFormat::from_path(path).map_err(Failure::usage)?;
        check_folder_of(path).map_err(Failure::failed)?;
    }
    let surface = GivenSurface::required(&settings.measured, document.command(), common)?;
    let view = settings.view(surface.extent())?;
    let (name, notes) = (surface.name.clone(), surface.notes.clone());

    let bar = Bar::new(common);
    interrupt::listen();
    let bar = Deadline::new(&bar, duration(settings.run.max_time));
    let outcome = settings.rendered(surface, (view, lights), (common, &bar))?;
    let factor = picture
        .exposure
        .unwrap_or_else(|| exposure(&outcome.picture));
    for path in &picture.output {
        write_picture(path, &outcome.picture, factor, COMMENT).map_err(Failure::failed)?;
    }
    if interrupt::came() {
        say("interrupted; the picture of the passes that were complete is written");
    }
    if common.quiet {
        return Ok(());
    }
    print(&report(&name, &outcome, factor, &notes, &picture.output))
}

impl Settings {
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

    /// Renders `surface`.
    fn rendered(
        &self,
        surface: GivenSurface,
        (view, lights): (View, Lights),
        (common, bar): (&Common, &Deadline<'_>),
    ) -> Result<RenderOutcome, Failure> {
        let material = self.material.material().map_err(Failure::usage)?;
        let medium = self.medium.as_ref();
        let layer = medium
            .map(|medium| medium.layer(material))
            .transpose()
            .map_err(Failure::usage)?;
        let bottom = match medium.and_then(|medium| medium.bottom_surface.file()) {
            Some(path) => Some(GivenSurface::read(path, &self.measured, common)?.shape),
            None => None,
        };
        let settings = RenderSettings {
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
        };
        let layer = layer.as_ref();
        let outcome = match (surface.shape, bottom) {
            (GivenShape::Field(field), None) => {
                render(field, None, material, layer, &settings, bar)
            }
            (GivenShape::Mesh(mesh), None) => {
                render_mesh(mesh, None, material, layer, &settings, bar)
            }
            (GivenShape::Field(field), Some(GivenShape::Field(bottom))) => {
                render(field, Some(bottom), material, layer, &settings, bar)
            }
            (GivenShape::Mesh(mesh), Some(GivenShape::Mesh(bottom))) => {
                render_mesh(mesh, Some(bottom), material, layer, &settings, bar)
            }
            _ => {
                return Err(Failure::usage(
                    "--bottom-surface: one of surface and bottom is a height map, the other a triangle mesh; both must be of one kind",
                ));
            }
        };
        outcome.map_err(|error| match error {
            RenderError::View(_)
            | RenderError::Layer(_)
            | RenderError::TooGrazing { .. }
            | RenderError::BadSize(..) => Failure::usage(error),
            _ => Failure::failed(error),
        })
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
        Lights::new(self.sky, self.below, sun).map_err(Failure::usage)
    }
}

fn report(
    name: &str,
    outcome: &RenderOutcome,
    factor: f64,
    notes: &[String],
    output: &[PathBuf],
) -> String {
    let picture = &outcome.picture;
    let [columns, rows] = picture.size;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let [build, follow] = outcome.seconds;
    let lines = outcome.samples as f64 * (columns * rows) as f64;
    let mut text = format!(
        "{name}, {columns} x {rows} pixels of {} camera rays, {lines:.3e} in {:.1} s\n  mean radiance {:.5}, standard error of a pixel {:.2e} on average, from {} passes; exposure {factor:.4}\n",
        outcome.samples,
        build + follow,
        mean(&picture.radiance),
        mean(&picture.error),
        outcome.passes,
    );
    for (fraction, what) in [
        (outcome.truncated, "ended by a limit"),
        (outcome.left_patch, "left the patch sideways"),
        (outcome.lost, "failed numerically"),
    ] {
        if fraction > 0.0 {
            text.push_str(&format!(
                "note: {fraction:.1e} of the light {what} and is dark\n"
            ));
        }
    }
    for note in notes {
        text.push_str(&format!("note: {note}\n"));
    }
    for path in output {
        text.push_str(&format!("picture in {}\n", path.display()));
    }
    text
}
