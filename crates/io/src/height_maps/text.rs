//! Matrices of numbers as text (.asc, .txt, .csv), read only.
//!
//! One row per line, all of one length, separated by white space or, where a line holds a comma, by
//! commas; lines that begin with `#` are comments. A point is missing where `nan` or `bad` stands
//! in upper or lower case, or the field between two commas is empty. Without a header the spacing
//! is 1 and the unit arbitrary.
//!
//! A header of `name=value` lines, as interferometers write it, may come first:
//! ```text
//! h=650 w=650
//! pixel size=3.69862e-007 m
//! data unit=rad
//! height conversion factor (-> m)=6.30079e-008
//! ```
//! `h` and `w` are rows and columns; `pixel size` is the spacing along both axes; numbers are in
//! `data unit` and become metres by the conversion factor, or by their own SI prefix where there
//! is no factor.

use std::io::BufRead;
use std::path::Path;

use asperity_surface::{LengthUnit, RawHeightMap};

use super::unit::PowerOfMetre;
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
    heights: Vec<f64>,
    /// Known from the header or the first row on.
    columns: Option<usize>,
    rows: usize,
}

impl Matrix {
    /// Adds a line of a file of `length` bytes.
    fn take_line(&mut self, line: Line<'_>, length: u64) -> Result<(), ReadError> {
        let trimmed = line.text.trim();
        if trimmed.is_empty() || trimmed.starts_with('#') {
            return Ok(());
        }
        if self.columns.is_none() && trimmed.contains('=') {
            return self.header.take_line(line, trimmed);
        }
        let before = self.heights.len();
        if self.columns.is_none()
            && let (Some(nx), Some(ny)) = (self.header.w, self.header.h)
        {
            // A digit and a separator are the least size of a number; the last has no separator.
            check_claim(line.path, [ny, nx], 2, length + 1)?;
            self.heights = room(line.path, nx, ny)?;
        }
        read_row(line, &mut self.heights)?;
        let found = self.heights.len() - before;
        let expected = *self.columns.get_or_insert(match self.header.w {
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

    /// The map, after the last line of this number.
    fn finish(mut self, path: &Path, last: usize) -> Result<RawHeightMap, ReadError> {
        let rows = self.rows;
        let Some(columns) = self.columns else {
            return Err(ReadError::truncated(path, "it holds no numbers at all"));
        };
        if let Some(h) = self.header.h
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
        let (spacing, unit) = self.header.apply(path, &mut self.heights)?;
        let mut map = RawHeightMap::new(self.heights, [rows, columns], spacing)
            .map_err(ReadError::surface(path))?;
        map.unit = unit;
        if unit == LengthUnit::Arbitrary {
            map = map.with_assumed_spacing();
        }
        Ok(map)
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

/// Fields of the header, where they are present.
#[derive(Default)]
struct Header {
    h: Option<u64>,
    w: Option<u64>,
    pixel_size: Option<(f64, PowerOfMetre)>,
    data_unit: Option<String>,
    conversion: Option<f64>,
}

impl Header {
    fn take_line(&mut self, line: Line<'_>, text: &str) -> Result<(), ReadError> {
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

    fn take(&mut self, line: Line<'_>, name: &str, value: &str) -> Result<(), ReadError> {
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
    fn apply(&self, path: &Path, heights: &mut [f64]) -> Result<([f64; 2], LengthUnit), ReadError> {
        let scale = |heights: &mut [f64], by: &dyn Fn(f64) -> f64| {
            for height in heights {
                *height = by(*height);
            }
        };
        let Some((size, size_unit)) = self.pixel_size else {
            return if self.data_unit.is_none() && self.conversion.is_none() {
                Ok(([1.0, 1.0], LengthUnit::Arbitrary))
            } else {
                Err(ReadError::unsupported(
                    path,
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
                return Err(ReadError::unsupported(
                    path,
                    format_args!(
                        "its heights are in `{}`, but without a `height conversion factor (-> m)` a unit of length is needed",
                        self.data_unit.as_deref().map(short).unwrap_or_default()
                    ),
                ));
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
