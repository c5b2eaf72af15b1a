//! Result set: the results of a study, of which what is missing is run.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use asperity_io::{ResultFolder, exists, names_in, read_bytes, read_journal, write_bytes};
use asperity_simulate::{
    Case, Observer, Outcome, SavedSurface, Settings, SimulateError, Simulation, StoppedBy,
    SurfaceKey,
};
use serde_json::{Value, json};

use crate::case_result::CaseResult;
use crate::error::ResultsError;
use crate::header::{Header, other_build};
use crate::npz::{Machines, NpzReader, NpzWriter};
use crate::rounding::rounding;
use crate::store::{JOURNAL, Pace, Part, PartStore, ReadRecord};

/// The file of results in a result folder.
const FILE: &str = "results.npz";

/// Folders of checkpoints of earlier versions.
const EARLIER: [&str; 3] = ["checkpoints", "cells", "directions"];

/// What an earlier run has left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Resumed {
    /// Cases that are complete.
    pub cases: usize,
    /// Surfaces, or rounds of rays on a given one, of cases that are not.
    pub parts: usize,
}

/// The results of a study: a header, a result per case, and the finished parts of cases that are not complete.
///
/// # Examples
/// ```
/// use asperity_optics::{Incidence, Material};
/// use asperity_results::{Header, ResultSet};
/// use asperity_simulate::{Case, Effort, Light, Settings, Silent, SimulateError, SurfaceSource};
/// use asperity_surface::{Psd, Synthesis};
///
/// let surfaces = Synthesis::new(Psd::gaussian(1.0, 8.0)?, [64, 64], [1.0, 1.0], false)?;
/// let light = Light::from_above(Incidence::from_degrees(30.0, 0.0)?);
/// let case = Case::new(SurfaceSource::random(surfaces), Material::dielectric(1.5)?, light);
/// let settings = Settings { effort: Effort::Rays { total: 4000, surfaces: 4 }, ..Settings::default() };
///
/// let mut results = ResultSet::in_memory(Header::new("example", settings.seed, "glass".into()));
/// results.run_missing(0, &[case], &settings, &Silent, |outcome| {
///     Ok::<_, SimulateError>(outcome.into())
/// })?;
/// assert_eq!(results.case(0).map(|case| case.outcome.surfaces.len()), Some(4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ResultSet<'a> {
    /// What the results follow from.
    pub header: Header,
    cases: Vec<Option<Arc<CaseResult>>>,
    store: PartStore<'a>,
    folder: Option<&'a ResultFolder>,
    resumed: Resumed,
    notes: Vec<String>,
    stopped_by: Option<StoppedBy>,
    began: Instant,
}

/// What becomes of complete results of another run in the same folder.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Complete {
    Replaced,
    Refused,
}

/// What a file or a journal holds.
#[derive(Default)]
struct Found {
    cases: BTreeMap<usize, CaseResult>,
    parts: BTreeMap<SurfaceKey, SavedSurface>,
    count: usize,
    seconds: f64,
    /// Where the journal ends that more can be added to, or 0.
    end: u64,
}

impl ResultSet<'static> {
    /// No results yet, and no folder to keep them in.
    #[must_use]
    pub fn in_memory(header: Header) -> Self {
        Self::of(header, Found::default(), None, Pace::DEFAULT)
    }

    /// Reads a file of results, or those of a folder, with what the journal of a killed run adds.
    ///
    /// # Errors
    /// [`ResultsError`] if there are none, they cannot be read, are damaged, or of another form or results epoch.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ResultsError> {
        let path = path.as_ref();
        let (file, journal) = match path.is_dir() {
            true => (path.join(FILE), Some(path.join(JOURNAL))),
            false => (path.to_owned(), None),
        };
        let mut found = Found::default();
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
                header = Some(parsed(&path, value.map_err(broken(&path))?)?);
                found.read_records(records);
            }
        }
        let header = header.ok_or_else(|| broken(path)("it has no header".to_owned()))?;
        Ok(Self::of(header, found, None, Pace::DEFAULT))
    }

    /// The results of shards of one run, in one. Of a case that several have, the first complete one counts.
    ///
    /// # Errors
    /// [`ResultsError::OtherShard`] if they are of different runs.
    pub fn merge(shards: Vec<ResultSet<'_>>) -> Result<Self, ResultsError> {
        let mut shards = shards.into_iter();
        let first = shards.next().ok_or(ResultsError::NoShards)?;
        let mut header = first.header.clone();
        header.machine.seconds = 0.0;
        let mut found = Found::default();
        for shard in std::iter::once(first).chain(shards) {
            if let Some(difference) = header.difference(&json!(shard.header)) {
                return Err(ResultsError::OtherShard(difference));
            }
            if header.rounding != shard.header.rounding {
                let difference = "machines that round differently".to_owned();
                return Err(ResultsError::OtherShard(difference));
            }
            header.machine.seconds += shard.header.machine.seconds;
            found.count = found.count.max(shard.cases.len());
            for (number, case) in shard.cases.into_iter().enumerate() {
                let Some(case) = case else { continue };
                let known = found.cases.get(&number);
                if known.is_none_or(CaseResult::is_cut_short) {
                    found.cases.insert(number, Arc::unwrap_or_clone(case));
                }
            }
            let mut state = shard.store.state();
            state.hold_parts();
            for (key, part) in std::mem::take(&mut state.parts) {
                if let Part::Held(surface) = part {
                    found.parts.insert(key, *surface);
                }
            }
        }
        Ok(Self::of(header, found, None, Pace::DEFAULT))
    }
}

impl<'a> ResultSet<'a> {
    /// What an earlier run of the same study and document has left in a result folder, to be resumed. Complete results of another run are
    /// replaced.
    ///
    /// # Errors
    /// [`ResultsError`] if it was of another study, document or results epoch and is not complete, or of an earlier version of this program,
    /// or cannot be read.
    pub fn open(folder: &'a ResultFolder, header: Header) -> Result<Self, ResultsError> {
        Self::open_at(folder, header, Pace::DEFAULT, Complete::Replaced)
    }

    /// The same of a study to which `cases` can be added later: those that are there are found by their names, and a document is that of
    /// all of them.
    ///
    /// # Errors
    /// [`ResultsError`] if it was of another study, document or results epoch, has cases that are not among `cases`, or cannot be read.
    pub fn open_cases(
        folder: &'a ResultFolder,
        header: Header,
        cases: &[Case],
    ) -> Result<Self, ResultsError> {
        let open = |header| Self::open_at(folder, header, Pace::DEFAULT, Complete::Refused);
        let mut set = open(header.clone())?;
        match set.renumber(cases)? {
            false => Ok(set),
            // The journal knows the cases by their former numbers.
            true => {
                set.close()?;
                open(header)
            }
        }
    }

    /// Gives all cases their numbers among `cases`, and returns whether one has another. Parts are of cases by their former numbers.
    fn renumber(&mut self, cases: &[Case]) -> Result<bool, ResultsError> {
        let names: BTreeMap<String, usize> = (cases
            .iter()
            .enumerate()
            .map(|(i, case)| (case.direction_name(), i)))
        .collect();
        let mut renumbered = vec![None; cases.len()];
        let mut is_changed = false;
        for (number, case) in std::mem::take(&mut self.cases).into_iter().enumerate() {
            let Some(mut case) = case else { continue };
            let known = &case.outcome.case;
            let name = known.direction_name();
            let place = names.get(&name).copied();
            let place = place.filter(|&i| cases[i].summary_json() == known.summary_json());
            let Some(place) = place else {
                let folder = self
                    .folder
                    .map_or_else(PathBuf::new, |f| f.path().to_owned());
                return Err(ResultsError::OtherCases { folder, name });
            };
            is_changed |= place != number;
            Arc::make_mut(&mut case).outcome.number = place;
            renumbered[place] = Some(case);
        }
        self.cases = renumbered;
        if is_changed {
            let mut state = self.store.state();
            state.parts.clear();
            state.is_changed = true;
        }
        Ok(is_changed)
    }

    pub(crate) fn open_at(
        folder: &'a ResultFolder,
        header: Header,
        pace: Pace,
        complete: Complete,
    ) -> Result<Self, ResultsError> {
        refuse_earlier(folder.path())?;
        let mut found = Found::default();
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
                Ok((_, of)) if header.difference(&of).is_some() => {
                    if complete == Complete::Refused || of["complete"] != true {
                        return Err(other(&file, header.difference(&of).unwrap_or_default()));
                    }
                    Ok(())
                }
                Ok((_, of)) if of["rounding"] != rounding() => {
                    notes.push(other_rounding(&file));
                    Ok(())
                }
                Ok((mut reader, _)) => found.read_file(&mut reader),
            };
            if let Err(reason) = whole {
                found = Found::default();
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
                    None if of["rounding"] != rounding() => notes.push(other_rounding(&path)),
                    None => {
                        found.read_records(records);
                        found.end = journal.end;
                    }
                },
            }
            if journal.dropped > 0 {
                notes.push(format!(
                    "the last {} bytes of {} are no whole record and are computed again",
                    journal.dropped,
                    path.display()
                ));
            }
        }
        let before = found.seconds;
        let mut set = Self::of(header, found, Some(folder), pace);
        set.header.machine.seconds += before;
        set.notes = notes;
        Ok(set)
    }

    fn of(header: Header, found: Found, folder: Option<&'a ResultFolder>, pace: Pace) -> Self {
        let last = found.cases.last_key_value().map_or(0, |(last, _)| last + 1);
        let mut cases = vec![None; last.max(found.count)];
        for (number, case) in found.cases {
            cases[number] = Some(Arc::new(case));
        }
        let target = folder.map(|folder| (header.clone(), folder));
        let store = PartStore::new(target, found.end, pace);
        let is_complete = |number: usize| {
            let case = cases.get(number).and_then(Option::as_ref);
            case.is_some_and(|case| !case.is_cut_short())
        };
        let parts = found.parts.into_iter();
        let parts = parts.filter(|(key, _)| !is_complete(key.case));
        let parts = parts.map(|(key, surface)| (key, Part::Held(Box::new(surface))));
        store.state().parts = parts.collect();
        let parts = store.state().parts.len();
        Self {
            resumed: Resumed {
                cases: (0..cases.len()).filter(|&i| is_complete(i)).count(),
                parts,
            },
            header,
            cases,
            store,
            folder,
            notes: Vec::new(),
            stopped_by: None,
            began: Instant::now(),
        }
    }

    /// What an earlier run has left.
    #[must_use]
    pub const fn resumed(&self) -> Resumed {
        self.resumed
    }

    /// What a reader should know of the files that an earlier run has left: a sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Number of cases, of which some may be missing.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.cases.len()
    }

    /// Whether there are no cases.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }

    /// A case; `None` if it is missing.
    #[must_use]
    pub fn case(&self, number: usize) -> Option<&CaseResult> {
        self.cases.get(number)?.as_deref()
    }

    /// All cases that are there, with their numbers.
    pub fn cases(&self) -> impl Iterator<Item = (usize, &CaseResult)> {
        let cases = self.cases.iter().enumerate();
        cases.filter_map(|(number, case)| Some((number, case.as_deref()?)))
    }

    /// The cases of which a coordinate, or whatever else they are, is wanted.
    pub fn select(
        &self,
        is_wanted: impl Fn(&Case) -> bool,
    ) -> impl Iterator<Item = (usize, &CaseResult)> {
        self.cases()
            .filter(move |(_, case)| is_wanted(&case.outcome.case))
    }

    /// Whether a case is there and needs no further run.
    #[must_use]
    pub fn is_complete(&self, number: usize) -> bool {
        self.case(number).is_some_and(|case| !case.is_cut_short())
    }

    /// What ended the last run before all of its cases were complete.
    #[must_use]
    pub const fn stopped_by(&self) -> Option<StoppedBy> {
        self.stopped_by
    }

    /// Number of cases that a stop cut short: their results are of the surfaces or rays that were finished.
    #[must_use]
    pub fn cut_short(&self) -> usize {
        self.cases().filter(|(_, case)| case.is_cut_short()).count()
    }

    /// The finished parts of cases that are not complete.
    #[must_use]
    pub const fn parts(&self) -> &PartStore<'a> {
        &self.store
    }

    /// Time spent on the journal so far.
    #[must_use]
    pub fn journal_time(&self) -> Duration {
        self.store.state().journal_time
    }

    /// Simulates those of `cases` that are missing, from the finished parts of an earlier run.
    ///
    /// The first of `cases` has the number `first` in this set, so that several simulations go into one set. `keep` decides what of
    /// an outcome is kept, as all, or moments alone, and what follows from the rest. A case that a stop cuts short is there as far as it got,
    /// and the next run goes on with it. If nothing was finished before an interrupt, nothing is added.
    ///
    /// # Errors
    /// As [`simulate`](asperity_simulate::simulate), and the first error of `keep`.
    pub fn run_missing<E: From<SimulateError>>(
        &mut self,
        first: usize,
        cases: &[Case],
        settings: &Settings,
        observer: &dyn Observer,
        mut keep: impl FnMut(Outcome) -> Result<CaseResult, E>,
    ) -> Result<(), E> {
        let end = first + cases.len();
        self.header.set_axes(cases);
        if self.cases.len() < end {
            self.cases.resize(end, None);
        }
        self.store
            .state()
            .describe(cases.iter().map(|case| &case.surface));
        for (number, case) in (first..).zip(cases) {
            self.attach(number, case);
        }
        let simulation =
            Simulation::of_missing(cases, settings, |case| self.is_complete(first + case))?;
        self.store.begin(first);
        let Self { cases, store, .. } = self;
        let store = &*store;
        let run = simulation.resume(Some(store), observer, |mut outcome| {
            outcome.number += first;
            let number = outcome.number;
            let case = Arc::new(keep(outcome)?);
            store.add_case(number, &case);
            cases[number] = Some(case);
            Ok(())
        });
        let is_complete = (first..end).all(|case| self.is_complete(case));
        self.stopped_by = match is_complete {
            true => None,
            false => observer.stop().or(Some(StoppedBy::Interrupt)),
        };
        run
    }

    /// Gives a case that was read the surface that it was read without.
    fn attach(&mut self, number: usize, case: &Case) {
        let state = self.store.state();
        if let (Some(Some(known)), Some(described)) = (
            self.cases.get_mut(number),
            state.described_as(&case.surface),
        ) && known.outcome.case.surface == *described
        {
            Arc::make_mut(known).outcome.case.surface = case.surface.clone();
        }
    }

    /// Ends a run: writes the file of results, and removes the journal. Without a folder it does nothing.
    ///
    /// # Errors
    /// [`ResultsError`] if a file cannot be written or removed.
    pub fn close(&mut self) -> Result<(), ResultsError> {
        let Some(folder) = self.folder else {
            return Ok(());
        };
        self.header.machine.seconds += self.began.elapsed().as_secs_f64();
        self.began = Instant::now();
        let is_changed = {
            let mut state = self.store.state();
            state.hold_parts();
            std::mem::take(&mut state.is_changed)
        };
        let path = folder.claim_checkpoint(FILE)?;
        if is_changed || !exists(&path) {
            write_bytes(&path, &self.bytes(Machines::Named)?)?;
        }
        folder.discard(JOURNAL)?;
        self.store.state().take_failure().map_or(Ok(()), Err)
    }

    /// The file without what depends on the machine and the moment: equal results have equal bytes.
    ///
    /// # Errors
    /// [`ResultsError`] if the results cannot be written.
    pub fn comparable_bytes(&self) -> Result<Vec<u8>, ResultsError> {
        self.bytes(Machines::LeftOut)
    }

    fn bytes(&self, machines: Machines) -> Result<Vec<u8>, ResultsError> {
        let write = || {
            let state = self.store.state();
            let mut writer = NpzWriter::new();
            let mut header = json!(self.header);
            header["cases"] = self.cases.len().into();
            let is_complete = (0..self.cases.len()).all(|case| self.is_complete(case));
            header["complete"] = (is_complete && self.stopped_by.is_none()).into();
            writer.add("header", &header)?;
            for (number, case) in self.cases() {
                writer.add(&name_of(number), &state.to_write(case))?;
            }
            let mut parts = Vec::new();
            for (key, part) in &state.parts {
                if let Part::Held(surface) = part {
                    parts.push((key, surface));
                }
            }
            if !parts.is_empty() {
                let mut bytes = Vec::new();
                let written = ciborium::into_writer(&parts, &mut bytes);
                written.map_err(|error| error.to_string())?;
                writer.add_bytes(PARTS, &bytes)?;
            }
            writer.finish(machines)
        };
        write().map_err(ResultsError::Unwritable)
    }
}

/// Name of the member with finished parts.
const PARTS: &str = "parts.cbor";

fn name_of(number: usize) -> String {
    format!("cases/{number:06}")
}

impl Found {
    fn read_file(&mut self, reader: &mut NpzReader) -> Result<(), String> {
        let header = reader.value::<Value>("header")?;
        self.count = header["cases"].as_u64().unwrap_or(0) as usize;
        self.seconds = header["machine"]["seconds"].as_f64().unwrap_or(0.0);
        for number in 0..self.count {
            let name = name_of(number);
            if reader.has(&format!("{name}.json")) {
                self.cases.insert(number, reader.value(&name)?);
            }
        }
        if reader.has(PARTS) {
            let bytes = reader.bytes(PARTS)?;
            let parts: Vec<(SurfaceKey, SavedSurface)> =
                ciborium::from_reader(bytes.as_slice()).map_err(|error| error.to_string())?;
            self.parts.extend(parts);
        }
        Ok(())
    }

    /// Puts the records of a journal on top. One that is of no known form ends them.
    fn read_records(&mut self, records: impl Iterator<Item = (u64, Vec<u8>)>) {
        for (_, record) in records {
            match ciborium::from_reader(record.as_slice()) {
                Ok(ReadRecord::Case(number, case)) => {
                    self.cases.insert(number, *case);
                }
                Ok(ReadRecord::Part(key, surface)) => {
                    self.parts.insert(key, *surface);
                }
                Err(_) => return,
            }
        }
    }
}

/// Refuses a folder in which an earlier version has left checkpoints.
fn refuse_earlier(folder: &Path) -> Result<(), ResultsError> {
    for place in EARLIER {
        let names = names_in(folder.join(place));
        if let Some(name) = names.into_iter().find(|name| name.ends_with(".json")) {
            let path = folder.join(place).join(name);
            return Err(ResultsError::Earlier { path });
        }
    }
    Ok(())
}

/// The header of results of any study.
fn parsed(path: &Path, value: Value) -> Result<Header, ResultsError> {
    let study = value["study"].as_str().unwrap_or_default();
    if let Some(difference) = other_build(&value, study) {
        return Err(other(path, difference));
    }
    serde_json::from_value(value).map_err(|error| broken(path)(error.to_string()))
}

fn broken(path: &Path) -> impl Fn(String) -> ResultsError {
    move |reason| ResultsError::Damaged {
        path: path.to_owned(),
        reason,
    }
}

fn other(path: &Path, difference: String) -> ResultsError {
    let path: PathBuf = path.to_owned();
    ResultsError::OtherRun { path, difference }
}

fn damaged(path: &Path, reason: &str) -> String {
    let reason = reason.replace('\n', " ");
    format!(
        "{} is damaged and is computed again ({reason})",
        path.display()
    )
}

fn other_rounding(path: &Path) -> String {
    format!(
        "{} is of a machine that rounds differently and is computed again",
        path.display()
    )
}
