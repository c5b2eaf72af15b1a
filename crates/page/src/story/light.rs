//! The story of `verify` and `trace`: light on surfaces, against models.

use std::collections::BTreeMap;

use serde_json::Value;

use super::sentences::{Story, light_of, range};
use crate::cases::{Case, Verdict};
use crate::folder::Folder;
use crate::words::{counted, estimate_or_dash, listed, two_digits};

pub(super) fn story(folder: &Folder, cases: &[Case]) -> Story {
    let mut story = Story::default();
    let Some(first) = cases.first() else {
        return story;
    };
    let surface = match folder.command() {
        "trace" => given(&first.summary["config"]["surface"]),
        _ => "random surfaces".to_owned(),
    };
    let subject = match cases {
        [one] => one.label.clone(),
        several => format!(
            "{}, from {} to {}",
            counted(several.len() as u64, "case"),
            several[0].label,
            several[several.len() - 1].label
        ),
    };
    let mut names: Vec<String> = Vec::new();
    for model in cases.iter().flat_map(Case::models) {
        let name = model["model"].as_str().unwrap_or_default().to_owned();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    story.asked.push(format!(
        "How do {surface} reflect and transmit light? {subject}."
    ));
    if !names.is_empty() {
        story
            .asked
            .push(format!("Do these models predict it: {}?", listed(&names)));
    }
    story.found = match cases {
        [one] => found_in_one(one),
        several => found_in_several(several),
    };
    story.sure.push(certainty(&first.summary, cases.len() > 1));
    if let Some(level) = first.summary["comparison"]["level"].as_f64()
        && !names.is_empty()
    {
        story.sure.push(format!(
            "Models are tested at level {}: so rarely is a correct one rejected by chance.",
            two_digits(level)
        ));
    }
    story
}

/// The surfaces of a trace.
fn given(surface: &Value) -> String {
    let name = |surface: &Value| surface["file"].as_str().map(str::to_owned);
    match surface.as_array() {
        Some(several) => counted(several.len() as u64, "given surface"),
        None => {
            let name = name(surface);
            name.map_or_else(
                || "given surfaces".to_owned(),
                |name| format!("the facets of {name}"),
            )
        }
    }
}

fn found_in_one(case: &Case) -> Vec<String> {
    let energy = |name: &str| estimate_or_dash(&case.energy[name]);
    let mut found = Vec::new();
    let is_there = |name: &&&str| {
        case.energy[**name]["mean"]
            .as_f64()
            .is_some_and(|mean| mean > 0.0)
    };
    let sides = ["reflected", "transmitted", "absorbed"];
    let parts: Vec<String> = sides
        .iter()
        .filter(is_there)
        .map(|name| format!("{} is {name}", energy(name)))
        .collect();
    found.push(format!("Of the incident light {}.", listed(&parts)));
    for one in case.verdicts() {
        let [distance, noise] = [one.distance, one.noise].map(two_digits);
        let Verdict {
            model,
            light,
            verdict,
            ..
        } = one;
        found.push(format!(
            "{model} for {light}: {verdict}, total variation {distance} ({noise} by noise alone)."
        ));
    }
    found
}

fn found_in_several(cases: &[Case]) -> Vec<String> {
    let mut found: Vec<String> = ["reflected", "transmitted", "absorbed"]
        .iter()
        .filter_map(|part| light_of(cases, part))
        .collect();
    let mut verdicts: BTreeMap<(String, &str), Vec<Verdict>> = BTreeMap::new();
    for verdict in cases.iter().flat_map(Case::verdicts) {
        let key = (verdict.model.clone(), verdict.light);
        verdicts.entry(key).or_default().push(verdict);
    }
    for ((model, light), of_cases) in verdicts {
        let counts = ["rejected", "not rejected", "not resolved"].map(|word| {
            let count = of_cases.iter().filter(|one| one.verdict == word).count();
            (count > 0).then(|| format!("{word} in {count}"))
        });
        let counts: Vec<String> = counts.into_iter().flatten().collect();
        if let Some([low, high]) = range(of_cases.iter().map(|one| one.distance)) {
            found.push(format!(
                "{model} for {light}: {} of {} cases, total variation {} to {}.",
                counts.join(", "),
                of_cases.len(),
                two_digits(low),
                two_digits(high)
            ));
        }
    }
    found
}

/// Sentence on rays, surfaces and errors of a case, which stands for `several`.
fn certainty(summary: &Value, several: bool) -> String {
    let work = &summary["work"];
    let number = |key: &str| work[key].as_u64().unwrap_or(0);
    let each = if several { " per case" } else { "" };
    let from = summary["errors_from"].as_str().unwrap_or("blocks");
    format!(
        "{} on {}{}; standard errors by the scatter between {from}.",
        counted(number("rays"), "ray"),
        counted(number("realisations"), "surface"),
        each,
    )
}
