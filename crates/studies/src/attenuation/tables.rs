//! The tables of geometric attenuation, and the report that shows them.

use std::fmt::Write;

use asperity_analysis::{
    Beckmann, smith_correlated_g2, smith_lit, smith_lit_as_printed, smith_separable_g2,
    v_cavity_lit, v_cavity_mean_g1, v_cavity_mean_g2,
};
use asperity_simulate::{Cells, counted, short};
use asperity_surface::LengthUnit;
use asperity_tally::Estimate;

use super::{AttenuationOutcome, AttenuationRow, Demarcation, VisibilityRow};
use crate::output::{
    Basis, Column, EstimateWithLimit, Format, Table, range_text, unit_of_lengths, with_error,
    wrapped,
};

/// Description of the column `theta`.
const THETA: &str = "polar angle of the light";

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

/// A column of angles in degrees.
fn angle<'a, R: 'a>(name: &'a str, about: &'static str, value: fn(&R) -> f64) -> Column<'a, R> {
    Column::new(name, about, value).unit("deg")
}

/// A column of measured fractions of points, and what they rest on where all points agree.
fn supported<'a, R: 'a>(
    name: &'a str,
    about: &'static str,
    support: impl Fn(&R) -> Basis + 'a,
    value: fn(&R) -> Option<Estimate>,
) -> Column<'a, R> {
    Column::estimate(name, about, move |row| {
        Some(EstimateWithLimit::new(value(row)?, support(row)))
    })
}

/// A column of what a theory expects.
fn theory<'a, R: 'a>(name: &'a str, about: &'static str, value: fn(&R) -> f64) -> Column<'a, R> {
    Column::new(name, about, value).format(Format::Fixed(4))
}

/// attenuation.csv: a row per sigma, light and view.
pub(super) fn attenuation(outcome: &AttenuationOutcome<'_>) -> Table<'static, AttenuationRow> {
    type Row = AttenuationRow;
    let unit = outcome.study.config.surface.unit;
    let independent = outcome.independent_points();
    // From straight above nothing is hidden.
    let unless = move |is_proven: bool| match is_proven {
        true => Basis::Proven,
        false => Basis::Samples(independent),
    };
    let of_light = move |row: &Row| unless(row.light.is_vertical());
    let of_view = move |row: &Row| unless(row.view.is_vertical());
    let of_both = move |row: &Row| unless(row.light.is_vertical() && row.view.is_vertical());
    let g1 = |row: &Row| Beckmann::new(row.slopes).g1(row.light.wi());
    let lit = |row: &Row| smith_lit(&row.slopes, row.light.wi());
    let less = |fraction: Estimate, smith: f64| {
        let mean = fraction.mean - smith;
        Some(Estimate { mean, ..fraction })
    };
    Table::new()
        .column(sigma_column(unit, |row: &Row| row.sigma))
        .column(angle("theta", THETA, |row: &Row| row.light.theta_deg()))
        .column(angle("phi", "azimuth of the light", |row: &Row| row.light.phi_deg()))
        .column(angle("view_theta", "polar angle of the eye", |row: &Row| row.view.theta_deg()))
        .column(angle("view_phi", "azimuth of the eye", |row: &Row| row.view.phi_deg()))
        .column(supported("lit", "fraction of all points that are lit", of_light, |row: &Row| Some(row.lit)))
        .column(supported("g1", "fraction of the points facing the light that are lit", of_light, |row: &Row| Some(row.g1)).heading("g1 (facing)"))
        .column(supported("g1_projected", "g1 weighted by the areas projected towards the light: Smith's G1", of_light, |row: &Row| Some(row.g1_projected)))
        .column(Column::estimate("lit_projected", "projected area of the lit points over that of the mean plane", |row: &Row| Some(row.lit_projected)))
        .column(theory("smith_lit", "lit, by Smith", lit).heading("Smith lit"))
        .column(theory("smith_g1", "g1, by Smith: 1 / (1 + Lambda)", g1).heading("Smith g1"))
        .column(theory("smith_lit_as_printed", "lit, by Smith's formula as the 2019 paper prints it", |row: &Row| smith_lit_as_printed(row.sigma, row.light.wi())).heading("as printed"))
        .column(theory("v_cavity_lit", "lit, of V-cavities", |row: &Row| v_cavity_lit(&row.slopes, row.light.wi())).heading("V-cavity lit"))
        .column(theory("v_cavity_g1", "g1, of V-cavities", |row: &Row| v_cavity_mean_g1(&row.slopes, row.light.wi())).heading("V-cavity g1"))
        .column(supported("local_shadow", "fraction of all points that face away from the light", of_light, |row: &Row| Some(row.local_shadow)))
        .column(supported("distant_shadow", "fraction of all points that face the light and are shadowed", of_light, |row: &Row| Some(row.distant_shadow)))
        .column(supported("local_mask", "fraction of all points that face away from the eye", of_view, |row: &Row| Some(row.local_mask)))
        .column(supported("distant_mask", "fraction of all points that face the eye and are masked", of_view, |row: &Row| Some(row.distant_mask)))
        .column(supported("g1_view", "fraction of the points facing the eye that are visible", of_view, |row: &Row| Some(row.g1_view)))
        .column(supported("g2", "fraction of the points facing both that are lit and visible", of_both, |row: &Row| Some(row.g2)).heading("g2 (facing both)"))
        .column(theory("smith_separable_g2", "g2, by Smith: G1(wi) G1(wo)", |row: &Row| smith_separable_g2(&row.slopes, row.light.wi(), row.view.wi())).heading("separable"))
        .column(theory("smith_correlated_g2", "g2, by Smith: 1 / (1 + Lambda(wi) + Lambda(wo))", |row: &Row| smith_correlated_g2(&row.slopes, row.light.wi(), row.view.wi())).heading("Smith correlated"))
        .column(theory("v_cavity_g2", "g2, of V-cavities", |row: &Row| v_cavity_mean_g2(&row.slopes, row.light.wi(), row.view.wi())).heading("V-cavity"))
        .column(supported("paper_g2", "fraction of the samples of the grid that are lit and visible: 1 - N_s / N of the 2019 paper", of_both, |row: &Row| Some(row.paper_g2)))
        .column(supported("mirror_g2", "fraction of all points that are lit and whose mirrored ray escapes", move |_: &Row| unless(false), |row: &Row| row.mirror_g2))
        .column(Column::estimate("g1_less_smith", "g1 less smith_g1", move |row: &Row| less(row.g1, g1(row))))
        .column(Column::estimate("lit_less_smith", "lit less smith_lit", move |row: &Row| less(row.lit, lit(row))))
}

/// demarcation.csv: a row per sigma.
pub(super) fn demarcation(outcome: &AttenuationOutcome<'_>) -> Table<'static, Demarcation> {
    let unit = outcome.study.config.surface.unit;
    type Row = Demarcation;
    let measured = |name, heading, about, value: fn(&Row) -> Option<Estimate>| {
        let column = Column::estimate(name, about, value);
        column.unit("deg").heading(heading)
    };
    let expected = |name, heading, about, value: fn(&Row) -> Option<f64>| {
        let column = Column::new(name, about, value).format(Format::Fixed(2));
        column.unit("deg").heading(heading)
    };
    let first_dark = "polar angle of the light at which the first point is dark";
    let scaled = "its cotangent over the root mean square slope";
    let scaled = Column::estimate("first_dark_scaled", scaled, |row: &Row| {
        Some(row.first_dark_scaled)
    });
    let first = "polar angle at which the first point that faces the light is dark";
    let dark = "polar angle at which 1 % of all points are dark";
    let by_smith = "one_percent_dark, by Smith";
    let shadowed = "polar angle at which 1 % of all points face the light and are dark";
    let smith = expected(
        "smith_one_percent_shadowed",
        "Smith",
        "one_percent_shadowed, by Smith",
        |row| row.smith_one_percent_shadowed,
    );
    let paper = "the demarcation angle of the 2019 paper";
    Table::new()
        .column(sigma_column(unit, |row: &Row| row.sigma))
        .column(measured("first_dark", "first dark", first_dark, |row| {
            Some(row.first_dark)
        }))
        .column(scaled.heading("cot / slope rms"))
        .column(measured("first_shadowed", "first shadowed", first, |row| {
            row.first_shadowed
        }))
        .column(measured("one_percent_dark", "1 % dark", dark, |row| {
            row.one_percent_dark
        }))
        .column(expected(
            "smith_one_percent_dark",
            "Smith",
            by_smith,
            |row| row.smith_one_percent_dark,
        ))
        .column(measured(
            "one_percent_shadowed",
            "1 % shadowed",
            shadowed,
            |row| row.one_percent_shadowed,
        ))
        .column(smith)
        .column(expected("paper", "2019 paper", paper, |row| row.paper))
}

/// visibility.csv: a row per sigma, light and height.
pub(super) fn visibility(outcome: &AttenuationOutcome<'_>) -> Table<'static, VisibilityRow> {
    type Row = VisibilityRow;
    let unit = outcome.study.config.surface.unit;
    let independent = outcome.independent_points();
    let support = move |row: &Row| match row.theta {
        0.0 => Basis::Proven,
        _ => Basis::Samples(independent.min(row.points).max(1.0)),
    };
    let x = "tan(theta) / s, the only parameter of the models";
    let points = "points of that height that face the light, per surface";
    let lit = "fraction of these points that are lit";
    let lit = supported("visibility", lit, support, |row: &Row| row.visibility);
    let xu_sun = "the same, by Eq. 24 of Xu and Sun, at height zero";
    let xu_sun = Column::new("xu_sun", xu_sun, |row: &Row| row.xu_sun);
    let height = |name, about, end: fn(&Row) -> f64| Column::new(name, about, end).unit("sigma");
    Table::new()
        .column(sigma_column(unit, |row: &Row| row.sigma))
        .column(angle("theta", THETA, |row: &Row| row.theta))
        .column(theory("x", x, |row: &Row| row.x).heading("tan(theta) / s"))
        .column(height("height_min", "lowest height", |row| row.height_min))
        .column(height("height_max", "highest height", |row| row.height_max))
        .column(Column::new("points", points, |row: &Row| row.points))
        .column(lit.heading("explicit"))
        .column(theory("smith", "the same, by Smith", |row: &Row| row.smith).heading("Smith"))
        .column(
            xu_sun
                .format(Format::Fixed(4))
                .heading("Xu and Sun, Eq. 24"),
        )
}

/// Headline: the light that reaches the surface, and its largest difference from Smith's.
pub(super) fn headline(outcome: &AttenuationOutcome<'_>) -> Vec<String> {
    let rows = &outcome.rows;
    let mut lines = Vec::new();
    if let Some(lit) = range_text(rows.iter().map(|row| row.lit.mean)) {
        lines.push(format!("light reaches {lit} of the points"));
    }
    let less = |row: &AttenuationRow| {
        let smith = Beckmann::new(row.slopes).g1(row.light.wi());
        row.g1.mean - smith
    };
    let furthest = rows
        .iter()
        .max_by(|a, b| less(a).abs().total_cmp(&less(b).abs()));
    if let Some(row) = furthest {
        let mean = less(row);
        lines.push(format!(
            "G1 is off Smith's most at sigma {}, theta {} deg: by {}",
            short(row.sigma),
            short(row.light.theta_deg()),
            with_error(Estimate { mean, ..row.g1 })
        ));
    }
    lines.push(format!(
        "standard errors from {}",
        counted(outcome.work.realisations, "surface")
    ));
    lines
}

/// Measured fractions next to theory: report.txt.
pub(super) fn attenuation_table(outcome: &AttenuationOutcome<'_>) -> String {
    let surface = &outcome.study.config.surface;
    let unit = surface.unit;
    let work = &outcome.work;
    let mut out = format!(
        "tau {}{}, {} of {} points, {} border, by {}; fractions of points, not of projected areas\npaper_g2: fraction of the samples of the grid, {} per surface\n",
        short(surface.tau.0),
        unit.suffix(),
        counted(work.realisations, "surface"),
        work.points,
        surface.border,
        work.method,
        work.samples,
    );
    let cells = match surface.cells.of_random() {
        Cells::Flat => format!(
            "the slope variance of the mesh is {:.2} % below that of the continuous surface",
            100.0 * outcome.study.mesh_slope_deficit(),
        ),
        Cells::Smooth => {
            "cells are smooth, with the slope variance of the continuous surface".to_owned()
        }
    };
    let _ = writeln!(out, "errors from the scatter between surfaces; {cells}\n");
    let fractions = |columns: &str, keys: usize, rows: Vec<&AttenuationRow>| {
        let columns: Vec<&str> = columns.split(' ').collect();
        let table = attenuation(outcome).select(&columns).keys(keys);
        table.text(rows)
    };
    // What depends on the light alone is the same for each view.
    let of_first_view = outcome.of_first_view().collect();
    let of_light = "sigma theta lit smith_lit v_cavity_lit smith_lit_as_printed g1 smith_g1 v_cavity_g1 mirror_g2";
    if outcome.study.views.iter().all(|view| view.is_vertical()) {
        out += &fractions(&format!("{of_light} paper_g2"), 2, of_first_view);
    } else {
        let of_both = "sigma theta phi view_theta view_phi g2 smith_correlated_g2 smith_separable_g2 v_cavity_g2 paper_g2";
        let by_light = fractions(of_light, 2, of_first_view);
        let by_view = fractions(of_both, 5, outcome.rows.iter().collect());
        let _ = write!(out, "{by_light}\n{by_view}");
    }
    if !outcome.demarcation.is_empty() {
        let table = demarcation(outcome).text(&outcome.demarcation);
        let _ = write!(
            out,
            "\npolar angle at which shadow begins, degrees\n{table}"
        );
    }
    if !outcome.visibility.is_empty() {
        // Eq. 24 is for heights about zero alone.
        let about_zero = outcome.visibility.iter().filter(|row| row.xu_sun.is_some());
        let columns = ["sigma", "theta", "x", "visibility", "smith", "xu_sun"];
        let table = visibility(outcome).select(&columns).text(about_zero);
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
