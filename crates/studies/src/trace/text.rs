//! The report of a traced surface as text.

use std::fmt::Write;

use asperity_optics::Material;
use asperity_simulate::layer_name;

use super::TraceOutcome;
use super::comparison_text::comparison_text;
use crate::config::Incident;
use crate::output::wrapped;
use crate::report::energies::{energy_table, errors_table, work_line};
use crate::report::flux_support::FluxSupport;
use crate::report::polarised::polarised_text;

/// Surface and light, then energies, errors and notes.
#[must_use]
pub fn trace_table(outcome: &TraceOutcome) -> String {
    let found = &outcome.outcome;
    let mut text = format!(
        "{}, {}\nflux fractions; standard errors from {} ray blocks\n{}{}{}{}\n",
        outcome.name,
        light_line(outcome),
        found.statistics.batches(),
        energy_table(&found.statistics, &FluxSupport::of(found)),
        polarised_text(&found.statistics),
        errors_table(&found.errors),
        work_line(&found.work),
    );
    if let Some(comparison) = &outcome.comparison {
        text.push_str(&comparison_text(outcome, comparison));
    }
    if let Some(line) = outcome
        .stopping()
        .and_then(|stopping| stopping.line(outcome.unit))
    {
        let _ = writeln!(text, "{line}");
    }
    if let Some(validity) = &outcome.validity {
        let _ = writeln!(text, "{}", wrapped(&format!("note: {validity}")));
    }
    for warning in &outcome.warnings {
        let _ = writeln!(text, "note: {warning}");
    }
    wrapped(&text)
}

/// Material, layer and light.
fn light_line(outcome: &TraceOutcome) -> String {
    let case = &outcome.outcome.case;
    let material = match case.material {
        Material::Dielectric { eta } => format!("eta {eta}"),
        Material::Conductor { eta, kappa } => format!("conductor {eta} + {kappa} i"),
        Material::Lambertian { reflectance } => format!("Lambertian, reflectance {reflectance}"),
        _ => "mirror".to_owned(),
    };
    let side = match outcome.config.light.from {
        Incident::Above => "above",
        Incident::Below => "below",
    };
    let below = case.layer.map_or(String::new(), |below| {
        format!(
            " over a medium ({})",
            layer_name(&below.layer, outcome.unit)
        )
    });
    let phi = outcome.config.light.phi.one("phi").map_or(0.0, |phi| phi.0);
    format!(
        "{material}{below}, light from {side} at theta {} deg, phi {phi} deg",
        case.light.incidence.theta_deg()
    )
}
