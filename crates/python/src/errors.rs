//! Errors as Python raises them: `ValueError` for what other arguments would help, `OSError` for files, `RuntimeError` for the rest.
//!
//! Sentences are those of the command line, with flags as keyword arguments.

use std::fmt::Display;

use asperity_io::{ReadError, ReadProblem, ResultFolderError, WriteError, WriteProblem, within};
use asperity_page::PageError;
use asperity_studies::settings::{Document, SECTIONS, Setting, SettingError};
use asperity_studies::{
    EvaluationError, ExportError, GivenError, MaterialsError, ReportError, StudyError,
};
use pyo3::PyErr;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError, PyTypeError, PyValueError};

/// Most characters of a sentence: what it names may be of any length.
const MAX_SENTENCE: usize = 2000;

/// Reason for which a call fails, which Python raises.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Another argument would help.
    Value(String),
    /// An argument that the function does not have.
    Type(String),
    /// A file does not exist.
    NotFound(String),
    /// A file cannot be read or written.
    File(String),
    /// Anything else.
    Failed(String),
    /// A stop came before there was any result.
    Stopped(String),
}

impl Failure {
    pub(crate) fn value(reason: impl Display) -> Self {
        Self::Value(reason.to_string())
    }

    pub(crate) fn file(reason: impl Display) -> Self {
        Self::File(reason.to_string())
    }

    fn of_kind(is_usage: bool, reason: impl Display) -> Self {
        match is_usage {
            true => Self::value(reason),
            false => Self::file(reason),
        }
    }

    /// The failure of a study of `document`.
    pub(crate) fn of_study(document: &Document, error: StudyError) -> Self {
        match error {
            error if error.is_stopped() => Self::Stopped(error.to_string()),
            StudyError::Given(GivenError::Read(error)) => error.into(),
            // What a file holds, which other arguments may make use of
            StudyError::Given(error @ GivenError::File { .. }) => Self::value(error),
            StudyError::Config(_) if error.is_usage() => match document.file_to_blame() {
                Some(file) => Self::Value(format!("{file}: {error}")),
                None => Self::value(error),
            },
            error => {
                let is_usage = error.is_usage()
                    || matches!(error, StudyError::HeightField(_) | StudyError::Mesh(_));
                let is_file = matches!(
                    error,
                    StudyError::SurfaceFile(_)
                        | StudyError::Given(_)
                        | StudyError::Results(_)
                        | StudyError::Config(_)
                );
                let sentence = error.sentence(document.own_unit());
                match (is_usage, is_file) {
                    (true, _) => Self::Value(sentence),
                    (false, true) => Self::File(sentence),
                    (false, false) => Self::Failed(sentence),
                }
            }
        }
    }

    /// The failure with flags of the command line as keyword arguments: `given` are those of the call.
    pub(crate) fn in_python(self, given: &[(String, Vec<String>)]) -> PyErr {
        let worded = |sentence: String| {
            let mut sentence = within(&sentence, MAX_SENTENCE).to_string();
            for (flag, values) in given.iter().filter(|(_, values)| !values.is_empty()) {
                let (name, values) = (keyword(flag), values.join(" "));
                sentence =
                    sentence.replace(&format!("--{flag} {values}"), &format!("{name}={values}"));
            }
            with_keywords(&sentence)
        };
        match self {
            Self::Value(sentence) => PyValueError::new_err(worded(sentence)),
            Self::Type(sentence) => PyTypeError::new_err(worded(sentence)),
            Self::NotFound(sentence) => PyFileNotFoundError::new_err(worded(sentence)),
            Self::File(sentence) => PyOSError::new_err(worded(sentence)),
            Self::Failed(sentence) | Self::Stopped(sentence) => {
                PyRuntimeError::new_err(worded(sentence))
            }
        }
    }
}

/// The keyword argument of a flag, which is given without its hyphens: `from_` where Python has the word.
pub(crate) fn keyword(flag: &str) -> String {
    let name = flag.replace('-', "_");
    match name.as_str() {
        "for" | "from" => name + "_",
        _ => name,
    }
}

/// The setting of a flag, if there is one.
fn setting_of(flag: &str) -> Option<&'static Setting> {
    let mut settings = SECTIONS.iter().flat_map(|section| section.settings);
    settings.find(|setting| setting.flag_name().as_deref() == Some(flag))
}

/// A sentence with every `--some-flag` as `some_flag`, or `some_flag=True` of a switch; parts of other words stay.
fn with_keywords(sentence: &str) -> String {
    let mut worded = String::new();
    let mut rest = sentence;
    while let Some(at) = rest.find("--") {
        let (before, flag) = rest.split_at(at);
        worded.push_str(before);
        let is_of_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let name = &flag[2..];
        let (name, after) = name.split_at(name.find(|c| !is_of_name(c)).unwrap_or(name.len()));
        let begins = !worded.ends_with(|c: char| c.is_alphanumeric() || "=_./-".contains(c));
        match setting_of(name).filter(|_| begins) {
            Some(setting) => {
                worded.push_str(&keyword(name));
                worded.push_str(if setting.takes_value() { "" } else { "=True" });
            }
            None => {
                worded.push_str("--");
                worded.push_str(name);
            }
        }
        rest = after;
    }
    worded + rest
}

impl From<SettingError> for Failure {
    fn from(error: SettingError) -> Self {
        Self::value(error)
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        match error.problem {
            ReadProblem::NotFound => Self::NotFound(error.to_string()),
            _ => Self::file(error),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::of_kind(
            matches!(error.problem, WriteProblem::WrongEnding { .. }),
            error,
        )
    }
}

impl From<ResultFolderError> for Failure {
    fn from(error: ResultFolderError) -> Self {
        Self::file(error)
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Self::file(error)
    }
}

impl From<EvaluationError> for Failure {
    fn from(error: EvaluationError) -> Self {
        Self::of_kind(error.is_usage(), error)
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        Self::of_kind(error.is_usage(), error)
    }
}

impl From<MaterialsError> for Failure {
    fn from(error: MaterialsError) -> Self {
        Self::of_kind(error.is_usage(), error)
    }
}

impl From<PageError> for Failure {
    fn from(error: PageError) -> Self {
        Self::of_kind(error.is_usage(), error)
    }
}
