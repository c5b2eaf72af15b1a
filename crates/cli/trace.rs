//! `asperity trace`: light on one given surface.

use std::path::Path;

use asperity_io::ResultFolder;
use asperity_optics::Material;
use asperity_simulate::{
    Case, Deadline, Outcome, Settings, Shape, SimulateError, Simulation, Stopping, layer_name,
};
use asperity_studies::settings::Document;
use asperity_studies::{
    Azimuth, Incident, PlottedCase, Summary, Surroundings, TraceConfig, energy_table, errors_table,
    lost_warning, trace_files, trace_report, work_line,
};
use asperity_tracer::Geometry;
use serde_json::{Value, json};

use crate::common::{Common, Results};
use crate::failure::Failure;
use crate::given::{GivenShape, GivenSurface};
use crate::input::{refuse_config, refuse_simulation};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::{Bar, duration};

pub(crate) fn run(document: &Document, common: &Common) -> Result<(), Failure> {
    let config: TraceConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let refuse = |error| refuse_config(document, &error);
    config.check().map_err(refuse)?;
    let settings = config.ray_settings().map_err(refuse)?;
    let surface = GivenSurface::required(&config.measured, document.command(), common)?;
    check_refinement(&config, &surface)?;
    let bottom = match config.medium.as_ref().and_then(|m| m.bottom_surface.file()) {
        Some(path) => Some(GivenSurface::read(path, &config.measured, common)?),
        None => None,
    };
    let files = [
        document.file().map(Path::to_owned),
        surface.file.clone(),
        bottom.as_ref().and_then(|bottom| bottom.file.clone()),
    ];
    let mut warnings = surface.warnings();
    let name = surface.name.clone();
    let about = About {
        surface: surface_json(&surface, &config),
        bottom: bottom.as_ref().map(|bottom| surface_json(bottom, &config)),
    };
    let shape = shape(surface, bottom)?;
    let case = config.case(shape.clone()).map_err(refuse)?;
    let described = described(&config, &case, about);
    // Everything is checked before a ray is traced; the folder is made when there are results.
    let simulation = Simulation::new(&[case], &settings).map_err(refuse_simulation)?;
    let folder = match &results.output {
        Some(path) => {
            let inputs = files.each_ref().map(Option::as_deref);
            let names = trace_files(&settings.tally, config.output.plots);
            Some(result_folder(path, "trace", &inputs, &names)?)
        }
        None => None,
    };
    let checkpoints = folder
        .as_ref()
        .map(|folder| config.checkpoints(folder, &shape));
    let checkpoints = checkpoints.transpose().map_err(Failure::failed)?;
    if checkpoints.as_ref().is_some_and(|kept| kept.resumed() > 0) {
        say("resumed with the rays of the run that was ended");
    }
    let bar = Bar::new(common);
    interrupt::listen();
    let bar = Deadline::new(&bar, duration(config.run.max_time));
    let outcomes = match &checkpoints {
        Some(checkpoints) => simulation.resume(checkpoints, &bar),
        None => simulation.run(&bar),
    };
    let outcomes = outcomes.map_err(refuse_simulation)?;
    let outcome = outcomes.into_iter().next();
    let outcome = outcome.ok_or_else(|| Failure::failed(SimulateError::Interrupted))?;
    warnings.extend(lost_warning(&outcome.statistics));
    // How the run ended is told where that was to be found out.
    let has_target = settings.target().is_some();
    let stopping = Some(&outcome.stopping).filter(|s| has_target || s.is_cut_short());
    warnings.extend(stopping.iter().flat_map(|s| s.warnings.clone()));
    let summary = Summary::new(
        "trace",
        described,
        config.run.seed,
        "ray blocks",
        &outcome.statistics,
        outcome.work.clone(),
    )
    .with_errors(outcome.errors.to_json())
    .with_warnings(warnings.clone())
    .with_stopping(stopping.cloned());
    if let Some(folder) = &folder {
        write(&config, folder, &name, &settings, (&outcome, &summary))?;
    }
    let is_stopped = outcome.stopping.is_cut_short();
    if let Some(checkpoints) = checkpoints {
        checkpoints.close(is_stopped).map_err(Failure::failed)?;
    }
    if let Some(folder) = folder {
        folder.finish(!is_stopped).map_err(Failure::failed)?;
    }
    common.say(|| {
        let work = &outcome.work;
        format!(
            "built in {:.3} s, traced in {:.3} s",
            work.build_seconds, work.trace_seconds
        )
    });
    if interrupt::came() {
        say(match &results.output {
            Some(_) => "interrupted; the results so far are written, and the same command resumes",
            None => "interrupted; these are the results so far",
        });
    }
    if results.json {
        return print_json(&summary);
    }
    if common.quiet {
        return Ok(());
    }
    let mut text = format!("{name}, {}\n", light_line(&outcome.case, &config));
    text.push_str(&table(&outcome, stopping, &warnings));
    if let Some(folder) = &results.output {
        text.push_str(&format!("results in {}\n", folder.display()));
    }
    print(&text)
}

/// Refuses to refine a mesh, which has no surface between its corners.
fn check_refinement(config: &TraceConfig, surface: &GivenSurface) -> Result<(), Failure> {
    match (&surface.shape, &surface.file) {
        (GivenShape::Mesh(_), Some(path)) if config.run.refine => Err(Failure::usage(format!(
            "--refine: {} is a triangle mesh, which says nothing of the surface between its corners; only height maps can be refined",
            path.display()
        ))),
        _ => Ok(()),
    }
}

/// A surface over the one below it, if there is one.
fn shape(surface: GivenSurface, bottom: Option<GivenSurface>) -> Result<Shape, Failure> {
    let top = surface.shape.simulated();
    let Some(bottom) = bottom else {
        return Ok(top);
    };
    top.over(bottom.shape.simulated()).ok_or_else(|| {
        Failure::usage(
            "--bottom-surface: one of surface and bottom is a height map, the other a triangle mesh; both must be of one kind",
        )
    })
}

/// Writes the results into a folder.
fn write(
    config: &TraceConfig,
    folder: &ResultFolder,
    name: &str,
    settings: &Settings,
    (outcome, summary): (&Outcome, &Summary),
) -> Result<(), Failure> {
    let case = &outcome.case;
    let light = PlottedCase {
        incidence: case.light.incidence,
        material: case.material,
        layer: case.layer.map(|below| below.layer),
        from: config.light.from,
        max_order: config.run.max_order,
        case: None,
    };
    let surroundings = config.output.plots.then(|| Surroundings {
        field: case.surface.field(),
        name: name.to_owned(),
        light: &light,
    });
    trace_report(
        folder,
        outcome,
        &settings.tally,
        summary,
        surroundings.as_ref(),
    )
    .map_err(Failure::failed)
}

/// Energies, errors and notes as text.
fn table(outcome: &Outcome, stopping: Option<&Stopping>, warnings: &[String]) -> String {
    let mut text = format!(
        "flux fractions; standard errors from {} ray blocks\n{}{}{}\n",
        outcome.statistics.batches(),
        energy_table(&outcome.statistics),
        errors_table(&outcome.errors),
        work_line(&outcome.work),
    );
    if let Some(line) = stopping.and_then(Stopping::line) {
        text.push_str(&format!("{line}\n"));
    }
    for warning in warnings {
        text.push_str(&format!("note: {warning}\n"));
    }
    text
}

fn light_line(case: &Case, config: &TraceConfig) -> String {
    let incidence = case.light.incidence;
    let material = match case.material {
        Material::Dielectric { eta } => format!("eta {eta}"),
        Material::Conductor { eta, kappa } => format!("conductor {eta} + {kappa} i"),
        _ => "mirror".to_owned(),
    };
    let side = match config.light.from {
        Incident::Above => "above",
        Incident::Below => "below",
    };
    let below = case.layer.map_or(String::new(), |below| {
        format!(" over a medium ({})", layer_name(&below.layer))
    });
    let phi = config.light.phi.one("phi").map_or(0.0, |phi| phi.0);
    format!(
        "{material}{below}, light from {side} at theta {} deg, phi {phi} deg",
        incidence.theta_deg()
    )
}

/// The surfaces as `summary.json` holds them.
struct About {
    surface: Value,
    bottom: Option<Value>,
}

/// The configuration as `summary.json` holds it.
fn described(config: &TraceConfig, case: &Case, about: About) -> Value {
    let (run, incidence) = (&config.run, case.light.incidence);
    let mut described = json!({
        "surface": about.surface,
        "material": case.material,
        "light": {
            "theta_deg": incidence.theta_deg(),
            "phi_deg": incidence.phi_deg(),
            "azimuth": config.light.azimuth.unwrap_or(Azimuth::Fixed),
            "from": config.light.from,
        },
        "rays": run.target_error.is_none().then_some(run.rays),
        "target_error": run.target_error,
        "of": run.of,
        "max_time": run.max_time,
        "bins": run.bins,
        "in_plane_half_width_deg": run.in_plane_half_width,
        "side": run.side,
        "branching": run.branching,
        "roulette": run.roulette,
        "max_order": run.max_order,
        "accelerator": run.accelerator,
        "estimator": run.estimator,
        "sampling": run.sampling,
        "refine": run.refine,
    });
    if let (Some(medium), Some(layer)) = (&config.medium, case.layer) {
        described["below"] = json!({
            "medium": medium,
            "layer": layer.layer,
            "bottom": about.bottom,
        });
    }
    described
}

/// A surface as `summary.json` holds it.
fn surface_json(surface: &GivenSurface, config: &TraceConfig) -> Value {
    match &surface.shape {
        GivenShape::Field(field) => json!({
            "file": surface.file,
            "shape": field.shape(),
            "spacing": field.spacing(),
            "unit": field.unit(),
            "border": field.border(),
            "points_filled": surface.filled,
            "form_removed": config.measured.remove.to_string(),
            "generated": field.provenance(),
        }),
        GivenShape::Mesh(mesh) => {
            let repairs = mesh.repairs();
            json!({
                "file": surface.file,
                "vertices": mesh.vertex_count(),
                "triangles": mesh.facet_count(),
                "extent": mesh.size(),
                "border": mesh.border(),
                "triangles_dropped": repairs.dropped,
                "turned_over": repairs.turned_over,
            })
        }
    }
}
