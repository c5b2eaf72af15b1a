//! Shards: the parts of one run that results are of, where they are not of all of it.

use std::collections::BTreeSet;
use std::fmt;

use asperity_simulate::{Share, counted};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The shards of a run that results are of, where they are not of all of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shards {
    /// Number of shards of the run.
    pub of: u64,
    /// Numbers of those that results are of, from 1.
    pub numbers: BTreeSet<u64>,
    /// `false` of a shard that was ended before all of it was traced.
    pub finished: bool,
    /// `true` if they were merged while others are missing.
    pub merged: bool,
    /// Settings as they were given, from which a merge judges the results of all shards.
    pub request: Value,
    /// Settings with their defaults, which all shards have in common.
    pub settings: Value,
}

impl Shards {
    /// One shard, of which nothing is traced yet.
    #[must_use]
    pub fn one(share: Share, request: Value, settings: Value) -> Self {
        Self {
            of: share.of(),
            numbers: [share.number()].into(),
            finished: false,
            merged: false,
            request,
            settings,
        }
    }

    /// The share of the run that is traced: that of one shard; nothing of several, which were traced by others.
    pub(crate) fn share(&self) -> Share {
        let mut numbers = self.numbers.iter();
        let first = numbers.next().filter(|_| numbers.next().is_none());
        let share = first.and_then(|&number| Share::new(number, self.of));
        share.unwrap_or(Share::NOTHING)
    }

    /// Numbers of the shards that are missing.
    pub fn missing(&self) -> impl Iterator<Item = u64> {
        (1..=self.of).filter(|number| !self.numbers.contains(number))
    }

    /// Returns `true` if there are such shards.
    pub(crate) fn are_valid(&self) -> bool {
        let mut numbers = self.numbers.iter();
        !self.numbers.is_empty() && numbers.all(|&number| Share::new(number, self.of).is_some())
    }

    /// Returns `true` if both are the same shards of the same division.
    pub(crate) fn are_those_of(&self, other: &Self) -> bool {
        (self.of, &self.numbers) == (other.of, &other.numbers)
    }
}

impl fmt::Display for Shards {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.numbers.first() {
            Some(number) if self.numbers.len() == 1 => write!(f, "shard {number}/{}", self.of),
            _ => {
                let count = counted(self.numbers.len() as u64, "shard");
                write!(f, "{count} of {}", self.of)
            }
        }
    }
}
