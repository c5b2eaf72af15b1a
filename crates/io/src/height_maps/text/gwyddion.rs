//! Comments that Gwyddion writes above a matrix of text:
//! ```text
//! # Channel: Topography
//! # Width: 50 um
//! # Height: 50 um
//! # Value units: nm
//! ```
//! Width and height are the extents of all pixels, so that the spacing is the width over the number of
//! columns. Heights are converted to the unit of the width. The names are in the language of the program, and are
//! known by their order then.

use asperity_surface::LengthUnit;

use crate::error::ReadProblem;
use crate::height_maps::unit::PowerOfMetre;
use crate::text_lines::{decimal, short};

/// Names of the comments that say what the numbers are.
const NAMES: [&str; 3] = ["Width", "Height", "Value units"];

/// Number of comments, with that of the channel.
const COMMENTS: usize = 4;

/// Most letters of a unit.
const MAX_UNIT: usize = 4;

/// Most comments that are kept.
const MAX_COMMENTS: usize = 64;

/// Comments of the form `name: value`.
#[derive(Default)]
pub(super) struct Comments(Vec<(String, String)>);

impl Comments {
    /// Takes the text of a comment; those of another form are left.
    pub(super) fn take(&mut self, comment: &str) {
        if let Some((name, value)) = comment.split_once([':', '\u{ff1a}'])
            && self.0.len() < MAX_COMMENTS
        {
            self.0
                .push((name.trim().to_owned(), value.trim().to_owned()));
        }
    }

    /// Width, height and unit of the values, those of them that are there.
    fn given(&self) -> [Option<&str>; 3] {
        let named = NAMES.map(|name| {
            let mut all = self.0.iter();
            let found = all.find(|(own, _)| own.eq_ignore_ascii_case(name));
            found.map(|(_, value)| value.as_str())
        });
        // One alone may be any comment
        if named.iter().flatten().count() > 1 {
            return named;
        }
        let is_unit = |text: &str| text.chars().count() <= MAX_UNIT;
        let are_lengths = |values: [&str; 2]| values.iter().all(|value| length(value).is_some());
        // Beside the channel alone, in a unit that is refused later
        let have_one_unit = |values: [&str; 2]| {
            let [first, second] = values.map(number_and_unit);
            self.0.len() <= COMMENTS && first.zip(second).is_some_and(|(a, b)| a.1 == b.1)
        };
        let mut all = self.0.windows(3);
        let translated = all.find_map(|three| {
            let [width, height, units] = [0, 1, 2].map(|k| three[k].1.as_str());
            let extents = [width, height];
            let are_these = are_lengths(extents) && is_unit(units) || have_one_unit(extents);
            are_these.then_some([width, height, units].map(Some))
        });
        translated.unwrap_or_default()
    }

    /// Scales the heights of a map of this shape `[ny, nx]`; returns spacing and unit, or `None` without such comments.
    pub(super) fn apply(
        &self,
        [ny, nx]: [usize; 2],
        heights: &mut [f64],
    ) -> Result<Option<([f64; 2], LengthUnit)>, ReadProblem> {
        let given = self.given();
        if given == [None; 3] {
            return Ok(None);
        }
        let of = |k: usize| given[k].ok_or_else(|| refuse(NAMES[k], "is missing"));
        let invalid = |k: usize, text: &str| refuse(NAMES[k], format_args!("is `{}`", short(text)));
        let extent = |k: usize| {
            let text = of(k)?;
            length(text).ok_or_else(|| invalid(k, text))
        };
        let ((width, width_unit), (height, height_unit)) = (extent(0)?, extent(1)?);
        let units = of(2)?;
        let vertical = PowerOfMetre::parse(units).ok_or_else(|| invalid(2, units))?;
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

/// A positive number and a unit of length.
fn length(text: &str) -> Option<(f64, PowerOfMetre)> {
    let (number, unit) = number_and_unit(text)?;
    Some((number, PowerOfMetre::parse(unit)?))
}

/// A positive number and a unit; some languages write a decimal comma.
fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let (number, unit) = text.split_once(char::is_whitespace)?;
    let number = decimal(number)?;
    (number.is_finite() && number > 0.0).then_some((number, unit.trim()))
}

fn refuse(name: &str, what: impl std::fmt::Display) -> ReadProblem {
    ReadProblem::unsupported(format_args!(
        "its comments say what its numbers are, but `{name}` {what}; needed are Width and Height, each a positive number and a unit of length, and Value units, a unit of length"
    ))
}
