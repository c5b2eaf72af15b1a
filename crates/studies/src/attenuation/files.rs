//! The files of an attenuation run.

use serde_json::{Value, json};

use super::tables::{attenuation, demarcation, visibility};
use super::{AttenuationConfig, AttenuationOutcome, figures};
use crate::output::Head;
use crate::report::views::Views;
use crate::study::Findings;

impl AttenuationConfig {
    /// The files of the study.
    pub(super) fn views<'a>(&self) -> Views<'a, AttenuationOutcome<'a>> {
        let mut views: Views<'a, AttenuationOutcome<'a>> = Views::new();
        views.csv("attenuation.csv", |found| {
            Some(attenuation(found).with_rows(&found.rows))
        });
        if self.run.demarcation {
            views.csv("demarcation.csv", |found| {
                Some(demarcation(found).with_rows(&found.demarcation))
            });
        }
        if self.run.heights {
            views.csv("visibility.csv", |found| {
                Some(visibility(found).with_rows(&found.visibility))
            });
        }
        if self.output.plots {
            for (name, figure) in figures::FIGURES {
                views.figure(name, move |found| {
                    Ok(figure(found).map(|curves| curves.draw()).transpose()?)
                });
            }
        }
        views.text("report.txt", |found| Some(found.text()));
        views.json("summary.json", |found| Some(attenuation_summary(found)));
        views
    }
}

/// The contents of summary.json.
pub(super) fn attenuation_summary(outcome: &AttenuationOutcome<'_>) -> Value {
    let config = &outcome.study.config;
    let (attenuation, demarcation) = (attenuation(outcome), demarcation(outcome));
    let visibility = visibility(outcome);
    let mut summary = json!({
        "headline": outcome.headline(),
        "seed": config.run.seed,
        "config": config,
        "mesh_slope_deficit": outcome.study.mesh_slope_deficit(),
        "rows": attenuation.json(&outcome.rows),
        "demarcation": demarcation.json(&outcome.demarcation),
        "visibility": visibility.json(&outcome.visibility),
        "columns": {
            "attenuation.csv": attenuation.description(),
            "demarcation.csv": demarcation.description(),
            "visibility.csv": visibility.description(),
        },
        "work": outcome.work,
    });
    Head::of("attenuation").insert_into(&mut summary);
    let warnings = outcome.warnings();
    if !warnings.is_empty() {
        summary["warnings"] = json!(warnings);
    }
    if let Some(stopped_by) = outcome.stopped_by {
        summary["stopped_by"] = json!(stopped_by);
    }
    summary
}
