//! The files of a map: map.csv, two plots, report.txt and summary.json.

use asperity_simulate::short;

use asperity_io::{ResultFolder, write_bytes, write_json};
use asperity_plot::{MapVerdict, MappedCell, ValidityMap};

use super::cell::ComparedLight;
use super::interval::CellVerdict;
use super::json::map_summary;
use super::summary::{grooves, map_table, materials, smoothness, thetas};
use super::{FOLDER, MapConfig, MapOutcome, tables};
use crate::config::case_text::material_text;
use crate::config::error::ConfigError;
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
    folder.claim_all(
        results(outcome.config.output.plots)
            .iter()
            .map(String::as_str),
    )?;
    let place = Place::root(folder);
    tables::map(outcome.config.run.polarisation)
        .write_csv(&place.claim("map.csv")?, tables::judged(outcome))?;
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

/// Names of the files of a map, checkpoints aside.
fn results(plots: bool) -> Vec<String> {
    let mut names = ["map.csv", "report.txt", "summary.json"]
        .map(str::to_owned)
        .to_vec();
    if plots {
        names.extend(
            ComparedLight::BOTH
                .iter()
                .flat_map(|light| figure_files(&format!("map_{}", light.name()))),
        );
    }
    names
}

impl MapConfig {
    /// Names of all files that a map writes into its folder.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn files(&self) -> Result<Vec<String>, ConfigError> {
        let mut names = results(self.output.plots);
        let cells = self.cells()?.into_iter();
        names.extend(cells.map(|cell| format!("{FOLDER}/{}.json", cell.case.folder())));
        Ok(names)
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
                    let here = outcome.cells.iter().find(|cell| {
                        cell.case.material == *material
                            && cell.case.smoothness == *s
                            && cell.case.incidence.theta_deg() == *theta
                    });
                    let results = here.and_then(|cell| cell.results.as_ref());
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
