//! Paths of single rays of traced surfaces: paths.csv, and their figure over a section of the surface.

use std::borrow::Cow;

use asperity_plot::{Colour, Curve, CurveAxis, Curves, Figure, PlotError, Point, Style};
use asperity_simulate::LightPath;
use asperity_surface::LengthUnit;
use asperity_tally::Component;
use asperity_tracer::PathEnd;

use super::outcome::TraceOutcome;
use crate::output::{Column, Table, unit_of_lengths};
use crate::report::views::Csv;

/// Height of a figure over its width: one length is as long along both axes.
const HEIGHT: f64 = 0.75;

/// A point of a path.
struct PathPoint<'a> {
    number: usize,
    point: usize,
    at: [f64; 3],
    path: &'a LightPath,
}

/// paths.csv: a row per point.
pub(super) fn paths_table<'a>(outcome: &'a TraceOutcome<'_>) -> Option<Csv<'a>> {
    type Row<'a> = PathPoint<'a>;
    let paths = outcome.paths.as_ref()?.paths.iter().enumerate();
    let rows = paths.flat_map(|(number, path)| {
        let points = path.points.iter().enumerate();
        points.map(move |(point, &at)| PathPoint {
            number: number + 1,
            point,
            at,
            path,
        })
    });
    let unit = unit_of_lengths(outcome.outcome.case.at.unit);
    let place = |name, about, axis: usize| {
        Column::new(name, about, move |row: &Row<'_>| row.at[axis]).unit(unit)
    };
    let table = Table::new()
        .column(Column::new(
            "path",
            "number of the path, from 1",
            |row: &Row<'_>| row.number,
        ))
        .column(Column::new(
            "point",
            "0: far before the surface; then interactions; a last one far after it if light leaves",
            |row: &Row<'_>| row.point,
        ))
        .column(place(
            "along",
            "from the middle of the tile in the direction in which the light travels",
            0,
        ))
        .column(place(
            "across",
            "from the plane of incidence, to the left",
            1,
        ))
        .column(place("height", "above the mean plane", 2))
        .column(Column::new(
            "order",
            "interactions of the path with surfaces",
            |row: &Row<'_>| u64::from(row.path.events.order()),
        ))
        .column(Column::new(
            "scatterings",
            "scatterings of the path inside the medium",
            |row: &Row<'_>| u64::from(row.path.scatterings),
        ))
        .column(Column::new(
            "end",
            "what becomes of the path",
            |row: &Row<'_>| end(row.path.end),
        ));
    Some(table.with_rows(rows))
}

const fn end(end: PathEnd) -> &'static str {
    match end {
        PathEnd::Above => "above",
        PathEnd::Below => "below",
        PathEnd::Absorbed => "absorbed",
        PathEnd::Truncated => "truncated",
        PathEnd::LeftPatch => "left patch",
        PathEnd::Lost => "lost",
    }
}

/// The paths in the plane of incidence, by order, or by what the medium did.
pub(super) fn paths_figure(outcome: &TraceOutcome<'_>) -> Result<Option<Figure>, PlotError> {
    let (Some(found), case) = (&outcome.paths, &outcome.outcome.case) else {
        return Ok(None);
    };
    let length = found.section.last().map_or(1.0, |last| 2.0 * last[0]);
    let heights = found.section.iter().map(|[_, height]| *height);
    let (low, high) = heights.fold((0.0, 0.0), |(low, high): (f64, f64), h| {
        (low.min(h), high.max(h))
    });
    let lowest = found.planes.last().copied();
    let (low, high) = (lowest.unwrap_or(low).max(-0.5 * length), high);
    let middle = 0.5 * (low + high);
    let half = 0.5 * HEIGHT * length;
    let unit = match case.at.unit {
        LengthUnit::Arbitrary => String::new(),
        unit => format!(" ({unit})"),
    };
    let line = |points: Vec<[f64; 2]>, name: &str| Curve {
        name: name.to_owned(),
        colour: Colour::Component(0),
        style: Style::Line(0),
        points: points
            .into_iter()
            .map(|[x, y]| Point::exact(x, y))
            .collect(),
    };
    let has_medium = !case.layers.is_empty();
    let mut curves: Vec<Curve> = found
        .paths
        .iter()
        .map(|path| curve(path, has_medium))
        .collect();
    // By order in the legend
    curves.sort_by_key(|curve| match curve.colour {
        Colour::Nth(number) => number,
        _ => usize::MAX,
    });
    curves.push(line(found.section.clone(), "surface"));
    let shown = found.planes.iter().filter(|plane| **plane > middle - half);
    for (number, plane) in shown.enumerate() {
        let ends = [-0.5 * length, 0.5 * length].map(|x| [x, *plane]);
        let name = if number == 0 { "bottom of a layer" } else { "" };
        curves.push(line(ends.to_vec(), name));
    }
    let figure = Curves {
        title: format!("Light paths on {}", outcome.study.first),
        subtitle: case.figure_label(),
        x: CurveAxis {
            label: format!("along the plane of incidence{unit}"),
            range: Some([-0.5 * length, 0.5 * length]),
        },
        y: CurveAxis {
            label: format!("height{unit}"),
            range: Some([middle - half, middle + half]),
        },
        log_from: None,
        curves,
        notes: vec![
            format!(
                "{} rays, seed {}. Both axes have one scale.",
                found.paths.len(),
                outcome.study.settings.seed
            ),
            "The surface is its section by the plane of incidence, at which all rays aim; paths that leave the plane are projected onto it.".to_owned(),
        ],
    };
    figure.draw().map(Some)
}

/// A path, named and coloured by the component of the light that it belongs to.
fn curve(path: &LightPath, has_medium: bool) -> Curve {
    let order = path.events.order();
    let (class, components) = match has_medium {
        true => (path.scatterings.min(2), &Component::MEDIUM[..]),
        false => (order.clamp(1, 4) - 1, &Component::ORDERS[..]),
    };
    let (name, number): (Cow<'static, str>, _) = match path.end {
        PathEnd::Above | PathEnd::Below if order == 0 => ("past the surface".into(), 4),
        PathEnd::Above | PathEnd::Below => {
            let class = class as usize;
            (components[class].label(), class)
        }
        other => (end(other).into(), 5),
    };
    Curve {
        name: name.into_owned(),
        colour: Colour::Nth(number),
        style: Style::Line(0),
        points: path
            .points
            .iter()
            .map(|[x, _, z]| Point::exact(*x, *z))
            .collect(),
    }
}
