//! Line: numbers, ranges and lists as they stand in one line of text.

use super::align::TEXT_WIDTH;
use super::number::significant;

/// Smallest and largest finite number, once if they are one.
pub(crate) fn range_text(numbers: impl Iterator<Item = f64>) -> Option<String> {
    let [low, high] = range(numbers)?;
    Some(match low == high {
        true => low,
        false => format!("{low} to {high}"),
    })
}

/// Smallest and largest finite number, to three digits; `None` without any.
pub(crate) fn range(numbers: impl Iterator<Item = f64>) -> Option<[String; 2]> {
    let mut numbers: Vec<f64> = numbers.filter(|number| number.is_finite()).collect();
    numbers.sort_by(f64::total_cmp);
    Some([numbers.first()?, numbers.last()?].map(|number| significant(*number)))
}

/// A fraction in percent, to two digits.
pub(crate) fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    if percent == 0.0 {
        return "0 %".to_owned();
    }
    // Of the rounded number
    let rounded = format!("{percent:.1e}");
    let exponent: Option<i32> = rounded
        .rsplit('e')
        .next()
        .and_then(|text| text.parse().ok());
    match (1 - exponent.unwrap_or(0)).max(0) {
        digits @ 0..6 => format!("{percent:.0$} %", digits as usize),
        _ => format!("{rounded} %"),
    }
}

/// A model's flux less the explicit one, in percent of the explicit one, in brackets; nothing where no light is.
pub(crate) fn relative(model: f64, explicit: f64) -> String {
    if explicit <= 0.0 {
        return String::new();
    }
    let off = model / explicit - 1.0;
    let sign = if off > 0.0 { "+" } else { "" };
    format!(" ({sign}{})", percent(off))
}

/// Line of `before`, as many of `parts` as fit, at least one, and `after`.
pub(crate) fn fitted(before: &str, parts: &[String], after: &str) -> String {
    const MORE: &str = ", ...";
    let mut line = before.to_owned();
    for (i, part) in parts.iter().enumerate() {
        let comma = if i == 0 { "" } else { ", " };
        let is_last = i + 1 == parts.len();
        let needed = comma.len() + part.len() + after.len() + if is_last { 0 } else { MORE.len() };
        if i > 0 && line.chars().count() + needed > TEXT_WIDTH {
            line.push_str(MORE);
            break;
        }
        line.push_str(comma);
        line.push_str(part);
    }
    line + after
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_have_two_digits() {
        let text = [0.0, 0.001_62, 0.552, 1.0, 3.96e-7, 2e-9].map(percent);
        assert_eq!(relative(0.85, 1.0), " (-15 %)");
        assert_eq!(relative(1.001, 1.0), " (+0.10 %)");
        assert_eq!(relative(1.0, 0.0), "");
        assert_eq!(
            text,
            ["0 %", "0.16 %", "55 %", "100 %", "4.0e-5 %", "2.0e-7 %"]
        );
    }

    #[test]
    fn a_line_holds_as_many_parts_as_fit() {
        let parts: Vec<String> = (0..30).map(|i| format!("part {i}")).collect();
        let line = fitted("all: ", &parts, " of it");
        assert!(
            line.len() <= TEXT_WIDTH && line.ends_with(", ... of it"),
            "{line}"
        );
        assert_eq!(fitted("", &parts[..2], "."), "part 0, part 1.");
    }
}
