//! Roughness statistics as text.

use std::fmt::Write;
use std::path::Path;

use asperity_surface::{Compared, LengthUnit, Roughness, Triangle};

use crate::input::Input;

/// A number of six significant digits.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if (-4.0..6.0).contains(&magnitude) {
        let digits = (5.0 - magnitude).max(0.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.5e}")
    }
}

fn optional(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), number)
}

/// The unit behind a length, with a blank before it; nothing for arbitrary units.
fn suffix(unit: LengthUnit) -> String {
    match unit {
        LengthUnit::Arbitrary => String::new(),
        _ => format!(" {unit}"),
    }
}

/// All parameters of a surface, with their names and conventions.
pub(crate) fn roughness_table(path: &Path, input: &Input, r: &Roughness) -> String {
    let u = suffix(r.unit);
    let [ny, nx] = r.shape;
    let [dx, dy] = r.spacing;
    let [x, y] = r.extent;
    let mut out = format!(
        "{}\n  {nx} x {ny} samples, spacing {} x {}{u}, tile {} x {}{u}, {} border\n",
        path.display(),
        number(dx),
        number(dy),
        number(x),
        number(y),
        r.border,
    );
    let mut row = |name: &str, value: String, meaning: &str| {
        let _ = writeln!(out, "  {name:<22}{value:<28}{meaning}");
    };
    row(
        "mean",
        format!("{}{u}", number(r.mean)),
        "mean height, left out below",
    );
    row(
        "Sq",
        format!("{}{u}", number(r.sq)),
        "root mean square height, sigma",
    );
    row("Sa", format!("{}{u}", number(r.sa)), "mean absolute height");
    row(
        "Sz",
        format!("{}{u}", number(r.sz)),
        "highest peak to lowest valley",
    );
    row("Ssk", optional(r.ssk), "skewness; 0 for a Gaussian surface");
    row("Sku", optional(r.sku), "kurtosis; 3 for a Gaussian surface");
    row(
        "Sdq",
        number(r.sdq),
        "root mean square gradient of the mesh",
    );
    let pair = |[x, y]: [f64; 2]| format!("{}, {}", number(x), number(y));
    row(
        "slope mean x, y",
        pair(r.slope_mean),
        "tilt; remove it with --remove plane",
    );
    row(
        "slope variance x, y",
        pair(r.slope_variance),
        "of the mesh, about the mean slope",
    );
    let both = |x: Option<f64>, y: Option<f64>| format!("{}, {}{u}", optional(x), optional(y));
    row(
        "tau x, y",
        both(r.tau_x, r.tau_y),
        "autocorrelation falls to 1/e: exp(-r^2 / tau^2)",
    );
    row(
        "l x, y",
        both(r.l_x, r.l_y),
        "the same as exp(-r^2 / (2 l^2)): tau / sqrt 2",
    );
    row(
        "equivalent tau x, y",
        both(r.equivalent_tau_x, r.equivalent_tau_y),
        "of a Gaussian surface of this Sq and slope: sqrt 2 Sq / slope",
    );
    row(
        "equivalent s",
        optional(r.equivalent_smoothness),
        "smoothness tau / sigma = 2 / Sdq",
    );
    let steepest = &r.steepest;
    let half = match steepest.triangle {
        Triangle::Lower => "lower",
        Triangle::Upper => "upper",
    };
    row(
        "steepest facet",
        format!(
            "{} ({:.2} deg)",
            number(steepest.slope),
            steepest.angle_degrees
        ),
        &format!("cell {}, {}, {half} triangle", steepest.ix, steepest.iy),
    );
    out.push_str(&requested_and_realised(r, r.unit));
    for note in &input.notes {
        let _ = writeln!(out, "note: {note}");
    }
    out
}

/// Requested and realised statistics; empty for a surface that was not generated.
pub(crate) fn requested_and_realised(r: &Roughness, unit: LengthUnit) -> String {
    let Some(realised) = &r.realised else {
        return String::new();
    };
    let u = suffix(unit);
    let mut out = format!(
        "  {:<22}{:<16}{:<16}expected scatter of a surface\n",
        "", "requested", "realised"
    );
    let mut row = |name: &str, c: &Compared, u: &str| {
        let scatter = c
            .expected_deviation
            .map_or("-".to_owned(), |d| format!("+- {}", number(d)));
        let _ = writeln!(
            out,
            "  {:<22}{:<16}{:<16}{scatter}",
            format!("{name}{u}"),
            number(c.requested),
            optional(c.realised),
        );
    };
    let of = |u: &str| {
        if u.is_empty() {
            String::new()
        } else {
            format!(" in{u}")
        }
    };
    let lengths = of(&u);
    row("sigma", &realised.sigma, &lengths);
    row("tau x", &realised.tau_x, &lengths);
    row("tau y", &realised.tau_y, &lengths);
    row("slope variance x", &realised.slope_variance_x, "");
    row("slope variance y", &realised.slope_variance_y, "");
    out
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_six_digits() {
        assert_eq!(number(0.0), "0");
        assert_eq!(number(8.123_456_7), "8.12346");
        assert_eq!(number(123_456.7), "123457");
        assert_eq!(number(2.4e-7), "2.40000e-7");
        assert_eq!(number(-0.001_234_567), "-0.00123457");
    }
}
