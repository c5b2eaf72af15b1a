//! Preparation of cases: groups that share surfaces, and how each case is estimated.

pub(crate) mod case_run;
mod explanation;
mod given;
pub(crate) mod group;
