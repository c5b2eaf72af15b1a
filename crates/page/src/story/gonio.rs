//! The story of `gonio`: BRDF and BTDF by direction of the light.

use asperity_simulate::short;
use serde_json::Value;

use super::sentences::{Story, angles, light_of, mean, range};
use crate::cases::Case;
use crate::folder::Folder;
use crate::words::{counted, estimate_or_dash, two_digits};

pub(super) fn story(folder: &Folder, cases: &[Case]) -> Story {
    let summary = &folder.summary;
    let mut story = Story::default();
    let sample = match summary["sample"]["name"].as_str() {
        Some(name) => name.to_owned(),
        None => "random surfaces".to_owned(),
    };
    let settings = summary["settings"].as_array().map_or(0, Vec::len);
    story.asked.push(format!(
        "What are the BRDF and BTDF of {sample}, with light from {}?",
        angles(&summary["thetas_deg"])
    ));
    if settings > 1 {
        story
            .asked
            .push(format!("{settings} settings are measured."));
    }
    for part in ["reflected", "transmitted", "absorbed"] {
        story.found.extend(light_of(cases, part));
    }
    if let Some((peak, theta)) = brightest(&summary["directions"]) {
        story.found.push(format!(
            "The brightest direction has a BSDF of {} 1/sr, with light from {}°.",
            estimate_or_dash(peak),
            short(theta)
        ));
    }
    let rays: u64 = cases
        .iter()
        .filter_map(|case| case.summary["rays"].as_u64())
        .sum();
    let missing = summary["missing"].as_u64().unwrap_or(0);
    story.sure.push(format!(
        "{} in {}{}.",
        counted(rays, "ray"),
        counted(cases.len() as u64, "direction"),
        match missing {
            0 => String::new(),
            missing => format!("; {} not measured yet", counted(missing, "direction")),
        }
    ));
    let largest = cases.iter().flat_map(|case| {
        ["reflected", "transmitted"]
            .map(|side| case.energy[side]["se"].as_f64().unwrap_or(f64::NAN))
    });
    if let Some([_, high]) = range(largest) {
        story.sure.push(format!(
            "The largest standard error of reflected and transmitted light is {}.",
            two_digits(high)
        ));
    }
    story
}

/// Largest BSDF of all directions, and the polar angle of its light.
fn brightest(directions: &Value) -> Option<(&Value, f64)> {
    let directions = directions.as_array()?.iter();
    let peaks = directions.flat_map(|one| {
        let theta = one["theta_i_deg"].as_f64().unwrap_or(f64::NAN);
        ["reflected", "transmitted"].map(|side| (&one["peak"][side]["bsdf"], theta))
    });
    peaks
        .filter(|(peak, _)| mean(peak).is_finite())
        .max_by(|a, b| mean(a.0).total_cmp(&mean(b.0)))
}
