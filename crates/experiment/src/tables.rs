//! Results as text that people read.

use std::fmt::Write;

use asperity_analysis::{Comparison, Verdict};
use asperity_tally::{BatchStatistics, Estimate, Layout, Side};

use crate::config::short;
use crate::summary::SummaryWork;
use crate::verify::{CaseOutcome, ModelOutcome, VerifyOutcome};

/// A flux fraction with its error, as in `0.02481 +- 0.00004`: the error to two digits.
pub(crate) fn with_error(estimate: Estimate) -> String {
    match estimate.se {
        Some(se) if se > 0.0 => {
            let digits = (1 - se.log10().floor() as i32).clamp(0, 12) as usize;
            format!("{:.digits$} +- {se:.digits$}", estimate.mean)
        }
        Some(_) => format!("{} (exact)", short(estimate.mean)),
        None => format!("{} (no error)", short(estimate.mean)),
    }
}

/// Energies, orders and event paths of one run.
#[must_use]
pub fn energy_table(layout: &Layout, statistics: &BatchStatistics) -> String {
    let mut out = String::new();
    let names = ["reflected", "transmitted", "absorbed", "truncated", "lost"];
    for (i, name) in names.into_iter().enumerate() {
        let _ = writeln!(out, "  {name:<12} {}", with_error(statistics.estimate(i)));
    }
    let residual = statistics.means()[..5].iter().sum::<f64>() - 1.0;
    let _ = writeln!(out, "  sum - 1      {residual:.1e}");
    for side in Side::BOTH {
        let fluxes: Vec<String> = (1..=4)
            .map(|order| statistics.estimate(layout.order(side, order)))
            .enumerate()
            .filter(|(_, flux)| flux.mean != 0.0)
            .map(|(i, flux)| format!("{}: {}", i + 1, with_error(flux)))
            .collect();
        if !fluxes.is_empty() {
            let _ = writeln!(out, "  {side} by order  {}", fluxes.join(",  "));
        }
    }
    out
}

/// One line about the effort.
#[must_use]
pub fn work_line(work: &SummaryWork) -> String {
    format!(
        "{} rays, {} segments searched and {} skipped, accelerator {}, {:.1} s on {} threads",
        work.rays,
        work.segments,
        work.segments_skipped,
        work.accelerator,
        work.seconds,
        work.threads
    )
}

/// The comparison of every case.
#[must_use]
pub fn verify_table(outcome: &VerifyOutcome) -> String {
    let mut out = String::new();
    for case in &outcome.cases {
        out.push_str(&case_table(outcome, case));
        out.push('\n');
    }
    if outcome.cases.len() > 1 {
        out.push_str(&overview(outcome));
    }
    out
}

/// The comparison of one case.
pub(crate) fn case_table(outcome: &VerifyOutcome, case: &CaseOutcome) -> String {
    let mut out = String::new();
    let [nx, ny] = outcome.config.surface.size.xy().map(|n| n.0);
    let _ = writeln!(out, "{}", case.case);
    let surfaces = case.work.realisations;
    let plural = if surfaces == 1 { "" } else { "s" };
    let _ = writeln!(
        out,
        "{surfaces} surface{plural} of {nx} x {ny}, {} rays; standard errors from {} {}\n",
        case.work.rays,
        case.statistics.batches(),
        case.errors_from,
    );

    let _ = write!(out, "{:<24}{:<26}", "flux fraction", "explicit");
    for model in &case.models {
        let _ = write!(out, "{:<26}", model.model.name());
    }
    out.push('\n');
    for side in Side::BOTH {
        for (part, estimate) in parts(&outcome.layout, case, side) {
            let _ = write!(
                out,
                "{:<24}{:<26}",
                format!("{side} {part}"),
                with_error(estimate)
            );
            for model in &case.models {
                let _ = write!(out, "{:<26}", beside(model, side, part, estimate));
            }
            out.truncate(out.trim_end().len());
            out.push('\n');
        }
    }
    for (i, name) in [(2, "absorbed"), (3, "truncated"), (4, "lost")] {
        let _ = writeln!(out, "{name:<24}{}", with_error(case.statistics.estimate(i)));
    }
    if !case.models.is_empty() {
        out.push('\n');
        out.push_str(&distribution_table(case));
        let _ = writeln!(out, "\n{}", conclusion(case));
    }
    out
}

/// The parts of the light of one side: scattered once, more often, and all.
fn parts(layout: &Layout, case: &CaseOutcome, side: Side) -> [(&'static str, Estimate); 3] {
    let statistics = &case.statistics;
    [
        ("single", statistics.estimate(layout.order(side, 1))),
        ("multiple", statistics.estimate(layout.multiple(side))),
        ("total", statistics.estimate(side.index())),
    ]
}

/// A model's energy and its distance from the explicit one in standard errors.
fn beside(model: &ModelOutcome, side: Side, part: &str, explicit: Estimate) -> String {
    let energy = match side {
        Side::Reflected => model.energy.reflected,
        Side::Transmitted => model.energy.transmitted,
    };
    match (part, explicit.se) {
        ("multiple", _) => "-".to_owned(),
        (_, Some(se)) if se > 0.0 => {
            let digits = (1 - se.log10().floor() as i32).clamp(0, 12) as usize;
            format!(
                "{energy:.digits$} (z {:+.1})",
                (explicit.mean - energy) / se
            )
        }
        _ => short(energy),
    }
}

/// Total variation, p value and verdict of every model.
fn distribution_table(case: &CaseOutcome) -> String {
    let mut out = String::new();
    let tested = case.models[0]
        .single
        .bins
        .iter()
        .filter(|bin| bin.tested)
        .count();
    let _ = write!(
        out,
        "{:<50}",
        format!("distribution of single scattering, {tested} bins")
    );
    for model in &case.models {
        let _ = write!(out, "{:<26}", model.model.name());
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    type Cell = fn(&Comparison) -> String;
    let optional = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.5}"));
    let rows: [(&str, Cell); 3] = [
        ("total variation distance", |c| {
            format!("{:.5}", c.total_variation.observed)
        }),
        ("largest |t| over bins", |c| {
            c.test
                .map_or("-".to_owned(), |test| format!("{:.1}", test.max_t))
        }),
        ("p value, sign flips of surfaces", |c| {
            c.test
                .map_or("-".to_owned(), |test| format!("{:.4}", test.p))
        }),
    ];
    for (i, (name, cell)) in rows.into_iter().enumerate() {
        let _ = write!(out, "  {name:<48}");
        for model in &case.models {
            let _ = write!(out, "{:<26}", cell(&model.single));
        }
        out.truncate(out.trim_end().len());
        out.push('\n');
        if i == 0 {
            let _ = write!(out, "  {:<48}", "  of which noise would cause, mean");
            for model in &case.models {
                let noise = optional(model.single.total_variation.noise);
                let _ = write!(out, "{noise:<26}");
            }
            out.truncate(out.trim_end().len());
            out.push('\n');
        }
    }
    let _ = write!(out, "  {:<48}", "total variation distance from all light");
    for model in &case.models {
        let _ = write!(
            out,
            "{:<26}",
            format!("{:.5}", model.total.total_variation.observed)
        );
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    let _ = write!(out, "  {:<48}", "verdict");
    for model in &case.models {
        let _ = write!(out, "{:<26}", verdict_word(&model.verdict));
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

/// One word for a verdict.
pub(crate) fn verdict_word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Fails => "fails",
        Verdict::NotResolved(_) => "not resolved",
    }
}

/// The sentence that says which model holds within the error.
pub(crate) fn conclusion(case: &CaseOutcome) -> String {
    let named = |wanted: &str| -> Vec<&ModelOutcome> {
        case.models
            .iter()
            .filter(|m| verdict_word(&m.verdict) == wanted)
            .collect()
    };
    let list = |models: &[&ModelOutcome]| {
        let names: Vec<&str> = models.iter().map(|m| m.model.name()).collect();
        match names.as_slice() {
            [] => String::new(),
            [one] => (*one).to_owned(),
            [most @ .., last] => format!("{} and {last}", most.join(", ")),
        }
    };
    let verb = |models: &[&ModelOutcome], one: &str, several: &str| {
        if models.len() == 1 {
            one.to_owned()
        } else {
            several.to_owned()
        }
    };
    let (holds, fails, open) = (named("holds"), named("fails"), named("not resolved"));
    let mut clauses = Vec::new();
    if !holds.is_empty() {
        let seen = holds
            .iter()
            .filter_map(|m| m.single.total_variation.noise_95)
            .fold(0.0, f64::max);
        clauses.push(format!(
            "{} {} within the error (noise alone reaches a total variation of {seen:.5})",
            list(&holds),
            verb(&holds, "holds", "hold"),
        ));
    }
    if !fails.is_empty() {
        let distances: Vec<String> = fails
            .iter()
            .map(|m| format!("{:.5}", m.single.total_variation.observed))
            .collect();
        clauses.push(format!(
            "{} {} (total variation {})",
            list(&fails),
            verb(&fails, "fails", "fail"),
            distances.join(", "),
        ));
    }
    if !open.is_empty() {
        let reason = match &open[0].verdict {
            Verdict::NotResolved(reason) => reason.to_string(),
            _ => String::new(),
        };
        clauses.push(format!(
            "{} {} not resolved ({reason})",
            list(&open),
            verb(&open, "is", "are")
        ));
    }
    format!(
        "Single scattering, tested at level {}: {}.",
        short(case.level),
        clauses.join("; ")
    )
}

/// A line a case and model, for runs of many cases.
fn overview(outcome: &VerifyOutcome) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "{:<36}{:<18}{:<24}{:<12}{:<10}verdict",
        "case", "model", "total variation (noise)", "p value", "multiple"
    );
    for case in &outcome.cases {
        let multiple: f64 = Side::BOTH
            .map(|side| case.statistics.means()[outcome.layout.multiple(side)])
            .iter()
            .sum();
        for model in &case.models {
            let tv = &model.single.total_variation;
            let noise = tv.noise.map_or("-".to_owned(), |n| format!("{n:.5}"));
            let p = model
                .single
                .test
                .map_or("-".to_owned(), |t| format!("{:.4}", t.p));
            let _ = writeln!(
                out,
                "{:<36}{:<18}{:<24}{p:<12}{multiple:<10.5}{}",
                case.case.to_string(),
                model.model.name(),
                format!("{:.5} ({noise})", tv.observed),
                verdict_word(&model.verdict),
            );
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_two_digits_and_means_as_many_places() {
        let estimate = |mean, se| with_error(Estimate { mean, se: Some(se) });
        assert_eq!(estimate(0.024_812_3, 0.000_041_7), "0.024812 +- 0.000042");
        assert_eq!(estimate(0.5, 0.0), "0.5 (exact)");
        assert_eq!(
            with_error(Estimate {
                mean: 0.25,
                se: None
            }),
            "0.25 (no error)"
        );
    }
}
