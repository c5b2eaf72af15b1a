//! Sentences of a story, and what they are made of.

use asperity_simulate::short;
use serde_json::Value;

use crate::cases::Case;
use crate::words;

/// The sentences at the top of a page.
#[derive(Default)]
pub(crate) struct Story {
    pub(crate) asked: Vec<String>,
    pub(crate) found: Vec<String>,
    pub(crate) sure: Vec<String>,
}

/// Smallest and largest finite number; `None` without finite numbers.
pub(super) fn range(numbers: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = numbers.into_iter().filter(|number| number.is_finite());
    finite.fold(None, |range, number| match range {
        None => Some([number, number]),
        Some([low, high]) => Some([f64::min(low, number), f64::max(high, number)]),
    })
}

/// The mean of an estimate in a summary; NaN if it is missing.
pub(super) fn mean(value: &Value) -> f64 {
    value["mean"].as_f64().unwrap_or(f64::NAN)
}

/// The angles of a list, as in `0°, 30° and 60°`; the ends of a long one.
pub(super) fn angles(values: &Value) -> String {
    let all: Vec<f64> = values
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_f64)
        .collect();
    let text = |angle: &f64| format!("{}°", short(*angle));
    match all.as_slice() {
        [first, .., last] if all.len() > 6 => format!(
            "{} angles from {} to {}",
            all.len(),
            text(first),
            text(last)
        ),
        few => words::listed(&few.iter().map(text).collect::<Vec<_>>()),
    }
}

/// Sentence on a part of the light in several cases, as in `From 0.0228 ± 0.0001 to 0.065 ± 0.002 of the incident light is reflected.`; `None`
/// if there is none.
pub(super) fn light_of(cases: &[Case], part: &str) -> Option<String> {
    let all = cases.iter().map(|case| &case.energy[part]);
    let mut all: Vec<&Value> = all.filter(|value| mean(value).is_finite()).collect();
    all.sort_by(|a, b| mean(a).total_cmp(&mean(b)));
    let (first, last) = (all.first()?, all.last()?);
    if mean(last) <= 0.0 {
        return None;
    }
    let [low, high] = [first, last].map(|value| words::estimate_or_dash(value));
    Some(match all.len() {
        1 => format!("Of the incident light {low} is {part}."),
        _ => format!("From {low} to {high} of the incident light is {part}."),
    })
}
