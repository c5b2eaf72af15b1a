//! Output of a run: tallies with errors, the work done, and the end of the run.

pub(crate) mod chosen_paths;
pub(crate) mod numbered_blocks;
pub(crate) mod outcome;
pub(crate) mod stopped_by;
pub(crate) mod stopping;
pub(crate) mod surface_tallies;
pub(crate) mod work;
