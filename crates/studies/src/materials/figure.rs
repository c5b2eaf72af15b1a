//! Figure of optical constants against the wavelength.

use asperity_io::MaterialRecord;
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};

use super::constants::Row;

/// Ratio of the largest to the smallest `k` beyond which a figure has a logarithmic panel.
const DECADES: f64 = 100.0;

/// `n` and `k` over the wavelengths of `rows`, with a logarithmic panel where `k` spans decades.
pub(super) fn figure(record: &MaterialRecord, rows: &[Row]) -> Curves {
    let points = |value: fn(&Row) -> Option<f64>| -> Vec<Point> {
        let rows = rows.iter();
        rows.filter_map(|row| Some(Point::exact(row.wavelength_nm, value(row)?)))
            .collect()
    };
    let [n, k] = [points(|row| Some(row.n)), points(|row| row.k)];
    let positive = || k.iter().map(|point| point.y).filter(|k| *k > 0.0);
    let [least, most] = [positive().reduce(f64::min), positive().reduce(f64::max)];
    let spans_decades = most > least.map(|least| DECADES * least);
    let notes = match k.is_empty() {
        true => vec!["k is unknown.".to_owned()],
        false => Vec::new(),
    };
    let curves = [("n", n), ("k", k)].into_iter().enumerate();
    let curves = curves.filter(|(_, (_, points))| !points.is_empty());
    let axis = |label: &str| CurveAxis {
        label: label.to_owned(),
        range: None,
    };
    Curves {
        title: format!("Optical constants of {}", record.name),
        subtitle: record.cite.clone(),
        x: axis("wavelength (nm)"),
        y: axis("n, k"),
        log_from: least.filter(|_| spans_decades),
        curves: curves
            .map(|(number, (name, points))| Curve {
                name: name.to_owned(),
                colour: Colour::Nth(number),
                style: Style::Line(number),
                points,
            })
            .collect(),
        notes,
    }
}
