//! Fields of a header of text: names and values, and errors that name the field.

use std::collections::BTreeMap;

use crate::error::ReadProblem;
use crate::text_lines::short;

/// Fields by their names in lower case; the last of several of one name.
#[derive(Default)]
pub(super) struct Fields(BTreeMap<String, String>);

impl Fields {
    /// The fields of lines `name = value`; lines that begin with one of `comments` or hold no `=` are left.
    pub(super) fn of_lines(text: &str, comments: &[char]) -> Self {
        let mut fields = Self::default();
        let lines = text.lines().map(str::trim);
        for line in lines.filter(|line| !line.starts_with(comments)) {
            if let Some((name, value)) = line.split_once('=') {
                fields.insert(name, value);
            }
        }
        fields
    }

    pub(super) fn insert(&mut self, name: &str, value: &str) {
        let name = name.trim().to_ascii_lowercase();
        self.0.insert(name, value.trim().to_owned());
    }

    /// The value of a field, if it is there.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.0.get(&name.to_ascii_lowercase()).map(String::as_str)
    }

    /// The value of a field that is needed.
    pub(super) fn text(&self, name: &str) -> Result<&str, ReadProblem> {
        self.get(name).ok_or_else(|| {
            ReadProblem::malformed(format_args!("its header lacks the field `{name}`"))
        })
    }

    /// A whole number, not negative.
    pub(super) fn whole(&self, name: &str) -> Result<u64, ReadProblem> {
        let text = self.text(name)?;
        text.parse()
            .map_err(|_| refuse(name, text, "a whole number"))
    }

    /// A finite number.
    pub(super) fn number(&self, name: &str) -> Result<f64, ReadProblem> {
        let text = self.text(name)?;
        let number = text.parse().ok().filter(|x: &f64| x.is_finite());
        number.ok_or_else(|| refuse(name, text, "a number"))
    }
}

/// The error for a value that is not what it must be.
pub(super) fn refuse(name: &str, value: &str, needed: &str) -> ReadProblem {
    ReadProblem::malformed(format_args!(
        "the field `{name}` of its header is `{}`, but {needed} is needed",
        short(value)
    ))
}
