//! Found results: the contents of the file and the journal of an earlier run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use asperity_io::{ResultFolder, exists, names_in, read_bytes, read_journal, shown_path};
use asperity_simulate::{SurfaceKey, SurfaceTallies};
use serde_json::{Value, json};

use crate::case_result::Stored;
use crate::error::{ResultsError, first_line};
use crate::header::{Header, other_build};
use crate::npz::NpzReader;
use crate::shards::Shards;
use crate::store::{JOURNAL, ReadRecord};
use crate::thumbnail::Thumbnail;

/// The file of results in a result folder.
pub(crate) const FILE: &str = "results.npz";

/// Folders of checkpoints of earlier versions.
pub(crate) const EARLIER: [&str; 3] = ["checkpoints", "cells", "directions"];

/// Name of the member with finished parts.
pub(crate) const PARTS: &str = "parts.cbor";

/// Name of the member with the thumbnail of the first surface.
pub(crate) const SURFACE: &str = "surface";

/// Upper limit of the number of cases, beyond that of any study: a damaged number would take all memory.
const MAX_CASES: usize = 1 << 20;

/// Treatment of complete results of another run in the same folder.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Complete {
    Replaced,
    Refused,
}

/// Contents of a result file or a journal.
pub(crate) struct Found<C> {
    pub(crate) cases: BTreeMap<usize, C>,
    pub(crate) parts: BTreeMap<SurfaceKey, SurfaceTallies>,
    pub(crate) thumbnail: Option<Thumbnail>,
    pub(crate) count: usize,
    pub(crate) seconds: f64,
    /// Offset in bytes at which the journal can be extended; 0 to begin a new one.
    pub(crate) end: u64,
}

impl<C> Default for Found<C> {
    fn default() -> Self {
        Self {
            cases: BTreeMap::new(),
            parts: BTreeMap::new(),
            thumbnail: None,
            count: 0,
            seconds: 0.0,
            end: 0,
        }
    }
}

impl Header {
    /// Header of a result file, or of that of a folder.
    ///
    /// # Errors
    /// [`ResultsError`] if there is no such file, it cannot be read, or it is of another format or results epoch.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ResultsError> {
        let file = &file_of(path.as_ref());
        let reader = NpzReader::new(read_bytes(file)?);
        let value = reader.and_then(|mut reader| reader.value("header"));
        parsed(file, value.map_err(broken(file))?)
    }
}

impl Thumbnail {
    /// Thumbnail in a result file, or in that of a folder; `None` if the file has none, as of triangle meshes.
    ///
    /// # Errors
    /// [`ResultsError`] if there is no such file, or it cannot be read or is damaged.
    pub fn read(path: impl AsRef<Path>) -> Result<Option<Self>, ResultsError> {
        let file = &file_of(path.as_ref());
        let reader = NpzReader::new(read_bytes(file)?);
        let thumbnail = reader.and_then(|mut reader| reader.thumbnail());
        thumbnail.map_err(broken(file))
    }
}

impl NpzReader {
    fn thumbnail(&mut self) -> Result<Option<Thumbnail>, String> {
        let has_one = self.has(&format!("{SURFACE}.json"));
        has_one.then(|| self.value(SURFACE)).transpose()
    }
}

/// Returns `true` if a folder has a file of results, or the journal of a killed run.
#[must_use]
pub fn has_results(folder: &Path) -> bool {
    [FILE, JOURNAL].iter().any(|name| exists(folder.join(name)))
}

/// A result file, or that of a folder.
fn file_of(path: &Path) -> PathBuf {
    match path.is_dir() {
        true => path.join(FILE),
        false => path.to_owned(),
    }
}

impl<C: Stored> Found<C> {
    /// Contents of a result file, or of that of a folder with the journal of a killed run.
    pub(crate) fn read(path: &Path) -> Result<(Header, Self), ResultsError> {
        let file = file_of(path);
        let journal = path.is_dir().then(|| path.join(JOURNAL));
        let mut found = Self::default();
        let mut header = None;
        let journal = journal.filter(|journal| exists(journal));
        if journal.is_none() || exists(&file) {
            let mut reader = NpzReader::new(read_bytes(&file)?).map_err(broken(&file))?;
            let value = reader.value("header").map_err(broken(&file))?;
            header = Some(parsed(&file, value)?);
            found.read_file(&mut reader).map_err(broken(&file))?;
        }
        if let Some(path) = journal {
            let mut records = read_journal(&path)?.records.into_iter();
            if let Some((_, first)) = records.next() {
                let value = serde_json::from_slice(&first).map_err(|error| error.to_string());
                let of_run = parsed(&path, value.map_err(broken(&path))?)?;
                // A killed run of other settings was about to replace the file.
                if header.is_some_and(|of| of.difference(&json!(of_run)).is_some()) {
                    found = Self::default();
                }
                header = Some(of_run);
                found.read_records(records);
            }
        }
        let header = header.ok_or_else(|| broken(path)("it has no header".to_owned()))?;
        Ok((header, found))
    }

    /// Contents of a result folder for the run of `header`, and notes on them for the user.
    pub(crate) fn of_folder(
        folder: &ResultFolder,
        header: &Header,
        complete: Complete,
    ) -> Result<(Self, Vec<String>), ResultsError> {
        refuse_earlier(folder.path())?;
        let mut found = Self::default();
        let mut notes = Vec::new();
        let file = folder.path().join(FILE);
        if exists(&file) {
            folder.keep(FILE);
            let read = NpzReader::new(read_bytes(&file)?).and_then(|mut reader| {
                let header = reader.value::<Value>("header")?;
                Ok((reader, header))
            });
            let whole = match read {
                Err(reason) => Err(reason),
                Ok((mut reader, of)) if header.completes(&of) => found.read_file(&mut reader),
                Ok((mut reader, of))
                    if header.difference(&of).is_some()
                        && header.extends(&of)
                        && of["complete"] == true
                        && reader.has(PARTS) =>
                {
                    let read = found.read_file(&mut reader);
                    found.cases.clear();
                    read
                }
                Ok((_, of)) if header.difference(&of).is_some() => {
                    if complete == Complete::Refused || of["complete"] != true {
                        return Err(other(&file, header.difference(&of).unwrap_or_default()));
                    }
                    Ok(())
                }
                Ok((mut reader, _)) => found.read_file(&mut reader),
            };
            if let Err(reason) = whole {
                found = Self::default();
                notes.push(damaged(&file, &reason));
            }
        }
        let path = folder.path().join(JOURNAL);
        if exists(&path) {
            folder.keep(JOURNAL);
            let journal = read_journal(&path)?;
            let mut records = journal.records.into_iter();
            let first = records.next();
            let first = first.and_then(|(_, first)| serde_json::from_slice::<Value>(&first).ok());
            match first {
                None => notes.push(damaged(&path, "it has no header")),
                Some(of) => match header.difference(&of) {
                    Some(difference) => return Err(other(&path, difference)),
                    None => {
                        found.read_records(records);
                        found.end = journal.end;
                    }
                },
            }
            if journal.dropped > 0 {
                notes.push(format!(
                    "the last {} bytes of {} are damaged or incomplete; what they held is computed again",
                    journal.dropped,
                    shown_path(&path)
                ));
            }
        }
        Ok((found, notes))
    }

    fn read_file(&mut self, reader: &mut NpzReader) -> Result<(), String> {
        let header = reader.value::<Value>("header")?;
        let count = header["cases"].as_u64().unwrap_or(0);
        self.count = usize::try_from(count).unwrap_or(usize::MAX);
        if self.count > MAX_CASES {
            return Err(format!(
                "it claims {count} cases; at most {MAX_CASES} are allowed"
            ));
        }
        self.seconds = header["machine"]["seconds"].as_f64().unwrap_or(0.0);
        for number in 0..self.count {
            let name = name_of(number);
            if reader.has(&format!("{name}.json")) {
                self.cases.insert(number, reader.value(&name)?);
            }
        }
        self.thumbnail = reader.thumbnail()?;
        if reader.has(PARTS) {
            let bytes = reader.bytes(PARTS)?;
            let parts: Vec<(SurfaceKey, SurfaceTallies)> =
                ciborium::from_reader(bytes.as_slice()).map_err(|error| error.to_string())?;
            self.parts.extend(parts);
        }
        Ok(())
    }

    /// Adds the records of a journal, up to the first of unknown form.
    fn read_records(&mut self, records: impl Iterator<Item = (u64, Vec<u8>)>) {
        for (_, record) in records {
            match ciborium::from_reader(record.as_slice()) {
                Ok(ReadRecord::<C>::Case(number, case)) if number < MAX_CASES => {
                    self.cases.insert(number, *case);
                }
                Ok(ReadRecord::Part(key, surface)) => {
                    self.parts.insert(key, *surface);
                }
                _ => return,
            }
        }
    }
}

/// Refuses a folder with checkpoints of an earlier version.
fn refuse_earlier(folder: &Path) -> Result<(), ResultsError> {
    for place in EARLIER {
        let names = names_in(folder.join(place));
        if let Some(name) = names.into_iter().find(|name| name.ends_with(".json")) {
            let difference = "a checkpoint of an earlier version of this program, which this one does not resume";
            let path = folder.join(place).join(name);
            return Err(other(&path, difference.to_owned()));
        }
    }
    Ok(())
}

/// Name of the member of a case.
pub(crate) fn name_of(number: usize) -> String {
    format!("cases/{number:06}")
}

/// The header of results of any study.
fn parsed(path: &Path, value: Value) -> Result<Header, ResultsError> {
    let study = value["study"].as_str().unwrap_or_default();
    if let Some(difference) = other_build(&value, study) {
        return Err(other(path, difference));
    }
    let header: Header =
        serde_json::from_value(value).map_err(|error| broken(path)(error.to_string()))?;
    match header.shards.as_ref().is_none_or(Shards::are_valid) {
        true => Ok(header),
        false => Err(broken(path)("it has no such shards".to_owned())),
    }
}

fn broken(path: &Path) -> impl Fn(String) -> ResultsError {
    move |reason| ResultsError::Damaged {
        path: path.to_owned(),
        reason,
    }
}

fn other(path: &Path, difference: String) -> ResultsError {
    let path = path.to_owned();
    ResultsError::OtherRun { path, difference }
}

fn damaged(path: &Path, reason: &str) -> String {
    let reason = first_line(reason);
    format!(
        "{} is damaged and is computed again ({reason})",
        shown_path(path)
    )
}
