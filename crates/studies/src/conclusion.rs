//! The verdicts on a case in words.

use asperity_simulate::short;
use std::fmt::Write;

use asperity_analysis::{Comparison, Verdict};
use asperity_tally::{Component, TallySpec};

use crate::output::{distance, wrapped};
use crate::verify::CaseOutcome;

/// Where light deviates most significantly from a model, and by how much of the model.
pub(crate) fn strongest_deviation(comparison: &Comparison, spec: &TallySpec) -> Option<String> {
    let test = comparison.test.as_ref().ok()?;
    let strongest = test.strongest();
    let grid = spec.grid();
    let width = match strongest.name.as_str() {
        "sides" => grid.bins_per_side(),
        "rings" => grid.n_phi(),
        _ => 1,
    };
    let first = strongest.member * width;
    let bins = &comparison.bins[first..first + width];
    let [mean, expected] = [
        bins.iter().map(|b| b.mean).sum::<f64>(),
        bins.iter().map(|b| b.model).sum::<f64>(),
    ];
    let bin = grid.bin(spec.recorded_bins().start + first);
    let degrees = |range: [f64; 2]| {
        let [from, to] = range.map(|angle| short(round_degrees(angle.to_degrees())));
        format!("{from}-{to}")
    };
    let mut place = bin.side.to_string();
    if width < grid.bins_per_side() {
        let _ = write!(place, " {} deg", degrees(bin.theta));
    }
    if width == 1 {
        let _ = write!(place, " phi {}", degrees(bin.phi));
    }
    if expected > 0.0 {
        let _ = write!(place, " {:+.1} %", 100.0 * (mean / expected - 1.0));
    }
    Some(place)
}

/// A positive number to so many significant digits.
fn round_to(value: f64, digits: i32) -> f64 {
    let unit = 10_f64.powi(value.log10().floor() as i32 + 1 - digits);
    (value / unit).round() * unit
}

/// Degrees without the rounding of their way through radians.
fn round_degrees(degrees: f64) -> f64 {
    (degrees * 1e6).round() / 1e6
}

/// One word for a verdict.
pub(crate) fn verdict_word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Fails => "fails",
        Verdict::NotResolved(_) => "not resolved",
    }
}

/// The sentences that say which models hold within the error: one for each share of the light that a
/// model claims.
pub(crate) fn conclusion(spec: &TallySpec, case: &CaseOutcome) -> String {
    let level = short(round_to(case.level, 2));
    let sentences: Vec<String> = [
        (Component::Single, "Single scattering"),
        (Component::Multiple, "Multiple scattering"),
        (Component::Unscattered, "Light never scattered inside"),
        (Component::ScatteredOnce, "Light scattered inside once"),
        (Component::All, "All orders together"),
    ]
    .into_iter()
    .filter_map(|(part, name)| {
        let clauses = clauses(spec, case, part)?;
        Some(wrapped(&format!(
            "{name}, tested at level {level}: {clauses}."
        )))
    })
    .collect();
    sentences.join("\n")
}

/// What is said of the models that claim a part of the light; `None` if none does.
fn clauses(spec: &TallySpec, case: &CaseOutcome, part: Component) -> Option<String> {
    let claims: Vec<(&str, &Comparison, &Verdict)> = case
        .models
        .iter()
        .filter_map(|model| {
            let part = model.compared(part)?;
            Some((model.model.name(), &part.comparison, part.verdict.as_ref()?))
        })
        .collect();
    let named = |wanted: &str| -> Vec<(&str, &Comparison, &Verdict)> {
        let mut claims = claims.clone();
        claims.retain(|(_, _, verdict)| verdict_word(verdict) == wanted);
        claims
    };
    let list = |claims: &[(&str, &Comparison, &Verdict)]| {
        let names: Vec<&str> = claims.iter().map(|claim| claim.0).collect();
        match names.as_slice() {
            [] => String::new(),
            [one] => (*one).to_owned(),
            [most @ .., last] => format!("{} and {last}", most.join(", ")),
        }
    };
    let (holds, fails, open) = (named("holds"), named("fails"), named("not resolved"));
    let mut clauses = Vec::new();
    if !holds.is_empty() {
        let seen = holds
            .iter()
            .filter_map(|(_, comparison, _)| comparison.total_variation.noise_95)
            .fold(0.0, f64::max);
        clauses.push(format!(
            "{} {} within the error (in total variation, noise alone reaches {})",
            list(&holds),
            if holds.len() == 1 { "holds" } else { "hold" },
            distance(seen),
        ));
    }
    for (name, comparison, _) in &fails {
        let found = &comparison.total_variation;
        let noise = found.noise.unwrap_or(0.0);
        let place = strongest_deviation(comparison, spec).unwrap_or_default();
        clauses.push(format!(
            "{name} fails, most clearly in {place} (total variation {}, noise alone {})",
            distance(found.observed),
            distance(noise),
        ));
    }
    if let Some((_, _, Verdict::NotResolved(reason))) = open.first() {
        clauses.push(format!(
            "{} {} not resolved ({reason})",
            list(&open),
            if open.len() == 1 { "is" } else { "are" },
        ));
    }
    (!clauses.is_empty()).then(|| clauses.join("; "))
}
