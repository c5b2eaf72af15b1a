//! The energies of one run and their errors as text, with what a reader should know of them.

use std::fmt::Write;

use asperity_simulate::{ControlVariateMean, ErrorBudget, SummaryWork, counted, short};
use asperity_tally::{
    Component, Entry, MAX_LISTED_ORDER, Side, TallyResult, TallySpec, TallyStatistics,
    is_of_few_rays,
};
use asperity_tracer::PathSettings;

use crate::config::RunConfig;
use crate::output::{Column, Table, aligned, listed, two_digits, wrapped};
use crate::report::flux_basis::FluxBasis;

/// Name of light of the first order.
pub(crate) const SINGLE_SCATTERING: &str = "single scattering";

/// Name of all recorded light where paths end after `max_order` interactions. The default limit is so high
/// that it does not matter.
pub(crate) fn recorded_orders(max_order: u32) -> String {
    match max_order {
        1 => SINGLE_SCATTERING.to_owned(),
        2..PathSettings::DEFAULT_MAX_ORDER => format!("orders up to {max_order}"),
        _ => "all orders".to_owned(),
    }
}

/// The light of one side by the components of a medium.
fn by_medium(statistics: &TallyStatistics, support: &FluxBasis, side: Side) -> Option<String> {
    let spec = statistics.spec();
    if !spec.has_medium() || statistics.means().flux(side, Component::All) == 0.0 {
        return None;
    }
    let fluxes = spec.components().iter().map(|&component| {
        let flux = support.flux(side, statistics.flux(side, component));
        format!("{}: {}", component.short_label(), flux.text())
    });
    let fluxes: Vec<String> = fluxes.collect();
    Some(listed(&side.to_string(), &fluxes))
}

/// The energies of one run, by side, order of scattering and number of scatterings inside a medium. `support`: what
/// fluxes rest on whose samples all agree.
#[must_use]
pub fn energy_table(statistics: &TallyStatistics, support: &FluxBasis) -> String {
    let spec = statistics.spec();
    let energies = spec.sides().map(|side| {
        let all = spec.flux_entry(side, Component::All);
        (side.to_string(), all)
    });
    let endings = endings(spec).map(|(name, i)| (name.to_owned(), i));
    let fluxes = energies.chain(endings).map(|(name, i)| {
        let flux = support.of_budget(statistics, i);
        (name, flux.text())
    });
    let residual = statistics.means().budget().total() - 1.0;
    let residual = ("sum - 1".to_owned(), with_sign(residual));
    let rows: Vec<Vec<String>> = fluxes
        .chain([residual])
        .map(|(name, flux)| vec![name, flux])
        .collect();
    let mut out = aligned(&rows, 1);
    for side in spec.sides() {
        let orders = by_order(statistics, support, side);
        let of_medium = by_medium(statistics, support, side);
        let few = few_samples(statistics, side);
        for line in orders.into_iter().chain(of_medium).chain(few) {
            let _ = writeln!(out, "{line}");
        }
    }
    out
}

/// The light of one side by its order of scattering at the surface; `None` if there is none.
fn by_order(statistics: &TallyStatistics, support: &FluxBasis, side: Side) -> Option<String> {
    let mut fluxes: Vec<String> = (1..=4)
        .map(|order| (order, statistics.order(side, order)))
        .filter(|(_, flux)| flux.mean != 0.0)
        .map(|(order, flux)| format!("{order}: {}", support.flux(side, flux).text()))
        .collect();
    let above: f64 = (5..=MAX_LISTED_ORDER)
        .map(|order| statistics.means().order(side, order))
        .sum();
    if above != 0.0 {
        fluxes.push(format!("above: {}", short(above)));
    }
    (!fluxes.is_empty()).then(|| listed(&format!("{side} by order"), &fluxes))
}

/// Sentence that names the components of one side's light that few samples carry; `None` without any.
pub(crate) fn few_samples(statistics: &TallyStatistics, side: Side) -> Option<String> {
    let orders = (1..=4).filter(|&order| is_of_few_rays(statistics.order(side, order)));
    let kept = statistics
        .spec()
        .components()
        .iter()
        .filter(|&&component| is_of_few_rays(statistics.flux(side, component)));
    let names: Vec<String> = orders
        .map(|order| format!("order {order}"))
        .chain(kept.map(|component| component.label().into_owned()))
        .collect();
    (!names.is_empty()).then(|| {
        wrapped(&format!(
            "fewer than 20 surfaces or rays carry {side} light of {}: errors of it are lower bounds",
            names.join(", ")
        ))
    })
}

/// The errors of the energies by their source.
#[must_use]
pub(crate) fn errors_table(budget: &ErrorBudget) -> String {
    let spec = budget.spec();
    let errors = |side: &Side| budget.flux(*side, Component::All);
    let table = Table::new()
        .column(Column::new("errors", "", |side: &Side| side.to_string()))
        .column(Column::new("rays", "", move |side| {
            errors(side).rays.map(two_digits)
        }))
        .column(Column::new("between surfaces", "", move |side| {
            errors(side).surfaces.map(two_digits)
        }))
        .column(Column::new("mesh", "", move |side| {
            let errors = errors(side);
            let mut mesh = errors.mesh.map_or("-".to_owned(), with_sign);
            if let Some(se) = errors.mesh_se {
                let _ = write!(mesh, " +- {}", two_digits(se));
            }
            if let Some(removed) = errors.mesh_removed {
                let _ = write!(mesh, " ({} removed)", with_sign(removed));
            }
            mesh
        }));
    let mut out = table.text(spec.sides());
    if spec.sides().any(|side| errors(&side).mesh.is_none()) {
        let why = format!("mesh {}", budget.mesh_explanation());
        let _ = writeln!(out, "{}", wrapped(&why));
    }
    out
}

/// A shift to two digits.
fn with_sign(shift: f64) -> String {
    match shift {
        0.0 => "0".to_owned(),
        shift if shift < 0.0 => format!("-{}", two_digits(-shift)),
        shift => format!("+{}", two_digits(shift)),
    }
}

/// Names and entries of the budget, energies aside. What left on a side that is not recorded is a part of truncated,
/// and set in beneath it.
pub(crate) fn endings(spec: &TallySpec) -> impl Iterator<Item = (&'static str, Entry)> {
    let one_side = spec.sides().count() < Side::BOTH.len();
    [
        ("absorbed", TallySpec::BUDGET.absorbed),
        ("truncated", TallySpec::BUDGET.truncated),
        ("  not recorded", TallySpec::BUDGET.not_recorded),
        ("lost", TallySpec::BUDGET.lost),
    ]
    .into_iter()
    .filter(move |&(_, i)| i != TallySpec::BUDGET.not_recorded || one_side)
}

/// Warning if light was lost.
#[must_use]
pub(crate) fn lost_warning(statistics: &TallyStatistics) -> Option<String> {
    let lost = statistics.budget().lost.mean;
    (lost != 0.0).then(|| {
        format!("{lost:.3e} of the flux was lost to numerical failure: do not trust these results")
    })
}

/// Least ratio of rays that were traced to those requested of which a report tells.
const MORE_RAYS: f64 = 1.1;

/// Warning if notably more rays were traced than `run` requests of each case.
pub(crate) fn more_rays_warning(run: &RunConfig, traced: u64) -> Option<String> {
    let requested = run.rays.0;
    let more = run.target_error.is_none() && traced as f64 >= MORE_RAYS * requested as f64;
    more.then(|| {
        format!(
            "{traced} rays were traced in place of {requested}: all surfaces have the same number, in blocks that are squares of strata"
        )
    })
}

/// The effort in words.
#[must_use]
pub(crate) fn work_line(work: &SummaryWork) -> String {
    let instructions = match &work.machine.instructions {
        Some(name) => format!(" ({name})"),
        None => String::new(),
    };
    let estimator = match work.control_variate {
        None => "plain",
        Some(ControlVariateMean::GaussianSlopes | ControlVariateMean::SlopeMixture) => "controlled",
        Some(ControlVariateMean::FacetsOfSurface) => "controlled by the facets of this surface",
    };
    let inside = if work.scatterings > 0 {
        format!(
            ", {:.1} scatterings per ray and at most {} on one path",
            work.scatterings as f64 / work.rays as f64,
            work.most_scatterings
        )
    } else {
        String::new()
    };
    let folded = if work.folded {
        ", bins at mirrored azimuths averaged"
    } else {
        ""
    };
    let slope_control = match work.slope_control {
        Some(remaining) => format!(
            ", surfaces controlled by their slopes (which leaves {remaining:.2} of the variance)"
        ),
        None => String::new(),
    };
    wrapped(&format!(
        "{} rays, {estimator}{folded}{slope_control}, {} path segments searched and {} skipped{inside}, accelerator {}{}, {:.1} s on {}",
        work.rays,
        work.segments,
        work.segments_skipped,
        work.accelerator,
        instructions,
        work.machine.seconds,
        counted(work.machine.threads as u64, "thread")
    ))
}
