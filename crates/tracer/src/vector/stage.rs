//! Stage: a loop over arrays that is compiled for each instruction set.

/// Most lanes of any search: twice those of the widest instruction set.
pub(crate) const MAX_LANES: usize = 32;

/// A loop over arrays that is compiled for each instruction set.
pub(crate) trait Stage {
    /// Runs the loop. Implementations are `#[inline(always)]`, as is all that they call, so that they are compiled
    /// for the instructions of the function that calls them.
    fn run(self);
}
