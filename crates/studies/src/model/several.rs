//! Several: a model at every combination of lists of values.

use std::path::Path;

use asperity_simulate::short;
use serde_json::{Value, json};

use super::directions::MAX_ROWS;
use super::error::EvaluationError;
use super::evaluation::{Evaluation, columns};
use crate::config::error::ConfigError;
use crate::output::Head;
use crate::report::views::Csv;

/// A model with one value of each list.
struct Part {
    values: Vec<f64>,
    /// The values in words.
    label: String,
    evaluation: Box<dyn Evaluation>,
}

/// A model at every combination of lists of values.
pub(super) struct Several {
    /// Names of the lists.
    names: Vec<&'static str>,
    parts: Vec<Part>,
    notes: Vec<String>,
}

impl Several {
    /// Evaluations by the values of the lists of these `names`, of which there is one or more.
    ///
    /// # Errors
    /// [`EvaluationError`] of an evaluation, or if all together have too many rows.
    pub(super) fn of(
        names: Vec<&'static str>,
        evaluations: impl Iterator<Item = Result<(Vec<f64>, Box<dyn Evaluation>), EvaluationError>>,
    ) -> Result<Self, EvaluationError> {
        let (mut parts, mut notes, mut rows) = (Vec::new(), Vec::new(), 0.0);
        for evaluated in evaluations {
            let (values, evaluation) = evaluated?;
            rows += evaluation.rows().0 as f64;
            if rows > MAX_ROWS {
                return Err(ConfigError::unsuitable(
                    "the rows of all combinations of the lists",
                    format!("must be at most {MAX_ROWS:.0e}"),
                )
                .into());
            }
            let pairs = names.iter().zip(&values);
            let words: Vec<String> = pairs
                .map(|(name, value)| format!("{name} = {}", short(*value)))
                .collect();
            let label = words.join(", ");
            let of_part = evaluation.notes().iter();
            notes.extend(of_part.map(|note| format!("{label}: {note}")));
            parts.push(Part {
                values,
                label,
                evaluation,
            });
        }
        Ok(Self {
            names,
            parts,
            notes,
        })
    }
}

impl Evaluation for Several {
    fn table(&self) -> Csv<'_> {
        let parts = self.parts.iter();
        let parts = parts.map(|part| (part.values.clone(), part.evaluation.table()));
        Csv::stacked(&self.names, parts)
    }

    fn is_listed(&self) -> bool {
        self.parts.iter().all(|part| part.evaluation.is_listed())
    }

    fn rows(&self) -> (usize, &'static str) {
        let rows = self.parts.iter().map(|part| part.evaluation.rows());
        let add = |(count, _), (more, kind)| (count + more, kind);
        rows.fold((0, ""), add)
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn description(&self) -> &'static str {
        let first = self.parts.first();
        first.map_or("", |part| part.evaluation.description())
    }

    fn text(&self) -> String {
        let parts = self.parts.iter();
        let texts = parts.map(|part| match part.evaluation.text() {
            text if text.is_empty() => text,
            text => format!("\n{}\n{text}", part.label),
        });
        texts.collect()
    }

    fn summary(&self, file: Option<&Path>) -> Value {
        let case = |part: &Part| {
            let mut summary = part.evaluation.summary(None);
            let pairs = self.names.iter().zip(&part.values);
            let at = pairs.map(|(&name, value)| (name.to_owned(), json!(value)));
            summary["at"] = Value::Object(at.collect());
            summary
        };
        let mut summary = json!({
            "cases": self.parts.iter().map(case).collect::<Vec<_>>(),
            "columns": columns(&self.table(), file),
        });
        Head::of("model").insert_into(&mut summary);
        summary
    }
}
