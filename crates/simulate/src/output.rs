//! What a run returns: tallies with errors, the work done, and how the run ended.

pub(crate) mod chosen_paths;
pub(crate) mod outcome;
pub(crate) mod stopped_by;
pub(crate) mod stopping;
pub(crate) mod surface_tallies;
pub(crate) mod work;
