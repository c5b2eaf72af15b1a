//! The story of `map`: where models are within tolerance.

use std::collections::BTreeMap;

use super::sentences::Story;
use crate::folder::Folder;
use crate::words::counted;

pub(super) fn story(folder: &Folder) -> Story {
    let summary = &folder.summary;
    let tolerance = &summary["config"]["map"];
    let cells = summary["cells"].as_array().map_or(0, Vec::len);
    let number = |key: &str| tolerance[key].as_f64().unwrap_or(f64::NAN);
    let mut story = Story::default();
    story
        .asked
        .push("Where is each model within tolerance of explicit surfaces?".to_owned());
    story.asked.push(format!(
        "{} of roughness, material and angle; tolerances: total variation {}, energy of each side {}, direction of each peak {}°.",
        counted(cells as u64, "cell"),
        number("total_variation"),
        number("energy"),
        number("peak"),
    ));
    let mut found: BTreeMap<(&str, &str), [u64; 3]> = BTreeMap::new();
    for one in summary["summary"].as_array().into_iter().flatten() {
        let text = |key: &str| one[key].as_str().unwrap_or_default();
        let sums = found.entry((text("light"), text("model"))).or_default();
        for (place, sum) in sums.iter_mut().enumerate() {
            *sum += one["cells"][place].as_u64().unwrap_or(0);
        }
    }
    for ((light, model), [within, beyond, open]) in found {
        let against = match light {
            "own" => "the light that it describes",
            _ => "all light",
        };
        story.found.push(format!(
            "{model} against {against}: within tolerance in {within} of {} cells, beyond in {beyond}, not resolved in {open}.",
            within + beyond + open
        ));
    }
    let all = summary["cells"].as_array().into_iter().flatten();
    let rays = all.filter_map(|cell| cell["rays"].as_u64()).sum();
    story.sure.push(format!(
        "{} in all. A cell is within or beyond if the 95 % confidence interval of a measure says so, per measure and cell, and not resolved otherwise.",
        counted(rays, "ray")
    ));
    let missing = summary["missing"].as_u64().unwrap_or(0);
    if missing > 0 {
        story
            .sure
            .push(format!("{} not computed yet.", counted(missing, "cell")));
    }
    story
}
