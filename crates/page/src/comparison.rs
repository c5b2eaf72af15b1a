//! Comparison: energies and settings of several folders next to each other.

use serde_json::{Value, json};

use crate::cases::{Case, ENERGIES};
use crate::words::estimate_or_dash;

/// One quantity of all folders.
pub(crate) struct Difference {
    pub(crate) case: String,
    pub(crate) quantity: &'static str,
    pub(crate) values: Vec<String>,
    /// The last folder less the first.
    pub(crate) difference: String,
    /// The difference over its standard error; `None` without an error.
    pub(crate) z: Option<f64>,
}

impl Difference {
    /// The difference in standard errors as text.
    pub(crate) fn z_text(&self) -> String {
        self.z
            .map_or_else(|| "–".to_owned(), |z| format!("{z:+.1}"))
    }
}

/// Energies of the cases that all folders have.
pub(crate) struct Differences {
    pub(crate) rows: Vec<Difference>,
    /// Number of cases that are compared.
    pub(crate) cases: usize,
    /// Number of cases that some folder lacks.
    pub(crate) unmatched: usize,
}

/// Differences between the cases with the same label in all folders. If there are none, and all folders have the same number of cases, cases
/// are compared in their order.
pub(crate) fn differences(folders: &[Vec<Case>]) -> Differences {
    let first = folders.first().map_or(&[][..], Vec::as_slice);
    let same_label = |case: &Case| -> Option<Vec<&Case>> {
        let find = |cases: &'_ Vec<Case>| cases.iter().position(|other| other.label == case.label);
        let found = folders.iter().map(|cases| Some(&cases[find(cases)?]));
        found.collect()
    };
    let mut matched: Vec<Vec<&Case>> = first.iter().filter_map(same_label).collect();
    if matched.is_empty() && folders.iter().all(|cases| cases.len() == first.len()) {
        let same_number = |number| folders.iter().map(|cases| &cases[number]).collect();
        matched = (0..first.len()).map(same_number).collect();
    }
    let largest = folders.iter().map(Vec::len).max().unwrap_or(0);
    Differences {
        cases: matched.len(),
        unmatched: largest - matched.len(),
        rows: matched.iter().flat_map(|cases| of_cases(cases)).collect(),
    }
}

/// Energies of one case of all folders.
fn of_cases(cases: &[&Case]) -> Vec<Difference> {
    let mut labels: Vec<&str> = cases.iter().map(|case| case.label.as_str()).collect();
    labels.dedup();
    let case = labels.join("; ");
    let of_quantity = |quantity: &'static str| {
        let values: Vec<&Value> = cases.iter().map(|case| &case.energy[quantity]).collect();
        let is_there = |value: &&Value| value["mean"].as_f64().is_some_and(|mean| mean != 0.0);
        if !values.iter().any(is_there) {
            return None;
        }
        let (difference, z) = difference(values[0], values[values.len() - 1]);
        Some(Difference {
            case: case.clone(),
            quantity,
            values: values.into_iter().map(estimate_or_dash).collect(),
            difference,
            z,
        })
    };
    ENERGIES.into_iter().filter_map(of_quantity).collect()
}

/// Difference of two independent estimates, and the difference over its standard error.
fn difference(first: &Value, last: &Value) -> (String, Option<f64>) {
    let parts = |value: &Value| Some((value["mean"].as_f64()?, value["se"].as_f64()?));
    let (Some((a, a_se)), Some((b, b_se))) = (parts(first), parts(last)) else {
        return ("–".to_owned(), None);
    };
    let se = a_se.hypot(b_se);
    let estimate = json!({"mean": b - a, "se": se});
    let z = (se > 0.0).then(|| (b - a) / se);
    (estimate_or_dash(&estimate), z)
}

/// Settings whose values differ between folders.
pub(crate) fn settings(all: &[&[(String, String)]]) -> Vec<(String, Vec<String>)> {
    let mut keys: Vec<&String> = all
        .iter()
        .flat_map(|settings| settings.iter().map(|(key, _)| key))
        .collect();
    keys.sort();
    keys.dedup();
    let value = |settings: &[(String, String)], key: &String| {
        let found = settings.iter().find(|(name, _)| name == key);
        found.map_or("–".to_owned(), |(_, value)| value.clone())
    };
    let rows = keys.into_iter().map(|key| {
        (
            key.clone(),
            all.iter().map(|settings| value(settings, key)).collect(),
        )
    });
    rows.filter(|(_, values): &(String, Vec<String>)| {
        values.iter().any(|value| *value != values[0])
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_have_the_errors_of_both() {
        let first = json!({"mean": 0.3, "se": 0.003});
        let last = json!({"mean": 0.31, "se": 0.004});
        let (text, z) = difference(&first, &last);
        assert_eq!(text, "0.0100 ± 0.0050");
        assert!((z.unwrap() - 2.0).abs() < 1e-9);
        assert_eq!(difference(&first, &Value::Null).0, "–");
    }

    #[test]
    fn only_settings_that_differ_are_listed() {
        let of = |eta: &str, rays: &[&str]| {
            let rays = rays
                .iter()
                .map(|rays| ("run.rays".to_owned(), (*rays).to_owned()));
            [("material.eta".to_owned(), eta.to_owned())]
                .into_iter()
                .chain(rays)
                .collect::<Vec<_>>()
        };
        let found = settings(&[&of("1.5", &["10"]), &of("1.5", &[])]);
        assert_eq!(
            found,
            [("run.rays".to_owned(), vec!["10".to_owned(), "–".to_owned()])]
        );
    }
}
