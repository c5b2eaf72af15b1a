//! Ready group: cases that share surfaces, ready to be planned and traced.

use super::context::Context;
use super::draft::Draft;
use crate::error::SimulateError;

/// Cases that share surfaces, of which those that are given are built.
pub(crate) trait ReadyGroup {
    /// Rays of the pilot run.
    fn pilot_rays(&self) -> u64 {
        0
    }

    /// Plans the effort by a pilot run, where it follows from a target error. `_all_cases`: cases of the run.
    fn plan(&mut self, _all_cases: usize, _context: Context<'_>) -> Result<(), SimulateError> {
        Ok(())
    }

    /// What is about to be traced and why, a line each.
    fn explanations(&self) -> Vec<String>;

    /// Surfaces planned.
    fn surfaces(&self) -> u64;

    /// Rays of all cases, as planned.
    fn rays(&self) -> u64;

    /// Traces all cases: as planned, and more until the error is reached. Cases that were not begun before an
    /// interrupt are left out.
    fn run(
        self: Box<Self>,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<Vec<Draft>, SimulateError>;
}
