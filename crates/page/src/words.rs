//! Words: numbers and labels as the page writes them.

use asperity_studies::EstimateWithLimit;
use serde::Deserialize;
use serde_json::Value;

/// A mean with its error from a summary, as in `0.024812 ± 0.000042`; a dash if there is none.
pub(crate) fn estimate_or_dash(value: &Value) -> String {
    match EstimateWithLimit::deserialize(value) {
        Ok(estimate) => line(&estimate.text()),
        Err(_) => "–".to_owned(),
    }
}

/// A line of text with the signs of the field, as in `0.0248 ± 0.0001 at 30°`.
pub(crate) fn line(line: &str) -> String {
    line.replace(" +- ", " ± ").replace(" deg", "°")
}

/// A label of a case with the signs of the field, as in `s = 3, n = 1.4, θᵢ = 30°`.
pub(crate) fn label(label: &str) -> String {
    let label = label.replace("theta = ", "θᵢ = ");
    let label = label.replace("phi = ", "φᵢ = ");
    label.replace(" deg", "°")
}

/// A number of things with its noun, thousands apart, as in `1,000,000 rays`.
pub(crate) fn counted(count: u64, noun: &str) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    let plural = if count == 1 { "" } else { "s" };
    format!("{text} {noun}{plural}")
}

/// A positive number to two digits, as in `2.1 × 10⁻³`, which no line breaks.
pub(crate) fn two_digits(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 || (0.01..100.0).contains(&value) {
        let digits = if value == 0.0 {
            0
        } else {
            (1 - value.log10().floor() as i32).max(0)
        };
        return format!("{value:.0$}", digits as usize);
    }
    let text = format!("{value:.1e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let raised = |c: char| match c {
        '-' => '⁻',
        digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹']
            [digit.to_digit(10).unwrap_or(0) as usize],
    };
    let exponent: String = exponent.chars().map(raised).collect();
    format!("{mantissa}\u{a0}×\u{a0}10{exponent}")
}

/// Names in one phrase, as in `a, b and c`.
pub(crate) fn listed(names: &[String]) -> String {
    match names {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// A text as a sentence.
pub(crate) fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    format!(
        "{}{}.",
        first.unwrap_or_default(),
        letters.as_str().trim_end_matches('.')
    )
}

/// Texts of a list of a summary.
pub(crate) fn texts(value: &Value) -> Vec<String> {
    let all = value.as_array().into_iter().flatten();
    all.filter_map(Value::as_str).map(str::to_owned).collect()
}

/// A size of a file.
pub(crate) fn size(bytes: usize) -> String {
    match bytes {
        0..1000 => format!("{bytes} B"),
        1000..1_000_000 => format!("{} kB", bytes / 1000),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn estimates_have_the_digits_of_their_errors() {
        let mean = json!({"mean": 0.024_812_3, "se": 0.000_041_7});
        assert_eq!(estimate_or_dash(&mean), "0.024812 ± 0.000042");
        let exact = json!({"mean": 0.0, "se": 0.0, "exact": true});
        assert_eq!(estimate_or_dash(&exact), "0 (exact)");
        let none_seen = json!({"mean": 0.0, "se": 0.0, "below": 9.2e-5});
        assert_eq!(estimate_or_dash(&none_seen), "0 (< 9.2e-5, 95 %)");
        assert_eq!(estimate_or_dash(&Value::Null), "–");
    }

    #[test]
    fn counts_and_lists_read_as_text() {
        assert_eq!(counted(1, "ray"), "1 ray");
        assert_eq!(counted(1_002_528, "ray"), "1,002,528 rays");
        let names = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(listed(&names), "a, b and c");
        assert_eq!(two_digits(0.00213), "2.1\u{a0}×\u{a0}10⁻³");
        assert_eq!([0.0412, 12.346, 0.0].map(two_digits), ["0.041", "12", "0"]);
        assert_eq!(label("s = 3, theta = 30 deg"), "s = 3, θᵢ = 30°");
    }
}
