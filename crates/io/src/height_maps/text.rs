//! Heights as text (.asc, .txt, .csv), read only.
//!
//! One row per line, all of one length, separated by white space or, where a line holds a comma, by
//! commas; lines that begin with `#` are comments. A point is missing where `nan` or `bad` stands
//! in upper or lower case, or the field between two commas is empty. Without a header the spacing
//! is 1 and the unit arbitrary.
//!
//! A header may come first:
//! - `name=value` lines of interferometers:
//!   ```text
//!   h=650 w=650
//!   pixel size=3.69862e-007 m
//!   data unit=rad
//!   height conversion factor (-> m)=6.30079e-008
//!   ```
//!   `h` and `w` are rows and columns; `pixel size` is the spacing along both axes; numbers are in
//!   `data unit` and become metres by the conversion factor, or by their own SI prefix where there
//!   is no factor;
//! - the comments of Gwyddion (`# Width: 50 um`, `# Height: 50 um`, `# Value units: nm`): [`gwyddion`];
//! - the grid of a terrain (`ncols`, `nrows`, `cellsize`, `NODATA_value`): [`esri`].
//!
//! Three numbers in each row are a list of points x, y, z where x and y lie on a regular grid, and always in files that
//! end in .xyz: [`points`].

mod esri;
mod gwyddion;
mod interferometer;
mod points;

use std::io::BufRead;
use std::path::Path;

use asperity_surface::{LengthUnit, RawHeightMap};

use self::esri::Grid;
use self::gwyddion::Comments;
use self::interferometer::Header;
use crate::error::ReadError;
use crate::limits::{check_claim, room};
use crate::text_lines::{Line, read_line, short};

pub(crate) fn read<R: BufRead>(
    path: &Path,
    mut reader: R,
    length: u64,
) -> Result<RawHeightMap, ReadError> {
    let mut matrix = Matrix::default();
    let mut bytes = Vec::new();
    let mut number = 0;
    while read_line(path, &mut reader, &mut bytes)? {
        number += 1;
        let line = |text| Line { path, number, text };
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            let what = "bytes that are not UTF-8 text were found, but numbers are needed";
            line("").refuse_at(e.valid_up_to(), what)
        })?;
        let byte_order_mark = if number == 1 { "\u{feff}" } else { "" };
        let text = text.strip_prefix(byte_order_mark).unwrap_or(text);
        matrix.take_line(line(text), length)?;
    }
    matrix.finish(path, number)
}

/// The numbers read so far.
#[derive(Default)]
struct Matrix {
    header: Header,
    comments: Comments,
    grid: Grid,
    heights: Vec<f64>,
    /// Known from the header or the first row on.
    columns: Option<usize>,
    rows: usize,
}

impl Matrix {
    /// Adds a line of a file of `length` bytes.
    fn take_line(&mut self, line: Line<'_>, length: u64) -> Result<(), ReadError> {
        let trimmed = line.text.trim();
        if let Some(comment) = trimmed.strip_prefix('#') {
            self.comments.take(comment);
            return Ok(());
        }
        let before_numbers = self.columns.is_none();
        if trimmed.is_empty() || (before_numbers && points::is_heading(trimmed)) {
            return Ok(());
        }
        if before_numbers && trimmed.contains('=') {
            return self.header.take_line(line, trimmed);
        }
        if before_numbers && self.grid.take_line(line, trimmed)? {
            return Ok(());
        }
        let before = self.heights.len();
        let [ny, nx] = self.claim();
        if before_numbers && let (Some(nx), Some(ny)) = (nx, ny) {
            // A digit and a separator are the least size of a number; the last has no separator.
            check_claim(line.path, [ny, nx], 2, length + 1)?;
            self.heights = room(line.path, nx, ny)?;
        }
        read_row(line, &mut self.heights)?;
        let found = self.heights.len() - before;
        let expected = *self.columns.get_or_insert(match nx {
            Some(w) => usize::try_from(w).unwrap_or(usize::MAX),
            None => found,
        });
        if found != expected {
            return Err(line.refuse_at(
                line.text.trim_end().len(),
                format_args!("this row has {found} numbers, but {expected} are needed"),
            ));
        }
        self.rows += 1;
        Ok(())
    }

    /// Rows and columns as a header states them.
    fn claim(&self) -> [Option<u64>; 2] {
        [
            self.header.h.or(self.grid.rows),
            self.header.w.or(self.grid.columns),
        ]
    }

    /// The map, after the last line of this number.
    fn finish(mut self, path: &Path, last: usize) -> Result<RawHeightMap, ReadError> {
        let rows = self.rows;
        let Some(columns) = self.columns else {
            return Err(ReadError::truncated(path, "it holds no numbers at all"));
        };
        if let [Some(h), _] = self.claim()
            && h != rows as u64
        {
            let what = format!("{h} rows were expected, but {rows} are there");
            return Err(if (rows as u64) < h {
                ReadError::truncated(path, what)
            } else {
                let (number, text) = (last, "");
                Line { path, number, text }.refuse_at(0, what)
            });
        }
        let map = |heights, spacing: [f64; 2]| {
            RawHeightMap::new(heights, [rows, columns], spacing).map_err(ReadError::surface(path))
        };
        let (spacing, unit) = self.header.apply(path, &mut self.heights)?;
        if unit != LengthUnit::Arbitrary {
            let mut map = map(self.heights, spacing)?;
            map.unit = unit;
            return Ok(map);
        }
        if let Some(spacing) = self.grid.apply(path, &mut self.heights)? {
            return map(self.heights, spacing);
        }
        let stated = self
            .comments
            .apply(path, [rows, columns], &mut self.heights)?;
        if let Some((spacing, unit)) = stated {
            let mut map = map(self.heights, spacing)?;
            map.unit = unit;
            return Ok(map);
        }
        if self.claim() == [None, None] {
            if columns == 3
                && let Some(list) = points::map_of(path, &self.heights)?
            {
                return Ok(list);
            }
            if points::is_named_as_list(path) {
                return Err(points::wrong_columns(path, columns));
            }
        }
        Ok(map(self.heights, spacing)?.with_assumed_spacing())
    }
}

/// Appends the numbers of one line.
fn read_row(line: Line<'_>, heights: &mut Vec<f64>) -> Result<(), ReadError> {
    let mut push = |field: &str| {
        let height = match field.parse::<f64>() {
            Ok(height) if height.is_infinite() => {
                return Err(line.refuse(
                    field,
                    format_args!(
                        "`{}` is infinite; heights must be finite, or nan where missing",
                        short(field)
                    ),
                ));
            }
            Ok(height) => height,
            Err(_) if field.is_empty() || field.eq_ignore_ascii_case("bad") => f64::NAN,
            Err(_) => {
                return Err(line.refuse(
                    field,
                    format_args!(
                        "`{}` is not a number; numbers with a decimal point are needed, or nan or bad for missing points",
                        short(field)
                    ),
                ));
            }
        };
        heights.push(height);
        Ok(())
    };
    let text = line.text;
    if text.contains(',') {
        text.split(',').map(str::trim).try_for_each(&mut push)
    } else {
        text.split_whitespace().try_for_each(&mut push)
    }
}
