//! The comparison of explicit results with models as text: report.txt of a verification.

use std::fmt::Write;

use asperity_analysis::{Comparison, SignFlipTest};
use asperity_simulate::{Stopping, short};
use asperity_tally::{Estimate, History, Layout, Share, Side};
use asperity_tracer::PathSettings;

use crate::conclusion::{conclusion, strongest_deviation, verdict_word};
use crate::energies::{
    SINGLE_SCATTERING, endings, errors_table, flux_with_error, history_name, lost_warning,
    recorded_orders,
};
use crate::models::{ComparedShare, ModelOutcome};
use crate::output::{Column, Format, Table, distance, with_error, wrapped};
use crate::part::Part;
use crate::verify::{CaseOutcome, VerifyOutcome};

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
            "nothing was traced: fluxes without shadowing and masking, which differ from the\ntrue ones by at most {bound:.1e}",
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
        let _ = writeln!(out, "{}", wrapped(&line));
    }
    let max_order = outcome.config.run.max_order;
    let orders = recorded_orders(max_order);
    if max_order < PathSettings::DEFAULT_MAX_ORDER {
        let _ = writeln!(out, "{orders} only; further paths are truncated");
    }
    if case.deviation_bound.is_none() {
        let config = outcome.config.on_grid(case.size, case.spacing);
        let _ = writeln!(
            out,
            "the slope variance of the mesh is {:.2} % below that of the continuous surface",
            100.0 * config.mesh_slope_deficit(),
        );
    }
    out.push('\n');

    out.push_str(&flux_table(outcome, case));
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

/// A row of the table of fluxes.
struct FluxRow {
    name: String,
    explicit: Estimate,
    /// The part of the light that models may describe; `None` for light that does not leave.
    part: Option<(Side, Part)>,
}

/// The fluxes by side and part of the light, beside those that the models expect.
fn flux_table(outcome: &VerifyOutcome, case: &CaseOutcome) -> String {
    let layout = &outcome.layout;
    let of_side = |side: Side| {
        let row = move |(name, part): (&str, Part)| FluxRow {
            name: format!("{side} {name}"),
            explicit: case.statistics.estimate(part.on_side(layout, side)),
            part: Some((side, part)),
        };
        parts(layout).into_iter().map(row)
    };
    let endings = endings(layout).map(|(name, i)| FluxRow {
        name: name.to_owned(),
        explicit: case.statistics.estimate(i),
        part: None,
    });
    let models = case.models.iter().map(|model| {
        Column::new(model.model.name(), "", |row: &FluxRow| match row.part {
            Some((side, part)) => model_flux(model, side, part, row.explicit),
            None => String::new(),
        })
    });
    Table::new()
        .column(Column::new("flux fraction", "", |row: &FluxRow| {
            row.name.clone()
        }))
        .column(Column::new("explicit", "", |row: &FluxRow| {
            match row.part {
                Some(_) => with_error(row.explicit),
                None => flux_with_error(layout, row.explicit),
            }
        }))
        .columns(models)
        .text(layout.sides().flat_map(of_side).chain(endings))
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

/// The flux that a model expects, and its distance from the explicit one in standard errors of the difference.
fn model_flux(model: &ModelOutcome, side: Side, part: Part, explicit: Estimate) -> String {
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

/// A part of the light beside a model that describes it.
struct Described<'a> {
    model: &'a ModelOutcome,
    compared: &'a ComparedShare,
}

impl Described<'_> {
    fn comparison(&self) -> &Comparison {
        &self.compared.comparison
    }

    fn test(&self) -> Option<&SignFlipTest> {
        self.comparison().test.as_ref().ok()
    }
}

/// Total variation, p value and verdict of every model that describes a part of the light; `orders`
/// names all light that was recorded. Empty if none does.
fn distribution_table(layout: &Layout, case: &CaseOutcome, part: Part, orders: &str) -> String {
    type Row<'a> = Described<'a>;
    let models: Vec<Row<'_>> = case
        .models
        .iter()
        .filter(|model| model.describes(part))
        .filter_map(|model| {
            let compared = model.compared(part)?;
            Some(Described { model, compared })
        })
        .collect();
    if models.is_empty() {
        return String::new();
    }
    let column = |heading, value: fn(&Row<'_>) -> Option<String>| {
        Column::new(heading, "", move |row: &Row<'_>| value(row))
    };
    let mut table = Table::new()
        .column(Column::new(part_name(part, orders), "", |row: &Row<'_>| {
            row.model.model.name()
        }))
        .column(column(tested_bins(case), |row| {
            let tested = row.comparison().bins.iter().filter(|bin| bin.tested);
            Some(tested.count().to_string())
        }))
        .column(column("total variation distance", |row| {
            Some(distance(row.comparison().total_variation.observed))
        }))
        .column(column("  expected from noise alone", |row| {
            row.comparison().total_variation.noise.map(distance)
        }))
        .column(column("largest |t|: bins; rings; sides", |row| {
            let scales = row.test()?.scales.iter();
            let largest: Vec<String> = scales.map(|scale| format!("{:.1}", scale.max_t)).collect();
            Some(largest.join("; "))
        }))
        .column(column("p value, sign flips of surfaces", |row| {
            Some(format!("{:.4}", row.test()?.p))
        }))
        .column(Column::new(
            "most significant deviation",
            "",
            |row: &Row<'_>| strongest_deviation(row.comparison(), layout),
        ))
        .column(column("verdict", |row| {
            row.compared
                .verdict
                .as_ref()
                .map(|verdict| verdict_word(verdict).to_owned())
        }));
    if part != Part::Orders(Share::Total) && case.models.iter().any(|m| m.judged_part() == part) {
        let heading = format!("total variation from {orders}");
        table = table.column(Column::new(heading, "", |row: &Row<'_>| {
            distance(row.model.total.comparison.total_variation.observed)
        }));
    }
    table.transposed_text(models)
}

/// Which bins enter the test.
const fn tested_bins(case: &CaseOutcome) -> &'static str {
    match (case.free_azimuth, case.work.control) {
        (true, None) => "bins in rings of 20 rays or more",
        (false, None) => "bins of 20 rays or more",
        // Rays that do not deviate cancel exactly.
        (true, Some(_)) => "bins in rings of 20 deviating rays",
        (false, Some(_)) => "bins of 20 deviating rays or more",
    }
}

/// What one model says of a part of the light in one case.
struct Judged<'a> {
    case: &'a CaseOutcome,
    model: &'a ModelOutcome,
    part: Part,
    compared: &'a ComparedShare,
}

/// A line per case and model, for runs of many cases.
fn overview(outcome: &VerifyOutcome) -> String {
    type Row<'a> = Judged<'a>;
    let judged = outcome.cases.iter().flat_map(|case| {
        case.models.iter().flat_map(move |model| {
            let judged = |part, compared| Judged {
                case,
                model,
                part,
                compared,
            };
            // What the medium scattered and what it did not are judged apart.
            let unscattered = Part::Inside(History::Unscattered);
            let apart = model.compared(unscattered);
            std::iter::once(judged(model.judged_part(), model.judged()))
                .chain(apart.map(|compared| judged(unscattered, compared)))
        })
    });
    let multiple = |row: &Row<'_>| {
        let of = |side| row.case.statistics.means()[outcome.layout.multiple(side)];
        of(Side::Reflected) + of(Side::Transmitted)
    };
    Table::new()
        .column(Column::new("case", "", |row: &Row<'_>| {
            row.case.case.to_string()
        }))
        .column(Column::new("model", "", |row: &Row<'_>| {
            row.model.model.name()
        }))
        .column(Column::new("light", "", |row: &Row<'_>| match row.part {
            Part::Orders(Share::Total) => "all",
            Part::Inside(history) => history_name(history),
            Part::Orders(_) => "single",
        }))
        .column(Column::new(
            "total variation (noise)",
            "",
            |row: &Row<'_>| {
                let found = &row.compared.comparison.total_variation;
                let noise = found.noise.map_or_else(|| "-".to_owned(), distance);
                format!("{} ({noise})", distance(found.observed))
            },
        ))
        .column(Column::new("p value", "", |row: &Row<'_>| {
            let test = row.compared.comparison.test.as_ref().ok()?;
            Some(format!("{:.4}", test.p))
        }))
        .column(Column::new("multiple", "", multiple).format(Format::Fixed(5)))
        .column(Column::new("verdict", "", |row: &Row<'_>| {
            row.compared.verdict.as_ref().map(verdict_word)
        }))
        .text(judged)
}
