//! Value text: reads the value of a setting as it is written on the command line.
//!
//! A part `FIRST:LAST:STEP` of a list of numbers stands for even steps, both ends included: `400:700:10nm`. A unit of one of the three is that of all.

use serde_json::Value;

use super::command::Command;
use super::kind::Kind;
use super::number::parse_number;
use super::setting::{Arity, Setting};

/// The value of these texts of the command line; `None` if they are invalid.
pub(super) fn read_text(setting: &Setting, command: Command, texts: &[String]) -> Option<Value> {
    let one = |text: &str| setting.kind.parse(text.trim(), setting.range);
    if setting.arity == Arity::Repeated {
        let values = texts.iter().map(|text| one(text));
        let values = values.collect::<Option<Vec<_>>>()?;
        return Some(<[Value; 1]>::try_from(values).map_or_else(Value::from, |[one]| one));
    }
    let [text] = texts else {
        return None;
    };
    if setting.was_radiance(command) && parse_number(text).is_ok() {
        return None;
    }
    if setting.kind == Kind::Models && text == "none" {
        return Some(Value::Array(Vec::new()));
    }
    let separators: &[char] = match setting.arity {
        Arity::PerAxis => &[',', 'x', 'X'],
        Arity::One if !setting.is_list(command) => &[],
        Arity::ListIn(_) if !setting.is_list(command) => &[],
        _ => &[','],
    };
    let parts = text.split(separators).map(|part| match setting.kind {
        kind if kind.has_steps() && setting.is_list(command) => steps(part),
        _ => Some(vec![part.to_owned()]),
    });
    let parts = parts.collect::<Option<Vec<_>>>()?;
    let values = parts.iter().flatten().map(|part| one(part));
    let values: Vec<Value> = values.collect::<Option<_>>()?;
    match (setting.arity, values.as_slice()) {
        (Arity::Tuple(names), values) if values.len() != names.len() => None,
        (Arity::PerAxis, [_, _, _, ..]) => None,
        (Arity::Tuple(_), _) => Some(values.into()),
        _ if setting.kind == Kind::Models => Some(values.into()),
        (_, [value]) => Some(value.clone()),
        _ => Some(values.into()),
    }
}

/// Most values of even steps.
const MAX_STEPS: f64 = 20_000.0;

/// Digits to which values of even steps are rounded, so that those of decimal steps are decimal.
const DIGITS: usize = 12;

/// The values of `FIRST:LAST:STEP`, each with its unit; a part of any other form by itself. `None` for steps that do not lead from the first to
/// the last.
fn steps(part: &str) -> Option<Vec<String>> {
    let ends: Vec<&str> = part.split(':').collect();
    let [first, last, step] = ends[..] else {
        return Some(vec![part.to_owned()]);
    };
    let unit = |text: &str| {
        let number = text.trim_end_matches(char::is_alphabetic);
        text[number.len()..].to_owned()
    };
    let units = [first, last, step].map(|text| unit(text.trim()));
    let given: Vec<&String> = units.iter().filter(|unit| !unit.is_empty()).collect();
    let own = given.first().map_or("", |unit| unit.as_str());
    if given.iter().any(|unit| *unit != own) {
        return None;
    }
    let number = |text: &str| parse_number(text.trim().trim_end_matches(char::is_alphabetic)).ok();
    let (first, last, step) = (number(first)?, number(last)?, number(step)?);
    let count = (last - first) / step;
    if !(0.0..MAX_STEPS).contains(&count) {
        return None;
    }
    // The last value may miss the end by rounding
    if (count - count.round()).abs() > 1e-9 * count.max(1.0) {
        return None;
    }
    let values = (0..=count.round() as u32).map(|i| {
        let value = first + f64::from(i) * step;
        let rounded: f64 = format!("{value:.DIGITS$e}").parse().unwrap_or(value);
        format!("{rounded}{own}")
    });
    Some(values.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_steps_hold_both_ends_and_share_a_unit() {
        let listed = |part: &str| steps(part).map(|values| values.join(" "));
        let found = |part: &str| listed(part).unwrap_or_else(|| "refused".to_owned());
        assert_eq!(found("400:700:100nm"), "400nm 500nm 600nm 700nm");
        assert_eq!(found("400nm:700nm:100nm"), "400nm 500nm 600nm 700nm");
        assert_eq!(found("0:0.3:0.1"), "0 0.1 0.2 0.3");
        assert_eq!(found("80:0:-40"), "80 40 0");
        assert_eq!(found("5:5:1"), "5");
        assert_eq!(found("1/1.4"), "1/1.4");
        for part in [
            "400:700:-10",
            "400:700:0",
            "0:85:20",
            "400:700:1e5",
            "400um:700nm:10nm",
            "400nm:700:10um",
            "0:1e9:1",
            "a:b:c",
        ] {
            assert_eq!(found(part), "refused", "{part}");
        }
    }
}
