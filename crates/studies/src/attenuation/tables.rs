//! The tables of geometric attenuation, and the report that shows them.

use crate::output::unit_of_lengths;
use asperity_surface::LengthUnit;
use std::fmt::Write;

use asperity_simulate::{Cells, counted, short};
use asperity_tally::Estimate;

use super::{AttenuationOutcome, AttenuationRow, Demarcation, VisibilityRow};
use crate::output::{Column, Format, Support, Supported, Table, wrapped};

/// A column of angles in degrees.
fn angle<'a, R: 'a>(name: &'a str, about: &'static str, value: fn(&R) -> f64) -> Column<'a, R> {
    Column::new(name, about, value).unit("deg")
}

/// A column of measured fractions of points, and what they rest on where all points agree.
fn supported<'a, R: 'a>(
    name: &'a str,
    about: &'static str,
    support: impl Fn(&R) -> Support + 'a,
    value: impl Fn(&R) -> Option<Estimate> + 'a,
) -> Column<'a, R> {
    Column::estimate(name, about, move |row| {
        Some(Supported::new(value(row)?, support(row)))
    })
}

/// A column of measured numbers.
fn fraction<'a, R: 'a>(
    name: &'a str,
    about: &'static str,
    value: impl Fn(&R) -> Estimate + 'a,
) -> Column<'a, R> {
    Column::estimate(name, about, move |row| Some(value(row)))
}

/// A column of what a theory expects.
fn theory<'a, R: 'a>(name: &'a str, about: &'static str, value: fn(&R) -> f64) -> Column<'a, R> {
    Column::new(name, about, value).format(Format::Fixed(4))
}

/// attenuation.csv: a row per sigma, light and view. `independent`: independent points over all surfaces.
pub(super) fn attenuation(unit: LengthUnit, independent: f64) -> Table<'static, AttenuationRow> {
    type Row = AttenuationRow;
    // From straight above nothing is hidden.
    let unless = move |is_proven: bool| match is_proven {
        true => Support::Proven,
        false => Support::Samples(independent),
    };
    let of_light = move |row: &Row| unless(row.theta == 0.0);
    let of_view = move |row: &Row| unless(row.view_theta == 0.0);
    let of_both = move |row: &Row| unless(row.theta == 0.0 && row.view_theta == 0.0);
    let less = |fraction: Estimate, smith: f64| Estimate {
        mean: fraction.mean - smith,
        ..fraction
    };
    Table::new()
        .column(sigma_column(unit, |row: &Row| row.sigma))
        .column(angle("theta", "polar angle of the light", |row: &Row| row.theta))
        .column(angle("phi", "azimuth of the light", |row: &Row| row.phi))
        .column(angle("view_theta", "polar angle of the eye", |row: &Row| row.view_theta))
        .column(angle("view_phi", "azimuth of the eye", |row: &Row| row.view_phi))
        .column(supported("lit", "fraction of all points that are lit", of_light, |row: &Row| Some(row.lit)))
        .column(supported("g1", "fraction of the points facing the light that are lit", of_light, |row: &Row| Some(row.g1)).heading("g1 (facing)"))
        .column(supported("g1_projected", "g1 weighted by the areas projected towards the light: Smith's G1", of_light, |row: &Row| Some(row.g1_projected)))
        .column(fraction("lit_projected", "projected area of the lit points over that of the mean plane", |row: &Row| row.lit_projected))
        .column(theory("smith_lit", "lit, by Smith", |row: &Row| row.smith_lit).heading("Smith lit"))
        .column(theory("smith_g1", "g1, by Smith: 1 / (1 + Lambda)", |row: &Row| row.smith_g1).heading("Smith g1"))
        .column(theory("smith_lit_as_printed", "lit, by Smith's formula as the 2019 paper prints it", |row: &Row| row.smith_lit_as_printed).heading("as printed"))
        .column(theory("v_cavity_lit", "lit, of V-cavities", |row: &Row| row.v_cavity_lit).heading("V-cavity lit"))
        .column(theory("v_cavity_g1", "g1, of V-cavities", |row: &Row| row.v_cavity_g1).heading("V-cavity g1"))
        .column(supported("local_shadow", "fraction of all points that face away from the light", of_light, |row: &Row| Some(row.local_shadow)))
        .column(supported("distant_shadow", "fraction of all points that face the light and are shadowed", of_light, |row: &Row| Some(row.distant_shadow)))
        .column(supported("local_mask", "fraction of all points that face away from the eye", of_view, |row: &Row| Some(row.local_mask)))
        .column(supported("distant_mask", "fraction of all points that face the eye and are masked", of_view, |row: &Row| Some(row.distant_mask)))
        .column(supported("g1_view", "fraction of the points facing the eye that are visible", of_view, |row: &Row| Some(row.g1_view)))
        .column(supported("g2", "fraction of the points facing both that are lit and visible", of_both, |row: &Row| Some(row.g2)).heading("g2 (facing both)"))
        .column(theory("smith_separable_g2", "g2, by Smith: G1(wi) G1(wo)", |row: &Row| row.smith_separable_g2).heading("separable"))
        .column(theory("smith_correlated_g2", "g2, by Smith: 1 / (1 + Lambda(wi) + Lambda(wo))", |row: &Row| row.smith_correlated_g2).heading("Smith correlated"))
        .column(theory("v_cavity_g2", "g2, of V-cavities", |row: &Row| row.v_cavity_g2).heading("V-cavity"))
        .column(supported("paper_g2", "fraction of the samples of the grid that are lit and visible: 1 - N_s / N of the 2019 paper", of_both, |row: &Row| Some(row.paper_g2)))
        .column(supported("mirror_g2", "fraction of all points that are lit and whose mirrored ray escapes", move |_: &Row| unless(false), |row: &Row| row.mirror_g2))
        .column(fraction("g1_less_smith", "g1 less smith_g1", move |row: &Row| less(row.g1, row.smith_g1)))
        .column(fraction("lit_less_smith", "lit less smith_lit", move |row: &Row| less(row.lit, row.smith_lit)))
}

/// demarcation.csv: a row per sigma.
pub(super) fn demarcation(unit: LengthUnit) -> Table<'static, Demarcation> {
    type Row = Demarcation;
    let paper = "the demarcation angle of the 2019 paper";
    Table::new()
        .column(sigma_column(unit, |row: &Row| row.sigma))
        .columns(first_point_columns())
        .columns(one_percent_columns())
        .column(expected_angle("paper", paper, |row| row.paper).heading("2019 paper"))
}

/// The column `sigma`.
fn sigma_column<'a, R: 'a>(unit: LengthUnit, sigma: fn(&R) -> f64) -> Column<'a, R> {
    let heading = match unit {
        LengthUnit::Arbitrary => "sigma".to_owned(),
        unit => format!("sigma ({unit})"),
    };
    Column::new("sigma", "root mean square height", sigma)
        .unit(unit_of_lengths(unit))
        .heading(heading)
}

/// A column of measured polar angles.
fn measured_angle(
    name: &'static str,
    about: &'static str,
    value: fn(&Demarcation) -> Option<Estimate>,
) -> Column<'static, Demarcation> {
    Column::estimate(name, about, value).unit("deg")
}

/// A column of polar angles that a theory expects.
fn expected_angle(
    name: &'static str,
    about: &'static str,
    value: fn(&Demarcation) -> Option<f64>,
) -> Column<'static, Demarcation> {
    let column = Column::new(name, about, value).unit("deg");
    column.format(Format::Fixed(2))
}

/// Where the first point is dark, and where the first one is shadowed.
fn first_point_columns() -> [Column<'static, Demarcation>; 3] {
    type Row = Demarcation;
    let dark = "polar angle of the light at which the first point is dark";
    let scaled = "its cotangent over the root mean square slope";
    let shadowed = "polar angle at which the first point that faces the light is dark";
    [
        measured_angle("first_dark", dark, |row| Some(row.first_dark)).heading("first dark"),
        fraction("first_dark_scaled", scaled, |row: &Row| {
            row.first_dark_scaled
        })
        .heading("cot / slope rms"),
        measured_angle("first_shadowed", shadowed, |row| row.first_shadowed)
            .heading("first shadowed"),
    ]
}

/// Where 1 % of all points are dark, and where 1 % are shadowed, next to Smith's expectations.
fn one_percent_columns() -> [Column<'static, Demarcation>; 4] {
    let dark = "polar angle at which 1 % of all points are dark";
    let smith_dark = "one_percent_dark, by Smith";
    let shadowed = "polar angle at which 1 % of all points face the light and are dark";
    let smith_shadowed = "one_percent_shadowed, by Smith";
    [
        measured_angle("one_percent_dark", dark, |row| row.one_percent_dark).heading("1 % dark"),
        expected_angle("smith_one_percent_dark", smith_dark, |row| {
            row.smith_one_percent_dark
        })
        .heading("Smith"),
        measured_angle("one_percent_shadowed", shadowed, |row| {
            row.one_percent_shadowed
        })
        .heading("1 % shadowed"),
        expected_angle("smith_one_percent_shadowed", smith_shadowed, |row| {
            row.smith_one_percent_shadowed
        })
        .heading("Smith"),
    ]
}

/// visibility.csv: a row per sigma, light and height. `independent`: independent points over all surfaces.
pub(super) fn visibility(unit: LengthUnit, independent: f64) -> Table<'static, VisibilityRow> {
    type Row = VisibilityRow;
    let support = move |row: &Row| match row.theta {
        0.0 => Support::Proven,
        _ => Support::Samples(independent.min(row.points).max(1.0)),
    };
    Table::new()
        .column(sigma_column(unit, |row: &Row| row.sigma))
        .column(angle("theta", "polar angle of the light", |row: &Row| {
            row.theta
        }))
        .column(
            theory(
                "x",
                "tan(theta) / s, the only parameter of the models",
                |row: &Row| row.x,
            )
            .heading("tan(theta) / s"),
        )
        .column(
            Column::new("height_min", "lowest height", |row: &Row| row.height_min).unit("sigma"),
        )
        .column(
            Column::new("height_max", "highest height", |row: &Row| row.height_max).unit("sigma"),
        )
        .column(Column::new(
            "points",
            "points of that height that face the light, per surface",
            |row: &Row| row.points,
        ))
        .column(
            supported(
                "visibility",
                "fraction of these points that are lit",
                support,
                |row: &Row| row.visibility,
            )
            .heading("explicit"),
        )
        .column(theory("smith", "the same, by Smith", |row: &Row| row.smith).heading("Smith"))
        .column(
            Column::new(
                "xu_sun",
                "the same, by Eq. 24 of Xu and Sun, at height zero",
                |row: &Row| row.xu_sun,
            )
            .format(Format::Fixed(4))
            .heading("Xu and Sun, Eq. 24"),
        )
}

/// What was measured, next to theory: report.txt.
#[must_use]
pub fn attenuation_table(outcome: &AttenuationOutcome) -> String {
    let surface = &outcome.config.surface;
    let work = &outcome.work;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "tau {}{}, {} of {} points, {} border, by {}; fractions of points, not of projected areas",
        short(surface.tau.0),
        surface.unit.suffix(),
        counted(work.realisations, "surface"),
        work.points,
        surface.border,
        work.method,
    );
    let _ = writeln!(
        out,
        "paper_g2: fraction of the samples of the grid, {} per surface",
        work.samples,
    );
    let _ = match surface.cells.of_random() {
        Cells::Flat => writeln!(
            out,
            "errors from the scatter between surfaces; the slope variance of the mesh is {:.2} % below that of the continuous surface\n",
            100.0 * outcome.mesh_slope_deficit,
        ),
        Cells::Smooth => writeln!(
            out,
            "errors from the scatter between surfaces; cells are smooth, with the slope variance of the continuous surface\n",
        ),
    };
    let unit = outcome.config.surface.unit;
    out.push_str(&fractions(outcome));
    if !outcome.demarcation.is_empty() {
        let table = demarcation(unit).text(&outcome.demarcation);
        let _ = write!(
            out,
            "\npolar angle at which shadow begins, degrees\n{table}"
        );
    }
    if !outcome.visibility.is_empty() {
        // Eq. 24 is for heights about zero alone.
        let about_zero = outcome.visibility.iter().filter(|row| row.xu_sun.is_some());
        let columns = ["sigma", "theta", "x", "visibility", "smith", "xu_sun"];
        let table = visibility(unit, outcome.independent_points)
            .select(&columns)
            .text(about_zero);
        let _ = write!(
            out,
            "\nvisibility of the points at height zero that face the light\n{table}"
        );
    }
    for warning in outcome.warnings() {
        let _ = writeln!(out, "warning: {warning}");
    }
    wrapped(&out)
}

/// The fractions by light, and by light and view where a view is not vertical.
fn fractions(outcome: &AttenuationOutcome) -> String {
    let unit = outcome.config.surface.unit;
    let slanted = outcome.rows.iter().any(|row| row.view_theta > 0.0);
    // What depends on the light alone is the same for each view.
    let first_view = outcome.rows.first().map(|row| row.view_theta);
    let of_first_view = outcome
        .rows
        .iter()
        .filter(|row| Some(row.view_theta) == first_view);
    let mut columns = vec![
        "sigma",
        "theta",
        "lit",
        "smith_lit",
        "v_cavity_lit",
        "smith_lit_as_printed",
        "g1",
        "smith_g1",
        "v_cavity_g1",
        "mirror_g2",
    ];
    if !slanted {
        columns.push("paper_g2");
    }
    let mut out = attenuation(unit, outcome.independent_points)
        .select(&columns)
        .keys(2)
        .text(of_first_view);
    if slanted {
        let columns = [
            "sigma",
            "theta",
            "phi",
            "view_theta",
            "view_phi",
            "g2",
            "smith_correlated_g2",
            "smith_separable_g2",
            "v_cavity_g2",
            "paper_g2",
        ];
        let by_view = attenuation(unit, outcome.independent_points)
            .select(&columns)
            .keys(5)
            .text(&outcome.rows);
        let _ = write!(out, "\n{by_view}");
    }
    out
}
