//! Lines of text files: reads them one by one and makes errors that name line and column.

use std::fmt::Display;
use std::io::{self, BufRead};

use crate::error::ReadProblem;
use crate::shown::within;

/// Reads the next line, with its line feed, into `bytes`; false at the end of the file.
pub(crate) fn read_line(reader: &mut impl BufRead, bytes: &mut Vec<u8>) -> io::Result<bool> {
    bytes.clear();
    Ok(reader.read_until(b'\n', bytes)? > 0)
}

/// A line of a text file, with its place for messages.
#[derive(Clone, Copy)]
pub(crate) struct Line<'a> {
    /// Counted from one.
    pub(crate) number: usize,
    pub(crate) text: &'a str,
}

impl<'a> Line<'a> {
    pub(crate) fn words(self) -> impl Iterator<Item = &'a str> {
        self.text.split_whitespace()
    }

    /// An error at `word`, a slice of the line.
    pub(crate) fn refuse(self, word: &str, what: impl Display) -> ReadProblem {
        self.refuse_at(word.as_ptr().addr() - self.text.as_ptr().addr(), what)
    }

    /// An error at the byte `offset` of the line.
    pub(crate) fn refuse_at(self, offset: usize, what: impl Display) -> ReadProblem {
        ReadProblem::Text {
            line: self.number,
            column: offset + 1,
            what: what.to_string(),
        }
    }
}

/// The number that a text states, with a decimal point or a decimal comma.
pub(crate) fn decimal(text: &str) -> Option<f64> {
    match text.split_once(',') {
        None => number(text),
        Some((whole, digits)) => number(&format!("{whole}.{digits}")),
    }
}

/// The number that a text states, with a decimal point and an exponent that Fortran may have written: `1.5D-03`.
pub(crate) fn number(text: &str) -> Option<f64> {
    let exponent = || text.replace(['D', 'd'], "e").parse();
    text.parse().or_else(|_| exponent()).ok()
}

/// Text of a file for messages: on one line, 40 characters at most.
pub(crate) fn short(text: &str) -> String {
    within(&text.trim().replace(['\t', '\n', '\r'], " "), 40)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_text_is_one_line_without_control_characters() {
        assert_eq!(short(" a\tb\n\0\u{1b}[31m "), "a b \\u{0}\\u{1b}[31m");
        assert!(short(&"x".repeat(500)).len() < 70);
    }
}
