//! Results as text that people read.

use asperity_simulate::{ControlMean, ErrorBudget, Stopping, short};
use std::fmt::Write;

use asperity_analysis::SignFlipTest;
use asperity_tally::{BatchStatistics, Estimate, History, Layout, MAX_LISTED_ORDER, Share, Side};
use asperity_tracer::PathSettings;

use crate::conclusion::{conclusion, strongest_deviation, verdict_word};
use crate::models::{ComparedShare, ModelOutcome};
use crate::part::Part;
use crate::verify::{CaseOutcome, VerifyOutcome};
use asperity_simulate::SummaryWork;

/// A flux fraction with its error, as in `0.02481 +- 0.00004`: the error to two digits.
pub(crate) fn with_error(estimate: Estimate) -> String {
    match estimate.se {
        Some(se) if se > 0.0 => {
            let digits = (1 - se.log10().floor() as i32).clamp(0, 12) as usize;
            let mean = format!("{:.digits$}", estimate.mean);
            // What rounds to zero has no sign.
            let is_zero = mean.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
            let mean = mean.strip_prefix('-').filter(|_| is_zero).unwrap_or(&mean);
            format!("{mean} +- {se:.digits$}")
        }
        Some(_) => format!("{} (exact)", short(estimate.mean)),
        None => format!("{} (no error)", short(estimate.mean)),
    }
}

/// What light of the first order is called.
pub(crate) const SINGLE_SCATTERING: &str = "single scattering";

/// What all light is called that was recorded of paths ended after `max_order` interactions; as many
/// as are allowed by default end none that matters.
pub(crate) fn recorded_orders(max_order: u32) -> String {
    match max_order {
        1 => SINGLE_SCATTERING.to_owned(),
        2..PathSettings::DEFAULT_MAX_ORDER => format!("orders up to {max_order}"),
        _ => "all orders".to_owned(),
    }
}

/// What light is called that was scattered inside a medium so often.
pub(crate) const fn history_name(history: History) -> &'static str {
    match history {
        History::Unscattered => "never scattered inside",
        History::Once => "once",
        History::More => "more often",
    }
}

/// A flux fraction with its error. Inside a medium what no ray has done may yet be done by one.
fn seen(layout: &Layout, flux: Estimate) -> String {
    if layout.has_histories() && flux.mean == 0.0 && flux.se == Some(0.0) {
        return "0 (none seen)".to_owned();
    }
    with_error(flux)
}

/// The parts of the light of one side by how often it was scattered inside a medium.
fn by_history(layout: &Layout, statistics: &BatchStatistics, side: Side) -> Option<String> {
    if !layout.has_histories() || statistics.means()[side.index()] == 0.0 {
        return None;
    }
    let parts = History::ALL.map(|history| {
        let flux = statistics.estimate(layout.history(side, history));
        format!("{}: {}", history_name(history), seen(layout, flux))
    });
    Some(format!("{side} {}", parts.join(",  ")))
}

/// Energies, orders and event paths of one run.
#[must_use]
pub fn energy_table(layout: &Layout, statistics: &BatchStatistics) -> String {
    let mut out = String::new();
    let energies = layout.sides().map(|side| (side.to_string(), side.index()));
    let endings = endings(layout).map(|(name, i)| (name.to_owned(), i));
    for (name, i) in energies.chain(endings) {
        let _ = writeln!(out, "  {name:<12} {}", seen(layout, statistics.estimate(i)));
    }
    let residual = statistics.means()[..5].iter().sum::<f64>() - 1.0;
    let _ = writeln!(out, "  sum - 1      {residual:.1e}");
    for side in layout.sides() {
        let mut fluxes: Vec<String> = (1..=4)
            .map(|order| statistics.estimate(layout.order(side, order)))
            .enumerate()
            .filter(|(_, flux)| flux.mean != 0.0)
            .map(|(i, flux)| format!("{}: {}", i + 1, with_error(flux)))
            .collect();
        let above: f64 = (5..=MAX_LISTED_ORDER)
            .map(|order| statistics.means()[layout.order(side, order)])
            .sum();
        if above != 0.0 {
            fluxes.push(format!("above: {}", short(above)));
        }
        if !fluxes.is_empty() {
            let _ = writeln!(out, "  {side} by order  {}", fluxes.join(",  "));
        }
        if let Some(line) = by_history(layout, statistics, side) {
            let _ = writeln!(out, "  {line}");
        }
    }
    out
}

/// The errors of the energies by where they come from.
#[must_use]
pub fn errors_table(layout: &Layout, budget: &ErrorBudget) -> String {
    let mut rows = vec![
        ["errors", "rays", "between surfaces", "mesh"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for side in layout.sides() {
        let errors = budget.errors(side.index());
        let mut row = vec![side.to_string()];
        row.extend([errors.rays, errors.surfaces].map(|se| se.map_or("-".to_owned(), two_digits)));
        let mut mesh = errors.mesh.map_or("-".to_owned(), with_sign);
        if let Some(se) = errors.mesh_se {
            let _ = write!(mesh, " +- {}", two_digits(se));
        }
        row.push(match errors.mesh_removed {
            Some(removed) => format!("{mesh} ({} removed)", with_sign(removed)),
            None => mesh,
        });
        rows.push(row);
    }
    let mut out = aligned(&rows);
    let unknown = |side: Side| budget.errors(side.index()).mesh.is_none();
    if layout.sides().any(unknown) {
        let _ = writeln!(out, "  mesh {}", budget.way_of_mesh());
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

/// A number that is not negative to two digits.
fn two_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    format!("{:.1e}", value)
}

/// Names and entries of the budget beside the energies; what went to a side that is not asked for is
/// a part of truncated, and set in beneath it.
fn endings(layout: &Layout) -> impl Iterator<Item = (&'static str, usize)> {
    let not_asked = layout.sides().count() < Side::BOTH.len();
    [
        ("absorbed", Layout::ABSORBED),
        ("truncated", Layout::TRUNCATED),
        ("  not asked", Layout::NOT_ASKED),
        ("lost", Layout::LOST),
    ]
    .into_iter()
    .filter(move |&(_, i)| i != Layout::NOT_ASKED || not_asked)
}

/// What a reader must know if light was lost.
#[must_use]
pub fn lost_warning(statistics: &BatchStatistics) -> Option<String> {
    let lost = statistics.means()[Layout::LOST];
    (lost != 0.0).then(|| {
        format!("{lost:.3e} of the flux was lost to numerical failure: do not trust these results")
    })
}

/// What a reader must know of the results of a case.
pub(crate) fn warnings(outcome: &VerifyOutcome, case: &CaseOutcome) -> Vec<String> {
    let mut warnings: Vec<String> = lost_warning(&case.statistics).into_iter().collect();
    warnings.extend(case.stopping.iter().flat_map(|s| s.warnings.clone()));
    let left_out = outcome.left_out.len();
    if left_out > 0 {
        let of = outcome.cases.len() + left_out;
        warnings.push(format!(
            "interrupted before {left_out} of {of} cases were begun"
        ));
    }
    warnings
}

/// One line about the effort.
#[must_use]
pub fn work_line(work: &SummaryWork) -> String {
    let instructions = match &work.instructions {
        Some(name) => format!(" ({name})"),
        None => String::new(),
    };
    let estimator = match work.control {
        None => "plain",
        Some(ControlMean::GaussianSlopes) => "controlled",
        Some(ControlMean::FacetsOfSurface) => "controlled by the facets of this surface",
    };
    let inside = if work.scatterings > 0 {
        format!(
            ", {:.1} scatterings a ray and {} of one path at most",
            work.scatterings as f64 / work.rays as f64,
            work.most_scatterings
        )
    } else {
        String::new()
    };
    format!(
        "{} rays, {estimator}, {} segments searched and {} skipped{inside}, accelerator {}{}, {:.1} s on {} threads",
        work.rays,
        work.segments,
        work.segments_skipped,
        work.accelerator,
        instructions,
        work.seconds,
        work.threads
    )
}

/// The comparison of every case.
#[must_use]
pub fn verify_table(outcome: &VerifyOutcome) -> String {
    let mut out = String::new();
    for case in &outcome.cases {
        out.push_str(&case_table(outcome, case));
        out.push('\n');
    }
    if outcome.cases.len() > 1 {
        out.push_str(&overview(outcome));
    }
    out
}

/// The comparison of one case.
pub(crate) fn case_table(outcome: &VerifyOutcome, case: &CaseOutcome) -> String {
    let mut out = String::new();
    let [nx, ny] = case.size;
    let _ = writeln!(out, "{}", case.case);
    let surfaces = case.work.realisations;
    let plural = if surfaces == 1 { "" } else { "s" };
    let _ = match case.deviation_bound {
        Some(bound) => writeln!(
            out,
            "no surface was traced: these are facets without shadow and masking; no flux differs by more than {bound:.1e}",
        ),
        None => writeln!(
            out,
            "{surfaces} surface{plural} of {nx} x {ny}, {} rays; standard errors from {} {}",
            case.work.rays,
            case.statistics.batches(),
            case.errors_from,
        ),
    };
    if let Some(line) = case.stopping.as_ref().and_then(Stopping::line) {
        let _ = writeln!(out, "{line}");
    }
    let max_order = outcome.config.run.max_order;
    let orders = recorded_orders(max_order);
    if max_order < PathSettings::DEFAULT_MAX_ORDER {
        let _ = writeln!(out, "{orders} alone; light that would go on is truncated");
    }
    if case.deviation_bound.is_none() {
        let config = outcome.config.on_grid(case.size, case.spacing);
        let _ = writeln!(
            out,
            "slope variance of the mesh is {:.2} % below that of the continuous surface",
            100.0 * config.mesh_slope_deficit(),
        );
    }
    out.push('\n');

    let names = || {
        case.models
            .iter()
            .map(|model| model.model.name().to_owned())
    };
    let mut rows: Vec<Vec<String>> = vec![
        ["flux fraction", "explicit"]
            .map(str::to_owned)
            .into_iter()
            .chain(names())
            .collect(),
    ];
    for side in outcome.layout.sides() {
        for (name, part) in parts(&outcome.layout) {
            let estimate = case
                .statistics
                .estimate(part.on_side(&outcome.layout, side));
            let mut row = vec![format!("{side} {name}"), with_error(estimate)];
            row.extend(
                case.models
                    .iter()
                    .map(|model| beside(model, side, part, estimate)),
            );
            rows.push(row);
        }
    }
    for (name, i) in endings(&outcome.layout) {
        rows.push(vec![
            name.to_owned(),
            seen(&outcome.layout, case.statistics.estimate(i)),
        ]);
    }
    out.push_str(&aligned(&rows));
    out.push('\n');
    out.push_str(&errors_table(&outcome.layout, &case.errors));
    for warning in warnings(outcome, case) {
        let _ = writeln!(out, "warning: {warning}");
    }
    if !case.models.is_empty() {
        for part in Part::COMPARED {
            let table = distribution_table(&outcome.layout, case, part, &orders);
            if !table.is_empty() {
                let _ = write!(out, "\n{table}");
            }
        }
        if let Some(line) = sampled_models(case) {
            let _ = writeln!(out, "  {line}");
        }
        let _ = writeln!(out, "\n{}", conclusion(&outcome.layout, case));
    }
    out
}

/// What a part of the light is called; `orders` names all light that was recorded.
fn part_name(part: Part, orders: &str) -> String {
    match part {
        Part::Orders(Share::Single) => SINGLE_SCATTERING.to_owned(),
        Part::Orders(Share::Multiple) => "multiple scattering".to_owned(),
        Part::Orders(Share::Total) => orders.to_owned(),
        Part::Inside(history) => inside(history).to_owned(),
    }
}

/// Which models were sampled, and by how many rays.
fn sampled_models(case: &CaseOutcome) -> Option<String> {
    let sampled = |m: &&ModelOutcome| !m.expectation.is_exact();
    let names: Vec<&str> = case
        .models
        .iter()
        .filter(sampled)
        .map(|m| m.model.name())
        .collect();
    let rays = case.models.iter().find(sampled)?.expectation.rays();
    Some(format!(
        "{} sampled by {rays} rays; their noise is part of the errors",
        names.join(", ")
    ))
}

/// The parts of the light of one side: by how often the surface scattered it, or what is inside; and all.
fn parts(layout: &Layout) -> Vec<(&'static str, Part)> {
    let of_medium = History::ALL.map(|history| (inside(history), Part::Inside(history)));
    let of_surface = [Share::Single, Share::Multiple]
        .map(Part::Orders)
        .map(|part| (part.key(), part));
    let mut parts = if layout.has_histories() {
        of_medium.to_vec()
    } else {
        of_surface.to_vec()
    };
    parts.push(("total", Part::Orders(Share::Total)));
    parts
}

/// What light is called that was scattered inside a medium so often, without more words about it.
const fn inside(history: History) -> &'static str {
    match history {
        History::Unscattered => "never scattered inside",
        History::Once => "scattered inside once",
        History::More => "scattered inside more often",
    }
}

/// A model's energy and its distance from the explicit one in standard errors of the difference.
fn beside(model: &ModelOutcome, side: Side, part: Part, explicit: Estimate) -> String {
    let Some(energy) = model.energy(part, side) else {
        return "-".to_owned();
    };
    if !model.model.sides().ask(side) {
        return "-".to_owned();
    }
    let se = explicit.se.map(|se| se.hypot(energy.se.unwrap_or(0.0)));
    match se {
        Some(se) if se > 0.0 => {
            let digits = (1 - se.log10().floor() as i32).clamp(0, 12) as usize;
            let z = (explicit.mean - energy.mean) / se;
            format!("{:.digits$} (z {z:+.1})", energy.mean)
        }
        _ => short(energy.mean),
    }
}

/// Total variation, p value and verdict of every model that describes a part of the light; `orders`
/// names all light that was recorded. Empty if none does.
fn distribution_table(layout: &Layout, case: &CaseOutcome, part: Part, orders: &str) -> String {
    type Cell<'a> = Box<dyn Fn(&ModelOutcome, &ComparedShare) -> String + 'a>;
    let mut rows: Vec<(String, Cell<'_>)> = vec![
        (
            part_name(part, orders),
            Box::new(|m, _| m.model.name().to_owned()),
        ),
        (
            match (case.free_azimuth, case.work.control) {
                (true, None) => "bins in rings of 20 rays or more".into(),
                (false, None) => "bins of 20 rays or more".into(),
                // Others cancel exactly.
                (true, Some(_)) => "bins in rings of 20 deviating rays".into(),
                (false, Some(_)) => "bins of 20 deviating rays or more".into(),
            },
            Box::new(|_, part| {
                let tested = part.comparison.bins.iter().filter(|bin| bin.tested);
                tested.count().to_string()
            }),
        ),
        (
            "total variation distance".into(),
            Box::new(|_, part| distance(part.comparison.total_variation.observed)),
        ),
        (
            "  that noise alone would cause".into(),
            Box::new(|_, part| {
                let noise = part.comparison.total_variation.noise;
                noise.map_or_else(|| "-".to_owned(), distance)
            }),
        ),
        (
            "largest |t|: bins; rings; sides".into(),
            Box::new(|_, part| {
                let t = |test: &SignFlipTest| -> Vec<String> {
                    test.scales
                        .iter()
                        .map(|scale| format!("{:.1}", scale.max_t))
                        .collect()
                };
                let test = part.comparison.test.as_ref();
                test.map_or_else(|_| "-".to_owned(), |test| t(test).join("; "))
            }),
        ),
        (
            "p value, sign flips of surfaces".into(),
            Box::new(|_, part| match &part.comparison.test {
                Ok(test) => format!("{:.4}", test.p),
                Err(_) => "-".to_owned(),
            }),
        ),
        (
            "most significant deviation".into(),
            Box::new(|_, part| {
                let place = strongest_deviation(&part.comparison, layout);
                place.unwrap_or_else(|| "-".to_owned())
            }),
        ),
        (
            "verdict".into(),
            Box::new(|_, part| {
                let verdict = part.verdict.as_ref();
                verdict.map_or("-", verdict_word).to_owned()
            }),
        ),
    ];
    if part != Part::Orders(Share::Total) && case.models.iter().any(|m| m.judged_part() == part) {
        rows.push((
            format!("total variation from {orders}"),
            Box::new(|m, _| distance(m.total.comparison.total_variation.observed)),
        ));
    }
    let models: Vec<(&ModelOutcome, &ComparedShare)> = case
        .models
        .iter()
        .filter(|model| model.describes(part))
        .filter_map(|model| Some((model, model.compared(part)?)))
        .collect();
    if models.is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<String>> = rows
        .iter()
        .map(|(name, cell)| {
            std::iter::once(name.clone())
                .chain(models.iter().map(|(model, part)| cell(model, part)))
                .collect()
        })
        .collect();
    aligned(&rows)
}

/// A total variation distance, to five decimals or, where they would not show it, to two digits.
pub(crate) fn distance(value: f64) -> String {
    if value == 0.0 || value >= 1e-3 {
        format!("{value:.5}")
    } else {
        format!("{value:.1e}")
    }
}

/// Rows of cells as lines, in columns as wide as their widest cell.
pub(crate) fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter()
            .filter_map(|row| row.get(column))
            .map(|cell| cell.chars().count())
            .max()
    };
    let widths: Vec<usize> = (0..columns)
        .map(|column| width(column).unwrap_or(0))
        .collect();
    let mut out = String::new();
    for row in rows {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(cell, &width)| format!("{cell:<width$}"))
            .collect();
        out.push_str(cells.join("   ").trim_end());
        out.push('\n');
    }
    out
}

/// A line a case and model, for runs of many cases.
fn overview(outcome: &VerifyOutcome) -> String {
    let header = [
        "case",
        "model",
        "light",
        "total variation (noise)",
        "p value",
        "multiple",
        "verdict",
    ];
    let mut rows: Vec<Vec<String>> = vec![header.map(str::to_owned).to_vec()];
    for case in &outcome.cases {
        let multiple = |side| case.statistics.means()[outcome.layout.multiple(side)];
        let multiple = multiple(Side::Reflected) + multiple(Side::Transmitted);
        let judged = case.models.iter().flat_map(|model| {
            // What the medium scattered and what it did not are judged apart.
            let unscattered = Part::Inside(History::Unscattered);
            let apart = model.compared(unscattered).map(|c| (model, unscattered, c));
            [(model, model.judged_part(), model.judged())]
                .into_iter()
                .chain(apart)
        });
        for (model, part, judged) in judged {
            let found = &judged.comparison.total_variation;
            let noise = found.noise.map_or_else(|| "-".to_owned(), distance);
            let test = judged.comparison.test.as_ref();
            rows.push(vec![
                case.case.to_string(),
                model.model.name().to_owned(),
                match part {
                    Part::Orders(Share::Total) => "all",
                    Part::Inside(history) => history_name(history),
                    Part::Orders(_) => "single",
                }
                .to_owned(),
                format!("{} ({noise})", distance(found.observed)),
                test.map_or_else(|_| "-".to_owned(), |test| format!("{:.4}", test.p)),
                format!("{multiple:.5}"),
                judged.verdict.as_ref().map_or("-", verdict_word).to_owned(),
            ]);
        }
    }
    aligned(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_two_digits_and_means_as_many_places() {
        let estimate = |mean, se| with_error(Estimate { mean, se: Some(se) });
        assert_eq!(estimate(0.024_812_3, 0.000_041_7), "0.024812 +- 0.000042");
        assert_eq!(estimate(0.5, 0.0), "0.5 (exact)");
        assert_eq!(estimate(-0.000_41, 0.023), "0.000 +- 0.023");
        assert_eq!(estimate(-0.000_61, 0.023), "-0.001 +- 0.023");
        assert_eq!(
            with_error(Estimate {
                mean: 0.25,
                se: None
            }),
            "0.25 (no error)"
        );
    }
}
