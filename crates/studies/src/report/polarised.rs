//! Polarised light: tables of Mueller matrices, or of what averaging s and p changes; the same in summary.json
//! and as text.

use std::fmt::Write;

use asperity_numerics::elementary::atan2;
use asperity_tally::{
    Component, Entry, Estimate, Measure, Polarimetry, Side, TallyResult, TallySpec, TallyStatistics,
};
use serde_json::{Map, Value, json};

use crate::output::{Column, Table, bin_columns, two_digits, with_error, wrapped};
use crate::report::views::Csv;

/// A row of a table of one component: a ring or an in-plane bin.
struct Row {
    side: Side,
    component: Component,
    index: usize,
}

/// All light, then each order, on each side that is recorded.
fn rows(spec: &TallySpec, count: impl Fn(Side) -> usize) -> Vec<Row> {
    let mut rows = Vec::new();
    for side in spec.sides() {
        for component in components() {
            rows.extend((0..count(side)).map(|index| Row {
                side,
                component,
                index,
            }));
        }
    }
    rows
}

/// The components that Mueller matrices are kept of.
fn components() -> impl Iterator<Item = Component> {
    [Component::All].into_iter().chain(Component::ORDERS)
}

/// mueller.csv: a row per bin.
pub(crate) fn mueller_bins(statistics: &TallyStatistics) -> Csv<'_> {
    let spec = statistics.spec();
    let bins = spec.grid_entries(Component::All);
    let table = Table::new().columns(bin_columns(spec.grid(), |bin| *bin));
    with_elements(table, statistics, move |bin| bins.get(*bin)).with_rows(spec.recorded_bins())
}

/// mueller_theta.csv: a row per side, component and ring.
pub(crate) fn mueller_rings(statistics: &TallyStatistics) -> Csv<'_> {
    let spec = statistics.spec();
    let edges = move |row: &Row| spec.ring_filter(row.side).theta_deg(row.index);
    let table = Table::new().columns(row_columns("polar angle", edges));
    let entry = move |row: &Row| spec.ring_entries(row.side, row.component).get(row.index);
    let rows = rows(spec, |side| spec.ring_filter(side).len());
    with_elements(table, statistics, entry).with_rows(rows)
}

/// mueller_in_plane.csv: a row per side, component and bin of the in-plane slice.
pub(crate) fn mueller_in_plane(statistics: &TallyStatistics) -> Csv<'_> {
    let spec = statistics.spec();
    let edges = move |row: &Row| spec.in_plane_filter(row.side).theta_deg(row.index);
    let table = Table::new().columns(row_columns("signed polar angle", edges));
    let entry = move |row: &Row| {
        let entries = spec.in_plane_entries(row.side, row.component);
        entries.get(row.index)
    };
    let rows = rows(spec, |side| spec.in_plane_filter(side).len());
    with_elements(table, statistics, entry).with_rows(rows)
}

/// Side, component and the edges of a row.
fn row_columns<'a>(
    about: &'static str,
    edges: impl Fn(&Row) -> [f64; 2] + Copy + 'a,
) -> [Column<'a, Row>; 4] {
    [
        Column::new("side", "side on which light leaves", |row: &Row| {
            row.side.to_string()
        }),
        Column::new(
            "component",
            "all light, or that of an order",
            |row: &Row| row.component.to_string(),
        ),
        Column::new("theta_min_deg", about, move |row: &Row| edges(row)[0]).unit("deg"),
        Column::new("theta_max_deg", about, move |row: &Row| edges(row)[1]).unit("deg"),
    ]
}

/// Adds the flux, the elements of the Mueller matrix over it, and what they say of unpolarised light.
fn with_elements<'a, R: 'a>(
    table: Table<'a, R>,
    statistics: &'a TallyStatistics,
    entry: impl Fn(&R) -> Entry + Copy + 'a,
) -> Table<'a, R> {
    let flux = move |row: &R| Some(statistics.at(entry(row)));
    let elements = elements().map(move |[row, column]| {
        let name = format!("m{row}{column}");
        let about = "element of the Mueller matrix over the flux, its first element; empty where the flux has the error of fewer than 20 rays";
        let measure = Measure::Element { row, column };
        Column::estimate(name, about, move |place: &R| {
            statistics.over_flux(entry(place), measure)
        })
    });
    table
        .column(Column::estimate("flux", "flux of unpolarised light", flux))
        .columns(elements)
        .column(Column::estimate(
            "degree_of_polarisation",
            "of what leaves where unpolarised light falls",
            move |row: &R| Polarised::of(statistics, entry(row)).map(|p| p.degree()),
        ))
        .column(
            Column::estimate(
                "angle_of_polarisation_deg",
                "of its linear part, from s towards p",
                move |row: &R| Polarised::of(statistics, entry(row))?.angle_deg(),
            )
            .unit("deg"),
        )
}

/// Row and column of each element but the first.
pub(crate) fn elements() -> impl Iterator<Item = [usize; 2]> {
    (1..16).map(|i| [i / 4, i % 4])
}

/// Q, U and V over I of light that leaves where unpolarised light falls.
struct Polarised([Estimate; 3]);

impl Polarised {
    /// `None` where nothing has arrived.
    fn of(statistics: &TallyStatistics, flux: Entry) -> Option<Self> {
        let over = |row| statistics.over_flux(flux, Measure::Element { row, column: 0 });
        Some(Self([over(1)?, over(2)?, over(3)?]))
    }

    /// Degree of polarisation, with its error by those of the parts.
    fn degree(&self) -> Estimate {
        let degree = length(&self.0.map(|part| part.mean));
        let parts = self.0.map(|part| Some(part.mean * part.se?));
        let se = all(parts).map(|parts| length(&parts) / degree);
        Estimate {
            mean: degree,
            se: se.filter(|_| degree > 0.0),
        }
    }

    /// Angle of the linear part from s towards p, degrees in (-90, 90]; `None` without a linear part.
    fn angle_deg(&self) -> Option<Estimate> {
        let [q, u, _] = self.0;
        if q.mean == 0.0 && u.mean == 0.0 {
            return None;
        }
        let across = all([u.se.map(|se| q.mean * se), q.se.map(|se| u.mean * se)]);
        let square = q.mean * q.mean + u.mean * u.mean;
        Some(Estimate {
            mean: 0.5 * atan2(u.mean, q.mean).to_degrees(),
            se: across.map(|parts| (0.5 * length(&parts) / square).to_degrees()),
        })
    }
}

/// All numbers, if each is known.
fn all<const N: usize>(parts: [Option<f64>; N]) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = part?;
    }
    Some(numbers)
}

/// Root of the sum of squares.
fn length(parts: &[f64]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Entry of summary.json on polarised light: a key and its value.
pub(crate) fn polarised_json(statistics: &TallyStatistics) -> Option<(&'static str, Value)> {
    let spec = statistics.spec();
    let by_side = |of: &dyn Fn(Entry) -> Value| {
        let sides = spec.sides().map(|side| {
            let flux = |component| spec.flux_entry(side, component);
            let mut value = of(flux(Component::All));
            if value.is_null() {
                return (side.to_string(), value);
            }
            value["orders"] = Component::ORDERS
                .into_iter()
                .map(|component| (component.name().into_owned(), of(flux(component))))
                .collect::<Map<_, _>>()
                .into();
            (side.to_string(), value)
        });
        Value::Object(sides.collect())
    };
    match spec.polarimetry() {
        Polarimetry::Nothing => None,
        Polarimetry::Averaging => {
            let measure = Measure::Averaging;
            let of = |flux| match spec.measure_entry(flux, measure) {
                Some(entry) => json!(statistics.at(entry)),
                None => Value::Null,
            };
            Some(("tracked_less_averaged", by_side(&of)))
        }
        Polarimetry::Mueller => Some(("mueller", by_side(&|flux| matrix_json(statistics, flux)))),
    }
}

/// A Mueller matrix, null where no light leaves, as `mean` and `se`, and over its first element as `normalised` and `normalised_se`, which are
/// null for fewer than 20 rays.
fn matrix_json(statistics: &TallyStatistics, flux: Entry) -> Value {
    let spec = statistics.spec();
    let element = |row, column| {
        let entry = spec.measure_entry(flux, Measure::Element { row, column });
        entry.map(|entry| statistics.at(entry))
    };
    let over = |row, column| statistics.over_flux(flux, Measure::Element { row, column });
    if element(0, 0).is_none_or(|first| first.mean == 0.0) {
        return Value::Null;
    }
    let is_known = over(0, 0).is_some();
    let matrix = |of: &dyn Fn(usize, usize) -> Option<f64>| {
        let rows = (0..4).map(|row| (0..4).map(|column| of(row, column)).collect::<Vec<_>>());
        json!(rows.collect::<Vec<_>>())
    };
    json!({
        "mean": matrix(&|row, column| Some(element(row, column)?.mean)),
        "se": matrix(&|row, column| element(row, column)?.se),
        "normalised": is_known.then(|| matrix(&|row, column| Some(over(row, column)?.mean))),
        "normalised_se": is_known.then(|| matrix(&|row, column| over(row, column)?.se)),
    })
}

/// Lines on polarised light: by how much averaging differs, or the matrices of all light; empty if nothing is kept.
pub(crate) fn polarised_text(statistics: &TallyStatistics) -> String {
    let spec = statistics.spec();
    let mut out = String::new();
    for side in spec.sides() {
        let flux = spec.flux_entry(side, Component::All);
        match spec.polarimetry() {
            Polarimetry::Nothing => {}
            Polarimetry::Averaging => {
                if let Some(entry) = spec.measure_entry(flux, Measure::Averaging) {
                    let difference = with_error(statistics.at(entry));
                    let _ = writeln!(out, "{side}, tracked less averaged: {difference}");
                }
            }
            Polarimetry::Mueller => matrix_text(&mut out, statistics, side),
        }
    }
    if spec.polarimetry() == Polarimetry::Averaging {
        let about = "tracked less averaged: what polarisation changes against averaging s and p at every interface";
        let _ = writeln!(out, "{}", wrapped(about));
    }
    out
}

/// The matrix of all light of a side over the flux, four lines; nothing where no light leaves.
fn matrix_text(out: &mut String, statistics: &TallyStatistics, side: Side) {
    let flux = statistics.spec().flux_entry(side, Component::All);
    let over = |row, column| statistics.over_flux(flux, Measure::Element { row, column });
    if over(0, 0).is_none() {
        return;
    }
    let errors = elements().filter_map(|[row, column]| over(row, column)?.se);
    let largest = two_digits(errors.fold(0.0, f64::max));
    let _ = writeln!(
        out,
        "{side}, Mueller matrix over the flux, errors up to {largest}:"
    );
    for row in 0..4 {
        let numbers = (0..4).filter_map(|column| over(row, column));
        let numbers = numbers.map(|element| format!("{:>10.5}", element.mean));
        let _ = writeln!(out, "{}", numbers.collect::<String>());
    }
    if let Some(polarised) = Polarised::of(statistics, flux) {
        let degree = with_error(polarised.degree());
        let _ = writeln!(
            out,
            "{side}, degree of polarisation of unpolarised light: {degree}"
        );
    }
}
