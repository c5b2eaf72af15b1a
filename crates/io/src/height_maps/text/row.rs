//! Row: the numbers of one line.
//!
//! Fields are separated by semicolons where there is one, by commas where there is one, and by white space otherwise.
//! Beside semicolons, or where white space separates words of the form `0,5`, a comma is a decimal comma. A point is
//! missing where one of [`MISSING`] stands in upper or lower case, or where a field is empty.

use crate::error::ReadProblem;
use crate::text_lines::{Line, decimal, number, short};

/// Words for a missing point, beside `nan`.
const MISSING: [&str; 6] = ["bad", "na", "n/a", "null", "missing", "nodata"];

/// The numbers of a line.
pub(super) struct Row<'a> {
    pub(super) line: Line<'a>,
    /// Text of the numbers.
    pub(super) numbers: &'a str,
}

/// Returns `true` if a text has separators alone.
pub(super) fn is_blank(text: &str) -> bool {
    text.trim_matches([',', ';', ' ', '\t']).is_empty()
}

impl Row<'_> {
    /// Appends the numbers; returns how many empty fields are at the beginning and at the end. `is_first` if no number came before
    /// it; `is_missing` tells further words and numbers for a missing point.
    pub(super) fn read(
        &self,
        is_first: bool,
        is_missing: impl Fn(&str, Option<f64>) -> bool,
        heights: &mut Vec<f64>,
    ) -> Result<[usize; 2], ReadProblem> {
        let (mut before, mut empty) = (None, 0);
        let mut push = |field: &str, number: Option<f64>| {
            if field.is_empty() {
                empty += 1;
            } else {
                before.get_or_insert(empty);
                empty = 0;
            }
            let is_word = || MISSING.iter().any(|word| field.eq_ignore_ascii_case(word));
            heights.push(match number {
                _ if field.is_empty() || is_missing(field, number) => f64::NAN,
                Some(height) if height.is_infinite() => {
                    let found = short(field);
                    let what = format_args!(
                        "`{found}` is infinite; heights must be finite, or nan where missing"
                    );
                    return Err(self.line.refuse(field, what));
                }
                Some(height) => height,
                None if is_word() => f64::NAN,
                None => return Err(self.not_a_number(field, is_first)),
            });
            Ok(())
        };
        let text = self.numbers;
        let by_comma = text.contains(',') && !has_decimal_commas(text);
        if text.contains(';') {
            let mut fields = text.split(';').map(str::trim);
            fields.try_for_each(|field| push(field, decimal(field)))?;
        } else if by_comma {
            let mut fields = text.split(',').map(str::trim);
            fields.try_for_each(|field| push(field, number(field)))?;
        } else {
            let mut fields = text.split_whitespace();
            fields.try_for_each(|field| push(field, decimal(field)))?;
        }
        Ok([before.unwrap_or(0), empty])
    }

    fn not_a_number(&self, field: &str, is_first: bool) -> ReadProblem {
        let is_grouped = |field: &str| {
            let digits = field.trim_start_matches(['-', '+']).replace(['.', ','], "");
            let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
            is_number && field.matches(['.', ',']).count() > 1
        };
        let unquoted = field.trim_matches(['"', '\'']);
        let heading = match is_first {
            _ if unquoted != field && decimal(unquoted).is_some() => {
                "; quotes around numbers are not read: remove them"
            }
            _ if is_grouped(field) => "; digits in groups are not read: write 1234.5 or 1234,5",
            true => "; a heading above the numbers is not read: remove it, or let it begin with #",
            false => "",
        };
        let what = format_args!(
            "`{}` is not a number; numbers are needed, or nan or bad for missing points{heading}",
            short(field)
        );
        self.line.refuse(field, what)
    }
}

/// Returns `true` if white space separates two words or more, and commas stand between two digits of a word only.
fn has_decimal_commas(text: &str) -> bool {
    let is_digit = |c: char| c.is_ascii_digit();
    let is_number = |word: &str| match word.split_once(',') {
        None => true,
        Some((whole, digits)) => {
            whole.ends_with(is_digit) && digits.starts_with(is_digit) && !digits.contains(',')
        }
    };
    text.split_whitespace().nth(1).is_some() && text.split_whitespace().all(is_number)
}
