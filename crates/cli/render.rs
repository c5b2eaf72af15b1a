//! `asperity render`: a picture of one surface.

use std::path::Path;
use std::time::Duration;

use asperity_io::{PictureFormat, SurfaceFormat, check_folder_of, write_picture};
use asperity_optics::Incidence;
use asperity_render::{
    Lights, Patch, Projection, RenderError, RenderOutcome, RenderSettings, Sun, View, exposure,
    render, render_mesh,
};
use asperity_simulate::{BottomSurface, Deadline};
use asperity_surface::HeightField;
use asperity_tracer::{AcceleratorKind, Branching, MeshSurface, PathSettings};

use crate::args::{CameraArgument, CameraArguments, Common, LightsArguments, Render};
use crate::failure::Failure;
use crate::input::{name_of, read_mesh_surface, read_surface};
use crate::interrupt;
use crate::output::{print, say};
use crate::progress::Bar;

/// What the values of an EXR are.
const COMMENT: &str = "Y: radiance, linear, in the unit in which the lights were given; error: its standard error; A: share of the pixel that shows the surface";

/// Flux below which roulette decides: pictures are noisy by other causes, and weak paths take long.
const ROULETTE: f64 = 0.2;

/// Vertical field of view of a pinhole camera, degrees, unless one is given.
const FIELD_OF_VIEW: f64 = 40.0;

pub(crate) fn run(command: &Render, common: &Common) -> Result<(), Failure> {
    let material = command.interface.material()?;
    let layer = command.medium.layer(material)?;
    let lights = command.lights.lights()?;
    let image = &command.image;
    for path in &image.output {
        PictureFormat::from_path(path).map_err(Failure::usage)?;
        check_folder_of(path).map_err(Failure::failed)?;
    }
    if image.exposure.is_some_and(|factor| factor <= 0.0) {
        return Err(Failure::usage("the exposure must be a factor above zero"));
    }
    let medium = command.medium.over(None)?;
    let bottom_surface = medium
        .as_ref()
        .map_or(BottomSurface::Flat, |medium| medium.bottom_surface);
    if bottom_surface == BottomSurface::Independent {
        return Err(Failure::usage(
            "--bottom-surface independent: one surface is seen here, and none is drawn; take flat, same or a file",
        ));
    }
    let (name, subject, notes) = match &command.file {
        Some(path) => Subject::read(path, command, common)?,
        None => Subject::flat()?,
    };
    let bottom = match command.medium.bottom_file() {
        Some(path) => Some(Subject::read(path, command, common)?.1),
        None => None,
    };
    let settings = RenderSettings {
        view: command.camera.view(subject.size())?,
        lights,
        size: image.size,
        samples: image.samples,
        seed: image.seed,
        paths: PathSettings::new(Branching::Pick, ROULETTE, PathSettings::DEFAULT_MAX_ORDER)
            .map_err(Failure::usage)?,
        accelerator: AcceleratorKind::Auto,
        bottom: bottom_surface,
        most_scatterings: match &medium {
            Some(medium) => medium.most_scatterings().map_err(Failure::usage)?,
            None => 0,
        },
    };

    let bar = Bar::new(common);
    interrupt::listen();
    let time = image.max_time.map(Duration::try_from_secs_f64);
    let bar = Deadline::new(&bar, time.and_then(Result::ok));
    let layer = layer.as_ref();
    let outcome = match (subject, bottom) {
        (Subject::Field(field), None) => render(field, None, material, layer, &settings, &bar),
        (Subject::Mesh(mesh), None) => render_mesh(mesh, None, material, layer, &settings, &bar),
        (Subject::Field(field), Some(Subject::Field(bottom))) => {
            render(field, Some(bottom), material, layer, &settings, &bar)
        }
        (Subject::Mesh(mesh), Some(Subject::Mesh(bottom))) => {
            render_mesh(mesh, Some(bottom), material, layer, &settings, &bar)
        }
        _ => {
            return Err(Failure::usage(
                "--bottom-surface: one of surface and bottom is a height map, the other a triangle mesh; both must be of one kind",
            ));
        }
    };
    let outcome = outcome.map_err(|error| match error {
        RenderError::View(_)
        | RenderError::Layer(_)
        | RenderError::TooGrazing { .. }
        | RenderError::BadSize(..) => Failure::usage(error),
        _ => Failure::failed(error),
    })?;
    let factor = image.exposure.unwrap_or_else(|| exposure(&outcome.picture));
    for path in &image.output {
        write_picture(path, &outcome.picture, factor, COMMENT).map_err(Failure::failed)?;
    }
    if interrupt::came() {
        say("interrupted; the picture of the passes that were complete is written");
    }
    if common.quiet {
        return Ok(());
    }
    print(&report(&name, &outcome, factor, &notes, command))
}

/// What a picture is of.
enum Subject {
    Field(HeightField),
    Mesh(MeshSurface),
}

impl Subject {
    /// One flat cell.
    fn flat() -> Result<(String, Self, Vec<String>), Failure> {
        let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]);
        let field = field.map_err(Failure::failed)?;
        Ok(("flat surface".to_owned(), Self::Field(field), Vec::new()))
    }

    /// What a file holds, its name, and what a reader should know about it.
    fn read(
        path: &Path,
        command: &Render,
        common: &Common,
    ) -> Result<(String, Self, Vec<String>), Failure> {
        let name = name_of(path);
        match SurfaceFormat::from_path(path).map_err(Failure::failed)? {
            SurfaceFormat::Mesh(_) => {
                let mesh = read_mesh_surface(path, &command.reading, common)?;
                Ok((name, Self::Mesh(mesh), Vec::new()))
            }
            SurfaceFormat::HeightMap(_) => {
                let input = read_surface(path, &command.reading, common)?;
                Ok((name, Self::Field(input.field), input.notes))
            }
        }
    }

    /// Lengths of the tile along x and y.
    fn size(&self) -> [f64; 2] {
        match self {
            Self::Field(field) => field.extent(),
            Self::Mesh(mesh) => {
                let [x, y, _] = mesh.size();
                [x, y]
            }
        }
    }
}

impl CameraArguments {
    /// The view that the flags ask for, of a tile of that size.
    fn view(&self, size: [f64; 2]) -> Result<View, Failure> {
        let projection = match (self.camera, self.fov) {
            (CameraArgument::Orthographic, Some(_)) => {
                return Err(Failure::usage(
                    "--fov is of --camera pinhole alone: say with --width how much is seen",
                ));
            }
            (CameraArgument::Orthographic, None) => Projection::Orthographic,
            (CameraArgument::Pinhole, fov) => Projection::Pinhole {
                field_of_view: fov.unwrap_or(FIELD_OF_VIEW).to_radians(),
            },
        };
        let towards = direction(
            "the camera",
            ["--view-theta", "--view-phi"],
            self.view_theta,
            self.view_phi,
        )?;
        let target = match *self.look_at {
            [] => size.map(|length| 0.5 * length),
            [x, y] => [x, y],
            _ => {
                return Err(Failure::usage(format!(
                    "--look-at got {} values; give X,Y",
                    self.look_at.len()
                )));
            }
        };
        let width = self.width.unwrap_or(size[0]);
        View::new(projection, towards, target, width).map_err(Failure::usage)
    }
}

impl LightsArguments {
    /// The lights that the flags ask for.
    fn lights(&self) -> Result<Lights, Failure> {
        let patch = match *self.patch {
            [] => None,
            [x0, y0, x1, y1] => Some(Patch::new([x0, y0], [x1, y1]).map_err(Failure::usage)?),
            _ => {
                return Err(Failure::usage(format!(
                    "--patch got {} values; give X0,Y0,X1,Y1",
                    self.patch.len()
                )));
            }
        };
        let towards = direction(
            "the sun",
            ["--sun-theta", "--sun-phi"],
            self.sun_theta,
            self.sun_phi,
        )?;
        let radius = self.sun_radius.to_radians();
        let sun = Sun::new(towards, self.sun, radius, patch).map_err(Failure::usage)?;
        let sun = (self.sun > 0.0).then_some(sun);
        Lights::new(self.sky, self.below, sun).map_err(Failure::usage)
    }
}

/// The direction towards `what`, which stands above the horizon.
fn direction(
    what: &str,
    [flag, azimuth]: [&str; 2],
    theta: f64,
    phi: f64,
) -> Result<Incidence, Failure> {
    if !(0.0..90.0).contains(&theta) {
        return Err(Failure::usage(format!(
            "{flag} is {theta:?}; {what} stands from 0 to below 90 deg from the normal"
        )));
    }
    Incidence::from_degrees(theta, phi)
        .map_err(|error| Failure::usage(format!("{flag}, {azimuth}: {error}")))
}

fn report(
    name: &str,
    outcome: &RenderOutcome,
    factor: f64,
    notes: &[String],
    command: &Render,
) -> String {
    let picture = &outcome.picture;
    let [columns, rows] = picture.size;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let [build, follow] = outcome.seconds;
    let lines = outcome.samples as f64 * (columns * rows) as f64;
    let mut text = format!(
        "{name}, {columns} x {rows} pixels of {} lines of sight, {lines:.3e} in {:.1} s\n  mean radiance {:.5}, standard error of a pixel {:.2e} on average, from {} passes; exposure {factor:.4}\n",
        outcome.samples,
        build + follow,
        mean(&picture.radiance),
        mean(&picture.error),
        outcome.passes,
    );
    for (share, what) in [
        (outcome.truncated, "ended by a limit"),
        (outcome.left_patch, "left the patch sideways"),
        (outcome.lost, "failed numerically"),
    ] {
        if share > 0.0 {
            text.push_str(&format!(
                "note: {share:.1e} of the light {what} and is dark\n"
            ));
        }
    }
    for note in notes {
        text.push_str(&format!("note: {note}\n"));
    }
    for path in &command.image.output {
        text.push_str(&format!("picture in {}\n", path.display()));
    }
    text
}
