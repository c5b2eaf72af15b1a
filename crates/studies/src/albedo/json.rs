//! The contents of summary.json of tables of albedos.

use serde_json::{Value, json};

use super::array::{CHANNELS, array};
use super::outcome::AlbedoOutcome;
use super::tables;
use super::text::warnings;
use crate::output::Head;
use crate::study::Findings;

/// The contents of summary.json.
pub(super) fn albedo_summary(outcome: &AlbedoOutcome<'_>) -> Value {
    let mut config = json!(outcome.config);
    if let Some(run) = config["run"].as_object_mut() {
        run.remove("max_time");
        if outcome.config.run.target_error.is_some() {
            run.remove("realisations");
            run.remove("rays");
        }
    }
    let work = outcome
        .points()
        .filter_map(|point| Some(&point.outcome?.work));
    let materials = (0..outcome.materials()).map(|material| {
        let case = outcome.point(material, 0, 0).case;
        json!({ "name": outcome.material(material), "material": case.material })
    });
    let mut summary = json!({
        "headline": outcome.headline(),
        "seed": outcome.config.run.seed,
        "config": config,
        "materials": materials.collect::<Vec<_>>(),
        "alphas": outcome.axes.alphas,
        "cosines": outcome.axes.cosines,
        "channels": CHANNELS,
        "shape": array(outcome).0,
        "rays": work.map(|work| work.rays).sum::<u64>(),
        "complete": outcome.is_complete() && outcome.found.cut_short() == 0,
        "columns": {
            "albedo.csv": tables::points(outcome).description,
            "mean.csv": tables::means(outcome).description,
        },
        "warnings": warnings(outcome),
    });
    Head::of("albedo").insert_into(&mut summary);
    summary
}
