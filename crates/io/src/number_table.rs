//! Tables of numbers as text: columns with names, such as result files have.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use crate::error::{ReadError, ReadProblem};
use crate::files::open;
use crate::text_lines::{Line, read_line, short};

/// Most numbers of a table.
const MAX_NUMBERS: usize = 1 << 26;

/// Columns of numbers with their names.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberTable {
    path: PathBuf,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl NumberTable {
    /// File that the table was read from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Names of the columns, in the order of the file.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The column of that name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let i = self.names.iter().position(|own| own == name)?;
        Some(&self.columns[i])
    }

    /// The values along both axes of a grid, if the rows are its points: each pair of the columns `x` and `y` once, both ascending, those of
    /// equal `y` one after the other, two or more along each axis.
    #[must_use]
    pub fn grid(&self, [x, y]: [&str; 2]) -> Option<[Vec<f64>; 2]> {
        let (x, y) = (self.column(x)?, self.column(y)?);
        let count = y.iter().take_while(|value| **value == y[0]).count();
        if count == 0 || !x.len().is_multiple_of(count) {
            return None;
        }
        let along_x = &x[..count];
        let along_y: Vec<f64> = y.iter().step_by(count).copied().collect();
        let is_grid = x.chunks(count).all(|row| row == along_x)
            && y.chunks(count)
                .all(|row| row.iter().all(|value| *value == row[0]));
        let ascends =
            |values: &[f64]| values.len() > 1 && values.windows(2).all(|pair| pair[0] < pair[1]);
        (is_grid && ascends(along_x) && ascends(&along_y)).then(|| [along_x.to_vec(), along_y])
    }
}

/// Reads a table: a line of names, then lines of as many numbers, separated by commas. Empty lines and those that begin with `#` do not
/// count; an empty value is NaN.
///
/// # Examples
/// ```
/// use asperity_io::{read_number_table, write_bytes};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("psd.csv");
/// write_bytes(&path, b"wave_number,density\n0.1, 2.5\n0.2, 1.5\n")?;
/// let table = read_number_table(&path)?;
/// assert_eq!(table.column("density"), Some(&[2.5, 1.5][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is not UTF-8, has no line of names, or a line has another number of values or one that is no
/// finite number.
pub fn read_number_table(path: impl AsRef<Path>) -> Result<NumberTable, ReadError> {
    let path = path.as_ref();
    let read = || number_table_of(path, BufReader::new(open(path)?.0));
    read().map_err(|problem| problem.at(path))
}

/// The table in a text, with the `path` that [`NumberTable::path`] tells.
pub(crate) fn number_table_of(
    path: &Path,
    mut reader: impl BufRead,
) -> Result<NumberTable, ReadProblem> {
    let mut table = NumberTable {
        path: path.to_owned(),
        names: Vec::new(),
        columns: Vec::new(),
    };
    let (mut bytes, mut number) = (Vec::new(), 0);
    while read_line(&mut reader, &mut bytes)? {
        number += 1;
        let text = std::str::from_utf8(&bytes)
            .map_err(|_| ReadProblem::unsupported("it is not text (UTF-8)"))?;
        let text = text.trim_start_matches('\u{feff}').trim_end();
        if text.contains(|c: char| c.is_control() && c != '\t') {
            return Err(ReadProblem::unsupported(
                "it is not text: it holds control characters",
            ));
        }
        let line = Line { number, text };
        if text.trim().is_empty() || text.starts_with('#') {
            continue;
        }
        if table.names.is_empty() {
            table.names = names(line)?;
            table.columns = vec![Vec::new(); table.names.len()];
        } else {
            table.add(line)?;
        }
    }
    if table.names.is_empty() {
        return Err(ReadProblem::truncated("it has no line of names"));
    }
    Ok(table)
}

fn names(line: Line<'_>) -> Result<Vec<String>, ReadProblem> {
    let cells = line.text.split(',').map(str::trim);
    let names: Vec<String> = cells.map(str::to_owned).collect();
    if let Some(name) = names.iter().find(|name| name.parse::<f64>().is_ok()) {
        return Err(line.refuse_at(
            0,
            format_args!(
                "the first line must name the columns, but holds the number {}",
                short(name)
            ),
        ));
    }
    Ok(names)
}

impl NumberTable {
    fn add(&mut self, line: Line<'_>) -> Result<(), ReadProblem> {
        let count = line.text.split(',').count();
        let expected = self.names.len();
        if count != expected {
            return Err(line.refuse_at(
                0,
                format_args!("{count} values are in this line, but {expected} columns are named"),
            ));
        }
        if self.columns[0].len() * expected > MAX_NUMBERS {
            return Err(line.refuse_at(0, format_args!("the table has over {MAX_NUMBERS} numbers")));
        }
        for (column, cell) in self.columns.iter_mut().zip(line.text.split(',')) {
            match cell.trim().parse::<f64>() {
                Ok(value) if value.is_finite() => column.push(value),
                _ if cell.trim().is_empty() => column.push(f64::NAN),
                _ => {
                    let found = short(cell);
                    return Err(line.refuse(cell, format_args!("\"{found}\" is no finite number")));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Result<NumberTable, String> {
        let path = Path::new("psd.csv");
        number_table_of(path, text).map_err(|problem| problem.at(path).to_string())
    }

    #[test]
    fn columns_are_found_by_name() {
        let table = read(b"# units: um\n\nk, W\r\n1,2\r\n3e0,-4\r\n").unwrap();
        assert_eq!(table.names(), ["k", "W"]);
        assert_eq!(table.column("k"), Some(&[1.0, 3.0][..]));
        assert_eq!(table.column("W"), Some(&[2.0, -4.0][..]));
        assert_eq!(table.column("V"), None);
        let table = read(b"k,W\n1,\n").unwrap();
        assert!(table.column("W").unwrap()[0].is_nan());
    }

    #[test]
    fn damaged_tables_are_refused_in_one_sentence() {
        for (text, says) in [
            (&b""[..], "no line of names"),
            (b"# nothing else\n", "no line of names"),
            (b"1,2\n3,4\n", "must name the columns"),
            (b"k,W\n1\n", "1 values are in this line, but 2 columns"),
            (b"k,W\n1,nan\n", "\"nan\" is no finite number"),
            (b"k,W\n1,x\n", "\"x\" is no finite number"),
            (b"k,W\n\xff,1\n", "not text"),
            (b"\0\0,\0\n1,1\n", "holds control characters"),
        ] {
            let said = read(text).unwrap_err();
            assert!(said.contains(says), "{said}");
            assert!(
                said.starts_with("`psd.csv`") && !said.contains('\n'),
                "{said}"
            );
        }
    }
}
