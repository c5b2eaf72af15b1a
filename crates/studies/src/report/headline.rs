//! Headline: the first lines of a result. How much light leaves, which model holds within what, how sure that is, and what is left out.
//!
//! The printed text and report.txt begin with these lines. Pages read them from the key `headline` of summary.json.

use asperity_simulate::{Outcome, counted};
use asperity_tally::{Component, Side, TallyResult};
use asperity_tracer::PathSettings;

use crate::comparison::judgement::Judgement;
use crate::output::{EstimateWithLimit, TEXT_WIDTH, fitted, percent, range_text, two_digits};
use crate::report::appearance::{SampleLight, appearance_line};
use crate::report::flux_basis::FluxBasis;
use crate::validity::Validity;

/// Fraction of truncated light below which a headline leaves it out.
const MIN_TRUNCATED: f64 = 1e-5;

/// Light of one case, with what a headline tells of it.
pub(crate) struct CaseLight<'a> {
    pub(crate) outcome: &'a Outcome,
    /// Comparison with models, if there is one.
    pub(crate) judgement: Option<&'a Judgement<'a>>,
    /// Lengths against the wavelength; `None` if their unit is not known.
    pub(crate) validity: Option<Validity>,
    pub(crate) sample: SampleLight<'a>,
}

/// Headline of cases that are traced, and compared with models if they have any.
pub(crate) fn of_light(cases: &[CaseLight<'_>], max_order: u32) -> Vec<String> {
    let outcomes: Vec<&Outcome> = cases.iter().map(|case| case.outcome).collect();
    let mut lines: Vec<String> = light_line(&outcomes).into_iter().collect();
    let appearance = match cases {
        [one] => appearance_line(one.sample),
        _ => None,
    };
    let has_appearance = appearance.is_some();
    lines.extend(appearance);
    let all = model_line(cases, Component::All);
    let explained = all.as_ref().map(|(_, distance)| explanation(*distance));
    let single = (all.is_some() && !has_appearance).then(|| model_line(cases, Component::Single));
    lines.extend(
        all.into_iter()
            .chain(single.flatten())
            .map(|(line, _)| line),
    );
    let errors = errors_line(&outcomes);
    let both = errors.as_ref().zip(explained);
    let both = both.map(|(errors, text)| format!("{text}; {}", errors.replace("standard ", "")));
    // Distances too small for the line need no explanation.
    lines.extend(both.filter(|line| line.len() <= TEXT_WIDTH).or(errors));
    let validities = cases.iter().map(|case| case.validity);
    lines.push(left_out(&outcomes, validities, max_order));
    lines
}

/// Line with the fractions of the light that leave and that are absorbed; ranges of several cases. `None` without results.
pub(crate) fn light_line(outcomes: &[&Outcome]) -> Option<String> {
    let first = outcomes.first()?;
    let of_side = |side: Side| {
        let flux = move |one: &&Outcome| {
            let flux = one.statistics.flux(side, Component::All);
            FluxBasis::of(one).flux(side, flux)
        };
        (
            side.to_string(),
            outcomes.iter().map(flux).collect::<Vec<_>>(),
        )
    };
    let absorbed = |one: &&Outcome| FluxBasis::of(one).absorbed(one.statistics.budget().absorbed);
    let absorbed = (
        "absorbed".to_owned(),
        outcomes.iter().map(absorbed).collect(),
    );
    let parts = first
        .statistics
        .spec()
        .sides()
        .map(of_side)
        .chain([absorbed]);
    let parts: Vec<(String, Vec<EstimateWithLimit>)> = parts
        .filter(|(_, fluxes)| fluxes.iter().any(|one| one.estimate().mean > 0.0))
        .collect();
    let cases = match outcomes.len() {
        1 => String::new(),
        several => format!(" in {}", counted(several as u64, "case")),
    };
    let line = |text: fn(&[EstimateWithLimit]) -> String| {
        let parts = parts.iter();
        let parts = parts.map(|(name, fluxes)| format!("{name} {}", text(fluxes)));
        parts.collect::<Vec<_>>().join(", ")
    };
    let with_errors = line(|fluxes| match fluxes {
        [one] => one.text(),
        several => range_of(several),
    });
    let of_light = format!(" of the light{cases}");
    // Numbers with small errors take the room of the words, and of the errors.
    let fits = |line: &String| line.chars().count() <= TEXT_WIDTH;
    let all = [
        with_errors.clone() + &of_light,
        with_errors,
        line(range_of) + &of_light,
    ];
    Some(
        all.iter()
            .find(|line| fits(line))
            .unwrap_or(&all[2])
            .clone(),
    )
}

/// Smallest and largest mean of estimates.
fn range_of(estimates: &[EstimateWithLimit]) -> String {
    let means = estimates.iter().map(|one| one.estimate().mean);
    range_text(means).unwrap_or_else(|| "-".to_owned())
}

/// Line that says how far models are from a component of the light at most in any case, the nearest first, and the distance of the nearest; `None`
/// if no model is compared with it.
fn model_line(cases: &[CaseLight<'_>], component: Component) -> Option<(String, f64)> {
    let mut models: Vec<(&str, f64)> = Vec::new();
    for model in cases
        .iter()
        .filter_map(|case| case.judgement)
        .flat_map(|one| &one.models)
    {
        let Some(compared) = model.compared(component) else {
            continue;
        };
        // All light is compared with every model, whatever it leaves out
        if component != Component::All && !model.describes(component) {
            continue;
        }
        // By the triangle inequality the truth is no further away, in 95 of 100 cases
        let found = &compared.comparison.total_variation;
        let bound = (found.observed + found.noise_95.unwrap_or(0.0)).min(1.0);
        match models
            .iter_mut()
            .find(|(name, _)| *name == model.model.name())
        {
            Some((_, most)) => *most = most.max(bound),
            None => models.push((model.model.name(), bound)),
        }
    }
    models.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let (_, nearest) = *models.first()?;
    let parts: Vec<String> = models
        .iter()
        .map(|(name, bound)| format!("{name} {}", percent(*bound)))
        .collect();
    let light = match component {
        Component::All => "of all light, models hold within: ",
        _ => "of single scattering: ",
    };
    Some((fitted(light, &parts, ""), nearest))
}

/// Meaning of a total variation distance.
fn explanation(distance: f64) -> String {
    let of = (0..).map(|k| 10_u64.pow(k + 2)).take(7);
    let of = of
        .clone()
        .find(|of| *of as f64 * distance >= 1.95)
        .unwrap_or(100);
    let rays = (of as f64 * distance).round();
    format!(
        "total variation {}: {rays} of {of} rays go elsewhere",
        percent(distance)
    )
}

/// Clause on the standard errors; `None` without results.
pub(crate) fn errors_line(outcomes: &[&Outcome]) -> Option<String> {
    let batches = outcomes.iter().map(|one| one.statistics.batches());
    let (fewest, most) = (batches.clone().min()?, batches.max()?);
    let batches = match fewest == most {
        true => fewest.to_string(),
        false => format!("{fewest} to {most}"),
    };
    Some(format!(
        "standard errors from {batches} {}",
        outcomes[0].errors_from
    ))
}

/// Line on what the results leave out: diffraction, coherent light, mesh errors, and paths that were truncated or lost.
pub(crate) fn left_out(
    outcomes: &[&Outcome],
    validities: impl Iterator<Item = Option<Validity>>,
    max_order: u32,
) -> String {
    let judged: Vec<Option<Validity>> = validities.collect();
    let known = || judged.iter().copied().flatten();
    let coherent = outcomes.iter().zip(&judged);
    let coherent = coherent
        .filter_map(|(one, validity)| Some(validity.as_ref()?.most_coherent(&one.statistics)));
    let coherent = coherent.fold(0.0, f64::max);
    let doubtful = known().filter(|one| one.holds == Some(false)).count();
    let mut parts = Vec::new();
    let most = |of: fn(&Outcome) -> f64| outcomes.iter().map(|one| of(one)).fold(0.0, f64::max);
    let lost = most(|one| one.statistics.budget().lost.mean);
    if lost > 0.0 {
        parts.push(format!("{} lost", percent(lost)));
    }
    let truncated = most(|one| one.statistics.budget().truncated.mean);
    if truncated > MIN_TRUNCATED {
        parts.push(format!("{} truncated", percent(truncated)));
    }
    parts.push(match doubtful {
        _ if known().next().is_none() => "diffraction (no unit of length is given)".to_owned(),
        0 => "diffraction, negligible here".to_owned(),
        _ if coherent > 0.01 => format!("diffraction (up to {} coherent light)", percent(coherent)),
        _ => "diffraction (lengths near the wavelength)".to_owned(),
    });
    if max_order < PathSettings::DEFAULT_MAX_ORDER {
        parts.push(format!("orders above {max_order}"));
    }
    let mesh = outcomes.iter().flat_map(|one| {
        let sides = one.statistics.spec().sides();
        sides.map(|side| one.errors.flux(side, Component::All).mesh)
    });
    let mesh: Option<Vec<f64>> = mesh.collect();
    match mesh.map(|all| {
        all.into_iter()
            .fold(0.0, |most, one| f64::max(most, one.abs()))
    }) {
        None => parts.push("mesh error".to_owned()),
        Some(most) if most > 0.0 => parts.push(format!("mesh error up to {}", two_digits(most))),
        Some(_) => {}
    }
    fitted("left out: ", &parts, "")
}

/// Report: a headline, and tables below it.
pub(crate) fn with_tables(headline: &[String], tables: &str) -> String {
    format!("{}\n\n{tables}", headline.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_is_explained_by_rays() {
        let text = [0.0019, 0.021, 0.4, 3e-6].map(explanation);
        let expected = [
            "total variation 0.19 %: 19 of 10000 rays go elsewhere",
            "total variation 2.1 %: 2 of 100 rays go elsewhere",
            "total variation 40 %: 40 of 100 rays go elsewhere",
            "total variation 0.00030 %: 3 of 1000000 rays go elsewhere",
        ];
        assert_eq!(text, expected);
    }
}
