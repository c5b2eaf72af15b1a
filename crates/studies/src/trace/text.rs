//! The report of traced surfaces as text.

use std::fmt::Write;

use asperity_simulate::{Case, CaseGroup};

use super::comparison_text::{comparison_text, distributions_text};
use super::outcome::{TraceOutcome, TraceOutcomes};
use crate::output::wrapped;
use crate::report::appearance::appearance_text;
use crate::report::energies::{energy_table, errors_table};
use crate::report::flux_basis::FluxBasis;
use crate::report::polarised::polarised_text;
use crate::report::spectrum_views::spectra_text;

/// The report of the case; of several their spectra, and the notes on the first.
pub(super) fn traces_table(found: &TraceOutcomes) -> String {
    let [first, _, ..] = found.each.as_slice() else {
        return found.each.first().map(trace_table).unwrap_or_default();
    };
    let Some(spectra) = spectra_text(found.planned, &found.outcomes()) else {
        let each = found.each.iter().map(trace_table);
        return each.collect::<Vec<_>>().join("\n");
    };
    let mut text = format!("{}\n{spectra}", first.study.name);
    for warning in first.warnings() {
        let _ = writeln!(text, "note: {}: {warning}", first.outcome.case.label());
    }
    wrapped(&text)
}

/// Surfaces and light, then energies, errors and notes.
fn trace_table(outcome: &TraceOutcome) -> String {
    let found = outcome.outcome;
    let validity = outcome.study.validity;
    let first_lines = validity.and_then(|validity| validity.first_lines(&found.statistics));
    let mut text = format!(
        "{}, {}\n{}flux fractions; standard errors from {} {}\n{}",
        outcome.study.name,
        light_line(&found.case),
        first_lines.map_or_else(String::new, |line| line + "\n"),
        found.statistics.batches(),
        found.errors_from,
        energy_table(&found.statistics, &FluxBasis::of(found)),
    );
    if let Some(comparison) = &outcome.comparison {
        text.push_str(&comparison_text(comparison));
    }
    if let Some(line) = outcome
        .stopping()
        .and_then(|stopping| stopping.line(found.case.at.unit))
    {
        let _ = writeln!(text, "{line}");
    }
    if let Some(note) = validity.and_then(|validity| validity.note()) {
        let _ = writeln!(text, "{}", wrapped(&format!("note: {note}")));
    }
    for warning in outcome.warnings() {
        let _ = writeln!(text, "note: {warning}");
    }
    let _ = write!(
        text,
        "\n{}{}{}",
        appearance_text(outcome.sample_light()),
        polarised_text(&found.statistics),
        errors_table(&found.errors),
    );
    if let Some(comparison) = &outcome.comparison {
        text.push_str(&distributions_text(outcome, comparison));
    }
    wrapped(&text)
}

/// The light, and what it falls on.
fn light_line(case: &Case) -> String {
    let parts = case.setting_parts().into_iter();
    let parts = parts.filter(|part| part.group != CaseGroup::Light);
    let parts: Vec<String> = parts.map(|part| part.text()).collect();
    format!("{}, {}", parts.join(", "), case.light_text())
}
