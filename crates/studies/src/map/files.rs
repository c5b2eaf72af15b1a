//! The files of a map: map.csv, two plots, report.txt and summary.json.

use asperity_io::{ResultFolder, write_bytes, write_json};
use asperity_plot::{MapVerdict, MappedCell, ValidityMap};
use asperity_simulate::{material_text, short};

use super::cell::ComparedLight;
use super::interval::CellVerdict;
use super::json::map_summary;
use super::summary::{grooves, map_table, materials, smoothness, thetas};
use super::{MapConfig, MapOutcome, tables};
use crate::output::{Place, figure_files};
use crate::report::error::ReportError;
use crate::report::figures;

/// Writes a map into `folder`: map.csv, map_own and map_all as plots, report.txt, and, last, summary.json.
///
/// All of it depends on the cells alone, not on how many runs they took.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn map_report(folder: &ResultFolder, outcome: &MapOutcome) -> Result<(), ReportError> {
    let files = outcome.config.files();
    folder.claim_all(files.iter().map(String::as_str))?;
    let place = Place::root(folder);
    tables::map(outcome).write_csv(&place.claim("map.csv")?, tables::judged(outcome))?;
    if outcome.config.output.plots {
        for light in ComparedLight::BOTH {
            let figure = figure(outcome, light).draw()?;
            figures::save(&[&place], &format!("map_{}", light.name()), &figure)?;
        }
    }
    write_bytes(place.claim("report.txt")?, map_table(outcome).as_bytes())?;
    write_json(place.claim("summary.json")?, &map_summary(outcome))?;
    Ok(())
}

impl MapConfig {
    /// Names of all files that a map writes into its folder.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        let mut names = ["map.csv", "report.txt", "summary.json"]
            .map(str::to_owned)
            .to_vec();
        if self.output.plots {
            let figures = ComparedLight::BOTH.iter();
            names.extend(figures.flat_map(|light| figure_files(&format!("map_{}", light.name()))));
        }
        names
    }
}

/// The heat map of one comparison.
fn figure(outcome: &MapOutcome, light: ComparedLight) -> ValidityMap {
    let (materials, smoothness, thetas) =
        (materials(outcome), smoothness(outcome), thetas(outcome));
    let models = &outcome.config.compare.models;
    let mut cells = Vec::new();
    for material in &materials {
        for model in 0..models.len() {
            for s in &smoothness {
                for theta in &thetas {
                    let here = outcome.cells().find(|cell| {
                        cell.case.material == *material
                            && cell.case.at.smoothness == Some(*s)
                            && cell.case.light.incidence.theta_deg() == *theta
                    });
                    let results = here.and_then(|cell| cell.results);
                    cells.push(results.and_then(|results| {
                        let of_model = results.models.get(model)?;
                        let judged = results.judge(of_model, light, &outcome.config.map);
                        Some(MappedCell {
                            distance: of_model.distances(light).total_variation,
                            verdict: match judged.verdict {
                                CellVerdict::Within => MapVerdict::Within,
                                CellVerdict::Beyond => MapVerdict::Beyond,
                                CellVerdict::NotResolved => MapVerdict::NotResolved,
                            },
                        })
                    }));
                }
            }
        }
    }
    let tolerances = &outcome.config.map;
    let what = match light {
        ComparedLight::Own => "each model against the light it describes",
        ComparedLight::All => "each model against all light",
    };
    ValidityMap {
        title: format!("Validity map: {what}"),
        subtitle: format!(
            "Signs compare 95 % confidence intervals with total variation {}, energy per side {} of the incident flux, peak direction {}°{}",
            short(tolerances.total_variation.0),
            short(tolerances.energy.0),
            short(tolerances.peak.0),
            grooves(outcome).map_or_else(String::new, |text| format!("; {text}")),
        ),
        models: models.clone(),
        materials: materials.into_iter().map(material_text).collect(),
        smoothness,
        theta_deg: thetas,
        tolerance: tolerances.total_variation.0,
        cells,
    }
}
