//! Runs of the missing cases of a result set.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use asperity_io::ResultFolder;
use asperity_simulate::{
    Case, Observer, Outcome, PlannedWork, Settings, SimulateError, Simulation, StoppedBy,
};
use serde_json::Value;

use super::ResultSet;
use crate::case_result::CaseResult;
use crate::error::ResultsError;
use crate::found::{Complete, FILE};
use crate::header::Header;
use crate::store::Pace;

impl<'a> ResultSet<'a> {
    /// Opens results like [`open`](Self::open), for a study that can be extended by cases: results are matched to `cases` by name, and those of another run
    /// are always refused.
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
                let notes = std::mem::take(&mut set.notes);
                let mut renumbered = open(header)?;
                renumbered.notes.extend(notes);
                Ok(renumbered)
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
                let folder = self.folder.map_or(Path::new(""), ResultFolder::path);
                return Err(ResultsError::OtherRun {
                    path: folder.join(FILE),
                    difference: format!("the case {name} is not among those planned"),
                });
            };
            is_changed |= place != number;
            Arc::make_mut(&mut case).outcome.number = place;
            renumbered[place] = Some(case);
        }
        self.cases = renumbered;
        if is_changed {
            // That of a case that may not be the first any more.
            self.thumbnail = None;
            let mut state = self.store.state();
            if !std::mem::take(&mut state.parts).is_empty() {
                let note = "cases are numbered anew, so that finished surfaces of those that were cut short are computed again";
                self.notes.push(note.to_owned());
            }
            state.is_changed = true;
        }
        Ok(is_changed)
    }

    /// Simulates those of `cases` that are missing, starting from the finished parts of an earlier run, and keeps the tally of each surface.
    ///
    /// The first of `cases` has the number `first` in this set, so that several simulations share one set. The results of a case that a
    /// time limit or an interrupt ends are those so far; the next run continues it. If an interrupt comes before anything is finished, nothing is added.
    ///
    /// # Errors
    /// Same as [`simulate`](asperity_simulate::simulate).
    pub fn run_missing(
        &mut self,
        first: usize,
        cases: &[Case],
        settings: &Settings,
        observer: &dyn Observer,
    ) -> Result<(), SimulateError> {
        let held = self.cases.len().max(first + cases.len());
        let simulation = self.prepare(first, cases, settings)?;
        let keep = |outcome: Outcome| Ok(Some(outcome.into()));
        self.run_and_keep(simulation, first..first + cases.len(), observer, held, keep)
    }

    /// Runs missing cases like [`run_missing`](Self::run_missing), but keeps moments alone, and the findings that a study derives from the tallies of surfaces.
    /// A case without findings, for which there was no time, is left to a later run.
    ///
    /// # Errors
    /// Same as [`simulate`](asperity_simulate::simulate), and the first error of `derive`.
    pub fn run_missing_moments<E: From<SimulateError>>(
        &mut self,
        cases: &[Case],
        settings: &Settings,
        observer: &dyn Observer,
        mut derive: impl FnMut(&Outcome) -> Result<Option<Value>, E>,
    ) -> Result<(), E> {
        let simulation = self.prepare(0, cases, settings)?;
        self.run_and_keep(simulation, 0..cases.len(), observer, 0, |outcome| {
            Ok(derive(&outcome)?.map(|findings| CaseResult {
                findings,
                outcome: outcome.without_details(),
            }))
        })
    }

    /// Plans those of `cases` that are missing. With a target error pilot runs are traced for that, and kept.
    ///
    /// # Errors
    /// Same as [`simulate`](asperity_simulate::simulate).
    pub fn plan_missing(
        &mut self,
        cases: &[Case],
        settings: &Settings,
        observer: &dyn Observer,
    ) -> Result<Vec<PlannedWork>, SimulateError> {
        let simulation = self.prepare(0, cases, settings)?;
        self.store.begin(0);
        simulation.plan_work(Some(&self.store), observer)
    }

    /// The simulation of those of `cases` that are missing, the first of which has the number `first`.
    pub(super) fn prepare(
        &mut self,
        first: usize,
        cases: &[Case],
        settings: &Settings,
    ) -> Result<Simulation, SimulateError> {
        self.make_room(first + cases.len());
        let surfaces = cases.iter().map(|case| &case.surface);
        self.store.state().describe(surfaces);
        for (number, case) in (first..).zip(cases) {
            self.attach(number, case);
        }
        let is_complete = |case| self.is_complete(first + case);
        let simulation = Simulation::of_missing(cases, settings, &self.division, is_complete)?;
        Ok(simulation.on(self.engine()))
    }

    /// Runs a simulation of the cases with these `numbers`. `held`: number of cases whose surfaces are in memory at the end.
    pub(super) fn run_and_keep<E: From<SimulateError>>(
        &mut self,
        simulation: Simulation,
        numbers: Range<usize>,
        observer: &dyn Observer,
        held: usize,
        mut keep: impl FnMut(Outcome) -> Result<Option<CaseResult>, E>,
    ) -> Result<(), E> {
        self.store.begin(numbers.start);
        // A shard holds its own cases alone.
        let held = if self.share().is_whole() { held } else { 0 };
        let Self { cases, store, .. } = self;
        let store = &*store;
        let run = simulation.resume(Some(store), observer, held, |mut outcome| {
            outcome.number += numbers.start;
            let number = outcome.number;
            if let Some(case) = keep(outcome)?.map(Arc::new) {
                store.add_case(number, &case);
                cases[number] = Some(case);
            }
            Ok(())
        });
        let is_complete = numbers.into_iter().all(|case| self.is_complete(case));
        self.stopped_by = match is_complete {
            true => None,
            false if self.share().is_nothing() => Some(StoppedBy::Shards),
            false if self.share().is_whole() => observer.stop().or(Some(StoppedBy::Interrupt)),
            false => observer.stop(),
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
}
