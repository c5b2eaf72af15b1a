//! Header of a gridded terrain (ESRI ASCII grid):
//! ```text
//! ncols 4
//! nrows 6
//! xllcorner 0
//! yllcorner 0
//! cellsize 50
//! NODATA_value -9999
//! ```
//! Heights and cell size are in one unit, which the format does not name. Place on the map is ignored. Lines may end
//! anywhere, in the header and in the numbers.

use crate::error::ReadProblem;
use crate::height_maps::mark::Mark;
use crate::text_lines::{Line, decimal, short};

/// Mark of a missing point unless the file says.
const DEFAULT_NODATA: &str = "-9999";

/// The header, as far as it is there.
#[derive(Default)]
pub(super) struct Grid {
    pub(super) columns: Option<u64>,
    pub(super) rows: Option<u64>,
    cell: [Option<f64>; 2],
    nodata: Option<Mark>,
}

impl Grid {
    /// Reads the fields of the header that `text` of a line begins with; returns what follows them.
    pub(super) fn take<'a>(
        &mut self,
        line: Line<'_>,
        mut text: &'a str,
    ) -> Result<&'a str, ReadProblem> {
        loop {
            let (name, rest) = first_word(text);
            let (value, rest) = first_word(rest);
            if !self.take_field(line, &name.to_ascii_lowercase(), value)? {
                return Ok(text);
            }
            text = rest;
        }
    }

    /// Reads a field of the header; returns `false` if no field has that name.
    fn take_field(&mut self, line: Line<'_>, name: &str, value: &str) -> Result<bool, ReadProblem> {
        let refuse = |needed: &str| {
            let what = format!("{name} is `{}`, but {needed} is needed", short(value));
            line.refuse_at(0, what)
        };
        let whole = || {
            let number = value.parse::<u64>().ok().filter(|n| *n > 0);
            number.ok_or_else(|| refuse("a positive whole number"))
        };
        let positive = || {
            let number = decimal(value).filter(|x| x.is_finite() && *x > 0.0);
            number.ok_or_else(|| refuse("a positive number"))
        };
        match name {
            "ncols" => self.columns = Some(whole()?),
            "nrows" => self.rows = Some(whole()?),
            "cellsize" => self.cell = [Some(positive()?); 2],
            "dx" => self.cell[0] = Some(positive()?),
            "dy" => self.cell[1] = Some(positive()?),
            "nodata_value" | "nodata" => self.nodata = Some(Mark::new(value)),
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" => {
                decimal(value).ok_or_else(|| refuse("a number"))?;
            }
            _ => return Ok(false),
        }
        self.nodata.get_or_insert_with(|| Mark::new(DEFAULT_NODATA));
        Ok(true)
    }

    /// Columns and rows of numbers, wherever lines end.
    pub(super) fn shape(&self) -> Option<[u64; 2]> {
        Some([self.columns?, self.rows?])
    }

    /// Returns `true` for the text of a missing point, which need not be a `number`.
    pub(super) fn is_nodata(&self, field: &str, number: Option<f64>) -> bool {
        let nodata = self.nodata.as_ref();
        nodata.is_some_and(|mark| mark.is_stated_by(field, number))
    }

    /// The spacing, or `None` without such a header.
    pub(super) fn spacing(&self) -> Result<Option<[f64; 2]>, ReadProblem> {
        if self.columns.is_none() && self.rows.is_none() {
            return Ok(None);
        }
        let [Some(dx), Some(dy)] = self.cell else {
            return Err(ReadProblem::unsupported(
                "its header has ncols and nrows, but no cellsize, or dx and dy",
            ));
        };
        Ok(Some([dx, dy]))
    }
}

/// The first word of a text, and the text behind it.
fn first_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    text.split_once(char::is_whitespace).unwrap_or((text, ""))
}
