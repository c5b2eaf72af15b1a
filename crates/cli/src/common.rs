//! Settings of every command, and where its results go.

use std::io::{IsTerminal, stdout};
use std::path::PathBuf;

use asperity_io::shown_path;
use asperity_simulate::Observer;
use asperity_studies::settings::{Document, SettingError};
use asperity_studies::wrapped;
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::output::{print, print_json, say};

/// Settings of every command.
#[derive(Debug, Deserialize)]
pub(crate) struct Common {
    /// Number of threads; all cores unless given.
    pub(crate) threads: Option<usize>,
    /// Print nothing but errors and what `--json` prints.
    pub(crate) quiet: bool,
    /// Report progress and times.
    pub(crate) verbose: bool,
}

impl Common {
    /// Reads them from a document.
    pub(crate) fn of(document: &Document) -> Result<Self, SettingError> {
        #[derive(Deserialize)]
        struct Whole {
            program: Common,
        }
        Ok(document.read::<Whole>()?.program)
    }

    /// Prints a line on standard error with `--verbose`, if there is one.
    pub(crate) fn say_if(&self, line: Option<String>) {
        if let Some(line) = line {
            self.say(|| line);
        }
    }

    /// Prints a line on standard error with `--verbose`.
    pub(crate) fn say(&self, what: impl FnOnce() -> String) {
        if self.verbose {
            say(&wrapped(&what()));
        }
    }
}

/// Lines of two screens of a terminal.
const TWO_SCREENS: usize = 48;

/// The paragraphs of a text that fit on two screens, and the rest. A first one that is longer is cut.
fn two_screens(text: &str) -> [&str; 2] {
    let ends = text.match_indices('\n').map(|(end, _)| end + 1);
    let ends: Vec<usize> = ends.collect();
    if ends.len() <= TWO_SCREENS {
        return [text, ""];
    }
    let first = &text[..ends[TWO_SCREENS - 1]];
    let paragraphs = first.rfind("\n\n").map(|end| end + 2);
    let is_much = |end: &usize| first[..*end].lines().count() > TWO_SCREENS / 2;
    let end = paragraphs.filter(is_much).unwrap_or(first.len());
    let (shown, left) = text.split_at(end);
    [shown, left]
}

impl Observer for Common {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}

    fn explain(&self, text: &str) {
        self.say(|| text.to_owned());
    }
}

/// Targets of the results of a command.
#[derive(Debug, Deserialize)]
pub(crate) struct Results {
    /// A folder or a file.
    pub(crate) output: Option<PathBuf>,
    /// A figure.
    pub(crate) plot: Option<PathBuf>,
    /// A page of the results.
    pub(crate) report: Option<PathBuf>,
    /// Print results as JSON.
    #[serde(default)]
    pub(crate) json: bool,
}

impl Results {
    /// Reads them from a document.
    pub(crate) fn of(document: &Document) -> Result<Self, SettingError> {
        #[derive(Deserialize)]
        struct Whole {
            results: Results,
        }
        Ok(document.read::<Whole>()?.results)
    }

    /// The folder or file, which the command needs.
    pub(crate) fn required(&self) -> PathBuf {
        self.output.clone().unwrap_or_default()
    }

    /// Prints results as JSON with `--json`, nothing with `--quiet`, and text otherwise, with the folder that they
    /// were written to.
    pub(crate) fn print<T: Serialize>(
        &self,
        common: &Common,
        summary: impl FnOnce() -> T,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        self.print_file(common, summary, || {
            let text = text();
            // A pipe or file gets all of it.
            let is_whole = common.verbose || !stdout().is_terminal();
            let [shown, left] = match is_whole {
                true => [text.as_str(), ""],
                false => two_screens(&text),
            };
            let mut shown = shown.to_owned();
            if !left.is_empty() {
                let left = left.lines().count();
                shown.push_str(&format!("... {left} more lines: --verbose prints them\n"));
            }
            if let Some(folder) = &self.output {
                shown.push_str(&format!("results in {}\n", shown_path(folder)));
            }
            shown
        })
    }

    /// Prints results of a command whose output is a file, which the text names by itself.
    pub(crate) fn print_file<T: Serialize>(
        &self,
        common: &Common,
        summary: impl FnOnce() -> T,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        match (self.json, common.quiet) {
            (true, _) => print_json(&summary()),
            (false, true) => Ok(()),
            (false, false) => print(&text()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_screens_end_with_a_paragraph() {
        let lines = |count: usize| "line\n".repeat(count);
        let short = lines(TWO_SCREENS);
        assert_eq!(two_screens(&short), [short.as_str(), ""]);
        let text = format!("{}\n{}", lines(40), lines(30));
        let [shown, left] = two_screens(&text);
        assert_eq!([shown.lines().count(), left.lines().count()], [41, 30]);
        // A table that is longer is cut.
        let text = format!("{}\n{}", lines(5), lines(100));
        let [shown, left] = two_screens(&text);
        assert_eq!(
            [shown.lines().count(), left.lines().count()],
            [TWO_SCREENS, 58]
        );
    }
}
