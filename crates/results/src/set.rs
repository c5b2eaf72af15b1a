//! Container: the results of a study, by number of the case.

mod merge;
mod run;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use asperity_io::{ResultFolder, exists, write_bytes};
use asperity_simulate::{Division, Observer, Share, SimulateError, StoppedBy, SurfaceSource};
use asperity_surface::LengthUnit;
use asperity_tracer::{CpuEngine, Engine};
use serde_json::{Value, json};

use crate::case_result::{CaseResult, Stored};
use crate::error::ResultsError;
use crate::found::{Complete, FILE, Found, PARTS, SURFACE, name_of};
use crate::header::Header;
use crate::npz::{Machines, NpzWriter};
use crate::shards::Shards;
use crate::store::{JOURNAL, Pace, Part, PartStore};
use crate::thumbnail::Thumbnail;

/// Number of results that an earlier run left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Resumed {
    /// Complete cases.
    pub cases: usize,
    /// Finished surfaces, or rounds of rays on a given surface, of incomplete cases.
    pub parts: usize,
}

/// The results of a study that traces tallies.
pub type ResultSet<'a> = Container<'a, CaseResult>;

/// The results of a study: a header, a result per case, and the finished parts of cases that are not complete.
///
/// # Examples
/// ```
/// use asperity_optics::{Incidence, Material};
/// use asperity_results::{Header, ResultSet};
/// use asperity_simulate::{Case, Effort, Light, Settings, Silent, SurfaceSource};
/// use asperity_synthesis::{Psd, Synthesis};
///
/// let surfaces = Synthesis::new(Psd::gaussian(1.0, 8.0)?, [64, 64], [1.0, 1.0], false)?;
/// let light = Light::from_above(Incidence::from_degrees(30.0, 0.0)?);
/// let case = Case::new(SurfaceSource::random(surfaces), Material::dielectric(1.5)?, light);
/// let settings = Settings { effort: Effort::Rays { total: 4000, surfaces: 4 }, ..Settings::default() };
///
/// let mut results = ResultSet::in_memory(Header::new("example", settings.seed, "glass".into()));
/// results.run_missing(0, &[case], &settings, &Silent)?;
/// assert_eq!(results.case(0).map(|case| case.outcome.surfaces.len()), Some(4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Container<'a, C> {
    /// Identity of the run.
    pub header: Header,
    cases: Vec<Option<Arc<C>>>,
    thumbnail: Option<Thumbnail>,
    store: PartStore<'a, C>,
    folder: Option<&'a ResultFolder>,
    resumed: Resumed,
    notes: Vec<String>,
    division: Division,
    engine: Arc<dyn Engine>,
    stopped_by: Option<StoppedBy>,
    opened: Instant,
    began: Instant,
}

impl<C: Stored> Container<'static, C> {
    /// An empty set without a folder.
    #[must_use]
    pub fn in_memory(header: Header) -> Self {
        Self::of(header, Found::default(), None, Pace::DEFAULT)
    }

    /// Reads a file of results, or those of a folder, with what the journal of a killed run adds.
    ///
    /// # Errors
    /// [`ResultsError`] if there are none, they cannot be read, are damaged, or of another format or results epoch.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ResultsError> {
        let (header, found) = Found::read(path.as_ref())?;
        Ok(Self::of(header, found, None, Pace::DEFAULT))
    }
}

impl<'a, C: Stored> Container<'a, C> {
    /// The results of an earlier run of the same study and document in a result folder, to be resumed. Complete results of another run
    /// are replaced.
    ///
    /// # Errors
    /// [`ResultsError`] if it was of another study, document or results epoch and is not complete, or of an earlier version of this program,
    /// or cannot be read.
    pub fn open(folder: &'a ResultFolder, header: Header) -> Result<Self, ResultsError> {
        Self::open_at(folder, header, Pace::DEFAULT, Complete::Replaced)
    }

    fn open_at(
        folder: &'a ResultFolder,
        header: Header,
        pace: Pace,
        complete: Complete,
    ) -> Result<Self, ResultsError> {
        let (found, notes) = Found::of_folder(folder, &header, complete)?;
        let before = found.seconds;
        let mut set = Self::of(header, found, Some(folder), pace);
        set.header.machine.seconds += before;
        set.notes = notes;
        Ok(set)
    }

    fn of(header: Header, found: Found<C>, folder: Option<&'a ResultFolder>, pace: Pace) -> Self {
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
        let parts = parts.map(|(key, surface)| (key, Part::Held(Box::new(surface))));
        let parts: BTreeMap<_, _> = parts.collect();
        let of_incomplete = parts.keys().filter(|key| !is_complete(key.case)).count();
        store.state().parts = parts;
        Self {
            resumed: Resumed {
                cases: (0..cases.len()).filter(|&i| is_complete(i)).count(),
                parts: of_incomplete,
            },
            cases,
            thumbnail: found.thumbnail,
            store,
            folder,
            notes: Vec::new(),
            division: Division {
                share: header.shards.as_ref().map_or(Share::WHOLE, Shards::share),
                seconds: Vec::new(),
            },
            engine: Arc::new(CpuEngine),
            stopped_by: None,
            opened: Instant::now(),
            began: Instant::now(),
            header,
        }
    }

    /// Traces what is missing on another engine, which gives the same bytes.
    #[must_use]
    pub fn on(self, engine: Arc<dyn Engine>) -> Self {
        Self { engine, ..self }
    }

    /// The engine that traces what is missing.
    #[must_use]
    pub fn engine(&self) -> Arc<dyn Engine> {
        self.engine.clone()
    }

    /// The share of what is missing that is traced.
    #[must_use]
    pub const fn share(&self) -> Share {
        self.division.share
    }

    /// Balances shards by these times of all cases in seconds, and takes the pilot runs that `planned` has.
    ///
    /// # Errors
    /// The first difference, if it is of another run.
    pub fn follow_plan(
        &mut self,
        planned: Container<'_, C>,
        seconds: Vec<f64>,
    ) -> Result<(), String> {
        if let Some(difference) = self.header.difference_of_run(&json!(planned.header)) {
            return Err(difference);
        }
        self.division.seconds = seconds;
        let mut of_plan = planned.store.state();
        of_plan.hold_parts();
        let pilots = std::mem::take(&mut of_plan.parts);
        let mut state = self.store.state();
        for (key, part) in pilots {
            if key.is_of_pilot() {
                state.parts.entry(key).or_insert(part);
            }
        }
        Ok(())
    }

    /// Keeps the finished surfaces of complete cases in the file, so that a run with more surfaces or a smaller target error goes on from them.
    pub fn keep_parts(&mut self) {
        let mut state = self.store.state();
        state.is_changed |= !state.keeps_parts && self.folder.is_some();
        state.keeps_parts = true;
    }

    /// Number of results that an earlier run left.
    #[must_use]
    pub const fn resumed(&self) -> Resumed {
        self.resumed
    }

    /// Notes for the user on the files of an earlier run, one sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Number of cases, of which some may be missing.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.cases.len()
    }

    /// Returns `true` if there are no cases.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }

    /// A case; `None` if it is missing.
    #[must_use]
    pub fn case(&self, number: usize) -> Option<&C> {
        self.cases.get(number)?.as_deref()
    }

    /// All cases that are there, with their numbers.
    pub fn cases(&self) -> impl Iterator<Item = (usize, &C)> {
        let cases = self.cases.iter().enumerate();
        cases.filter_map(|(number, case)| Some((number, case.as_deref()?)))
    }

    /// The cases whose coordinate has this value, by the name of its [column](Stored::columns), as in `theta_deg`. Numbers are compared as numbers.
    pub fn select(&self, coordinate: &str, value: &Value) -> impl Iterator<Item = (usize, &C)> {
        let is_equal = move |found: &Value| match (found.as_f64(), value.as_f64()) {
            (Some(found), Some(wanted)) => found == wanted,
            _ => found == value,
        };
        self.cases().filter(move |(_, case)| {
            let mut columns = case.columns().into_iter();
            columns.any(|column| column.name == coordinate && is_equal(&column.value))
        })
    }

    /// Returns `true` if a case is there and needs no further run.
    #[must_use]
    pub fn is_complete(&self, number: usize) -> bool {
        self.case(number).is_some_and(|case| !case.is_cut_short())
    }

    /// Reason why the last run ended before all of its cases were complete.
    #[must_use]
    pub const fn stopped_by(&self) -> Option<StoppedBy> {
        self.stopped_by
    }

    /// Number of cases that a stop cut short: their results are of the surfaces or rays that were finished.
    #[must_use]
    pub fn cut_short(&self) -> usize {
        self.cases().filter(|(_, case)| case.is_cut_short()).count()
    }

    /// Seconds since the set was opened.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.opened.elapsed().as_secs_f64()
    }

    /// Time spent on the journal so far.
    #[must_use]
    pub fn journal_time(&self) -> Duration {
        self.store.state().journal_time
    }

    /// Numbers of the results that are missing and to be computed, those of the share, among as many as there are `costs`: the times that they
    /// are expected to take, in any unit.
    #[must_use]
    pub fn to_compute(&self, costs: &[f64]) -> Vec<usize> {
        let slices = self.share().slices(costs).into_iter().enumerate();
        let missing = slices.filter(|(number, _)| !self.is_complete(*number));
        let own = missing.filter(|(_, slice)| slice.units(1) == (0..1));
        own.map(|(number, _)| number).collect()
    }

    /// Computes the results that are missing and [to be computed](Self::to_compute), one after the other, until `compute` returns `None` at an interrupt.
    /// Without an interrupt a `None` leaves the result to another shard.
    ///
    /// # Errors
    /// The first error of `compute`.
    pub fn compute_missing<E>(
        &mut self,
        costs: &[f64],
        observer: &dyn Observer,
        mut compute: impl FnMut(usize) -> Result<Option<C>, E>,
    ) -> Result<(), E> {
        self.make_room(costs.len());
        self.stopped_by = None;
        for number in self.to_compute(costs) {
            if let Some(case) = compute(number)? {
                self.add(number, case);
            } else if let Some(stopped_by) = observer.stop() {
                self.stopped_by = Some(stopped_by);
                break;
            }
        }
        if self.share().is_nothing() && (0..costs.len()).any(|number| !self.is_complete(number)) {
            self.stopped_by = Some(StoppedBy::Shards);
        }
        Ok(())
    }

    /// Removes the results after the first `count`.
    pub fn truncate(&mut self, count: usize) {
        if self.cases.len() > count {
            self.cases.truncate(count);
            self.store.state().is_changed = true;
        }
    }

    /// Adds the result of a case, in place of the one that is there.
    pub fn add(&mut self, number: usize, case: C) {
        self.make_room(number + 1);
        let case = Arc::new(case);
        self.store.add_case(number, &case);
        self.cases[number] = Some(case);
    }

    /// Keeps a [`Thumbnail`] of the first surface of `source`, whose unit is `unit`, with the results. Nothing is drawn where the set has a
    /// thumbnail already, has no folder, or consists of triangle meshes, nor where `observer` gives up the first result.
    ///
    /// # Errors
    /// [`SimulateError`] if the surface cannot be drawn.
    pub fn keep_thumbnail(
        &mut self,
        source: &SurfaceSource,
        unit: LengthUnit,
        observer: &dyn Observer,
    ) -> Result<(), SimulateError> {
        if self.folder.is_some() && self.thumbnail.is_none() {
            let gives_up = || observer.gives_up_first();
            self.thumbnail = Thumbnail::of(source, self.header.seed, unit, &gives_up)?;
            self.store.state().is_changed |= self.thumbnail.is_some();
        }
        Ok(())
    }

    fn make_room(&mut self, count: usize) {
        if self.cases.len() < count {
            self.cases.resize(count, None);
        }
    }

    /// Keeps the finished parts of a run that ended without any result, and returns `true` if there are any.
    ///
    /// # Errors
    /// [`ResultsError`] if a file cannot be written or removed.
    pub fn close_early(&mut self) -> Result<bool, ResultsError> {
        let is_changed = self.folder.is_some() && self.store.state().is_changed;
        if is_changed {
            self.close()?;
        }
        Ok(is_changed)
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
        let is_ended = matches!(
            self.stopped_by,
            Some(StoppedBy::Time | StoppedBy::Interrupt)
        );
        if let Some(shards) = &mut self.header.shards {
            self.store.state().is_changed |= shards.finished == is_ended;
            shards.finished = !is_ended;
        }
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
            header["axes"] = json!(axes(self.cases()));
            let is_complete = (0..self.cases.len()).all(|case| self.is_complete(case));
            let is_whole = self.stopped_by.is_none() && self.header.shards.is_none();
            header["complete"] = (is_complete && is_whole).into();
            writer.add("header", &header)?;
            if let Some(thumbnail) = &self.thumbnail {
                writer.add(SURFACE, thumbnail)?;
            }
            for (number, case) in self.cases() {
                writer.add(&name_of(number), &state.to_write(case))?;
            }
            let mut parts = Vec::new();
            for (key, part) in &state.parts {
                let is_complete = self.is_complete(key.case);
                // Equal results have equal bytes; times of an incomplete case are kept until it is complete.
                let has_no_times = is_complete || matches!(machines, Machines::LeftOut);
                match part {
                    Part::Held(_) if is_complete && !state.keeps_parts => {}
                    Part::Held(surface) if has_no_times => {
                        parts.push((key, Cow::Owned(surface.without_machine())));
                    }
                    Part::Held(surface) => parts.push((key, Cow::Borrowed(&**surface))),
                    Part::Journal(_) => {}
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

/// The coordinates in which cases differ, with their values.
fn axes<'a, C: Stored + 'a>(
    cases: impl Iterator<Item = (usize, &'a C)>,
) -> BTreeMap<String, Vec<Value>> {
    let mut axes: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for column in cases.flat_map(|(_, case)| case.columns()) {
        let values = axes.entry(column.name).or_default();
        if !values.contains(&column.value) {
            values.push(column.value);
        }
    }
    axes.retain(|_, values| values.len() > 1);
    axes
}
