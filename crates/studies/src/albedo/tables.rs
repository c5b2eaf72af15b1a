//! The tables: albedo.csv and mean.csv.

use asperity_simulate::CaseGroup;
use asperity_tally::Side;

use super::means::MeanAlbedo;
use super::outcome::{AlbedoOutcome, AlbedoPoint};
use crate::output::{Column, Table, case_columns};
use crate::report::views::Csv;

const MATERIAL: [CaseGroup; 2] = [CaseGroup::Material, CaseGroup::Other];

/// Name of an albedo in tables, arrays and images: `E_R` or `E_T`.
pub(super) const fn letter(side: Side) -> &'static str {
    match side {
        Side::Reflected => "R",
        Side::Transmitted => "T",
    }
}

/// albedo.csv: a row per point that was found.
pub(super) fn points<'a>(outcome: &'a AlbedoOutcome<'_>) -> Csv<'a> {
    type Row<'a> = AlbedoPoint<'a>;
    let columns = |side: Side| {
        let e = letter(side);
        [
            Column::estimate(
                format!("E_{e}"),
                format!("{side} light of all orders"),
                move |row: &Row<'_>| row.flux(side),
            ),
            Column::new(
                format!("single_{e}"),
                format!("{side} light of single scattering, Smith's model"),
                move |row: &Row<'_>| row.single(side),
            ),
            Column::new(
                format!("ratio_{e}"),
                format!("E_{e} over single_{e}; 1 where there is neither"),
                move |row: &Row<'_>| row.ratio(side),
            ),
        ]
    };
    Table::new()
        .columns(case_columns(
            &outcome.plan.cases,
            &MATERIAL,
            |row: &Row<'_>| row.case,
        ))
        .column(Column::new("alpha", "roughness", |row: &Row<'_>| row.alpha))
        .column(Column::new(
            "cos",
            "cosine of incidence",
            |row: &Row<'_>| row.cos,
        ))
        .columns(Side::BOTH.into_iter().flat_map(columns))
        .with_rows(outcome.points().filter(|point| point.outcome.is_some()))
}

/// Columns of the cosine-weighted means of a side.
pub(super) fn mean_columns<'a>(side: Side) -> [Column<'a, MeanAlbedo<'a>>; 2] {
    type Row<'a> = MeanAlbedo<'a>;
    let e = letter(side);
    [
        Column::estimate(
            format!("mean_E_{e}"),
            format!("{side} light of all orders, 2 int E mu dmu"),
            move |row: &Row<'_>| row.flux(side),
        )
        .heading(format!("E_{e}")),
        Column::new(
            format!("mean_single_{e}"),
            format!("{side} light of single scattering, likewise"),
            move |row: &Row<'_>| row.single(side),
        )
        .heading(format!("single_{e}")),
    ]
}

/// mean.csv: a row per material and roughness.
pub(super) fn means<'a>(outcome: &'a AlbedoOutcome<'_>) -> Csv<'a> {
    type Row<'a> = MeanAlbedo<'a>;
    Table::new()
        .columns(case_columns(
            &outcome.plan.cases,
            &MATERIAL,
            |row: &Row<'_>| row.point.case,
        ))
        .column(Column::new("alpha", "roughness", |row: &Row<'_>| {
            row.point.alpha
        }))
        .columns(Side::BOTH.into_iter().flat_map(mean_columns))
        .with_rows(MeanAlbedo::all(outcome))
}
