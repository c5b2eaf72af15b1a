//! The table of a map: map.csv.

use asperity_simulate::{Case, CaseGroup};
use asperity_tally::Side;
use asperity_tracer::Polarisation;

use super::cell::{
    CellModel, CellResults, CellSide, ComparedLight, Judged, JudgedCell, energy_name, peak_name,
};
use super::outcome::MapOutcome;
use crate::comparison::peak::PeakDifference;
use crate::output::{Cell, Column, Table, case_columns};
use crate::report::views::Csv;

/// One model in one cell in one comparison, with its judgement.
struct JudgedModel<'a> {
    case: &'a Case,
    results: &'a CellResults,
    model: &'a CellModel,
    light: ComparedLight,
    judged: JudgedCell,
}

impl JudgedModel<'_> {
    fn side(&self, side: Side) -> Option<&CellSide> {
        let sides = &self.model.distances(self.light).sides;
        sides.iter().find(|of| of.side == side)
    }

    fn peak(&self, side: Side) -> Option<PeakDifference> {
        self.side(side)?.peak
    }
}

/// Each cell, model and comparison that was found.
fn judged<'a>(outcome: &'a MapOutcome<'_>) -> impl Iterator<Item = JudgedModel<'a>> {
    let models = outcome.found().flat_map(|(case, results)| {
        let models = results.models.iter();
        models.map(move |model| (case, results, model))
    });
    models.flat_map(|(case, results, model)| {
        ComparedLight::BOTH.map(|light| JudgedModel {
            case,
            results,
            model,
            light,
            judged: results.judge(model, light, &outcome.config.map),
        })
    })
}

/// map.csv: a row per cell, model and comparison.
pub(super) fn map<'a>(outcome: &'a MapOutcome<'_>) -> Csv<'a> {
    type Row<'a> = JudgedModel<'a>;
    let groups = [
        CaseGroup::Surface,
        CaseGroup::Material,
        CaseGroup::Other,
        CaseGroup::Light,
    ];
    let cases = &outcome.plan.cases;
    let mut table = Table::new()
        .columns(case_columns(cases, &groups, |row: &Row<'_>| row.case))
        .column(Column::new(
            "model",
            "name of the model",
            |row: &Row<'_>| row.model.name.clone(),
        ))
        .column(Column::new(
            "light",
            "own: the light that the model describes; all: all light",
            |row: &Row<'_>| row.light.name(),
        ))
        .column(Column::new(
            "verdict",
            "whether all measures are within their tolerances",
            |row: &Row<'_>| row.judged.verdict.name(),
        ))
        .column(Column::new(
            "decided_by",
            "the measures that decided the verdict",
            |row: &Row<'_>| row.judged.decided_by().join(" "),
        ))
        .column(value(
            "total_variation",
            "total variation distance",
            "total-variation",
        ))
        .columns(range("total_variation", "total-variation"))
        .column(verdict("total_variation_verdict", "total-variation"));
    for side in Side::BOTH {
        table = table
            .columns(energy_columns(side))
            .columns(peak_columns(side));
    }
    if outcome.config.run.polarisation == Polarisation::Both {
        table = table.columns(Side::BOTH.map(averaging_column));
    }
    table
        .column(Column::new("surfaces", "surfaces", |row: &Row<'_>| {
            row.results.surfaces
        }))
        .column(Column::new(
            "rays",
            "rays over all surfaces",
            |row: &Row<'_>| row.results.rays,
        ))
        .column(Column::new(
            "model_rays",
            "rays that the model followed",
            |row: &Row<'_>| Some(row.model.rays).filter(|rays| *rays > 0),
        ))
        .with_rows(judged(outcome))
}

/// Part of the explicit flux of a side that is due to tracking polarisation.
fn averaging_column<'a>(side: Side) -> Column<'a, JudgedModel<'a>> {
    Column::estimate(
        format!("{side}_tracked_less_averaged"),
        "explicit flux less what it would be if s and p were averaged at every interface",
        move |row: &JudgedModel<'_>| Some(row.results.tracked_less_averaged?[side.index()]),
    )
}

/// Energies on one side, and their difference.
fn energy_columns<'a>(side: Side) -> Vec<Column<'a, JudgedModel<'a>>> {
    let measure = energy_name(side);
    let of_side = |name: &str, about, of: fn(&CellSide) -> Option<f64>| {
        measured(format!("{side}_{name}"), about, measure, move |row, _| {
            of(row.side(side)?)
        })
    };
    let mut columns = vec![
        of_side("explicit", "flux on explicit surfaces", |of| {
            Some(of.explicit)
        }),
        of_side("model", "flux that the model expects", |of| Some(of.model)),
        value(format!("{side}_difference"), "explicit less model", measure),
        of_side("difference_se", "its standard error", |of| of.difference_se),
    ];
    columns.extend(range(&format!("{side}_difference"), measure));
    columns.push(verdict(format!("{side}_verdict"), measure));
    columns
}

/// Directions of the peaks on one side, and their difference.
fn peak_columns<'a>(side: Side) -> Vec<Column<'a, JudgedModel<'a>>> {
    let measure = peak_name(side);
    let of_peak = |name: &str, about, of: fn(PeakDifference) -> Option<f64>| {
        let name = format!("{side}_{name}");
        measured(name, about, measure, move |row, _| of(row.peak(side)?)).unit("deg")
    };
    let difference = format!("{side}_peak_difference");
    let mut columns = vec![
        of_peak(
            "peak_explicit_deg",
            "peak direction on explicit surfaces",
            |p| Some(p.explicit_deg),
        ),
        of_peak(
            "peak_model_deg",
            "peak direction that the model expects",
            |p| Some(p.model_deg),
        ),
        value(format!("{difference}_deg"), "explicit less model", measure).unit("deg"),
        of_peak("peak_difference_se_deg", "its standard error", |p| p.se_deg),
    ];
    let bounds = ["low", "high"].into_iter().enumerate();
    columns.extend(
        bounds.map(|(i, end)| bound(format!("{difference}_{end}_deg"), measure, i).unit("deg")),
    );
    columns.push(verdict(format!("{side}_peak_verdict"), measure));
    let half_width = move |row: &JudgedModel<'_>| row.peak(side).map(|peak| peak.half_width_deg);
    let name = format!("{side}_half_width_deg");
    columns.push(
        Column::new(
            name,
            "half width of the lobe at half its height",
            half_width,
        )
        .unit("deg"),
    );
    columns
}

/// A column that is empty where `measure` was not judged.
fn measured<'a, C: Into<Cell>>(
    name: impl Into<String>,
    about: &'static str,
    measure: &'static str,
    value: impl Fn(&JudgedModel<'_>, &Judged) -> Option<C> + 'a,
) -> Column<'a, JudgedModel<'a>> {
    let value = move |row: &JudgedModel<'a>| value(row, row.judged.measure(measure)?);
    Column::new(name.into(), about, value)
}

/// The value of a measure.
fn value<'a>(
    name: impl Into<String>,
    about: &'static str,
    measure: &'static str,
) -> Column<'a, JudgedModel<'a>> {
    measured(name, about, measure, |_, judged| {
        Some(judged.interval.value)
    })
}

/// The ends of the interval of a measure.
fn range<'a>(name: &str, measure: &'static str) -> [Column<'a, JudgedModel<'a>>; 2] {
    let ends = [("low", 0), ("high", 1)];
    ends.map(|(end, i)| bound(format!("{name}_{end}"), measure, i))
}

/// One end of the interval of a measure.
fn bound<'a>(name: String, measure: &'static str, end: usize) -> Column<'a, JudgedModel<'a>> {
    let about = "end of its 95 % confidence interval";
    measured(name, about, measure, move |_, judged| {
        Some(judged.interval.range?[end])
    })
}

/// The verdict on a measure.
fn verdict<'a>(name: impl Into<String>, measure: &'static str) -> Column<'a, JudgedModel<'a>> {
    let about = "whether it is within its tolerance";
    measured(name, about, measure, |_, judged| {
        Some(judged.verdict.name())
    })
}
