//! Reduction of tallies to outcomes.

pub(crate) mod draft;
pub(crate) mod run;
pub(crate) mod tallies;
