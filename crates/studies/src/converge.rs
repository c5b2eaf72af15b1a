//! Run time against error: which error each method reaches in which time.
//!
//! # Definitions
//! - The *error* of a run is relative and over the bins of the recorded sides:
//!   `sqrt(sum_b (q_b - ref_b)^2) / sqrt(sum_b ref_b^2)`, `q_b` the mean flux fraction of all orders in
//!   bin `b` over the surfaces of the run, `ref_b` that of the reference. Repeats are averaged as squares.
//! - The *reference* is a run of many rays on many surfaces, with the controlled estimator and
//!   quasi-random starts, at the finest spacing. Its own standard errors, from the scatter between its
//!   surfaces, are expected to add `reference_error = sqrt(sum_b se_b^2) / sqrt(sum_b ref_b^2)` to every
//!   error, in quadrature. That is not subtracted: a row whose error is below twice it is marked as
//!   `at the reference`, and no line is fitted through it. At twice it, an error is 15 % too large.
//! - Where the model `smith` hides nothing, it is exact for light scattered once, and there is no other:
//!   then `error_exact` is the error against its fluxes. It holds what the mesh adds: facets are a little
//!   less steep than the continuous surface.
//! - A surface that absorbs nothing returns all light: `energy_error` is by how much reflected and
//!   transmitted light miss one, root mean square over repeats.
//! - *Seconds* are those by the clock from before the first surface is drawn until the last ray has
//!   ended: drawing, building and tracing, on all threads. The median over repeats counts. Methods take
//!   turns, so that a machine that slows down does so for all. What a control variate is expected to give is
//!   integrated once for a case; that takes `setup_seconds`, which are told apart.
//! - The *slope* is that of a least-squares line through the logarithms of seconds and error; the line
//!   also gives the seconds to an error, beyond what was measured with a mark. A line knows nothing of
//!   what lies beyond: plain rays, which see the mesh alone, come no nearer to the reference than the mesh
//!   error of what the control variate takes from the continuous surface.
//! - A *peer* is another ray tracer that follows as many plain, random rays, one branch each, in the seconds that
//!   its rate of rays takes; drawing surfaces and building its search structures count as nothing. Its errors are those of
//!   the same rays traced here.
//! - The *efficiency* of a method is `err_plain^2 t_plain / (err^2 t)`, the geometric mean over the runs
//!   of equal effort: how many times longer plain random rays would take to the same error, if errors
//!   fall as the root of time.
//!
//! Every run has surfaces and rays of its own, from a seed that follows from that of the configuration,
//! the case, the method (its accelerator aside), the effort and the repeat. Errors depend on nothing
//! else; seconds do. Each run is stored with its seconds, without the tallies of single surfaces, so that a measurement resumes and errors
//! are computed from what is stored.

mod case;
mod config;
mod deviation;
mod exact;
mod files;
mod fit;
mod json;
mod method;
mod study;
mod tables;
#[cfg(test)]
mod tests;

use asperity_results::ResultSet;

pub use case::{
    ConvergeWork, ConvergedCase, Efficiency, Measurement, MethodOutcome, Reference, SecondsTo,
};
pub use config::{ConvergeConfig, ConvergePlan, ConvergenceConfig};
pub use deviation::RepeatedError;
pub use fit::Fit;
pub use method::{ConvergeRun, Method};
pub use study::ConvergeStudy;

/// Outcome of a convergence run.
pub struct ConvergeOutcome<'a> {
    /// The configuration that was run.
    pub config: &'a ConvergeConfig,
    /// Its cases, methods and runs.
    pub plan: &'a ConvergePlan,
    /// Findings of each run.
    pub found: &'a ResultSet<'a>,
    /// The cases of which all runs are there.
    pub cases: Vec<ConvergedCase<'a>>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl ConvergeOutcome<'_> {
    /// Returns `true` if there were several cases to measure.
    fn several(&self) -> bool {
        self.plan.cases.len() > 1
    }
}
