//! Summary of a map: from which roughness on a model is within tolerance, and its numbers of cells.

use std::fmt::Write;

use asperity_optics::Material;
use asperity_simulate::{Case, Coordinate, GGX_ALPHA, short};
use serde::Serialize;

use super::cell::{CellResults, ComparedLight, FEWEST_SURFACES};
use super::interval::CellVerdict;
use super::outcome::MapOutcome;
use crate::output::{Column, Table, cut_short, wrapped};
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
    let mut summaries = Vec::new();
    for panel in panels(outcome) {
        for light in ComparedLight::BOTH {
            for (index, model) in outcome.config.compare.models.iter().enumerate() {
                let verdicts = verdicts(outcome, panel, light, index);
                let count = |wanted| verdicts.iter().filter(|v| v.verdict == wanted).count();
                summaries.push(ModelSummary {
                    material: panel.material,
                    others: panel.at.others.clone(),
                    light,
                    model: model.clone(),
                    within_from: thetas(outcome)
                        .into_iter()
                        .map(|theta| (theta, within_from(outcome, &verdicts, theta)))
                        .collect(),
                    cells: CellVerdict::ALL.map(count),
                });
            }
        }
    }
    summaries
}

/// The verdict on a model in one cell.
struct PlacedVerdict {
    smoothness: f64,
    theta_deg: f64,
    verdict: CellVerdict,
}

/// The verdicts of all cells that are there.
fn verdicts(
    outcome: &MapOutcome,
    panel: &Case,
    light: ComparedLight,
    model: usize,
) -> Vec<PlacedVerdict> {
    let here = outcome.found().filter(|(case, _)| is_in_panel(case, panel));
    let verdict = |(case, results): (&Case, &CellResults)| {
        let judged = results.judge(results.models.get(model)?, light, &outcome.config.map);
        Some(PlacedVerdict {
            smoothness: case.at.smoothness?,
            theta_deg: case.light.incidence.theta_deg(),
            verdict: judged.verdict,
        })
    };
    here.filter_map(verdict).collect()
}

/// The roughness, that of the least smoothness, from which all cells up to `theta` are there and within tolerance.
fn within_from(outcome: &MapOutcome, verdicts: &[PlacedVerdict], theta: f64) -> Option<f64> {
    let angles = thetas(outcome).into_iter().filter(|t| *t <= theta).count();
    let is_within = |s: &f64| {
        let here = |v: &&PlacedVerdict| v.smoothness == *s && v.theta_deg <= theta;
        verdicts
            .iter()
            .filter(here)
            .filter(|v| v.verdict == CellVerdict::Within)
            .count()
            == angles
    };
    let mut smooth_first = smoothness(outcome);
    smooth_first.reverse();
    let last = smooth_first.into_iter().take_while(is_within).last();
    last.map(|s| roughness(outcome, s))
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
    warnings.extend(wavelength_warnings(wavelength, unit.unwrap_or_default()));
    warnings.extend(outcome.config.surface.erosion_notes());
    if results().any(|r| r.lost != 0.0) {
        warnings
            .push("some flux was lost to numerical failure: do not trust these results".to_owned());
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::super::config::MapConfig;
    use super::*;

    fn placed(smoothness: f64, theta_deg: f64, verdict: CellVerdict) -> PlacedVerdict {
        PlacedVerdict {
            smoothness,
            theta_deg,
            verdict,
        }
    }

    #[test]
    fn a_model_is_within_tolerance_from_where_all_smoother_cells_are() {
        let text = "[surface]\nsmoothness = [1, 2, 3, 4]\n[light]\ntheta = [0, 60]\n[compare]\nmodels = [\"smith\"]";
        let config = MapConfig::from_toml(text).unwrap();
        let plan = config.plan().unwrap();
        let outcome = MapOutcome {
            results: vec![None; plan.cases.len()],
            config: &config,
            plan: &plan,
            cut_short: 0,
            stopped_by: None,
        };
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
            let list: Vec<PlacedVerdict> = verdicts
                .iter()
                .zip([1.0, 2.0, 3.0, 4.0])
                .flat_map(|(pair, s)| [placed(s, 0.0, pair[0]), placed(s, 60.0, pair[1])])
                .collect();
            assert_eq!(within_from(&outcome, &list, 0.0), at_0);
            assert_eq!(within_from(&outcome, &list, 60.0), to_60);
        }
        // A missing cell is not within tolerance.
        assert_eq!(
            within_from(&outcome, &[placed(4.0, 0.0, Within)], 60.0),
            None
        );
    }
}
