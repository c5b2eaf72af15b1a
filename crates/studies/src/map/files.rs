//! The files of a map: map.csv, two plots, report.txt and summary.json.

use asperity_plot::{MapVerdict, MappedCell, ValidityMap};
use asperity_simulate::{Case, short};

use super::cell::ComparedLight;
use super::config::MapConfig;
use super::interval::CellVerdict;
use super::json::map_summary;
use super::outcome::MapOutcome;
use super::summary::{
    cells_of, grooves, panels, place, roughness, roughness_name, smoothness, thetas,
};
use super::tables;
use crate::report::effort::effort;
use crate::report::views::Views;
use crate::study::Findings;

impl MapConfig {
    /// The files of the study.
    pub(super) fn views<'a>(&self) -> Views<'a, MapOutcome<'a>> {
        let mut views: Views<'a, MapOutcome<'a>> = Views::new();
        views.csv("map.csv", |outcome| Some(tables::map(outcome)));
        if self.output.plots {
            for light in ComparedLight::BOTH {
                views.figure(format!("map_{}", light.name()), move |outcome| {
                    Ok(Some(figure(outcome, light).draw()?))
                });
            }
        }
        views.text("report.txt", |outcome| Some(outcome.text()));
        views.json("summary.json", |outcome| Some(map_summary(outcome)));
        views
    }
}

/// The heat map of one comparison.
fn figure(outcome: &MapOutcome, light: ComparedLight) -> ValidityMap {
    let (panels, smoothness, thetas) = (panels(outcome), smoothness(outcome), thetas(outcome));
    let models = &outcome.config.compare.models;
    let mut cells = Vec::new();
    for panel in &panels {
        let here = cells_of(outcome, panel);
        for model in 0..models.len() {
            for s in &smoothness {
                for theta in &thetas {
                    let results = here.get(&place(*s, *theta));
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
            "Signs compare 95 % confidence intervals with total variation {}, energy per side {} of the incident flux, peak direction {}°; {}{}",
            short(tolerances.total_variation.0),
            short(tolerances.energy.0),
            short(tolerances.peak.0),
            effort(
                outcome
                    .found()
                    .map(|(_, found)| [found.surfaces, found.rays])
                    .collect::<Vec<_>>()
                    .into_iter(),
                " per cell",
                outcome.config.run.seed,
            ),
            grooves(outcome).map_or_else(String::new, |text| format!("; {text}")),
        ),
        models: models.clone(),
        materials: panels.into_iter().map(Case::panel_label).collect(),
        roughness_label: match roughness_name(outcome) {
            "s" => "smoothness s".to_owned(),
            name => name.to_owned(),
        },
        roughness: smoothness.iter().map(|s| roughness(outcome, *s)).collect(),
        theta_deg: thetas,
        tolerance: tolerances.total_variation.0,
        cells,
    }
}
