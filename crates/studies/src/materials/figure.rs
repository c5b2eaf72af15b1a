//! Figure of optical constants against the wavelength.

use asperity_io::MaterialRecord;
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};

use super::constants::Row;

/// Ratio of the largest to the smallest `k` beyond which a figure has a logarithmic panel.
const DECADES: f64 = 100.0;

/// Wavelengths in nanometres that a figure is restricted to where data go farther.
const SHOWN_NM: [f64; 2] = [150.0, 3000.0];

/// `n` and `k` over the wavelengths of `rows` from ultraviolet to near infrared, with a logarithmic panel where `k` spans decades.
pub(super) fn figure(record: &MaterialRecord, rows: &[Row]) -> Curves {
    let is_shown = |row: &&Row| (SHOWN_NM[0]..=SHOWN_NM[1]).contains(&row.wavelength_nm);
    let shown: Vec<&Row> = rows.iter().filter(is_shown).collect();
    let is_cut = shown.len() < rows.len() && shown.len() > 1;
    // Data of other wavelengths alone are shown whole
    let rows = match shown.len() {
        0 | 1 => rows.iter().collect(),
        _ => shown,
    };
    let points = |value: fn(&Row) -> Option<f64>| -> Vec<Point> {
        rows.iter()
            .filter_map(|row| Some(Point::exact(row.wavelength_nm, value(row)?)))
            .collect()
    };
    let [n, k] = [points(|row| Some(row.n)), points(|row| row.k)];
    let positive = || k.iter().map(|point| point.y).filter(|k| *k > 0.0);
    let [least, most] = [positive().reduce(f64::min), positive().reduce(f64::max)];
    let spans_decades = most > least.map(|least| DECADES * least);
    let mut notes = Vec::new();
    if k.is_empty() {
        notes.push("k is unknown.".to_owned());
    }
    if is_cut {
        let [first, last] = SHOWN_NM;
        notes.push(format!("Data reach beyond {first} to {last} nm."));
    }
    let label = if k.is_empty() { "n" } else { "n, k" };
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
        y: axis(label),
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
