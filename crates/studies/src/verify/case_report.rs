//! The comparison of explicit results with models as text: report.txt of a verification.

use std::borrow::Cow;
use std::fmt::Write;

use asperity_analysis::SlopeDistribution;
use asperity_numerics::elementary::{hypot, log10};
use asperity_simulate::{Cells, StoppedBy, counted, short};
use asperity_synthesis::SurfaceRecipe;
use asperity_tally::{Component, Estimate, Measure, Side, TallyResult, TallySpec};
use asperity_tracer::{PathSettings, Polarisation};

use super::outcome::VerifyOutcome;
use crate::comparison::AVERAGED_LAYERS;
use crate::comparison::compared::{COMPARED, key};
use crate::comparison::conclusion::{explained_conclusion, verdict_name};
use crate::comparison::judgement::Judgement;
use crate::comparison::models::{ComparedComponent, ModelOutcome};
use crate::config::case_model::CaseModel;
use crate::config::lobes::BinnedLobe;
use crate::output::{
    Column, EstimateWithLimit, Format, TEXT_WIDTH, Table, distance, relative, wrapped,
};
use crate::report::appearance::{appearance_text, coherent_warning};
use crate::report::distribution_table::{distribution_table, sampled_models};
use crate::report::energies::{
    endings, errors_table, few_samples, lost_warning, more_rays_warning, recorded_orders,
};
use crate::report::flux_basis::FluxBasis;
use crate::report::polarised::polarised_text;
use crate::report::spectrum_views::spectra_text;
use crate::validity::wavelength_warnings;

/// Longest title of a case that a table repeats in each row, characters.
const MAX_CASE_WIDTH: usize = 34;

/// Width of the widest number of a row, `total variation (noise)`, and of the blanks before the columns, characters.
const MEASURE_WIDTH: usize = 23 + 3 * 2;

/// Warnings on the results of a case.
pub(super) fn warnings(outcome: &VerifyOutcome, case: &Judgement<'_>) -> Vec<String> {
    let mut warnings: Vec<String> = lost_warning(&case.outcome.statistics).into_iter().collect();
    let traced = case.outcome.work.rays;
    warnings.extend(more_rays_warning(&outcome.config.run, traced));
    let stopping = outcome.stopping(case);
    warnings.extend(stopping.iter().flat_map(|s| s.warnings.clone()));
    warnings.extend(case.outcome.errors.mesh_warning().map(str::to_owned));
    warnings.extend(case.lobes().iter().filter_map(BinnedLobe::warning));
    let is_tracked = outcome.config.run.polarisation != Polarisation::Averaged;
    let mut models = case.models.iter();
    if is_tracked && models.any(|model| matches!(model.model, CaseModel::Layer(_))) {
        warnings.push(AVERAGED_LAYERS.to_owned());
    }
    let wavelength = outcome.config.light.wavelength_nm();
    let is_named = outcome.config.material.media().is_some();
    let unit = case.outcome.case.at.unit;
    warnings.extend(wavelength_warnings(wavelength, is_named, unit));
    warnings.extend(coherent_warning(
        outcome.config.output.coherent,
        &case.outcome.case,
    ));
    warnings.extend(gaussian_models_of_ggx(case));
    if outcome.config.lacks_models(case) {
        warnings.push(
            "the run was ended before the case was compared with models; the same command compares it, if it has the time"
                .to_owned(),
        );
    }
    warnings.extend(outcome.config.surface.erosion_notes());
    let left_out = outcome.left_out();
    if left_out > 0 {
        let of = outcome.cases.len() + left_out;
        warnings.push(match outcome.stopped_by {
            Some(StoppedBy::Shards) => {
                format!("{left_out} of {of} cases are left out: shards of the run are missing")
            }
            _ => format!("interrupted before {left_out} of {of} cases were begun"),
        });
    }
    warnings
}

/// Warning on models of Gaussian slopes of surfaces whose slopes are GGX.
fn gaussian_models_of_ggx(case: &Judgement<'_>) -> Option<String> {
    let recipe = case.outcome.case.surface.recipe()?;
    let SurfaceRecipe::StudentSlopes(_) = recipe else {
        return None;
    };
    let names = case.models.iter().filter_map(|model| match &model.model {
        CaseModel::Surface(of) if matches!(of.slopes(), SlopeDistribution::Gaussian(_)) => {
            Some(of.name())
        }
        _ => None,
    });
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| {
        format!(
            "the surfaces have GGX slopes, in place of which {} take Gaussian ones of the same variance; ggx, heitz-ggx and smith-slopes have their own",
            names.join(", ")
        )
    })
}

/// The comparison of every case.
pub(super) fn verify_table(outcome: &VerifyOutcome) -> String {
    let is_judged = outcome.cases.iter().any(|case| !case.models.is_empty());
    let spectra = spectra_text(&outcome.plan.cases, &outcome.outcomes());
    if let (false, Some(mut text), Some(first)) = (is_judged, spectra, outcome.cases.first()) {
        for warning in warnings(outcome, first) {
            let _ = writeln!(text, "note: {}: {warning}", first.outcome.case.label());
        }
        return wrapped(&text);
    }
    let mut out = String::new();
    if is_judged && outcome.cases.len() > 1 {
        out.push_str(&overview(outcome));
        out.push('\n');
    }
    for case in &outcome.cases {
        out.push_str(&case_table(outcome, case));
        out.push('\n');
    }
    out
}

/// The comparison of one case.
pub(super) fn case_table(outcome: &VerifyOutcome, case: &Judgement<'_>) -> String {
    let mut out = String::new();
    let surface = &case.outcome.case.surface;
    let [nx, ny] = surface.size().unwrap_or_default();
    let _ = writeln!(out, "{}", case.outcome.case.label());
    let validity = outcome.validity(case);
    let statistics = &case.outcome.statistics;
    if let Some(line) = validity.and_then(|validity| validity.first_lines(statistics)) {
        let _ = writeln!(out, "{}", wrapped(&line));
    }
    let _ = match case.outcome.deviation_bound {
        Some(bound) => writeln!(
            out,
            "nothing was traced: fluxes without shadowing and masking, which differ from the true ones by at most {bound:.1e}",
        ),
        None => writeln!(
            out,
            "{} of {nx} x {ny}, {} rays; standard errors from {} {}",
            counted(case.outcome.work.realisations, "surface"),
            case.outcome.work.rays,
            case.outcome.statistics.batches(),
            case.outcome.errors_from,
        ),
    };
    let stopping = outcome.stopping(case);
    if let Some(line) = stopping.and_then(|stopping| stopping.line(case.outcome.case.at.unit)) {
        let _ = writeln!(out, "{}", wrapped(&line));
    }
    let max_order = outcome.config.run.max_order;
    let orders = recorded_orders(max_order);
    if max_order < PathSettings::DEFAULT_MAX_ORDER {
        let _ = writeln!(out, "{orders} only; further paths are truncated");
    }
    if case.outcome.deviation_bound.is_none() {
        let _ = writeln!(out, "{}", cells_line(outcome, case));
    }
    out.push('\n');

    out.push_str(&flux_table(case));
    if !case.models.is_empty() {
        let _ = writeln!(out, "\n{}", explained_conclusion(case));
    }
    if let Some(note) = validity.and_then(|validity| validity.note()) {
        let _ = writeln!(out, "{}", wrapped(&format!("note: {note}")));
    }
    for warning in warnings(outcome, case) {
        let _ = writeln!(out, "warning: {warning}");
    }
    out.push('\n');
    out.push_str(&errors_table(&case.outcome.errors));
    for line in case
        .spec()
        .sides()
        .filter_map(|side| few_samples(&case.outcome.statistics, side))
    {
        let _ = writeln!(out, "{line}");
    }
    out.push_str(&appearance_text(outcome.sample_light(case)));
    out.push_str(&polarised_text(&case.outcome.statistics));
    out.push_str(&averaging_lines(case));
    if !case.models.is_empty() {
        for component in COMPARED {
            let table = distribution_table(case, component, &orders);
            if !table.is_empty() {
                let _ = write!(out, "\n{table}");
            }
        }
        for line in sampled_models(case) {
            let _ = writeln!(out, "  {line}");
        }
    }
    wrapped(&out)
}

/// The deviation from each model that describes all light, and what it would be with averaged light, where both are traced.
fn averaging_lines(case: &Judgement<'_>) -> String {
    let statistics = &case.outcome.statistics;
    let spec = statistics.spec();
    let mut out = String::new();
    let models = case.models.iter();
    for model in models.filter(|model| model.judged_component() == Component::All) {
        for side in spec
            .sides()
            .filter(|&side| model.model.sides().includes(side))
        {
            let flux = spec.flux_entry(side, Component::All);
            let Some(entry) = spec.measure_entry(flux, Measure::Averaging) else {
                return out;
            };
            let expected = model.expectation.statistics().means()[flux];
            let deviation = statistics.at(flux).mean - expected;
            let averaged = deviation - statistics.at(entry).mean;
            let _ = writeln!(
                out,
                "{side} flux less that of {}: {deviation:+.2e} tracked, {averaged:+.2e} averaged",
                model.model.name(),
            );
        }
    }
    out
}

/// Slopes of the surfaces as their cells have them.
fn cells_line(outcome: &VerifyOutcome, case: &Judgement<'_>) -> String {
    let source = &case.outcome.case.surface;
    let recipe = source.recipe();
    if let (Some(cells), Some(SurfaceRecipe::Eroded(eroded))) = (source.cells(), recipe) {
        let [after, before] = [
            eroded.slope_covariance(),
            eroded.before().slope_covariance(),
        ]
        .map(|[xx, _, yy]| xx + yy);
        return format!(
            "cells are {cells}: erosion leaves {:.1} % of the slope variance, on two surfaces",
            100.0 * after / before
        );
    }
    if source.cells() == Some(Cells::Smooth) {
        return "cells are smooth, with the slope variance of the continuous surface".to_owned();
    }
    if recipe.is_some_and(|recipe| recipe.structured().is_some()) {
        return "cells are flat, cut where edges of the structure pass between samples".to_owned();
    }
    let [dx, dy] = source.spacing().unwrap_or_default();
    let finer = if outcome.config.run.refine { 0.5 } else { 1.0 };
    let surface = &outcome.config.surface;
    format!(
        "cells are flat: the slope variance of the mesh is {:.2} % below that of the continuous surface",
        100.0 * surface.facet_slope_deficit([finer * dx, finer * dy]),
    )
}

/// A row of the table of fluxes.
struct FluxRow {
    name: String,
    explicit: EstimateWithLimit,
    /// The component of the light that models may describe; `None` for light that does not leave.
    component: Option<(Side, Component)>,
}

/// The fluxes by side and component of the light, next to those that the models expect.
fn flux_table(case: &Judgement<'_>) -> String {
    let spec = case.spec();
    let statistics = &case.outcome.statistics;
    let support = FluxBasis::of(case.outcome);
    let of_side = |side: Side| {
        let row = move |(name, component)| FluxRow {
            name: format!("{side} {name}"),
            explicit: support.flux(side, statistics.flux(side, component)),
            component: Some((side, component)),
        };
        components(spec).map(row)
    };
    let endings = endings(spec).map(|(name, i)| FluxRow {
        name: name.to_owned(),
        explicit: support.of_budget(statistics, i),
        component: None,
    });
    let models = case.models.iter().map(|model| {
        Column::new(model.model.name(), "", |row: &FluxRow| {
            match row.component {
                Some((side, component)) => {
                    model_flux(model, side, component, row.explicit.estimate())
                }
                None => String::new(),
            }
        })
    });
    Table::new()
        .column(Column::new("flux fraction", "", |row: &FluxRow| {
            row.name.clone()
        }))
        .column(Column::new("explicit", "", |row: &FluxRow| {
            row.explicit.text()
        }))
        .columns(models)
        .text(spec.sides().flat_map(of_side).chain(endings))
}

/// The components of the light of one side, with their names: those that it is split into, and all.
fn components(spec: &TallySpec) -> impl Iterator<Item = (Cow<'static, str>, Component)> {
    let name = |component: Component| match component.is_of_medium() {
        true => component.label(),
        false => key(component),
    };
    let all = spec.split().iter().copied().chain([Component::All]);
    all.map(move |component| (name(component), component))
}

/// The flux that a model expects, and how far that is from the explicit one.
fn model_flux(
    model: &ModelOutcome,
    side: Side,
    component: Component,
    explicit: Estimate,
) -> String {
    let Some(energy) = model.energy(component, side) else {
        return "-".to_owned();
    };
    if !model.model.sides().includes(side) {
        return "-".to_owned();
    }
    let off = relative(energy.mean, explicit.mean);
    let se = explicit.se.map(|se| hypot(se, energy.se.unwrap_or(0.0)));
    match se {
        Some(se) if se > 0.0 => {
            let digits = (1 - log10(se).floor() as i32).clamp(0, 12) as usize;
            format!("{:.digits$}{off}", energy.mean)
        }
        _ => format!("{}{off}", short(energy.mean)),
    }
}

/// One model against a component of the light in one case.
struct Judged<'a> {
    case: &'a Judgement<'a>,
    model: &'a ModelOutcome,
    component: Component,
    compared: &'a ComparedComponent,
}

/// A line per case and model, for runs of many cases.
fn overview(outcome: &VerifyOutcome) -> String {
    type Row<'a> = Judged<'a>;
    let judged = outcome.cases.iter().flat_map(|case| {
        case.models.iter().flat_map(move |model| {
            let judged = |component, compared| Judged {
                case,
                model,
                component,
                compared,
            };
            // What the medium scattered and what it did not are judged apart.
            let unscattered = Component::Unscattered;
            let apart = model.compared(unscattered);
            std::iter::once(judged(model.judged_component(), model.judged()))
                .chain(apart.map(|compared| judged(unscattered, compared)))
        })
    });
    let judged: Vec<Row<'_>> = judged.collect();
    let multiple = |row: &Row<'_>| {
        let of = |side| {
            row.case.outcome.statistics.means()[outcome
                .plan
                .settings
                .tally
                .flux_entry(side, Component::Multiple)]
        };
        of(Side::Reflected) + of(Side::Transmitted)
    };
    let titles: Vec<String> = outcome
        .cases
        .iter()
        .map(|c| c.outcome.case.label())
        .collect();
    let longest = |texts: &mut dyn Iterator<Item = String>| {
        texts.map(|text| text.chars().count()).max().unwrap_or(0)
    };
    let models = outcome.cases.iter().flat_map(|case| &case.models);
    let names = longest(&mut models.map(|model| model.model.name().to_owned()));
    let light = longest(
        &mut judged
            .iter()
            .map(|row| row.component.short_label().into_owned()),
    );
    let room = TEXT_WIDTH.saturating_sub(names + light + MEASURE_WIDTH);
    let is_long = |title: &String| title.chars().count() > room.min(MAX_CASE_WIDTH);
    // Long titles stand above the table, which refers to them by number.
    let numbered = titles.iter().any(is_long);
    let number = |case: &Judgement<'_>| {
        1 + outcome
            .cases
            .iter()
            .position(|c| std::ptr::eq(c, case))
            .unwrap_or(0)
    };
    let mut out = String::new();
    if numbered {
        for (i, title) in titles.iter().enumerate() {
            let _ = writeln!(out, "{}", wrapped(&format!("case {}: {title}", i + 1)));
        }
        out.push('\n');
    }
    let table = Table::new()
        .column(Column::new("case", "", |row: &Row<'_>| match numbered {
            true => number(row.case).to_string(),
            false => row.case.outcome.case.label(),
        }))
        .column(Column::new("model", "", |row: &Row<'_>| {
            row.model.model.name()
        }))
        .column(Column::new("light", "", |row: &Row<'_>| {
            row.component.short_label().into_owned()
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
        .column(Column::new("multiple flux", "", multiple).format(Format::Fixed(5)))
        .column(Column::new("verdict", "", |row: &Row<'_>| {
            row.compared.verdict.as_ref().map(verdict_name)
        }))
        .keys(3);
    out + &table.text(judged)
}
