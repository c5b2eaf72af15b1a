//! The stories of `converge`, `attenuation`, `albedo` and `inspect`.

use asperity_simulate::short;
use serde_json::{Value, json};

use super::sentences::{Story, angles, range};
use crate::error::PageError;
use crate::folder::Folder;
use crate::words::{self, counted, two_digits};

/// Run time against error.
pub(super) fn converge(folder: &Folder) -> Story {
    let summary = &folder.summary;
    let mut story = Story::default();
    match summary["cases"].as_array() {
        None => one_convergence(summary, &mut story),
        Some(cases) => cases
            .iter()
            .for_each(|case| one_convergence(&case["summary"], &mut story)),
    }
    story
}

fn one_convergence(summary: &Value, story: &mut Story) {
    let methods: Vec<&Value> = summary["methods"]
        .as_array()
        .into_iter()
        .flatten()
        .collect();
    let case = words::label(summary["label"].as_str().unwrap_or_default());
    story.asked.push(format!(
        "How long does each of {} take to an error, for {case}?",
        counted(methods.len() as u64, "method"),
    ));
    let at = |method: &Value| method["error_at_one_second"].as_f64();
    let best = methods
        .iter()
        .filter_map(|method| Some((at(method)?, method["name"].as_str()?)));
    if let Some((error, name)) = best.min_by(|a, b| a.0.total_cmp(&b.0)) {
        story.found.push(format!(
            "For {case}, {name} has the smallest relative error in one second, {}.",
            two_digits(error)
        ));
    }
    for method in &methods {
        let efficiency = &method["efficiency"];
        let name = method["name"].as_str().unwrap_or_default();
        // The method that others are compared with has no error.
        if efficiency["se"].is_number() {
            let ratio = json!({"mean": efficiency["ratio"], "se": efficiency["se"]});
            let ratio = words::estimate_or_dash(&ratio);
            story.found.push(format!(
                "{name}: {ratio} times as efficient as plain random rays."
            ));
        }
    }
    let reference = &summary["reference"];
    story.sure.push(format!(
        "Errors are against a reference of {} with {} each, whose own relative error is {}.",
        counted(reference["surfaces"].as_u64().unwrap_or(0), "surface"),
        counted(reference["rays_per_surface"].as_u64().unwrap_or(0), "ray"),
        two_digits(reference["error"].as_f64().unwrap_or(f64::NAN)),
    ));
}

/// Shadowing and masking.
pub(super) fn attenuation(folder: &Folder) -> Result<Story, PageError> {
    let config = &folder.summary["config"];
    let mut story = Story::default();
    let sigmas = config["surface"]["sigma"].as_array().map_or(1, Vec::len);
    story.asked.push(format!(
        "Which fraction of a rough surface does light reach, and how far is Smith off? {} of sigma, light from {}.",
        counted(sigmas as u64, "value"),
        angles(&config["light"]["theta"])
    ));
    if let Some(rows) = folder.rows("attenuation.csv")? {
        let column = |name| rows.numbers(name).unwrap_or_default();
        let [differences, errors] = ["g1_less_smith", "g1_less_smith_se"].map(column);
        let [sigma, theta] = ["sigma", "theta"].map(column);
        let largest = (0..differences.len()).filter(|&row| differences[row].is_finite());
        let largest =
            largest.max_by(|&a, &b| differences[a].abs().total_cmp(&differences[b].abs()));
        if let Some(row) = largest {
            let difference = json!({"mean": differences[row], "se": errors[row]});
            story.found.push(format!(
                "The counted G1 differs most from Smith's at sigma = {}, θ = {}°: by {}.",
                short(sigma[row]),
                short(theta[row]),
                words::estimate_or_dash(&difference)
            ));
        }
        if let Some([low, high]) = range(column("lit")) {
            story
                .found
                .push(format!("From {low:.3} to {high:.3} of all points are lit."));
        }
    }
    story.sure.push(format!(
        "Standard errors by the scatter between {}.",
        counted(
            config["run"]["realisations"].as_u64().unwrap_or(0),
            "surface"
        )
    ));
    Ok(story)
}

/// Directional albedos.
pub(super) fn albedo(folder: &Folder) -> Result<Story, PageError> {
    let summary = &folder.summary;
    let count = |key: &str| summary[key].as_array().map_or(0, Vec::len) as u64;
    let mut story = Story::default();
    let materials = summary["materials"].as_array().into_iter().flatten();
    let materials: Vec<String> = materials
        .filter_map(|one| one["name"].as_str())
        .map(str::to_owned)
        .collect();
    story.asked.push(format!(
        "How much light do rough surfaces of {} send back and through? {} of roughness, {} of incidence.",
        words::listed(&materials),
        counted(count("alphas"), "value"),
        counted(count("cosines"), "cosine")
    ));
    if let Some(rows) = folder.rows("albedo.csv")? {
        let column = |name| rows.numbers(name).unwrap_or_default();
        if let Some([low, high]) = range(column("E_R")) {
            story.found.push(format!(
                "Reflected light of all orders, E_R, is {low:.4} to {high:.4}."
            ));
        }
        if let Some([_, high]) = range(column("ratio_R")) {
            story.found.push(format!(
                "It is up to {high:.3} times that of single scattering by Smith's model."
            ));
        }
        if let Some([_, high]) = range(column("E_R_se")) {
            story.sure.push(format!(
                "The largest standard error of E_R is {}.",
                two_digits(high)
            ));
        }
    }
    let rays = summary["rays"].as_u64().unwrap_or(0);
    story.sure.push(format!("{} in all.", counted(rays, "ray")));
    Ok(story)
}

/// Roughness of a height map.
pub(super) fn inspect(folder: &Folder) -> Story {
    let surface = &folder.summary["surface"];
    let number = |key: &str| surface[key].as_f64().map_or("–".to_owned(), short);
    let unit = match surface["unit"].as_str() {
        Some("1") | None => String::new(),
        Some(unit) => format!(" {unit}"),
    };
    let mut story = Story::default();
    story.asked.push(format!(
        "How rough is this surface? {} × {} samples.",
        surface["shape"][1], surface["shape"][0]
    ));
    story.found.push(format!(
        "Root mean square height Sq = {}{unit}, mean absolute height Sa = {}{unit}, from lowest to highest point Sz = {}{unit}.",
        number("sq"),
        number("sa"),
        number("sz")
    ));
    story.found.push(format!(
        "Root mean square gradient Sdq = {}; correlation lengths {}{unit} along x and {}{unit} along y.",
        number("sdq"),
        number("tau_x"),
        number("tau_y")
    ));
    story.sure.push(
        "The numbers describe this surface, not an ensemble that it may come from.".to_owned(),
    );
    let sigma = &surface["realised"]["sigma"];
    if let (Some(requested), Some(realised), Some(expected)) = (
        sigma["requested"].as_f64(),
        sigma["realised"].as_f64(),
        sigma["expected_deviation"].as_f64(),
    ) {
        story.sure.push(format!(
            "It was drawn with sigma = {}, realised {}; {} is the deviation to expect of one surface.",
            short(requested),
            short(realised),
            short(expected)
        ));
    }
    story
}
