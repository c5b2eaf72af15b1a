//! Roughness parameters of a surface as text.

use asperity_simulate::short;
use asperity_surface::{LengthUnit, Roughness, SplineRoughness, SteepestFacet, Triangle};
use asperity_synthesis::{Compared, Gradients, Realisation, SteeperThan};

use super::structure::structure_table;
use crate::output::{Column, Table, beside};

/// A parameter with its value and convention.
pub(super) struct Parameter {
    name: &'static str,
    value: String,
    meaning: String,
}

impl Parameter {
    pub(super) fn new(name: &'static str, value: String, meaning: impl Into<String>) -> Self {
        Self {
            name,
            value,
            meaning: meaning.into(),
        }
    }
}

/// Columns of parameters with their values and conventions.
pub(super) fn parameter_table() -> Table<'static, Parameter> {
    Table::new()
        .column(Column::new("parameter", "", |row: &Parameter| row.name))
        .column(Column::new("value", "", |row: &Parameter| {
            row.value.clone()
        }))
        .column(Column::new("meaning", "", |row: &Parameter| {
            row.meaning.clone()
        }))
}

/// A number; `-` for one that is unknown.
pub(super) fn number(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), short)
}

/// Values along x and y.
fn pair([x, y]: [Option<f64>; 2]) -> String {
    format!("{}, {}", number(x), number(y))
}

/// The unit behind a length, with a blank before it; nothing for arbitrary units.
fn suffix(unit: LengthUnit) -> String {
    match unit {
        LengthUnit::Arbitrary => String::new(),
        _ => format!(" {unit}"),
    }
}

/// The grid, and all parameters of a surface with their conventions.
pub(crate) fn roughness_table(r: &Roughness) -> String {
    let [ny, nx] = r.shape;
    let [dx, dy] = r.spacing.map(short);
    let [x, y] = r.extent.map(short);
    let u = suffix(r.unit);
    let rows = heights(r).into_iter().chain(slopes(r)).chain(lengths(r));
    format!(
        "{nx} x {ny} samples, spacing {dx} x {dy}{u}, tile {x} x {y}{u}, {} border\n{}",
        r.border,
        parameter_table().folded_text(rows.chain([steepest(&r.steepest)]))
    )
}

/// A mean height, beside the root mean square.
fn mean(r: &Roughness, mean: f64, sq: f64) -> String {
    format!("{}{}", beside(mean, sq), suffix(r.unit))
}

/// Mean slopes, beside the root mean square gradient.
fn slope_mean(mean: [f64; 2], sdq: f64) -> String {
    let [x, y] = mean.map(|slope| beside(slope, sdq));
    format!("{x}, {y}")
}

/// Parameters of heights.
fn heights(r: &Roughness) -> [Parameter; 8] {
    let length = |value| format!("{}{}", short(value), suffix(r.unit));
    let row = Parameter::new;
    [
        row("mean", mean(r, r.mean, r.sq), "mean height, left out below"),
        row("Sq", length(r.sq), "root mean square height, sigma"),
        row("Sa", length(r.sa), "mean absolute height"),
        row("Sp", length(r.sp), "highest peak above the mean"),
        row("Sv", length(r.sv), "depth of the lowest valley"),
        row("Sz", length(r.sz), "highest peak to lowest valley"),
        row("Ssk", number(r.ssk), "skewness; 0 if Gaussian"),
        row("Sku", number(r.sku), "kurtosis; 3 if Gaussian"),
    ]
}

/// Parameters of the slopes of the mesh.
fn slopes(r: &Roughness) -> [Parameter; 3] {
    let values = |of: [f64; 2]| pair(of.map(Some));
    let row = Parameter::new;
    [
        row("Sdq", short(r.sdq), "root mean square gradient"),
        row(
            "slope mean x, y",
            slope_mean(r.slope_mean, r.sdq),
            "tilt; see --remove plane",
        ),
        row(
            "slope variance x, y",
            values(r.slope_variance),
            "about the mean slope",
        ),
    ]
}

/// Correlation lengths, and the smoothness that goes with them.
fn lengths(r: &Roughness) -> [Parameter; 4] {
    let lengths = |of| format!("{}{}", pair(of), suffix(r.unit));
    let row = Parameter::new;
    [
        row(
            "tau x, y",
            lengths([r.tau_x, r.tau_y]),
            "correlation exp(-r^2 / tau^2)",
        ),
        row(
            "l x, y",
            lengths([r.l_x, r.l_y]),
            "correlation exp(-r^2 / (2 l^2))",
        ),
        row(
            "equivalent tau x, y",
            lengths([r.equivalent_tau_x, r.equivalent_tau_y]),
            "sqrt 2 Sq / root mean square slope",
        ),
        row(
            "equivalent s",
            number(r.equivalent_smoothness),
            "smoothness tau / sigma = 2 / Sdq",
        ),
    ]
}

fn steepest(facet: &SteepestFacet) -> Parameter {
    let half = match facet.triangle {
        Triangle::Lower => "lower",
        Triangle::Upper => "upper",
    };
    Parameter::new(
        "steepest facet",
        format!("{} ({:.2} deg)", short(facet.slope), facet.angle_degrees),
        format!("cell {}, {}, {half} triangle", facet.ix, facet.iy),
    )
}

/// A parameter of the samples and facets, and of the smooth surface.
struct Both {
    name: &'static str,
    facets: String,
    smooth: String,
}

/// Parameters of the facets, `r`, next to those of the smooth surface through the same heights.
pub(crate) fn smooth_table(r: &Roughness, smooth: &SplineRoughness) -> String {
    let u = suffix(r.unit);
    let row = |name, [facets, smooth]: [String; 2]| Both {
        name,
        facets,
        smooth,
    };
    let length = |value| format!("{}{u}", short(value));
    let lengths = |of| format!("{}{u}", pair(of));
    let slopes = |of: [f64; 2]| pair(of.map(Some));
    let facet_tau = [r.equivalent_tau_x, r.equivalent_tau_y];
    let rows = [
        row(
            "mean",
            [mean(r, r.mean, r.sq), mean(r, smooth.mean, smooth.sq)],
        ),
        row("Sq", [r.sq, smooth.sq].map(length)),
        row("Sdq", [r.sdq, smooth.sdq].map(short)),
        row(
            "slope mean x, y",
            [
                slope_mean(r.slope_mean, r.sdq),
                slope_mean(smooth.slope_mean, smooth.sdq),
            ],
        ),
        row(
            "slope variance x, y",
            [r.slope_variance, smooth.slope_variance].map(slopes),
        ),
        row(
            "equivalent tau x, y",
            [facet_tau, smooth.equivalent_tau].map(lengths),
        ),
        row(
            "equivalent s",
            [r.equivalent_smoothness, smooth.equivalent_smoothness].map(number),
        ),
    ];
    Table::new()
        .column(Column::new("parameter", "", |row: &Both| row.name))
        .column(Column::new("samples, flat cells", "", |row: &Both| {
            row.facets.clone()
        }))
        .column(Column::new("smooth cells", "", |row: &Both| {
            row.smooth.clone()
        }))
        .text(rows)
}

/// A statistic of a generated surface.
struct Statistic<'a> {
    name: String,
    compared: &'a Compared,
}

/// Requested statistics next to those of this realisation, in `unit`; empty for a surface that was not generated. `lines`: rows and columns that
/// tell the correlation lengths, where these are not all.
pub(crate) fn realisation_table(
    realisation: Option<&Realisation>,
    unit: LengthUnit,
    lines: [Option<usize>; 2],
) -> String {
    type Row<'a> = Statistic<'a>;
    let realised = match realisation {
        None => return String::new(),
        Some(Realisation::Structured(structure)) => return structure_table(structure, unit),
        Some(Realisation::Random(realised)) => realised,
    };
    let length = |name: &str| match unit {
        LengthUnit::Arbitrary => name.to_owned(),
        unit => format!("{name} in {unit}"),
    };
    let [tau_x, tau_y] = [0, 1].map(|axis| {
        let (axis_name, lines_name) = [("x", "rows"), ("y", "columns")][axis];
        let of_lines = lines[axis].map(|count| format!(", {count} {lines_name}"));
        length(&format!("tau {axis_name}")) + &of_lines.unwrap_or_default()
    });
    let row = |name, compared| Statistic { name, compared };
    let mut rows = vec![
        row(length("sigma"), &realised.sigma),
        row(tau_x, &realised.tau_x),
        row(tau_y, &realised.tau_y),
        row("slope variance x".to_owned(), &realised.slope_variance_x),
        row("slope variance y".to_owned(), &realised.slope_variance_y),
    ];
    let heights = [
        ("skewness", &realised.skewness),
        ("kurtosis", &realised.kurtosis),
    ];
    for (name, compared) in heights {
        rows.extend(
            compared
                .as_ref()
                .map(|compared| row(name.to_owned(), compared)),
        );
    }
    let table = Table::new()
        .column(Column::new("statistic", "", |row: &Row<'_>| {
            row.name.clone()
        }))
        .column(Column::new("requested", "", |row: &Row<'_>| {
            row.compared.requested
        }))
        .column(Column::new("realised", "", |row: &Row<'_>| {
            row.compared.realised
        }))
        .column(Column::new(
            "expected scatter of a surface",
            "",
            |row: &Row<'_>| {
                let scatter = row.compared.expected_deviation?;
                Some(format!("+- {}", short(scatter)))
            },
        ))
        .text(rows);
    let gradients = realised.gradients.as_ref().map(gradient_table);
    table + &gradients.unwrap_or_default()
}

/// Fractions of facets steeper than multiples of GGX's alpha.
fn gradient_table(gradients: &Gradients) -> String {
    let table = Table::new()
        .column(Column::new(
            "gradient over alpha",
            "",
            |row: &SteeperThan| row.gradient,
        ))
        .column(Column::new("steeper, GGX", "", |row: &SteeperThan| {
            row.requested
        }))
        .column(Column::new("facets", "", |row: &SteeperThan| row.realised))
        .text(gradients.steeper.clone());
    let [first, second] = gradients.alpha.map(short);
    let alpha = match first == second {
        true => format!("alpha {first}"),
        false => format!("alpha {first} and {second} along the principal axes"),
    };
    let largest = short(gradients.largest_difference);
    format!("{table}{alpha}; fractions differ by at most {largest}\n")
}
