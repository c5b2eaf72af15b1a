//! The verdicts on a case in words.

use asperity_numerics::elementary::log10;
use asperity_simulate::short;
use std::fmt::Write;

use asperity_analysis::{Comparison, Verdict};
use asperity_tally::{Component, TallySpec};

use crate::comparison::judgement::Judgement;
use crate::output::{distance, wrapped};

/// The most significant deviation of a model from the light, as a fraction of the light.
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
    if mean > 0.0 {
        let _ = write!(place, " {:+.1} %", 100.0 * (expected / mean - 1.0));
    }
    Some(place)
}

/// A positive number to so many significant digits.
fn round_to(value: f64, digits: i32) -> f64 {
    let unit = 10_f64.powi(log10(value).floor() as i32 + 1 - digits);
    (value / unit).round() * unit
}

/// Degrees without the rounding of the conversion through radians.
fn round_degrees(degrees: f64) -> f64 {
    (degrees * 1e6).round() / 1e6
}

/// A verdict in words. A model that is not rejected may still be wrong by less than the error.
pub(crate) const fn verdict_name(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::NotRejected => "not rejected",
        Verdict::Rejected => "rejected",
        Verdict::NotResolved(_) => "not resolved",
    }
}

/// The sentences that say which models are rejected: one for each component of the light that a model describes.
pub(crate) fn conclusion(case: &Judgement<'_>) -> String {
    let level = short(round_to(case.level, 2));
    let sentences: Vec<String> = [
        (Component::Single, "Single scattering"),
        (Component::Multiple, "Multiple scattering"),
        (Component::Unscattered, "Light never scattered inside"),
        (Component::ScatteredOnce, "Light scattered inside once"),
        (Component::All, "All orders together"),
    ]
    .into_iter()
    .filter_map(|(component, name)| {
        let clauses = clauses(case, component)?;
        Some(wrapped(&format!(
            "{name}, tested at level {level}: {clauses}."
        )))
    })
    .collect();
    sentences.join("\n")
}

/// The conclusion with the meaning of a rejection, if there is one.
pub(crate) fn explained_conclusion(case: &Judgement<'_>) -> String {
    let components = case.models.iter().flat_map(|model| &model.components);
    let mut verdicts = components.map(|(_, compared)| &compared.verdict);
    let conclusion = conclusion(case);
    match verdicts.any(|verdict| matches!(verdict, Some(Verdict::Rejected))) {
        true => format!("{conclusion}\n(rejected: the difference is real, not that it is large)"),
        false => conclusion,
    }
}

/// The test of one model.
#[derive(Clone, Copy)]
struct Tested<'a> {
    name: &'a str,
    comparison: &'a Comparison,
    verdict: &'a Verdict,
}

/// Sentence on the models that describe a component of the light; `None` if none does.
fn clauses(case: &Judgement<'_>, component: Component) -> Option<String> {
    let tested = case.models.iter().filter_map(|model| {
        let compared = model.compared(component)?;
        Some(Tested {
            name: model.model.name(),
            comparison: &compared.comparison,
            verdict: compared.verdict.as_ref()?,
        })
    });
    let tested: Vec<Tested<'_>> = tested.collect();
    let of = |is: fn(&Verdict) -> bool| tested.iter().copied().filter(move |t| is(t.verdict));
    let not_rejected = of(|verdict| matches!(verdict, Verdict::NotRejected));
    let rejected = of(|verdict| matches!(verdict, Verdict::Rejected));
    let not_resolved = of(|verdict| matches!(verdict, Verdict::NotResolved(_)));
    let mut clauses = Vec::new();
    clauses.extend(clause_not_rejected(&not_rejected.collect::<Vec<_>>()));
    clauses.extend(rejected.map(|tested| {
        let found = &tested.comparison.total_variation;
        let place = strongest_deviation(tested.comparison, case.spec()).unwrap_or_default();
        format!(
            "{} is rejected, most clearly in {place} (total variation {}, noise alone {})",
            tested.name,
            distance(found.observed),
            distance(found.noise.unwrap_or(0.0)),
        )
    }));
    let not_resolved: Vec<Tested<'_>> = not_resolved.collect();
    if let Some(Verdict::NotResolved(reason)) = not_resolved.first().map(|tested| tested.verdict) {
        let (names, are) = named(&not_resolved);
        clauses.push(format!("{names} {are} not resolved ({reason})"));
    }
    (!clauses.is_empty()).then(|| clauses.join("; "))
}

fn clause_not_rejected(tested: &[Tested<'_>]) -> Option<String> {
    if tested.is_empty() {
        return None;
    }
    let noise = tested
        .iter()
        .filter_map(|tested| tested.comparison.total_variation.noise_95)
        .fold(0.0, f64::max);
    let (names, are) = named(tested);
    Some(format!(
        "{names} {are} not rejected (in total variation, noise alone reaches {})",
        distance(noise),
    ))
}

/// The names of models, and the verb that goes with them.
fn named(tested: &[Tested<'_>]) -> (String, &'static str) {
    let names: Vec<&str> = tested.iter().map(|tested| tested.name).collect();
    match names.as_slice() {
        [] => (String::new(), "are"),
        [one] => ((*one).to_owned(), "is"),
        [most @ .., last] => (format!("{} and {last}", most.join(", ")), "are"),
    }
}
