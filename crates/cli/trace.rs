//! `asperity trace`: light on one surface.

use asperity_experiment::{
    Light, RaySettings, Summary, Surroundings, check_sides, energy_table, lost_warning, trace,
    trace_report, work_line,
};
use asperity_io::create_output_folder;
use asperity_optics::{Incidence, Material};
use asperity_surface::{HeightField, Roughness};
use asperity_tally::Layout;
use asperity_tracer::{Medium, PathSettings};
use serde_json::{Value, json};

use crate::args::{Common, Trace};
use crate::failure::Failure;
use crate::input::{incident, name_of, read_surface};
use crate::output::{print, print_json};
use crate::progress::Bar;

pub(crate) fn run(command: &Trace, common: &Common) -> Result<(), Failure> {
    let material = command.interface.material()?;
    let incidence = command.light.incidence()?;
    let half_width = command.in_plane_half_width.to_radians();
    check_sides(command.side, material).map_err(Failure::usage)?;
    let layout = Layout::new(command.bins, half_width)
        .map_err(Failure::usage)?
        .with_sides(command.side);
    let branching = command.branching.into();
    let settings = RaySettings {
        rays: command.rays,
        seed: command.seed,
        layout,
        paths: PathSettings::new(branching, command.roulette, command.max_order)
            .map_err(Failure::usage)?,
        accelerator: command.accelerator,
    };
    let (field, name, filled, notes) = match &command.file {
        Some(path) => {
            let input = read_surface(path, &command.reading, common)?;
            (input.field, name_of(path), input.filled, input.notes)
        }
        None => (flat()?, "flat surface".to_owned(), 0, Vec::new()),
    };
    let config = config(command, material, incidence, &field, filled);
    let mut warnings = warnings(&field, notes);
    if let Some(folder) = &command.output {
        create_output_folder(folder).map_err(Failure::failed)?;
    }

    let bar = Bar::new(common);
    let medium = Medium::from(incident(command.from));
    let drawn = (command.output.is_some() && !command.no_plots).then(|| field.clone());
    let outcome =
        trace(field, material, incidence, medium, &settings, &bar).map_err(Failure::failed)?;
    let statistics = &outcome.statistics;
    warnings.extend(lost_warning(statistics));
    let summary = Summary::new(
        "trace",
        config,
        command.seed,
        "ray blocks",
        (&layout, statistics),
        outcome.work.clone(),
    )
    .with_warnings(warnings.clone());
    if let Some(folder) = &command.output {
        let light = Light {
            incidence,
            material,
            from: incident(command.from),
            case: None,
        };
        let surroundings = drawn.as_ref().map(|field| Surroundings {
            field,
            name: name.clone(),
            light: &light,
        });
        trace_report(folder, &outcome, &layout, &summary, surroundings.as_ref())
            .map_err(Failure::failed)?;
    }
    common.say(|| {
        let work = &outcome.work;
        format!(
            "built in {:.3} s, traced in {:.3} s",
            work.build_seconds, work.trace_seconds
        )
    });
    if command.json {
        return print_json(&summary);
    }
    let mut text = format!(
        "{name}, {}\nflux fractions; standard errors from {} ray blocks\n{}{}\n",
        light_line(material, incidence, command),
        statistics.batches(),
        energy_table(&layout, statistics),
        work_line(&outcome.work),
    );
    for warning in &warnings {
        text.push_str(&format!("note: {warning}\n"));
    }
    if let Some(folder) = &command.output {
        text.push_str(&format!("results in {}\n", folder.display()));
    }
    if common.quiet { Ok(()) } else { print(&text) }
}

/// One flat periodic cell.
fn flat() -> Result<HeightField, Failure> {
    HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).map_err(Failure::failed)
}

fn light_line(material: Material, incidence: Incidence, command: &Trace) -> String {
    let material = match material {
        Material::Dielectric { eta } => format!("eta {eta}"),
        Material::Conductor { eta, kappa } => format!("conductor {eta} + {kappa} i"),
        _ => "mirror".to_owned(),
    };
    let side = match command.from {
        crate::args::FromArgument::Above => "above",
        crate::args::FromArgument::Below => "below",
    };
    format!(
        "{material}, light from {side} at theta {} deg, phi {} deg",
        incidence.theta_deg(),
        incidence.phi_deg()
    )
}

fn config(
    command: &Trace,
    material: Material,
    incidence: Incidence,
    field: &HeightField,
    filled: usize,
) -> Value {
    json!({
        "surface": {
            "file": command.file,
            "shape": field.shape(),
            "spacing": field.spacing(),
            "unit": field.unit(),
            "border": field.border(),
            "points_filled": filled,
            "form_removed": command.reading.remove.to_string(),
            "generated": field.provenance(),
        },
        "material": material,
        "light": {
            "theta_deg": incidence.theta_deg(),
            "phi_deg": incidence.phi_deg(),
            "from": incident(command.from),
        },
        "rays": command.rays,
        "bins": command.bins,
        "in_plane_half_width_deg": command.in_plane_half_width,
        "side": command.side,
        "branching": asperity_tracer::Branching::from(command.branching),
        "roulette": command.roulette,
        "max_order": command.max_order,
        "accelerator": command.accelerator,
    })
}

/// Slope above which a facet is pointed out.
const STEEP: f64 = 50.0;

/// What a reader of the results should know about the surface.
fn warnings(field: &HeightField, mut warnings: Vec<String>) -> Vec<String> {
    let steepest = Roughness::of(field).steepest;
    if steepest.slope > STEEP {
        warnings.push(format!(
            "the steepest facet stands at {:.2} deg: are heights and spacing in the same unit?",
            steepest.angle_degrees
        ));
    }
    if field.border() == asperity_surface::Border::Open {
        warnings.push(
            "the patch is open: light that leaves it sideways is booked as truncated, and grazing light finds it too bright"
                .to_owned(),
        );
    }
    warnings.push(
        "one surface: errors hold for this surface, not for the ensemble it may come from"
            .to_owned(),
    );
    warnings
}
