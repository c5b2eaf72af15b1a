//! Checkpoints: the results of finished cases of a long run, by which it resumes.
//!
//! A checkpoint is a JSON file with the results of one case, the settings that they follow from, the build that
//! computed them and a checksum. A run takes up the checkpoints that it finds and computes the rest. A checkpoint
//! of other settings or of another results epoch is refused by name. A damaged one is computed again, and so is one
//! of a machine that rounds differently.

use std::path::{Path, PathBuf};

use asperity_analysis::fnv1a;
use asperity_io::{
    Build, RESULTS_EPOCH, ReadError, ResultFolder, ResultFolderError, exists, names_in, read_text,
    write_json,
};
use asperity_simulate::{Deadline, Observer, StoppedBy};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::config::values::Seconds;
use asperity_results::rounding;

/// Form of the files; another number is another form.
const SCHEMA: u64 = 5;

/// A case of a long run.
pub(crate) trait CheckpointCase {
    /// What is computed.
    type Results: Serialize + DeserializeOwned;
    /// Why it cannot be computed.
    type Error: From<CheckpointError>;

    /// Name of the file, without its ending.
    fn name(&self) -> String;

    /// The case in words.
    fn title(&self) -> String;

    /// All settings that the results depend on.
    fn settings(&self) -> Value;

    /// Why no run can have found these results; `None` if they may be right.
    fn invalid(&self, results: &Self::Results) -> Option<&'static str>;

    /// Computes the results; `None` if an interrupt came before they were complete.
    fn compute(&self, observer: &dyn Observer) -> Result<Option<Self::Results>, Self::Error>;
}

/// Why checkpoints cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The result folder cannot be used.
    #[error(transparent)]
    Folder(#[from] ResultFolderError),
    /// A complete checkpoint of another run, which this one must not overwrite.
    #[error(
        "{} is a checkpoint of another run ({difference}); choose another folder, or remove that file",
        path.display()
    )]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
}

/// A checkpoint as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Checkpoint<T> {
    schema: u64,
    study: String,
    build: Build,
    /// How the machine rounds that computed it.
    rounding: String,
    case: String,
    config: Value,
    results: T,
    /// Of the results, so that a changed number is noticed.
    checksum: String,
}

/// What was found of a case.
pub(crate) enum Found<T> {
    /// Nothing.
    Missing,
    /// A file that is no checkpoint, or whose results are not those that were written: why.
    Damaged(String),
    /// Results of a machine that rounds differently.
    OtherRounding,
    /// Its results.
    Results(T),
}

/// Said of results that no run has written.
pub(crate) const CHANGED: &str = "its results are not those that were written";

/// The cases of a run and how they came about.
pub(crate) struct Completed<T> {
    /// The results of all cases, in their order; `None` where the run ended before.
    pub(crate) results: Vec<Option<T>>,
    pub(crate) completion: Completion,
}

/// How the cases of a long run came about.
#[derive(Clone, Debug, Default)]
pub struct Completion {
    /// Cases taken from checkpoints.
    pub resumed: usize,
    /// Cases computed by this run.
    pub computed: usize,
    /// What a reader should know of the checkpoints: a sentence each.
    pub notes: Vec<String>,
    /// What ended the run before all cases were computed.
    pub stopped_by: Option<StoppedBy>,
}

/// The checkpoints of one study in a result folder.
pub(crate) struct Checkpoints<'a> {
    /// The result folder.
    pub(crate) folder: &'a ResultFolder,
    /// Name of the study.
    pub(crate) study: &'static str,
    /// Folder of the files within the result folder.
    pub(crate) place: &'static str,
    /// Stage of which an observer is told.
    pub(crate) stage: &'static str,
}

impl Checkpoints<'_> {
    /// Takes up the cases that have a checkpoint, computes the others and writes a checkpoint of each.
    ///
    /// All checkpoints are read before the first case is computed. Once `max_time` is over no case is begun, but one
    /// is computed in any case, so that repeated runs come to an end however short their time. An interrupt gives up
    /// the case that is being computed.
    pub(crate) fn complete<C: CheckpointCase>(
        &self,
        cases: &[C],
        max_time: Option<Seconds>,
        observer: &dyn Observer,
    ) -> Result<Completed<C::Results>, C::Error> {
        let found = cases
            .iter()
            .map(|case| self.read(case))
            .collect::<Result<Vec<_>, _>>()?;
        // Those of cases that this run leaves out may serve a later one.
        for name in names_in(self.folder.path().join(self.place)) {
            self.folder.keep(&format!("{}/{name}", self.place));
        }
        let deadline = Deadline::new(observer, max_time.and_then(Seconds::duration));
        let resumed = found.iter().filter(|found| found.is_complete()).count();
        observer.begin(self.stage, (cases.len() - resumed) as u64);
        let mut results = Vec::with_capacity(cases.len());
        let mut completion = Completion {
            resumed,
            ..Completion::default()
        };
        for (case, found) in cases.iter().zip(found) {
            completion.notes.extend(found.note(&self.path(case)));
            results.push(match found {
                Found::Results(results) => Some(results),
                _ => self.compute(case, &mut completion, &deadline, observer)?,
            });
        }
        observer.end();
        if results.iter().all(Option::is_some) {
            completion.stopped_by = None;
        }
        Ok(Completed {
            results,
            completion,
        })
    }

    /// Computes a case, unless the run is to stop.
    fn compute<C: CheckpointCase>(
        &self,
        case: &C,
        completion: &mut Completion,
        deadline: &Deadline<'_>,
        observer: &dyn Observer,
    ) -> Result<Option<C::Results>, C::Error> {
        if completion.stopped_by.is_none() {
            completion.stopped_by = match deadline.stop() {
                Some(StoppedBy::Time) if completion.computed == 0 => None,
                stop => stop,
            };
        }
        if completion.stopped_by.is_some() {
            return Ok(None);
        }
        observer.note(&case.title());
        observer.explain(&case.title());
        let results = case.compute(&Quiet(observer))?;
        // Whether it was complete before the interrupt came cannot be told.
        let results = results.filter(|_| observer.stop().is_none());
        match &results {
            Some(results) => {
                self.write(case, results)?;
                completion.computed += 1;
                observer.advance(1);
            }
            None => completion.stopped_by = observer.stop(),
        }
        Ok(results)
    }

    /// Name of the file of a case within the result folder.
    fn file<C: CheckpointCase>(&self, case: &C) -> String {
        format!("{}/{}.json", self.place, case.name())
    }

    fn path<C: CheckpointCase>(&self, case: &C) -> PathBuf {
        self.folder.path().join(self.file(case))
    }

    /// Writes the checkpoint of a case.
    pub(crate) fn write<C: CheckpointCase>(
        &self,
        case: &C,
        results: &C::Results,
    ) -> Result<(), CheckpointError> {
        let path = self.folder.claim_checkpoint(&self.file(case))?;
        let checkpoint = Checkpoint {
            schema: SCHEMA,
            study: self.study.to_owned(),
            build: Build::current(),
            rounding: rounding().to_owned(),
            case: case.title(),
            config: case.settings(),
            results,
            checksum: checksum(results),
        };
        Ok(write_json(path, &checkpoint).map_err(ResultFolderError::from)?)
    }

    /// Reads the checkpoint of a case.
    pub(crate) fn read<C: CheckpointCase>(
        &self,
        case: &C,
    ) -> Result<Found<C::Results>, CheckpointError> {
        let path = self.path(case);
        if !exists(&path) {
            return Ok(Found::Missing);
        }
        let text = match read_text(&path) {
            Err(error @ ReadError::Text { .. }) => return Ok(Found::Damaged(error.to_string())),
            text => text?,
        };
        let value: Value = match serde_json::from_str(&text) {
            Ok(value) => value,
            Err(error) => return Ok(Found::Damaged(error.to_string())),
        };
        // Another form or build may have other fields, so these are compared first.
        if let Some(difference) = other_build(&value, SCHEMA, self.study) {
            return Err(CheckpointError::OtherRun { path, difference });
        }
        let checkpoint: Checkpoint<C::Results> = match serde_json::from_value(value) {
            Ok(checkpoint) => checkpoint,
            Err(error) => return Ok(Found::Damaged(error.to_string())),
        };
        if checksum(&checkpoint.results) != checkpoint.checksum {
            return Ok(Found::Damaged(CHANGED.to_owned()));
        }
        // Which results are valid may depend on the settings, so these are compared before.
        if let Some(difference) = first_difference(&checkpoint.config, &case.settings(), "") {
            return Err(CheckpointError::OtherRun { path, difference });
        }
        Ok(match case.invalid(&checkpoint.results) {
            Some(reason) => Found::Damaged(reason.to_owned()),
            None if checkpoint.rounding != rounding() => Found::OtherRounding,
            None => Found::Results(checkpoint.results),
        })
    }
}

impl<T> Found<T> {
    const fn is_complete(&self) -> bool {
        matches!(self, Self::Results(_))
    }

    /// The sentence on a checkpoint at `path` that is there and not taken up.
    pub(super) fn note(&self, path: &Path) -> Option<String> {
        let path = path.display();
        match self {
            Self::Damaged(reason) => {
                let reason = reason.replace('\n', " ");
                Some(format!(
                    "{path} is damaged and is computed again ({reason})"
                ))
            }
            Self::OtherRounding => Some(format!(
                "{path} is of a machine that rounds differently and is computed again"
            )),
            Self::Missing | Self::Results(_) => None,
        }
    }
}

/// What tells a checkpoint from those of this form, study and results epoch; `None` if nothing does.
pub(super) fn other_build(checkpoint: &Value, schema: u64, study: &str) -> Option<String> {
    let found = checkpoint.get("schema").and_then(Value::as_u64);
    if let Some(found) = found.filter(|found| *found != schema) {
        return Some(format!("schema {found}, this program writes {schema}"));
    }
    let found = checkpoint.get("study").and_then(Value::as_str);
    if let Some(found) = found.filter(|found| *found != study) {
        return Some(format!("study {found} in place of {study}"));
    }
    let epoch = checkpoint.pointer("/build/results_epoch");
    let found = epoch
        .and_then(Value::as_u64)
        .filter(|found| *found != u64::from(RESULTS_EPOCH))?;
    Some(format!(
        "results epoch {found}, that of this program is {RESULTS_EPOCH}"
    ))
}

/// Over the results as they are written.
fn checksum<T: Serialize>(results: &T) -> String {
    format!("{:016x}", fnv1a(json!(results).to_string().as_bytes()))
}

/// The first key whose value differs, with both values.
pub(super) fn first_difference(found: &Value, expected: &Value, key: &str) -> Option<String> {
    if found == expected {
        return None;
    }
    let (Value::Object(a), Value::Object(b)) = (found, expected) else {
        return Some(format!("{key} {found} in place of {expected}"));
    };
    let mut names: Vec<&String> = a.keys().chain(b.keys()).collect();
    names.sort();
    names.into_iter().find_map(|name| {
        let key = if key.is_empty() {
            name.clone()
        } else {
            format!("{key}.{name}")
        };
        let of = |map: &Map<String, Value>| map.get(name).cloned().unwrap_or(Value::Null);
        first_difference(&of(a), &of(b), &key)
    })
}

/// Passes on the stop and explanations, and keeps the steps within a case to itself.
struct Quiet<'a>(&'a dyn Observer);

impl Observer for Quiet<'_> {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn explain(&self, text: &str) {
        self.0.explain(text);
    }
    fn stop(&self) -> Option<StoppedBy> {
        self.0.stop()
    }
}
