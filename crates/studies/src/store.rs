//! Files of finished pieces of a long run, by which it goes on where it was left.
//!
//! A file holds results with the configuration that they follow from and a checksum. What is not ours is
//! refused, what is damaged is found anew.

use asperity_simulate::{Deadline, Observer, StoppedBy};
use std::path::{Path, PathBuf};
use std::time::Duration;

use asperity_analysis::fnv1a;
use asperity_io::{ReadError, WriteError, read_text, write_json};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::values::Seconds;

/// What the files look like; another number is another form.
const SCHEMA: u64 = 1;

/// A file of a piece.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Piece<T> {
    schema: u64,
    version: String,
    case: String,
    config: Value,
    results: T,
    /// Of the results, so that a number that was changed is noticed.
    checksum: String,
}

/// What is there of a piece.
pub(crate) enum Stored<T> {
    /// Nothing.
    Missing,
    /// A file that is none, or whose results are not those that were written: why.
    Damaged(String),
    /// Its results.
    Results(T),
}

/// Why a file is neither read nor replaced.
pub(crate) enum StoreError {
    /// It cannot be read at all.
    Read(ReadError),
    /// It holds the whole piece of another configuration or version, which is not ours to overwrite.
    Foreign {
        /// The file.
        path: PathBuf,
        /// What differs.
        what: String,
    },
}

/// Writes the results of a piece; the file is complete or not there.
pub(crate) fn write<T: Serialize>(
    path: &Path,
    case: &str,
    config: Value,
    results: &T,
) -> Result<(), WriteError> {
    let file = Piece {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: case.to_owned(),
        config,
        results,
        checksum: checksum(results),
    };
    write_json(path, &file)
}

/// Reads what is there of a piece. `doubt` says what is wrong with results that no run finds.
pub(crate) fn read<T: Serialize + DeserializeOwned>(
    path: &Path,
    config: &Value,
    doubt: impl Fn(&T) -> Option<&'static str>,
) -> Result<Stored<T>, StoreError> {
    if !asperity_io::exists(path) {
        return Ok(Stored::Missing);
    }
    let text = read_text(path).map_err(StoreError::Read)?;
    let foreign = |what: String| {
        Err(StoreError::Foreign {
            path: path.to_owned(),
            what,
        })
    };
    let value: Value = match serde_json::from_str(&text) {
        Ok(value) => value,
        Err(error) => return Ok(Stored::Damaged(error.to_string())),
    };
    // Another form or version may have other fields, so it is asked for these first.
    if let Some(schema) = value.get("schema").and_then(Value::as_u64)
        && schema != SCHEMA
    {
        return foreign(format!("schema {schema}, this program writes {SCHEMA}"));
    }
    if let Some(version) = value.get("version").and_then(Value::as_str)
        && version != env!("CARGO_PKG_VERSION")
    {
        let ours = env!("CARGO_PKG_VERSION");
        return foreign(format!("version {version}, this is {ours}"));
    }
    let file: Piece<T> = match serde_json::from_value(value) {
        Ok(file) => file,
        Err(error) => return Ok(Stored::Damaged(error.to_string())),
    };
    if checksum(&file.results) != file.checksum {
        return Ok(Stored::Damaged(CHANGED.to_owned()));
    }
    // Whether numbers make sense may depend on the configuration, so that of another run is refused first.
    if let Some((key, found, expected)) = first_difference(&file.config, config, "") {
        return foreign(format!("{key} {found} in place of {expected}"));
    }
    Ok(match doubt(&file.results) {
        Some(reason) => Stored::Damaged(reason.to_owned()),
        None => Stored::Results(file.results),
    })
}

/// What is said of results that no run has written.
pub(crate) const CHANGED: &str = "its results are not those that were written";

/// Over the results as they are written.
fn checksum<T: Serialize>(results: &T) -> String {
    format!("{:016x}", fnv1a(json!(results).to_string().as_bytes()))
}

/// The first key whose value differs, with both values.
fn first_difference(
    found: &Value,
    expected: &Value,
    key: &str,
) -> Option<(String, String, String)> {
    if found == expected {
        return None;
    }
    if let (Value::Object(a), Value::Object(b)) = (found, expected) {
        let mut names: Vec<&String> = a.keys().chain(b.keys()).collect();
        names.sort();
        return names.into_iter().find_map(|name| {
            let key = if key.is_empty() {
                name.clone()
            } else {
                format!("{key}.{name}")
            };
            let of = |map: &serde_json::Map<String, Value>| {
                map.get(name).cloned().unwrap_or(Value::Null)
            };
            first_difference(&of(a), &of(b), &key)
        });
    }
    Some((key.to_owned(), found.to_string(), expected.to_string()))
}

/// Pieces that are there, and how they came to be.
pub(crate) struct Finished<T> {
    /// Those of all pieces, in their order; `None` where the run ended before.
    pub(crate) results: Vec<Option<T>>,
    /// Pieces that an earlier run had left.
    pub(crate) taken_up: usize,
    /// Pieces found by this run.
    pub(crate) computed: usize,
    /// What a reader should know of the files that were there: a sentence each.
    pub(crate) notes: Vec<String>,
    /// What ended the run before all pieces were there.
    pub(crate) stopped_by: Option<StoppedBy>,
}

/// Finds the pieces that are not there yet, one after the other. `name_of` names a piece and its file, and
/// `find` finds one and writes its file, or says `None` if an interrupt came before it was whole.
///
/// When the time is over no piece is begun, but one is finished in any case, so that runs come to an end
/// however short their time; an interrupt gives up the piece that is being found.
pub(crate) fn finish<P, T, E>(
    stage: &str,
    pieces: Vec<(P, Stored<T>)>,
    max_time: Option<Seconds>,
    progress: &dyn Observer,
    name_of: impl Fn(&P) -> (String, PathBuf),
    mut find: impl FnMut(&P) -> Result<Option<T>, E>,
) -> Result<Finished<T>, E> {
    let time = max_time.and_then(|time| Duration::try_from_secs_f64(time.0).ok());
    let deadline = Deadline::new(progress, time);
    let there = |(_, stored): &&(P, Stored<T>)| matches!(stored, Stored::Results(_));
    let taken_up = pieces.iter().filter(there).count();
    let all = pieces.len();
    progress.begin(stage, (all - taken_up) as u64);
    let mut finished = Finished {
        results: Vec::with_capacity(all),
        taken_up,
        computed: 0,
        notes: Vec::new(),
        stopped_by: None,
    };
    for (piece, stored) in pieces {
        let (name, path) = name_of(&piece);
        if let Stored::Damaged(reason) = &stored {
            let (path, reason) = (path.display(), reason.replace('\n', " "));
            finished
                .notes
                .push(format!("{path} is damaged and is not used ({reason})"));
        }
        if finished.stopped_by.is_none() {
            finished.stopped_by = match deadline.stop() {
                Some(StoppedBy::Time) if finished.computed == 0 => None,
                stop => stop,
            };
        }
        let results = match stored {
            Stored::Results(results) => Some(results),
            _ if finished.stopped_by.is_some() => None,
            _ => {
                progress.note(&name);
                let results = find(&piece)?;
                if results.is_some() {
                    finished.computed += 1;
                    progress.advance(1);
                } else {
                    finished.stopped_by = progress.stop();
                }
                results
            }
        };
        finished.results.push(results);
    }
    progress.end();
    if finished.results.iter().all(Option::is_some) {
        finished.stopped_by = None;
    }
    Ok(finished)
}

/// Passes on the stop and keeps the steps within a piece to itself.
pub(crate) struct Unseen<'a>(pub(crate) &'a dyn Observer);

impl Observer for Unseen<'_> {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        self.0.stop()
    }
}
