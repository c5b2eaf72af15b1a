//! The scale of heights: a full range in volts, and a sensitivity in nanometres per volt.

use super::header::{Header, Section};
use crate::error::ReadProblem;
use crate::height_maps::instruments::measured::length_unit;
use crate::height_maps::unit::PowerOfMetre;
use crate::text_lines::short;

/// Height of a step of the whole numbers.
pub(super) struct HeightScale {
    pub(super) step: f64,
    pub(super) unit: PowerOfMetre,
}

impl HeightScale {
    /// The scale of a channel, or `None` if its numbers are no lengths.
    pub(super) fn of(header: &Header, channel: &Section) -> Result<Option<Self>, ReadProblem> {
        let fields = &channel.fields;
        let Some(text) = fields
            .get("@4:Z scale")
            .or_else(|| fields.get("@2:Z scale"))
        else {
            return Err(ReadProblem::unsupported(
                "its channels have no `@2:Z scale`; versions before 4.3 are not read",
            ));
        };
        let bits = 8 * bytes_per_pixel(channel)?;
        let range = Value::parse(text)?;
        let step = range.number / 2_f64.powi(bits as i32);
        let Some(name) = range.scaled_by else {
            return Ok(length_unit(range.unit).map(|unit| Self { step, unit }));
        };
        let Some(text) = header.sensitivity(&format!("@{name}")) else {
            return Ok(None);
        };
        let sensitivity = Value::parse(text)?;
        // nm/V, for a range in V or mV
        let Some((length, per)) = sensitivity.unit.split_once('/') else {
            return Ok(None);
        };
        let Some(unit) = length_unit(length) else {
            return Ok(None);
        };
        let [Some(of_range), Some(per)] = [range.unit, per].map(volts) else {
            return Err(ReadProblem::unsupported(format_args!(
                "its heights are in `{}` and scaled by `{}`, but volts are needed",
                short(range.unit),
                short(sensitivity.unit)
            )));
        };
        Ok(Some(Self {
            step: step * (of_range / per) * sensitivity.number,
            unit,
        }))
    }
}

/// Bytes per number that the scale is of, 2 or 4.
pub(super) fn bytes_per_pixel(channel: &Section) -> Result<u64, ReadProblem> {
    let Some(text) = channel.fields.get("Bytes/pixel") else {
        return Ok(2);
    };
    match text {
        "2" => Ok(2),
        "4" => Ok(4),
        _ => Err(ReadProblem::unsupported(format_args!(
            "its numbers have {} bytes, but 2 or 4 are needed",
            short(text)
        ))),
    }
}

/// A value as `V [Sens. Zsens] (0.0067 V/LSB) 2.910461 V` gives it.
struct Value<'a> {
    /// In square brackets: the sensitivity that it is to be multiplied by.
    scaled_by: Option<&'a str>,
    number: f64,
    unit: &'a str,
}

impl<'a> Value<'a> {
    fn parse(text: &'a str) -> Result<Self, ReadProblem> {
        let refuse = || {
            ReadProblem::malformed(format_args!(
                "its header has the value `{}`, but one like `V [Sens. Zsens] (0.0067 V/LSB) 2.91 V` is needed",
                short(text)
            ))
        };
        let mut rest = text.trim().strip_prefix('V').ok_or_else(refuse)?.trim();
        let mut scaled_by = None;
        if let Some(after) = rest.strip_prefix('[') {
            let (name, after) = after.split_once(']').ok_or_else(refuse)?;
            scaled_by = Some(name.trim()).filter(|name| !name.is_empty());
            rest = after.trim();
        }
        if rest.starts_with('(') {
            rest = rest
                .get(parenthesis_end(rest).ok_or_else(refuse)?..)
                .unwrap_or_default()
                .trim();
        }
        let (number, unit) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let number = number.parse().ok().filter(|x: &f64| x.is_finite());
        Ok(Self {
            scaled_by,
            number: number.ok_or_else(refuse)?,
            unit: unit.trim(),
        })
    }
}

/// Offset of the end of the parenthesis that `text` begins with; units may have some inside.
fn parenthesis_end(text: &str) -> Option<usize> {
    let mut depth = 0;
    for (k, byte) in text.bytes().enumerate() {
        match byte {
            b'(' => depth += 1,
            b')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(k + 1);
        }
    }
    None
}

/// Volts in a unit of voltage.
fn volts(unit: &str) -> Option<f64> {
    match unit.trim() {
        "V" => Some(1.0),
        "mV" => Some(1e-3),
        "uV" | "\u{b5}V" | "~V" => Some(1e-6),
        _ => None,
    }
}
