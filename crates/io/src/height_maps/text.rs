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
use crate::error::ReadProblem;
use crate::limits::{check_claim, room};
use crate::text_lines::{Line, read_line, short};

pub(crate) fn read<R: BufRead>(
    path: &Path,
    mut reader: R,
    length: u64,
) -> Result<RawHeightMap, ReadProblem> {
    let mut matrix = Matrix::default();
    let mut bytes = Vec::new();
    let mut number = 0;
    while read_line(&mut reader, &mut bytes)? {
        number += 1;
        let line = |text| Line { number, text };
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            let what = "bytes that are not UTF-8 text were found, but numbers are needed";
            line("").refuse_at(e.valid_up_to(), what)
        })?;
        let byte_order_mark = if number == 1 { "\u{feff}" } else { "" };
        let text = text.strip_prefix(byte_order_mark).unwrap_or(text);
        matrix.take_line(line(text), length)?;
    }
    matrix.finish(points::is_named_as_list(path), number)
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
    fn take_line(&mut self, line: Line<'_>, length: u64) -> Result<(), ReadProblem> {
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
            check_claim([ny, nx], 2, length + 1)?;
            self.heights = room(nx, ny)?;
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

    /// The map, after the last line of this number; `is_list` if the file is named as a list of points.
    fn finish(mut self, is_list: bool, last: usize) -> Result<RawHeightMap, ReadProblem> {
        let rows = self.rows;
        let Some(columns) = self.columns else {
            return Err(ReadProblem::truncated("it holds no numbers at all"));
        };
        if let [Some(h), _] = self.claim()
            && h != rows as u64
        {
            let what = format!("{h} rows were expected, but {rows} are there");
            return Err(if (rows as u64) < h {
                ReadProblem::truncated(what)
            } else {
                let (number, text) = (last, "");
                Line { number, text }.refuse_at(0, what)
            });
        }
        let map = |heights, spacing, unit| -> Result<_, ReadProblem> {
            let mut map = RawHeightMap::new(heights, [rows, columns], spacing)?;
            map.unit = unit;
            Ok(map)
        };
        let (spacing, unit) = self.header.apply(&mut self.heights)?;
        if unit != LengthUnit::Arbitrary {
            return map(self.heights, spacing, unit);
        }
        if let Some(spacing) = self.grid.apply(&mut self.heights)? {
            return map(self.heights, spacing, unit);
        }
        let stated = self.comments.apply([rows, columns], &mut self.heights)?;
        if let Some((spacing, unit)) = stated {
            return map(self.heights, spacing, unit);
        }
        if self.claim() == [None, None] {
            if columns == 3
                && let Some(list) = points::map_of(is_list, &self.heights)?
            {
                return Ok(list);
            }
            if is_list {
                return Err(points::wrong_columns(columns));
            }
        }
        Ok(map(self.heights, spacing, unit)?.with_assumed_spacing())
    }
}

/// Appends the numbers of one line.
fn read_row(line: Line<'_>, heights: &mut Vec<f64>) -> Result<(), ReadProblem> {
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
