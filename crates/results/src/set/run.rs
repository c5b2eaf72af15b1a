//! Runs of the missing cases of a result set.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use asperity_io::ResultFolder;
use asperity_simulate::{Case, Observer, Outcome, Settings, SimulateError, Simulation, StoppedBy};
use serde_json::Value;

use super::ResultSet;
use crate::case_result::CaseResult;
use crate::error::ResultsError;
use crate::found::Complete;
use crate::header::Header;
use crate::store::Pace;

impl<'a> ResultSet<'a> {
    /// As [`open`](Self::open), for a study that can be extended by cases: results are matched to `cases` by name, and those of another run
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

    /// Simulates those of `cases` that are missing, starting from the finished parts of an earlier run, and keeps the tally of each surface.
    ///
    /// The first of `cases` has the number `first` in this set, so that several simulations share one set. The results of a case that a
    /// time limit or an interrupt ends are those so far; the next run continues it. If an interrupt comes before anything is finished, nothing is added.
    ///
    /// # Errors
    /// As [`simulate`](asperity_simulate::simulate).
    pub fn run_missing(
        &mut self,
        first: usize,
        cases: &[Case],
        settings: &Settings,
        observer: &dyn Observer,
    ) -> Result<(), SimulateError> {
        let held = self.cases.len().max(first + cases.len());
        let keep = |outcome: Outcome| Ok(outcome.into());
        self.run_and_keep(first, cases, settings, observer, held, keep)
    }

    /// As [`run_missing`](Self::run_missing), but keeps moments alone, and the findings that a study derives from the tallies of surfaces.
    ///
    /// # Errors
    /// As [`simulate`](asperity_simulate::simulate), and the first error of `derive`.
    pub fn run_missing_moments<E: From<SimulateError>>(
        &mut self,
        cases: &[Case],
        settings: &Settings,
        observer: &dyn Observer,
        mut derive: impl FnMut(&Outcome) -> Result<Value, E>,
    ) -> Result<(), E> {
        self.run_and_keep(0, cases, settings, observer, 0, |outcome| {
            Ok(CaseResult {
                findings: derive(&outcome)?,
                outcome: outcome.without_details(),
            })
        })
    }

    /// `held`: number of cases whose surfaces are in memory at the end.
    pub(super) fn run_and_keep<E: From<SimulateError>>(
        &mut self,
        first: usize,
        cases: &[Case],
        settings: &Settings,
        observer: &dyn Observer,
        held: usize,
        mut keep: impl FnMut(Outcome) -> Result<CaseResult, E>,
    ) -> Result<(), E> {
        let end = first + cases.len();
        self.make_room(end);
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
        let run = simulation.resume(Some(store), observer, held, |mut outcome| {
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
}
