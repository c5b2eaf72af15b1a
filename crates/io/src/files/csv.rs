//! Tables as comma-separated values.

use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;

use super::atomic::replace;
use crate::error::{WriteError, WriteProblem};
use crate::shown::printable;

/// One field of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum CsvField<'a> {
    /// A real number; NaN becomes an empty field.
    Number(f64),
    /// A whole number.
    Whole(u64),
    /// Text, quoted where it holds a comma, a quote or a line break.
    Text(Cow<'a, str>),
    /// Nothing.
    Empty,
}

impl From<f64> for CsvField<'_> {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<u64> for CsvField<'_> {
    fn from(value: u64) -> Self {
        Self::Whole(value)
    }
}

impl From<u32> for CsvField<'_> {
    fn from(value: u32) -> Self {
        Self::Whole(value.into())
    }
}

impl From<usize> for CsvField<'_> {
    fn from(value: usize) -> Self {
        Self::Whole(value as u64)
    }
}

impl<'a> From<&'a str> for CsvField<'a> {
    fn from(value: &'a str) -> Self {
        Self::Text(value.into())
    }
}

impl From<String> for CsvField<'_> {
    fn from(value: String) -> Self {
        Self::Text(value.into())
    }
}

impl<'a, T: Into<CsvField<'a>>> From<Option<T>> for CsvField<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// Writes a table with a header line, as [`write_atomically`](crate::write_atomically) does.
///
/// Lines end in a line feed, fields are separated by commas, the decimal sign is the point. Real
/// numbers have as many digits as give the same double back; NaN and `None` are empty fields.
///
/// ```
/// use asperity_io::{CsvField, write_csv};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("table.csv");
/// let rows = [(0.1, None), (f64::NAN, Some("lost"))];
/// write_csv(
///     &path,
///     &["flux", "note"],
///     rows.iter().map(|(flux, note)| [CsvField::from(*flux), CsvField::from(*note)]),
/// )?;
/// assert_eq!(std::fs::read_to_string(&path)?, "flux,note\n0.1,\n,lost\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteProblem::Invalid`] if a row is not as long as the header; otherwise for the reasons
/// of [`write_atomically`](crate::write_atomically).
pub fn write_csv<'a, Row: AsRef<[CsvField<'a>]>>(
    path: impl AsRef<Path>,
    header: &[&str],
    rows: impl IntoIterator<Item = Row>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    replace(path, |out| {
        let names: Vec<CsvField<'_>> = header.iter().copied().map(CsvField::from).collect();
        write_row(out, &names)?;
        for (i, row) in rows.into_iter().enumerate() {
            let row = row.as_ref();
            if row.len() != header.len() {
                return Err(WriteProblem::Invalid(format!(
                    "row {} has {} fields, its header {}",
                    i + 1,
                    row.len(),
                    header.len()
                )));
            }
            write_row(out, row)?;
        }
        Ok(())
    })
}

/// A table as text, in the form of [`write_csv`].
pub fn csv_text<'a, Row: AsRef<[CsvField<'a>]>>(
    header: &[&str],
    rows: impl IntoIterator<Item = Row>,
) -> String {
    let mut out = Vec::new();
    // Writing to memory does not fail.
    let names: Vec<CsvField<'_>> = header.iter().copied().map(CsvField::from).collect();
    let _ = write_row(&mut out, &names);
    for row in rows {
        let _ = write_row(&mut out, row.as_ref());
    }
    String::from_utf8_lossy(&out).into_owned()
}

fn write_row(out: &mut impl Write, row: &[CsvField<'_>]) -> io::Result<()> {
    for (i, field) in row.iter().enumerate() {
        if i > 0 {
            out.write_all(b",")?;
        }
        match field {
            CsvField::Number(value) => write_number(out, *value)?,
            CsvField::Whole(value) => write!(out, "{value}")?,
            CsvField::Text(text) if text.contains([',', '"', '\n', '\r']) => {
                write!(out, "\"{}\"", printable(text).replace('"', "\"\""))?;
            }
            CsvField::Text(text) => out.write_all(printable(text).as_bytes())?,
            CsvField::Empty => {}
        }
    }
    out.write_all(b"\n")
}

/// The shortest digits that give the same double back, with an exponent where that is shorter.
fn write_number(out: &mut impl Write, value: f64) -> io::Result<()> {
    if value.is_nan() {
        return Ok(());
    }
    // Debug takes an exponent below 1e-5 and from 1e16 on, but marks whole numbers by ".0".
    let text = format!("{value:?}");
    out.write_all(text.strip_suffix(".0").unwrap_or(&text).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(row: &[CsvField<'_>]) -> String {
        let mut out = Vec::new();
        write_row(&mut out, row).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers_are_read_back_as_the_same_doubles() {
        for value in [0.1, 1.0 / 3.0, 5e-324, f64::MAX, -2.5e-8, 1e15, 1e16, 3.0] {
            let text = line(&[value.into()]);
            assert_eq!(text.trim_end().parse::<f64>().unwrap(), value, "{text}");
            assert!(text.len() < 26, "{text}");
        }
        assert_eq!(line(&[3.0.into(), 1e-7.into(), 7_u64.into()]), "3,1e-7,7\n");
    }

    #[test]
    fn awkward_text_is_quoted_and_absence_is_empty() {
        assert_eq!(
            line(&[
                "a,b".into(),
                "say \"x\"".into(),
                f64::NAN.into(),
                None::<f64>.into()
            ]),
            "\"a,b\",\"say \"\"x\"\"\",,\n"
        );
    }

    #[test]
    fn a_row_of_wrong_length_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let error = write_csv(&path, &["a", "b"], [vec![CsvField::Empty]]).unwrap_err();
        let message = error.to_string();
        assert!(message.ends_with("is not written: row 1 has 1 fields, its header 2"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
