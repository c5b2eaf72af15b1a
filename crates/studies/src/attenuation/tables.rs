//! Attenuation as text that people read.

use asperity_simulate::short;
use std::fmt::Write;

use asperity_tally::Estimate;

use super::{AttenuationOutcome, AttenuationRow, Demarcation, VisibilityRow};
use crate::tables::{aligned, with_error};

/// What was measured, beside theory.
#[must_use]
pub fn attenuation_table(outcome: &AttenuationOutcome) -> String {
    let surface = &outcome.config.surface;
    let work = &outcome.work;
    let mut out = String::new();
    let plural = |count: u64| if count == 1 { "" } else { "s" };
    let _ = writeln!(
        out,
        "tau {}, {} surface{} of {} points, {} border, by {}; shares of points, not of projected areas",
        short(surface.tau.0),
        work.realisations,
        plural(work.realisations),
        work.points,
        surface.border,
        work.way,
    );
    let _ = writeln!(
        out,
        "paper_g2: share of samples of the grid, {} a surface",
        work.samples,
    );
    let _ = writeln!(
        out,
        "errors from the scatter between surfaces; slope variance of the mesh is {:.2} % below that of the continuous surface\n",
        100.0 * outcome.mesh_slope_deficit,
    );
    let views: Vec<f64> = {
        let mut views: Vec<f64> = outcome.rows.iter().map(|row| row.view_theta).collect();
        views.sort_by(f64::total_cmp);
        views.dedup();
        views
    };
    // The light does not know of the view: of several, one is enough here.
    let first_view = outcome.rows.first().map(|row| row.view_theta);
    let lights = outcome
        .rows
        .iter()
        .filter(|row| Some(row.view_theta) == first_view);
    let slanted = views.iter().any(|&theta| theta > 0.0);
    out.push_str(&aligned(&light_table(lights, slanted)));
    if slanted {
        out.push('\n');
        out.push_str(&aligned(&view_table(&outcome.rows)));
    }
    if !outcome.demarcation.is_empty() {
        out.push_str("\nwhere shadow begins, degrees\n");
        out.push_str(&aligned(&demarcation_table(&outcome.demarcation)));
    }
    if !outcome.visibility.is_empty() {
        out.push_str("\nvisibility of the points about height zero that face the light\n");
        out.push_str(&aligned(&visibility_table(&outcome.visibility)));
    }
    if work.lost > 0 {
        let _ = writeln!(
            out,
            "warning: of {} looks it could not be told what they see; they count as blocked",
            work.lost
        );
    }
    out
}

fn header(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

fn digits(value: f64) -> String {
    format!("{value:.4}")
}

/// A row a sigma and light. What depends on the view is there unless views have a table of their own.
fn light_table<'a>(
    rows: impl Iterator<Item = &'a AttenuationRow>,
    slanted: bool,
) -> Vec<Vec<String>> {
    let mut names = header(&[
        "sigma",
        "theta",
        "lit",
        "Smith",
        "V-cavity",
        "as printed",
        "g1 (facing)",
        "Smith",
        "V-cavity",
        "mirror_g2",
    ]);
    if !slanted {
        names.push("paper_g2".to_owned());
    }
    let mut table = vec![names];
    table.extend(rows.map(|row| {
        let mut fields = vec![
            short(row.sigma),
            short(row.theta),
            with_error(row.lit),
            digits(row.smith_lit),
            digits(row.v_cavity_lit),
            digits(row.smith_lit_as_printed),
            with_error(row.g1),
            digits(row.smith_g1),
            digits(row.v_cavity_g1),
            row.mirror_g2.map_or("-".to_owned(), with_error),
        ];
        if !slanted {
            fields.push(with_error(row.paper_g2));
        }
        fields
    }));
    table
}

/// A row a sigma, light and view.
fn view_table(rows: &[AttenuationRow]) -> Vec<Vec<String>> {
    let mut table = vec![header(&[
        "sigma",
        "theta, phi",
        "view theta, phi",
        "g2 (facing both)",
        "Smith correlated",
        "separable",
        "V-cavity",
        "paper_g2",
    ])];
    table.extend(rows.iter().map(|row| {
        vec![
            short(row.sigma),
            format!("{}, {}", short(row.theta), short(row.phi)),
            format!("{}, {}", short(row.view_theta), short(row.view_phi)),
            with_error(row.g2),
            digits(row.smith_correlated_g2),
            digits(row.smith_separable_g2),
            digits(row.v_cavity_g2),
            with_error(row.paper_g2),
        ]
    }));
    table
}

/// A row a sigma and light: heights about zero alone, for which Eq. 24 stands.
fn visibility_table(rows: &[VisibilityRow]) -> Vec<Vec<String>> {
    let mut table = vec![header(&[
        "sigma",
        "theta",
        "tan(theta) / s",
        "explicit",
        "Smith",
        "Xu and Sun, Eq. 24",
    ])];
    table.extend(rows.iter().filter_map(|row| {
        Some(vec![
            short(row.sigma),
            short(row.theta),
            digits(row.x),
            row.visibility.map_or("-".to_owned(), with_error),
            digits(row.smith),
            digits(row.xu_sun?),
        ])
    }));
    table
}

/// A row a sigma.
fn demarcation_table(rows: &[Demarcation]) -> Vec<Vec<String>> {
    let mut table = vec![header(&[
        "sigma",
        "first dark",
        "cot / slope rms",
        "first shadowed",
        "1 % dark",
        "Smith",
        "1 % shadowed",
        "Smith",
        "2019 paper",
    ])];
    let angle = |angle: Option<Estimate>| angle.map_or("-".to_owned(), with_error);
    let plain = |angle: Option<f64>| angle.map_or("-".to_owned(), |angle| format!("{angle:.2}"));
    table.extend(rows.iter().map(|row| {
        vec![
            short(row.sigma),
            with_error(row.first_dark),
            with_error(row.first_dark_scaled),
            angle(row.first_shadowed),
            angle(row.one_percent_dark),
            plain(row.smith_one_percent_dark),
            angle(row.one_percent_shadowed),
            plain(row.smith_one_percent_shadowed),
            plain(row.paper),
        ]
    }));
    table
}
