//! Header of a gridded terrain (ESRI ASCII grid):
//! ```text
//! ncols 4
//! nrows 6
//! xllcorner 0
//! yllcorner 0
//! cellsize 50
//! NODATA_value -9999
//! ```
//! Heights and cell size are in one unit, which the format does not name. Place on the map is ignored.

use crate::error::ReadProblem;
use crate::text_lines::{Line, short};

/// Number that marks a missing point unless the file says.
const DEFAULT_NODATA: f64 = -9999.0;

/// The header, as far as it is there.
#[derive(Default)]
pub(super) struct Grid {
    pub(super) columns: Option<u64>,
    pub(super) rows: Option<u64>,
    cell: [Option<f64>; 2],
    nodata: Option<f64>,
}

impl Grid {
    /// Reads a line of the header; returns false if the line is not part of it.
    pub(super) fn take_line(&mut self, line: Line<'_>, text: &str) -> Result<bool, ReadProblem> {
        let Some((name, value)) = text.split_once(char::is_whitespace) else {
            return Ok(false);
        };
        let (name, value) = (name.to_ascii_lowercase(), value.trim());
        let refuse = |needed: &str| {
            let what = format!("{name} is `{}`, but {needed} is needed", short(value));
            line.refuse_at(0, what)
        };
        let whole = || {
            let number = value.parse::<u64>().ok().filter(|n| *n > 0);
            number.ok_or_else(|| refuse("a positive whole number"))
        };
        let number = || value.parse::<f64>().map_err(|_| refuse("a number"));
        let positive = || {
            let number = value.parse::<f64>().ok();
            let number = number.filter(|x| x.is_finite() && *x > 0.0);
            number.ok_or_else(|| refuse("a positive number"))
        };
        match name.as_str() {
            "ncols" => self.columns = Some(whole()?),
            "nrows" => self.rows = Some(whole()?),
            "cellsize" => self.cell = [Some(positive()?); 2],
            "dx" => self.cell[0] = Some(positive()?),
            "dy" => self.cell[1] = Some(positive()?),
            "nodata_value" => self.nodata = Some(number()?),
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" => {
                number()?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Marks missing points; returns the spacing, or `None` without such a header.
    pub(super) fn apply(&self, heights: &mut [f64]) -> Result<Option<[f64; 2]>, ReadProblem> {
        if self.columns.is_none() && self.rows.is_none() {
            return Ok(None);
        }
        let [Some(dx), Some(dy)] = self.cell else {
            return Err(ReadProblem::unsupported(
                "its header has ncols and nrows, but no cellsize, or dx and dy",
            ));
        };
        let nodata = self.nodata.unwrap_or(DEFAULT_NODATA);
        for height in heights {
            if *height == nodata {
                *height = f64::NAN;
            }
        }
        Ok(Some([dx, dy]))
    }
}
