//! `asperity trace`: light on one surface.

use std::path::{Path, PathBuf};
use std::time::Duration;

use asperity_io::SurfaceFormat;
use asperity_optics::Material;
use asperity_simulate::{
    BottomSurface, Deadline, RaySettings, RunError, Scene, Stopping, Target, layer_name, trace,
    trace_mesh,
};
use asperity_studies::{
    Azimuth, Light, Summary, Surroundings, check_light, check_sides, energy_table, errors_table,
    lost_warning, trace_files, trace_report, work_line,
};
use asperity_surface::{Border, HeightField, RefinementError, Roughness};
use asperity_tally::TallySpec;
use asperity_tracer::{BuildError, Geometry, HalfSpace, MeshSurface, PathSettings};
use serde_json::{Value, json};

use crate::args::{AzimuthArgument, Common, Trace};
use crate::failure::Failure;
use crate::input::{Input, incident, name_of, read_mesh_surface, read_surface};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;

pub(crate) fn run(command: &Trace, common: &Common) -> Result<(), Failure> {
    let material = command.interface.material()?;
    let incidence = command.light.incidence()?;
    let half_width = command.in_plane_half_width.to_radians();
    let medium = command.medium.over(None)?;
    let layer = command.medium.layer(material)?;
    let incident_side = HalfSpace::from(incident(command.from));
    if layer.is_some() {
        check_light(incident_side, command.estimator).map_err(Failure::usage)?;
    }
    check_sides(command.side, material, layer.as_ref()).map_err(Failure::usage)?;
    let spec = TallySpec::new(command.bins, half_width)
        .map_err(Failure::usage)?
        .with_sides(command.side);
    let spec = if layer.is_some() {
        spec.with_medium()
    } else {
        spec
    };
    let branching = command.branching.into();
    let settings = RaySettings {
        rays: command.rays,
        seed: command.seed,
        spec,
        paths: PathSettings::new(branching, command.roulette, command.max_order)
            .map_err(Failure::usage)?,
        accelerator: command.accelerator,
        estimator: command.estimator,
        sampling: command.sampling,
        refine: command.refine,
        target: Target::new(command.target_error, command.of).map_err(Failure::usage)?,
        bottom: medium
            .as_ref()
            .map_or(BottomSurface::Flat, |medium| medium.bottom_surface),
        most_scatterings: match &medium {
            Some(medium) => medium.most_scatterings().map_err(Failure::usage)?,
            None => 0,
        },
    };
    if settings.bottom == BottomSurface::Independent {
        return Err(Failure::usage(
            "--bottom-surface independent: one surface is traced here, and none is drawn; take flat, same or a file",
        ));
    }
    if let Some(target) = settings.target {
        target
            .check(&spec, material, layer.as_ref())
            .map_err(Failure::usage)?;
    }
    let subject = Subject::of(command, common)?;
    let bottom = match command.medium.bottom_file() {
        Some(path) => Some(Subject::read(path, command, common)?),
        None => None,
    };
    let scene = Scene {
        material,
        layer,
        incidence,
        incident: incident_side,
        any_azimuth: command.light_azimuth == AzimuthArgument::Random,
    };
    let below = medium.zip(layer).map(|(medium, layer)| {
        json!({
            "medium": medium,
            "layer": layer,
            "bottom": bottom.as_ref().map(|bottom| &bottom.description),
        })
    });
    let config = config(command, &scene, subject.description, below);
    let (name, mut warnings) = (subject.name, subject.warnings);
    let folder = match &command.output {
        Some(path) => {
            let inputs = [
                command.file.as_deref(),
                command.medium.bottom_file().map(PathBuf::as_path),
            ];
            let names = trace_files(&spec, !command.no_plots);
            Some(result_folder(path, "trace", &inputs, &names)?)
        }
        None => None,
    };

    let bar = Bar::new(common);
    interrupt::listen();
    let time = command.max_time.map(Duration::try_from_secs_f64);
    let bar = Deadline::new(&bar, time.and_then(Result::ok));
    let plots = command.output.is_some() && !command.no_plots;
    let outcome = match (subject.shape, bottom.map(|bottom| bottom.shape)) {
        (Shape::Field(field), None) => trace(field, None, &scene, &settings, &bar),
        (Shape::Mesh(mesh), None) => trace_mesh(mesh, None, &scene, &settings, &bar),
        (Shape::Field(field), Some(Shape::Field(bottom))) => {
            trace(field, Some(bottom), &scene, &settings, &bar)
        }
        (Shape::Mesh(mesh), Some(Shape::Mesh(bottom))) => {
            trace_mesh(mesh, Some(bottom), &scene, &settings, &bar)
        }
        _ => {
            return Err(Failure::usage(
                "--bottom-surface: one of surface and bottom is a height map, the other a triangle mesh; both must be of one kind",
            ));
        }
    };
    let outcome = outcome.map_err(|error| match error {
        RunError::Build(BuildError::NeedsHeightField { .. } | BuildError::NotFlat)
        | RunError::OpenControl
        | RunError::MeshControl
        | RunError::AzimuthControl
        | RunError::Layer(_)
        | RunError::Model(_) => Failure::usage(error),
        RunError::Refinement(RefinementError::Open) => Failure::usage(format!("--refine: {error}")),
        _ => Failure::failed(error),
    })?;
    let statistics = &outcome.statistics;
    warnings.extend(lost_warning(statistics));
    let stopping = outcome.stopping.as_ref();
    warnings.extend(stopping.iter().flat_map(|s| s.warnings.clone()));
    let summary = Summary::new(
        "trace",
        config,
        command.seed,
        "ray blocks",
        statistics,
        outcome.work.clone(),
    )
    .with_errors(outcome.errors.to_json())
    .with_warnings(warnings.clone())
    .with_stopping(outcome.stopping.clone());
    if let Some(folder) = folder {
        let light = Light {
            incidence,
            material,
            layer,
            from: incident(command.from),
            max_order: command.max_order,
            case: None,
        };
        let surroundings = plots.then(|| Surroundings {
            field: outcome.field.as_ref(),
            name: name.clone(),
            light: &light,
        });
        trace_report(&folder, &outcome, &spec, &summary, surroundings.as_ref())
            .map_err(Failure::failed)?;
        folder.finish().map_err(Failure::failed)?;
    }
    common.say(|| {
        let work = &outcome.work;
        format!(
            "built in {:.3} s, traced in {:.3} s",
            work.build_seconds, work.trace_seconds
        )
    });
    if interrupt::came() {
        say("interrupted; the results so far are written");
    }
    if command.json {
        return print_json(&summary);
    }
    let mut text = format!(
        "{name}, {}\nflux fractions; standard errors from {} ray blocks\n{}{}{}\n",
        light_line(&scene, command),
        statistics.batches(),
        energy_table(statistics),
        errors_table(&outcome.errors),
        work_line(&outcome.work),
    );
    if let Some(line) = outcome.stopping.as_ref().and_then(Stopping::line) {
        text.push_str(&format!("{line}\n"));
    }
    for warning in &warnings {
        text.push_str(&format!("note: {warning}\n"));
    }
    if let Some(folder) = &command.output {
        text.push_str(&format!("results in {}\n", folder.display()));
    }
    if common.quiet { Ok(()) } else { print(&text) }
}

/// What light falls on.
struct Subject {
    shape: Shape,
    name: String,
    /// What summary.json says of it.
    description: Value,
    /// What a reader of the results should know about it.
    warnings: Vec<String>,
}

enum Shape {
    Field(HeightField),
    Mesh(MeshSurface),
}

impl Subject {
    /// Reads what the command asks for.
    fn of(command: &Trace, common: &Common) -> Result<Self, Failure> {
        let Some(path) = &command.file else {
            let input = Input {
                field: flat()?,
                filled: 0,
                notes: Vec::new(),
            };
            let name = "flat surface".to_owned();
            return Ok(Self::of_field(command, None, input, name));
        };
        Self::read(path, command, common)
    }

    /// Reads a surface from a file.
    fn read(path: &Path, command: &Trace, common: &Common) -> Result<Self, Failure> {
        match SurfaceFormat::from_path(path).map_err(Failure::failed)? {
            SurfaceFormat::Mesh(_) if command.refine => Err(Failure::usage(format!(
                "--refine: {} is a triangle mesh, which says nothing of the surface between its corners; only height maps can be refined",
                path.display()
            ))),
            SurfaceFormat::Mesh(_) => {
                let mesh = read_mesh_surface(path, &command.reading, common)?;
                Ok(Self::of_mesh(mesh, path))
            }
            SurfaceFormat::HeightMap(_) => {
                let input = read_surface(path, &command.reading, common)?;
                Ok(Self::of_field(command, Some(path), input, name_of(path)))
            }
        }
    }

    fn of_field(command: &Trace, path: Option<&Path>, input: Input, name: String) -> Self {
        let field = input.field;
        Self {
            name,
            description: json!({
                "file": path,
                "shape": field.shape(),
                "spacing": field.spacing(),
                "unit": field.unit(),
                "border": field.border(),
                "points_filled": input.filled,
                "form_removed": command.reading.remove.to_string(),
                "generated": field.provenance(),
            }),
            warnings: field_warnings(&field, input.notes),
            shape: Shape::Field(field),
        }
    }

    fn of_mesh(mesh: MeshSurface, path: &Path) -> Self {
        let repairs = mesh.repairs();
        Self {
            name: name_of(path),
            description: json!({
                "file": path,
                "vertices": mesh.vertex_count(),
                "triangles": mesh.facet_count(),
                "extent": mesh.size(),
                "border": mesh.border(),
                "triangles_dropped": repairs.dropped,
                "turned_over": repairs.turned_over,
            }),
            warnings: mesh_warnings(&mesh),
            shape: Shape::Mesh(mesh),
        }
    }
}

/// One flat periodic cell.
pub(crate) fn flat() -> Result<HeightField, Failure> {
    HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).map_err(Failure::failed)
}

fn light_line(scene: &Scene, command: &Trace) -> String {
    let incidence = scene.incidence;
    let material = match scene.material {
        Material::Dielectric { eta } => format!("eta {eta}"),
        Material::Conductor { eta, kappa } => format!("conductor {eta} + {kappa} i"),
        _ => "mirror".to_owned(),
    };
    let side = match command.from {
        crate::args::FromArgument::Above => "above",
        crate::args::FromArgument::Below => "below",
    };
    let below = scene.layer.map_or(String::new(), |layer| {
        format!(" over a medium ({})", layer_name(&layer))
    });
    format!(
        "{material}{below}, light from {side} at theta {} deg, phi {} deg",
        incidence.theta_deg(),
        command.light.phi
    )
}

fn config(command: &Trace, scene: &Scene, surface: Value, below: Option<Value>) -> Value {
    let incidence = scene.incidence;
    let mut config = json!({
        "surface": surface,
        "material": scene.material,
        "light": {
            "theta_deg": incidence.theta_deg(),
            "phi_deg": incidence.phi_deg(),
            "azimuth": Azimuth::from(command.light_azimuth),
            "from": incident(command.from),
        },
        "rays": command.target_error.is_none().then_some(command.rays),
        "target_error": command.target_error,
        "of": command.of,
        "max_time": command.max_time,
        "bins": command.bins,
        "in_plane_half_width_deg": command.in_plane_half_width,
        "side": command.side,
        "branching": asperity_tracer::Branching::from(command.branching),
        "roulette": command.roulette,
        "max_order": command.max_order,
        "accelerator": command.accelerator,
        "estimator": command.estimator,
        "sampling": command.sampling,
        "refine": command.refine,
    });
    if let Some(below) = below {
        config["below"] = below;
    }
    config
}

/// Slope above which a facet is pointed out.
const STEEP: f64 = 50.0;

/// What a reader of the results should know about the surface.
pub(crate) fn field_warnings(field: &HeightField, mut warnings: Vec<String>) -> Vec<String> {
    let steepest = Roughness::of(field).steepest;
    if steepest.slope > STEEP {
        warnings.push(format!(
            "the steepest facet stands at {:.2} deg: are heights and spacing in the same unit?",
            steepest.angle_degrees
        ));
    }
    warnings.extend(border_warning(field.border()));
    warnings.push(ONE_SURFACE.to_owned());
    warnings
}

/// What a reader of the results should know about the mesh.
pub(crate) fn mesh_warnings(mesh: &MeshSurface) -> Vec<String> {
    let repairs = mesh.repairs();
    let mut warnings = Vec::new();
    if repairs.turned_over {
        warnings.push(
            "the mesh faced away from +z (or inwards, being closed) and was turned over".to_owned(),
        );
    }
    if repairs.dropped > 0 {
        warnings.push(format!(
            "{} triangles without area were left out",
            repairs.dropped
        ));
    }
    // Under other borders than an open one such meshes are refused.
    if repairs.closed {
        warnings.push(
            "the mesh is closed: light that goes on beneath it meets nothing and is booked as truncated"
                .to_owned(),
        );
    }
    if repairs.open_edges > 0 {
        warnings.push(format!(
            "{} edges inside the tile have one triangle only: light that passes by them is booked as truncated",
            repairs.open_edges
        ));
    }
    warnings.extend(border_warning(mesh.border()));
    warnings.push(ONE_SURFACE.to_owned());
    warnings
}

const ONE_SURFACE: &str =
    "one surface: errors hold for this surface, not for the ensemble it may come from";

fn border_warning(border: Border) -> Option<String> {
    (border == Border::Open).then(|| {
        "the patch is open: light that leaves it sideways is booked as truncated, and grazing light finds it too bright"
            .to_owned()
    })
}
