//! Header of `name=value` lines, as interferometers write it.

use asperity_surface::LengthUnit;

use crate::error::ReadProblem;
use crate::height_maps::unit::PowerOfMetre;
use crate::text_lines::{Line, short};

/// Fields of the header, where they are present.
#[derive(Default)]
pub(super) struct Header {
    /// Rows.
    pub(super) h: Option<u64>,
    /// Columns.
    pub(super) w: Option<u64>,
    pixel_size: Option<(f64, PowerOfMetre)>,
    data_unit: Option<String>,
    conversion: Option<f64>,
}

impl Header {
    pub(super) fn take_line(&mut self, line: Line<'_>, text: &str) -> Result<(), ReadProblem> {
        let pair = |part: &str| -> Option<(String, String)> {
            let (name, value) = part.rsplit_once('=')?;
            Some((name.trim().to_ascii_lowercase(), value.trim().to_owned()))
        };
        let words: Option<Vec<_>> = text
            .split_whitespace()
            .map(|word| pair(word).filter(|(name, value)| !name.is_empty() && !value.is_empty()))
            .collect();
        // Several name=value words on one line, or one name of several words.
        let pairs = match words {
            Some(words) => words,
            None => pair(text).into_iter().collect(),
        };
        for (name, value) in pairs {
            self.take(line, &name, &value)?;
        }
        Ok(())
    }

    fn take(&mut self, line: Line<'_>, name: &str, value: &str) -> Result<(), ReadProblem> {
        let refuse = |needed: &str| {
            line.refuse_at(
                0,
                format_args!(
                    "{} is `{}`, but {needed} is needed",
                    short(name),
                    short(value)
                ),
            )
        };
        let positive = |text: &str| {
            let number = text.parse::<f64>().ok();
            number.filter(|x| x.is_finite() && *x > 0.0)
        };
        let again = match name {
            "h" | "w" => {
                let number = value.parse::<u64>().ok().filter(|n| *n > 0);
                let number = number.ok_or_else(|| refuse("a positive whole number"))?;
                let slot = if name == "h" {
                    &mut self.h
                } else {
                    &mut self.w
                };
                slot.replace(number).is_some()
            }
            "pixel size" => {
                let needed = "a positive number and a unit of length";
                let (number, unit) = value
                    .split_once(char::is_whitespace)
                    .and_then(|(number, unit)| {
                        Some((positive(number)?, PowerOfMetre::parse(unit)?))
                    })
                    .ok_or_else(|| refuse(needed))?;
                self.pixel_size.replace((number, unit)).is_some()
            }
            "data unit" => self.data_unit.replace(value.to_owned()).is_some(),
            "height conversion factor (-> m)" => {
                let number = positive(value).ok_or_else(|| refuse("a positive finite number"))?;
                self.conversion.replace(number).is_some()
            }
            _ => {
                return Err(line.refuse_at(
                    0,
                    format_args!(
                        "`{}` is an unknown header field; allowed are h, w, pixel size, data unit and height conversion factor (-> m)",
                        short(name)
                    ),
                ));
            }
        };
        if again {
            return Err(line.refuse_at(0, format_args!("the header field {name} is given twice")));
        }
        Ok(())
    }

    /// Scales the heights; returns spacing and unit.
    pub(super) fn apply(&self, heights: &mut [f64]) -> Result<([f64; 2], LengthUnit), ReadProblem> {
        let scale = |heights: &mut [f64], by: &dyn Fn(f64) -> f64| {
            for height in heights {
                *height = by(*height);
            }
        };
        let Some((size, size_unit)) = self.pixel_size else {
            return if self.data_unit.is_none() && self.conversion.is_none() {
                Ok(([1.0, 1.0], LengthUnit::Arbitrary))
            } else {
                Err(ReadProblem::unsupported(
                    "its header scales the heights but has no `pixel size`, which is needed too",
                ))
            };
        };
        let unit = size_unit.kept_as();
        let data_unit = self.data_unit.as_deref().and_then(PowerOfMetre::parse);
        let vertical = match (self.conversion, data_unit) {
            (Some(factor), _) => {
                scale(heights, &|h| h * factor);
                PowerOfMetre(0)
            }
            (None, Some(own)) => own,
            (None, None) => {
                return Err(ReadProblem::unsupported(format_args!(
                    "its heights are in `{}`, but without a `height conversion factor (-> m)` a unit of length is needed",
                    self.data_unit.as_deref().map(short).unwrap_or_default()
                )));
            }
        };
        let mut spacing = size;
        if let (Some(lateral), Some(vertical)) = (size_unit.convert(unit), vertical.convert(unit)) {
            spacing = lateral(size);
            scale(heights, &vertical);
        }
        Ok(([spacing, spacing], unit))
    }
}
