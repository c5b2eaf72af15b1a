//! Value text: reads the value of a setting as it is written on the command line.

use serde_json::Value;

use super::command::Command;
use super::kind::Kind;
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
    if setting.kind == Kind::Models && text == "none" {
        return Some(Value::Array(Vec::new()));
    }
    let separators: &[char] = match setting.arity {
        Arity::PerAxis => &[',', 'x', 'X'],
        Arity::One if !setting.is_list(command) => &[],
        Arity::ListIn(_) if !setting.is_list(command) => &[],
        _ => &[','],
    };
    let values: Vec<Value> = text.split(separators).map(one).collect::<Option<_>>()?;
    match (setting.arity, values.as_slice()) {
        (Arity::Tuple(names), values) if values.len() != names.len() => None,
        (Arity::PerAxis, [_, _, _, ..]) => None,
        (Arity::Tuple(_), _) => Some(values.into()),
        _ if setting.kind == Kind::Models => Some(values.into()),
        (_, [value]) => Some(value.clone()),
        _ => Some(values.into()),
    }
}
