//! Heights as text (.asc, .txt, .csv), read only.
//!
//! One row per line, all of one length, separated by white space, commas or semicolons: see [`row`]. Lines that begin
//! with `#`, `//`, `%` or `!` are comments. Without a header the spacing is 1 and the unit arbitrary.
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
//! end in .xyz or name their columns x, y, z: [`points`]. Profiles, and tables with headings, are refused: [`table`].

mod esri;
mod gwyddion;
mod interferometer;
mod points;
mod row;
mod table;

use std::borrow::Cow;
use std::io::BufRead;
use std::path::Path;

use asperity_surface::{LengthUnit, RawHeightMap};

use self::esri::Grid;
use self::gwyddion::Comments;
use self::interferometer::Header;
use self::row::Row;
use crate::error::ReadProblem;
use crate::limits::{check_claim, room};
use crate::text_lines::{Line, read_line};

/// Marks at the beginning of a comment.
const COMMENTS: [&str; 4] = ["#", "//", "%", "!"];

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
        let line = |number, text| Line { number, text };
        let text = match std::str::from_utf8(&bytes) {
            Ok(text) => Cow::Borrowed(text),
            // Comments may be in ISO 8859-1
            Err(_) if bytes.trim_ascii_start().starts_with(b"#") => {
                Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect())
            }
            Err(e) => {
                let what = "bytes that are not UTF-8 text were found, but numbers are needed";
                return Err(line(number, "").refuse_at(e.valid_up_to(), what));
            }
        };
        let byte_order_mark = if number == 1 { "\u{feff}" } else { "" };
        let text = text.strip_prefix(byte_order_mark).unwrap_or(&text);
        // Old Macintosh files end lines with a carriage return alone
        let text = text.trim_end_matches(['\r', '\n']);
        for (i, text) in text.split('\r').enumerate() {
            number += usize::from(i > 0);
            matrix.take_line(line(number, text), length)?;
        }
    }
    matrix.is_list |= points::is_named_as_list(path);
    matrix.finish(number)
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
    /// Most numbers of a line.
    longest: usize,
    /// Lines of separators alone since the last row.
    blank_rows: usize,
    /// Empty fields that every row begins and ends with.
    blank_columns: [usize; 2],
    /// `true` if the file says that it is a list of points.
    is_list: bool,
    /// Number of points of a list that begins with it.
    points: Option<f64>,
}

impl Matrix {
    /// Adds a line of a file of `length` bytes.
    fn take_line(&mut self, line: Line<'_>, length: u64) -> Result<(), ReadProblem> {
        let trimmed = line.text.trim();
        let before_numbers = self.columns.is_none();
        let comment = COMMENTS.iter().find_map(|mark| trimmed.strip_prefix(mark));
        if before_numbers && points::is_heading(comment.unwrap_or(trimmed)) {
            self.is_list = true;
            return Ok(());
        }
        if let Some(comment) = comment {
            self.comments.take(comment);
            return Ok(());
        }
        if before_numbers && trimmed.contains('=') {
            return self.header.take_line(line, trimmed);
        }
        let numbers = match before_numbers {
            true => self.grid.take(line, trimmed)?,
            false => trimmed,
        };
        let [ny, nx] = self.claim();
        if row::is_blank(numbers) {
            // Inside a map these are missing points; around it they are no part of it.
            let counts = !before_numbers && ny.is_none() && !numbers.is_empty();
            self.blank_rows += usize::from(counts);
            return Ok(());
        }
        if before_numbers && let (Some(nx), Some(ny)) = (nx, ny) {
            // A digit and a separator are the least size of a number; the last has no separator.
            check_claim([ny, nx], 2, length + 1)?;
            self.heights = room(nx, ny)?;
        }
        let blank_heights = self.blank_rows * self.columns.unwrap_or(0);
        self.heights.extend((0..blank_heights).map(|_| f64::NAN));
        self.rows += std::mem::take(&mut self.blank_rows) + 1;
        let before = self.heights.len();
        let row = Row { line, numbers };
        let is_missing = |field: &str, number| self.grid.is_nodata(field, number);
        let mut blank = row.read(before_numbers, is_missing, &mut self.heights)?;
        let mut found = self.heights.len() - before;
        if self.rows == 2 && self.columns == Some(1) && found >= 3 && nx.is_none() {
            // A list of points begins with their number, as CloudCompare writes it
            self.points = self.heights.drain(..1).next();
            (self.rows, self.columns, self.is_list) = (1, None, true);
        }
        let expected = *self.columns.get_or_insert(match nx {
            Some(w) => usize::try_from(w).unwrap_or(usize::MAX),
            None => found,
        });
        let extra = found.saturating_sub(expected);
        if nx.is_some() && extra > 0 && extra <= blank[0] + blank[1] {
            let last = extra.min(blank[1]);
            self.heights.truncate(before + found - last);
            self.heights.drain(before..before + extra - last);
            blank = [blank[0] + last - extra, blank[1] - last];
            found = expected;
        }
        self.longest = self.longest.max(found);
        if found != expected && self.grid.shape().is_none() {
            return Err(line.refuse_at(
                line.text.trim_end().len(),
                format_args!("this row has {found} numbers, but {expected} are needed"),
            ));
        }
        self.blank_columns = match self.rows {
            1 => blank,
            _ => [0, 1].map(|end| blank[end].min(self.blank_columns[end])),
        };
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
    fn finish(mut self, last: usize) -> Result<RawHeightMap, ReadProblem> {
        let Some(mut columns) = self.columns else {
            return Err(ReadProblem::truncated("it holds no numbers at all"));
        };
        if let Some([nx, ny]) = self.grid.shape() {
            table::check_lines([nx, ny], [self.rows, self.longest], self.heights.len())?;
            self.rows = self.heights.len() / columns;
        }
        let rows = self.rows;
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
        if let Some(points) = self.points.filter(|points| *points != rows as f64) {
            return Err(ReadProblem::malformed(format_args!(
                "its first line says {points} points, but {rows} rows of numbers follow"
            )));
        }
        let [first, last] = self.blank_columns;
        if self.claim()[1].is_none() && first + last > 0 {
            let all = self.heights.chunks(columns);
            let kept = all.flat_map(|row| &row[first..columns - last]);
            self.heights = kept.copied().collect();
            columns -= first + last;
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
        if let Some(spacing) = self.grid.spacing()? {
            return map(self.heights, spacing, unit);
        }
        let stated = self.comments.apply([rows, columns], &mut self.heights)?;
        if let Some((spacing, unit)) = stated {
            return map(self.heights, spacing, unit);
        }
        if self.claim() == [None, None] {
            if let Some(list) = points::map_of(self.is_list, columns, &self.heights)? {
                return Ok(list);
            }
            table::check_matrix(columns, &self.heights)?;
        }
        Ok(map(self.heights, spacing, unit)?.with_assumed_spacing())
    }
}
