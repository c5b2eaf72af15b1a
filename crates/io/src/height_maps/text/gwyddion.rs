//! Comments that Gwyddion writes above a matrix of text:
//! ```text
//! # Channel: Topography
//! # Width: 50 um
//! # Height: 50 um
//! # Value units: nm
//! ```
//! Width and height are the extents of all pixels, so that the spacing is the width over the number of
//! columns. Heights are converted to the unit of the width.

use asperity_surface::LengthUnit;

use crate::error::ReadProblem;
use crate::height_maps::unit::PowerOfMetre;
use crate::text_lines::short;

/// The comments that say what the numbers are, as far as they are there.
#[derive(Default)]
pub(super) struct Comments {
    width: Option<String>,
    height: Option<String>,
    value_units: Option<String>,
}

impl Comments {
    /// Takes the text of a comment; those of no such name are left.
    pub(super) fn take(&mut self, comment: &str) {
        let Some((name, value)) = comment.split_once(':') else {
            return;
        };
        let slot = match name.trim().to_ascii_lowercase().as_str() {
            "width" => &mut self.width,
            "height" => &mut self.height,
            "value units" => &mut self.value_units,
            _ => return,
        };
        slot.get_or_insert_with(|| value.trim().to_owned());
    }

    /// Scales the heights of a map of this shape `[ny, nx]`; returns spacing and unit, or `None` without such comments.
    pub(super) fn apply(
        &self,
        [ny, nx]: [usize; 2],
        heights: &mut [f64],
    ) -> Result<Option<([f64; 2], LengthUnit)>, ReadProblem> {
        let given = [&self.width, &self.height, &self.value_units];
        // One alone may be any comment
        if given.iter().filter(|value| value.is_some()).count() < 2 {
            return Ok(None);
        }
        let of = |name: &str, value: &Option<String>| match value {
            Some(value) => Ok(value.clone()),
            None => Err(refuse(name, "is missing")),
        };
        let [width, height] = [("Width", &self.width), ("Height", &self.height)].map(
            |(name, value)| -> Result<_, ReadProblem> {
                let value = of(name, value)?;
                length(&value).ok_or_else(|| refuse(name, format_args!("is `{}`", short(&value))))
            },
        );
        let ((width, width_unit), (height, height_unit)) = (width?, height?);
        let units = of("Value units", &self.value_units)?;
        let vertical = PowerOfMetre::parse(&units)
            .ok_or_else(|| refuse("Value units", format_args!("is `{}`", short(&units))))?;
        let unit = width_unit.kept_as();
        let converted = [width_unit, height_unit, vertical].map(|own| own.convert(unit));
        let [Some(along_x), Some(along_y), Some(up)] = converted else {
            return Ok(None);
        };
        for z in heights {
            *z = up(*z);
        }
        let spacing = [along_x(width) / nx as f64, along_y(height) / ny as f64];
        Ok(Some((spacing, unit)))
    }
}

/// A positive number and a unit of length; some languages write a decimal comma.
fn length(text: &str) -> Option<(f64, PowerOfMetre)> {
    let (number, unit) = text.split_once(char::is_whitespace)?;
    let number: f64 = number.replace(',', ".").parse().ok()?;
    (number.is_finite() && number > 0.0).then_some((number, PowerOfMetre::parse(unit)?))
}

fn refuse(name: &str, what: impl std::fmt::Display) -> ReadProblem {
    ReadProblem::unsupported(format_args!(
        "its comments say what its numbers are, but `{name}` {what}; needed are Width and Height, each a positive number and a unit of length, and Value units, a unit of length"
    ))
}
