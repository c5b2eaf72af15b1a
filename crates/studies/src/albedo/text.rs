//! Tables of albedos in words: report.txt.

use std::fmt::Write;

use asperity_simulate::counted;
use asperity_tally::Side;

use super::config::AlbedoSlopes;
use super::means::MeanAlbedo;
use super::outcome::AlbedoOutcome;
use super::tables::{letter, mean_columns};
use crate::output::{
    Column, NO_SCATTER, Table, cut_short, range_text, significant, two_digits, wrapped,
};
use crate::report::energies::lost_warning;

/// Headline: albedos of all light, next to single scattering, and their largest errors.
pub(super) fn headline(outcome: &AlbedoOutcome<'_>) -> Vec<String> {
    let points = || outcome.points().filter(|point| point.outcome.is_some());
    let mut lines = Vec::new();
    for side in Side::BOTH {
        let means = points().filter_map(|point| Some(point.flux(side)?.mean));
        let ratio = points()
            .filter_map(|point| point.ratio(side))
            .fold(0.0, f64::max);
        if let Some(means) = range_text(means) {
            lines.push(format!(
                "{side} {means} of the light, up to {} times single scattering",
                significant(ratio)
            ));
        }
    }
    let rays = points()
        .filter_map(|point| Some(point.outcome?.work.rays))
        .sum();
    let errors = Side::BOTH.map(|side| largest_error(outcome, side));
    lines.extend(errors.into_iter().flatten());
    lines.push(format!(
        "{} in {}",
        counted(rays, "ray"),
        counted(points().count() as u64, "point")
    ));
    lines
}

/// The summary as text: report.txt.
pub(super) fn albedo_text(outcome: &AlbedoOutcome<'_>) -> String {
    let done = outcome.points().filter(|point| point.outcome.is_some());
    let slopes = match outcome.config.albedo.slopes {
        AlbedoSlopes::Gaussian => "Gaussian",
        AlbedoSlopes::Ggx => "GGX",
    };
    let mut out = format!(
        "directional albedos: {} of {} points, {} x {} x {}; {slopes} slopes\n",
        done.count(),
        outcome.plan.cases.len(),
        counted(outcome.materials() as u64, "material"),
        counted(outcome.axes.alphas.len() as u64, "alpha"),
        counted(outcome.axes.cosines.len() as u64, "cosine"),
    );
    let means: Vec<MeanAlbedo<'_>> = MeanAlbedo::all(outcome).collect();
    for (material, rows) in means.chunks(outcome.axes.alphas.len()).enumerate() {
        let _ = writeln!(
            out,
            "\n{}: cosine-weighted means",
            outcome.material(material)
        );
        let table = Table::new()
            .column(Column::new("alpha", "", |row: &MeanAlbedo<'_>| {
                row.point.alpha
            }))
            .columns(
                outcome
                    .sides(material)
                    .iter()
                    .flat_map(|side| mean_columns(*side)),
            );
        out.push_str(&table.text(rows));
    }
    for warning in warnings(outcome) {
        let _ = writeln!(out, "\nwarning: {warning}");
    }
    wrapped(&out)
}

/// Line that names the largest standard error of a side, if any point has one.
fn largest_error(outcome: &AlbedoOutcome<'_>, side: Side) -> Option<String> {
    let errors = outcome.points().filter_map(|point| point.flux(side)?.se);
    let largest = errors
        .reduce(f64::max)
        .filter(|largest| *largest > NO_SCATTER)?;
    let e = letter(side);
    Some(format!(
        "largest standard error of E_{e}: {}",
        two_digits(largest)
    ))
}

/// Warnings on runs that were cut short, and on lost light.
pub(super) fn warnings(outcome: &AlbedoOutcome<'_>) -> Vec<String> {
    let cut = cut_short(
        outcome.found.cut_short(),
        outcome.plan.cases.len(),
        "points",
    );
    let statistics = outcome.points().filter_map(|point| point.outcome);
    let lost = statistics.filter_map(|outcome| lost_warning(&outcome.statistics));
    cut.into_iter().chain(lost.take(1)).collect()
}
