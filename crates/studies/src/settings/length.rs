//! Length: a number with or without a unit of length behind it.

use asperity_surface::LengthUnit;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::number::parse_number;

/// A length as it was given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Length {
    /// In the unit of the surface.
    Plain(f64),
    /// With a unit of its own.
    WithUnit {
        /// The number.
        length: f64,
        /// Its unit.
        unit: LengthUnit,
    },
}

impl Length {
    /// Reads `1.4`, `1/1.4` or `2um`; `None` for any other text.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let split = text
            .char_indices()
            .rev()
            .take_while(|(_, c)| c.is_alphabetic())
            .last()
            .map_or(text.len(), |(start, _)| start);
        let (number, symbol) = text.split_at(split);
        let length = parse_number(number).ok()?;
        if symbol.is_empty() {
            return Some(Self::Plain(length));
        }
        let unit = symbol.parse::<LengthUnit>().ok()?;
        Some(Self::WithUnit { length, unit }).filter(|_| unit != LengthUnit::Arbitrary)
    }

    /// The length of a value; `None` if it is of another kind.
    pub(super) fn of(value: &Value) -> Option<Self> {
        match value {
            Value::Number(_) | Value::Object(_) => serde_json::from_value(value.clone()).ok(),
            _ => None,
        }
    }

    /// The number, whatever its unit is.
    #[must_use]
    pub const fn number(self) -> f64 {
        match self {
            Self::Plain(length) | Self::WithUnit { length, .. } => length,
        }
    }

    /// The length in the `unit` of the surface; `None` if it has a unit and the surface has none.
    #[must_use]
    pub fn in_unit(self, unit: LengthUnit) -> Option<f64> {
        match self {
            Self::Plain(length) => Some(length),
            Self::WithUnit { length, unit: own } => Some(own.conversion(unit)?(length)),
        }
    }
}

/// Lengths of a value as numbers in `unit`; `None` where that is not possible.
pub(super) fn in_unit(value: &Value, unit: LengthUnit) -> Option<Value> {
    match value {
        Value::Array(values) => values.iter().map(|value| in_unit(value, unit)).collect(),
        Value::Object(_) => Length::of(value)?.in_unit(unit).map(Value::from),
        value => Some(value.clone()),
    }
}

/// The unit of the first length of a value that has one.
pub(super) fn first_unit(value: &Value) -> Option<LengthUnit> {
    match value {
        Value::Array(values) => values.iter().find_map(first_unit),
        value => match Length::of(value)? {
            Length::Plain(_) => None,
            Length::WithUnit { unit, .. } => Some(unit),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_may_have_a_unit() {
        let with = |length, unit| Some(Length::WithUnit { length, unit });
        assert_eq!(Length::parse("2e-3"), Some(Length::Plain(2e-3)));
        assert_eq!(Length::parse("5um"), with(5.0, LengthUnit::Micrometre));
        assert_eq!(
            Length::parse("5 \u{b5}m"),
            with(5.0, LengthUnit::Micrometre)
        );
        assert_eq!(Length::parse("1e3mm"), with(1e3, LengthUnit::Millimetre));
        assert_eq!(Length::parse("1/4km"), with(0.25, LengthUnit::Kilometre));
        for bad in ["", "um", "5 miles", "5 1", "inf", "nan", "5e", "1e3 u m"] {
            assert_eq!(Length::parse(bad), None, "{bad}");
        }
    }

    #[test]
    fn lengths_are_converted_where_units_are_known() {
        let length = Length::parse("5um").unwrap();
        assert_eq!(length.in_unit(LengthUnit::Nanometre), Some(5000.0));
        assert_eq!(length.in_unit(LengthUnit::Arbitrary), None);
        let plain = Length::parse("5").unwrap();
        assert_eq!(plain.in_unit(LengthUnit::Arbitrary), Some(5.0));
        assert_eq!(plain.in_unit(LengthUnit::Metre), Some(5.0));
    }
}
