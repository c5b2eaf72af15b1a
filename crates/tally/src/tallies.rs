//! Tallies: those of several batches of rays that are traced together.

use std::ops::AddAssign;

use crate::exit_columns::ExitColumns;
use crate::{ControlVariate, Side, Tally, TallyValues};

/// One [`Tally`] for each of several batches, all of the same spec, azimuth and control variate.
#[derive(Clone, Debug)]
pub struct Tallies<'c> {
    all: Tally<'c>,
    batches: usize,
}

impl<'c> Tallies<'c> {
    /// As many empty tallies like `empty` as there are batches.
    #[must_use]
    pub fn new(empty: Tally<'c>, batches: usize) -> Self {
        Self {
            all: empty.for_batches(batches),
            batches,
        }
    }

    /// Whether light that leaves on `side` is recorded.
    #[must_use]
    pub const fn records(&self, side: Side) -> bool {
        self.all.records(side)
    }

    /// The control variate, under which shadowed and masked light counts too.
    #[must_use]
    pub const fn control_variate(&self) -> Option<&'c ControlVariate> {
        self.all.control_variate()
    }

    /// The tally of batch number `batch`.
    ///
    /// # Panics
    /// If there are not so many batches.
    #[inline(always)]
    pub fn of(&mut self, batch: u32) -> &mut Tally<'c> {
        self.all.turn_to(batch as usize);
        &mut self.all
    }

    /// Finds the bins of exits, in loops that take the vector instructions of the function that calls this one.
    #[inline(always)]
    pub fn locate(&self, exits: &mut ExitColumns) {
        self.all.locate(exits);
    }

    /// Adds exits to the bins that [`Tallies::locate`] has found, in the tallies of their batches, and removes them: as [`Tally::add_exit`] and
    /// [`Tally::add_masked`] do.
    pub fn add_located(&mut self, exits: &mut ExitColumns) {
        for i in 0..exits.len() {
            self.of(exits.batch[i]).add_located(exits, i);
        }
        exits.clear();
    }

    /// Closes the tallies: fractions of the incident flux, for batches of `rays` rays of flux one each.
    #[must_use]
    pub fn into_fractions(self, rays: u64) -> Vec<TallyValues> {
        let batches = 0..self.batches;
        batches
            .map(|batch| self.all.fractions_of_batch(batch, rays))
            .collect()
    }
}

/// Adds what other rays of the same batches did; in which order does not matter.
///
/// # Panics
/// If the tallies are of different specs, batches or largest weights.
impl AddAssign<&Self> for Tallies<'_> {
    fn add_assign(&mut self, other: &Self) {
        self.all += &other.all;
    }
}
