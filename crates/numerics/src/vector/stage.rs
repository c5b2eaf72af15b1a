//! Stage: a loop over arrays that is compiled for each instruction set.

/// A loop over arrays that is compiled for each instruction set.
pub trait Stage {
    /// Runs the loop. Implementations are `#[inline(always)]`, as is all that they call, so that they are compiled
    /// for the instructions of the function that calls them.
    fn run(self);
}
