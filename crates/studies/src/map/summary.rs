//! Summary of a map: from which roughness on a model is within tolerance, and its numbers of cells.

use std::collections::HashMap;
use std::fmt::Write;

use asperity_optics::Material;
use asperity_simulate::{Case, Coordinate, GGX_ALPHA, counted, short};
use serde::Serialize;

use super::cell::{CellResults, ComparedLight, FEWEST_SURFACES};
use super::interval::CellVerdict;
use super::outcome::MapOutcome;
use crate::output::{Column, Table, cut_short, fitted, percent, wrapped};
use crate::report::energies::more_rays_warning;
use crate::validity::{first_warning, note_of_several, wavelength_warnings};

/// Summary of one model on one material, in one comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelSummary {
    /// The material.
    pub material: Material,
    /// Further coordinates.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<Coordinate>,
    /// The light.
    pub light: ComparedLight,
    /// The model.
    pub model: String,
    /// For each angle of the map, ascending, in degrees: the least smoothness from which the model is within tolerance at this angle and
    /// all below it, at every smoothness of the map above; of GGX slopes the largest alpha. `None` if not even on the smoothest surfaces.
    pub within_from: Vec<(f64, Option<f64>)>,
    /// Cells within tolerance, beyond it, and not resolved.
    pub cells: [usize; 3],
}

/// The panels of a map: a case of each material and further coordinates, in its order.
pub(super) fn panels<'a>(outcome: &MapOutcome<'a>) -> Vec<&'a Case> {
    let mut panels: Vec<&Case> = Vec::new();
    for case in &outcome.plan.cases {
        if !panels.iter().any(|panel| is_in_panel(case, panel)) {
            panels.push(case);
        }
    }
    panels
}

/// Returns `true` if a case is in the same panel as another.
pub(super) fn is_in_panel(case: &Case, panel: &Case) -> bool {
    case.material == panel.material && case.at.others == panel.at.others
}

/// The angles of a map in degrees, ascending.
pub(super) fn thetas(outcome: &MapOutcome) -> Vec<f64> {
    let cases = outcome.plan.cases.iter();
    ascending(cases.map(|case| case.light.incidence.theta_deg()))
}

/// Values of the smoothness of all cells, ascending.
pub(super) fn smoothness(outcome: &MapOutcome) -> Vec<f64> {
    let cases = outcome.plan.cases.iter();
    ascending(cases.filter_map(|case| case.at.smoothness))
}

/// Name of the roughness of the cells.
pub(super) fn roughness_name(outcome: &MapOutcome) -> &'static str {
    let roughness = outcome.plan.cases.first().and_then(Case::roughness);
    roughness.map_or("s", |(name, _)| name)
}

/// The roughness of the cells of a smoothness, as it is named.
pub(super) fn roughness(outcome: &MapOutcome, smoothness: f64) -> f64 {
    let cases = &mut outcome.plan.cases.iter();
    let case = cases.find(|case| case.at.smoothness == Some(smoothness));
    let roughness = case.and_then(Case::roughness);
    roughness.map_or(smoothness, |(_, [first, _])| first)
}

/// Each of these values once.
fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The verdicts of a map in short: by material and further coordinates, comparison and model.
pub(crate) fn summarise(outcome: &MapOutcome) -> Vec<ModelSummary> {
    let (smoothness, thetas) = (smoothness(outcome), thetas(outcome));
    let mut summaries = Vec::new();
    for panel in panels(outcome) {
        let cells = cells_of(outcome, panel);
        for light in ComparedLight::BOTH {
            for (index, model) in outcome.config.compare.models.iter().enumerate() {
                let judge = |results: &CellResults| {
                    let model = results.models.get(index)?;
                    Some(results.judge(model, light, &outcome.config.map).verdict)
                };
                let verdicts: HashMap<Place, CellVerdict> = cells
                    .iter()
                    .filter_map(|(place, results)| Some((*place, judge(results)?)))
                    .collect();
                let count = |wanted| verdicts.values().filter(|v| **v == wanted).count();
                summaries.push(ModelSummary {
                    material: panel.material,
                    others: panel.at.others.clone(),
                    light,
                    model: model.clone(),
                    within_from: within_from(&smoothness, &thetas, &verdicts)
                        .into_iter()
                        .map(|(theta, s)| (theta, s.map(|s| roughness(outcome, s))))
                        .collect(),
                    cells: CellVerdict::ALL.map(count),
                });
            }
        }
    }
    summaries
}

/// Place of a cell in its panel: the bits of smoothness and angle.
pub(super) type Place = [u64; 2];

/// The place of a smoothness and an angle.
pub(super) fn place(smoothness: f64, theta_deg: f64) -> Place {
    [smoothness, theta_deg].map(f64::to_bits)
}

/// The results of the cells of a panel that are there.
pub(super) fn cells_of<'a>(
    outcome: &'a MapOutcome<'_>,
    panel: &Case,
) -> HashMap<Place, &'a CellResults> {
    let here = outcome.found().filter(|(case, _)| is_in_panel(case, panel));
    let placed = here.filter_map(|(case, results)| {
        let theta_deg = case.light.incidence.theta_deg();
        Some((place(case.at.smoothness?, theta_deg), results))
    });
    placed.collect()
}

/// For each of the angles, the least smoothness from which all cells up to that angle are there and within tolerance.
fn within_from(
    smoothness: &[f64],
    thetas: &[f64],
    verdicts: &HashMap<Place, CellVerdict>,
) -> Vec<(f64, Option<f64>)> {
    let is_within = |s, theta| verdicts.get(&place(s, theta)) == Some(&CellVerdict::Within);
    // Angles, from the smallest on, at which all cells of a smoothness are within tolerance
    let angles = |s: &f64| {
        let within = thetas.iter().take_while(|theta| is_within(*s, **theta));
        (*s, within.count())
    };
    let angles: Vec<(f64, usize)> = smoothness.iter().rev().map(angles).collect();
    let from = |(number, theta): (usize, &f64)| {
        let within = angles.iter().take_while(|(_, count)| *count > number);
        (*theta, within.last().map(|(s, _)| *s))
    };
    thetas.iter().enumerate().map(from).collect()
}

/// Meaning of the roughness on anisotropic surfaces, which are all of one shape.
pub(super) fn grooves(outcome: &MapOutcome) -> Option<String> {
    let case = outcome.plan.cases.first()?;
    let [_, azimuth] = case.surface.recipe()?.anisotropy()?;
    let (name, [first, second]) = case.roughness()?;
    Some(format!(
        "{name} along the first axis, at {} deg from x; across it {name} is {} times as large",
        short(azimuth.to_degrees()),
        short(second / first)
    ))
}

/// Headline: the cells in which each model holds, the tolerances, and cells that are not resolved.
pub(super) fn headline(outcome: &MapOutcome<'_>) -> Vec<String> {
    let tolerances = &outcome.config.map;
    let cells = outcome.found().count();
    let summaries = summarise(outcome);
    let mut lines = vec![format!(
        "of {}, within {} of the light and {} deg of its peaks:",
        counted(cells as u64, "cell"),
        match tolerances.total_variation.0 == tolerances.energy.0 {
            true => percent(tolerances.energy.0),
            false => format!(
                "{} and {}",
                percent(tolerances.total_variation.0),
                percent(tolerances.energy.0)
            ),
        },
        short(tolerances.peak.0),
    )];
    let mut open = 0;
    for light in ComparedLight::BOTH {
        let count = |model: &String| {
            let of = summaries
                .iter()
                .filter(|one| one.light == light && one.model == *model);
            let [within, _, not_resolved] =
                of.fold([0; 3], |sum, one| [0, 1, 2].map(|i| sum[i] + one.cells[i]));
            open += not_resolved;
            (within, model.clone())
        };
        let mut models: Vec<(usize, String)> =
            outcome.config.compare.models.iter().map(count).collect();
        models.sort_by_key(|(within, _)| std::cmp::Reverse(*within));
        let parts: Vec<String> = models
            .into_iter()
            .map(|(within, model)| format!("{model} {within}"))
            .collect();
        let before = match light {
            ComparedLight::Own => "against the light that each describes: ",
            ComparedLight::All => "against all light: ",
        };
        lines.push(fitted(before, &parts, ""));
    }
    lines.push(format!(
        "by 95 % intervals of each measure and cell; {} not resolved",
        counted(open as u64, "verdict")
    ));
    lines
}

/// The summary as text: report.txt.
pub(super) fn map_table(outcome: &MapOutcome) -> String {
    let mut out = String::new();
    let tolerances = &outcome.config.map;
    let list = |values: Vec<f64>| values.into_iter().map(short).collect::<Vec<_>>().join(", ");
    let (all, missing) = (outcome.results.len(), outcome.missing());
    let done = all - missing;
    let name = roughness_name(outcome);
    let values = smoothness(outcome)
        .into_iter()
        .map(|s| roughness(outcome, s));
    let bound = match name {
        GGX_ALPHA => format!("largest {name} up to"),
        _ => format!("least {name} from"),
    };
    let _ = writeln!(
        out,
        "validity map: {done} of {} cells; {name} = {}; theta = {} deg",
        all,
        list(values.collect()),
        list(thetas(outcome)),
    );
    if let Some(grooves) = grooves(outcome) {
        let _ = writeln!(out, "anisotropic: {grooves}");
    }
    let validities = outcome.validities();
    let coherent = validities
        .iter()
        .filter_map(|(name, one)| Some((name.clone(), one.first_lines_at_most()?)));
    if let Some(line) = first_warning(coherent, "cells") {
        let _ = writeln!(out, "{line}");
    }
    let _ = writeln!(
        out,
        "within tolerance: the 95 % confidence interval of each measure lies within total variation {}, energy of each side {} of the incident flux, direction of each peak {} deg; beyond: that of one measure lies outside; not resolved: neither. Confidence is per measure and cell, not corrected for the number of cells.\nBy angle of incidence: the {bound} which a model is within tolerance at that angle and all smaller ones. Then the numbers of cells.",
        short(tolerances.total_variation.0),
        short(tolerances.energy.0),
        short(tolerances.peak.0),
    );
    let summaries = summarise(outcome);
    for panel in panels(outcome) {
        for light in ComparedLight::BOTH {
            let what = match light {
                ComparedLight::Own => "each model against the light that it describes",
                ComparedLight::All => "each model against all light",
            };
            let _ = writeln!(out, "\n{}: {what}", panel.panel_label());
            let here = |s: &&ModelSummary| {
                s.material == panel.material && s.others == panel.at.others && s.light == light
            };
            out.push_str(&table(outcome).text(summaries.iter().filter(here)));
        }
    }
    if let Some(note) = note_of_several(&validities, "cells") {
        let _ = writeln!(out, "\nnote: {note}");
    }
    for warning in warnings(outcome) {
        let _ = writeln!(out, "\nwarning: {warning}");
    }
    wrapped(&out)
}

/// A row per model: from which roughness on it is within the tolerances, and its numbers of cells.
fn table<'a>(outcome: &MapOutcome<'_>) -> Table<'a, ModelSummary> {
    let thetas = thetas(outcome).into_iter().enumerate().map(|(i, theta)| {
        let heading = match i {
            0 => format!("{} deg", short(theta)),
            _ => format!("to {} deg", short(theta)),
        };
        Column::new(heading, "", move |row: &ModelSummary| {
            row.within_from.get(i)?.1
        })
    });
    let verdicts = CellVerdict::ALL
        .into_iter()
        .enumerate()
        .map(|(i, verdict)| {
            Column::new(verdict.name(), "", move |row: &ModelSummary| row.cells[i])
        });
    Table::new()
        .column(Column::new("model", "", |row: &ModelSummary| {
            row.model.clone()
        }))
        .columns(thetas)
        .columns(verdicts)
}

/// Notes on the map, one sentence each.
pub(super) fn warnings(outcome: &MapOutcome) -> Vec<String> {
    let mut warnings = Vec::new();
    let results = || outcome.results.iter().flatten();
    if outcome.missing() > 0 {
        warnings.push(format!(
            "{} of {} cells are missing; the same command resumes",
            outcome.missing(),
            outcome.results.len()
        ));
    }
    warnings.extend(cut_short(outcome.cut_short, outcome.results.len(), "cells"));
    let most = results().map(|r| r.rays).max().unwrap_or(0);
    warnings.extend(more_rays_warning(&outcome.config.run, most));
    let few = |r: &super::CellResults| r.deviation_bound.is_none() && r.surfaces < FEWEST_SURFACES;
    if results().any(few) {
        warnings.push(format!(
            "cells with fewer than {FEWEST_SURFACES} surfaces are never resolved, however many rays they have"
        ));
    }
    let unit = outcome.plan.cases.first().map(|case| case.at.unit);
    let wavelength = outcome.config.light.wavelength_nm();
    let is_named = outcome.config.material.media().is_some();
    warnings.extend(wavelength_warnings(
        wavelength,
        is_named,
        unit.unwrap_or_default(),
    ));
    warnings.extend(outcome.config.surface.erosion_notes());
    if results().any(|r| r.lost != 0.0) {
        warnings
            .push("some flux was lost to numerical failure: do not trust these results".to_owned());
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_within_tolerance_from_where_all_smoother_cells_are() {
        let (smoothness, thetas) = ([1.0, 2.0, 3.0, 4.0], [0.0, 60.0]);
        use CellVerdict::{Beyond, NotResolved, Within};
        // Of four smoothness values, at 0 and at 60 degrees.
        for (verdicts, at_0, to_60) in [
            (
                [[Beyond; 2], [Within; 2], [Within; 2], [Within; 2]],
                Some(2.0),
                Some(2.0),
            ),
            (
                [[Within; 2], [Within, Beyond], [Within; 2], [Within; 2]],
                Some(1.0),
                Some(3.0),
            ),
            (
                [[Within; 2], [NotResolved; 2], [Within; 2], [Within; 2]],
                Some(3.0),
                Some(3.0),
            ),
            (
                [[Within; 2], [Within; 2], [Within; 2], [Within, NotResolved]],
                Some(1.0),
                None,
            ),
            ([[Within; 2]; 4], Some(1.0), Some(1.0)),
        ] {
            let cells = verdicts.iter().zip(smoothness).flat_map(|(pair, s)| {
                let cell = |i: usize| (place(s, thetas[i]), pair[i]);
                [0, 1].map(cell)
            });
            let found = within_from(&smoothness, &thetas, &cells.collect());
            assert_eq!(found, [(0.0, at_0), (60.0, to_60)]);
        }
        // A missing cell is not within tolerance.
        let alone = HashMap::from([(place(4.0, 0.0), Within)]);
        let found = within_from(&smoothness, &thetas, &alone);
        assert_eq!(found, [(0.0, Some(4.0)), (60.0, None)]);
    }
}
