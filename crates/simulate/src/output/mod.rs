//! What a run returns besides its tallies: the work done, and how the run ended.

pub(crate) mod stopping;
pub(crate) mod work;
