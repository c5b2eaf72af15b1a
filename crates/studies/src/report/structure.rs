//! Statistics of a structured surface as text.

use asperity_simulate::short;
use asperity_surface::LengthUnit;
use asperity_synthesis::{Expectation, RealisedStructure};

use crate::output::{Column, Table};

/// A statistic of a structured surface.
struct Statistic {
    name: String,
    found: Expectation,
}

/// Expected statistics next to those of this realisation, and what was adjusted so that the structure fits the tile.
pub(super) fn structure_table(structure: &RealisedStructure, unit: LengthUnit) -> String {
    let length = |name: &str| match unit {
        LengthUnit::Arbitrary => name.to_owned(),
        unit => format!("{name} in {unit}"),
    };
    let rows = [
        (length("depth"), structure.depth),
        ("coverage".to_owned(), structure.coverage),
        (
            "mean square slope".to_owned(),
            Some(structure.mean_square_slope),
        ),
        (length("period"), structure.period),
        ("azimuth in deg".to_owned(), structure.azimuth_degrees),
    ];
    let rows = rows
        .into_iter()
        .filter_map(|(name, found)| found.map(|found| Statistic { name, found }));
    let table = Table::new()
        .column(Column::new("statistic", "", |row: &Statistic| {
            row.name.clone()
        }))
        .column(Column::new("expected", "", |row: &Statistic| {
            row.found.expected
        }))
        .column(Column::new("realised", "", |row: &Statistic| {
            Some(row.found.realised)
        }))
        .text(rows);
    let lattice = structure.pitches.map(|pitches| {
        let [x, y] = pitches.map(short);
        format!(
            "lattice with columns {x}{unit} and rows {y}{unit} apart\n",
            unit = unit.suffix()
        )
    });
    let vertical = match structure.has_vertical_edges {
        true => "edges are vertical: the mean square slope of the continuous surface is infinite\n",
        false => "",
    };
    table + &lattice.unwrap_or_default() + vertical
}
