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

use std::time::Instant;

use asperity_results::{CaseResult, ResultSet};
use asperity_simulate::{Observer, Outcome, SimulateError, Simulation, StoppedBy};
use serde_json::json;

use crate::error::StudyError;

pub use case::{
    ConvergeWork, ConvergedCase, Efficiency, Measurement, MethodOutcome, Reference, SecondsTo,
};
pub use config::{ConvergeConfig, ConvergePlan, ConvergenceConfig};
pub use deviation::RepeatedError;
pub use fit::Fit;
pub use method::{ConvergeRun, Method};
pub use study::ConvergeStudy;

use case::{SETUP_SECONDS, StoredRun};

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

/// Measures run time against error for every case and method, by those runs of `plan` that `found` lacks.
///
/// # Errors
/// [`StudyError`] if a case cannot be traced, no light reaches the bins, or the run is stopped before there is any result.
pub fn converge<'a>(
    config: &'a ConvergeConfig,
    plan: &'a ConvergePlan,
    found: &'a mut ResultSet<'_>,
    observer: &dyn Observer,
) -> Result<ConvergeOutcome<'a>, StudyError> {
    let began = Instant::now();
    let mut prepared: Vec<Prepared<'_>> = Vec::new();
    let mut rays = 0;
    for (number, run) in plan.runs.iter().enumerate() {
        if found.is_complete(number) {
            continue;
        }
        let known = prepared.iter().position(|one| one.serves(run));
        let place = known.unwrap_or(prepared.len());
        if known.is_none() {
            prepared.push(Prepared::new(config, run)?);
        }
        rays += prepared[place].simulation(run).rays();
    }
    observer.begin("tracing", rays);
    found.compute_missing(plan.runs.len(), observer, |number| {
        let run = &plan.runs[number];
        let prepared = prepared.iter().find(|one| one.serves(run));
        prepared.map_or(Ok(None), |one| one.result(number, run, observer))
    })?;
    observer.end();
    if found.cases().next().is_none() {
        return Err(SimulateError::Interrupted.into());
    }
    found.close()?;
    let mut judged = judge_convergence(config, plan, found)?;
    judged.seconds = began.elapsed().as_secs_f64();
    Ok(judged)
}

/// Outcome of a measurement by the results of its plan. Cases that lack a run are left out.
///
/// # Errors
/// [`StudyError`] if no light reaches the bins that are compared.
pub fn judge_convergence<'a>(
    config: &'a ConvergeConfig,
    plan: &'a ConvergePlan,
    found: &'a ResultSet<'_>,
) -> Result<ConvergeOutcome<'a>, StudyError> {
    let began = Instant::now();
    let mut cases = Vec::new();
    for (case_number, case) in plan.cases.iter().enumerate() {
        let runs = plan.runs.iter().enumerate();
        let runs = runs.filter(|(_, run)| run.case_number == case_number);
        let stored = runs.map(|(number, run)| {
            Some(StoredRun {
                run,
                result: found.case(number)?,
            })
        });
        if let Some(runs) = stored.collect::<Option<Vec<_>>>() {
            cases.push(ConvergedCase::of(plan, case, &runs)?);
        }
    }
    Ok(ConvergeOutcome {
        config,
        plan,
        found,
        cases,
        seconds: began.elapsed().as_secs_f64(),
    })
}

/// A method, prepared for the runs of one case.
struct Prepared<'a> {
    /// The first of the runs.
    run: &'a ConvergeRun,
    simulation: Simulation,
    /// Seconds that it took to prepare.
    seconds: f64,
}

impl<'a> Prepared<'a> {
    fn new(config: &ConvergeConfig, run: &'a ConvergeRun) -> Result<Self, StudyError> {
        let settings = config.settings(&run.method)?;
        let clock = Instant::now();
        Ok(Self {
            run,
            simulation: Simulation::new(std::slice::from_ref(&run.case), &settings)?,
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    fn serves(&self, run: &ConvergeRun) -> bool {
        self.run.case_number == run.case_number && self.run.method == run.method
    }

    fn simulation(&self, run: &ConvergeRun) -> Simulation {
        self.simulation.repeated(run.effort, run.seed)
    }

    /// One run of the engine, by its clock; `None` if it was interrupted, since it is no sample then.
    fn result(
        &self,
        number: usize,
        run: &ConvergeRun,
        observer: &dyn Observer,
    ) -> Result<Option<CaseResult>, StudyError> {
        let outcomes = self.simulation(run).run(&Steps(observer));
        if observer.stop().is_some() {
            return Ok(None);
        }
        let result = |outcome: Outcome| CaseResult {
            findings: json!({ "repeat": run.repeat, "machine": { SETUP_SECONDS: self.seconds } }),
            outcome: Outcome {
                number,
                ..outcome.without_details()
            },
        };
        Ok(outcomes?.into_iter().next().map(result))
    }
}

/// Passes on steps and the stop; what a run begins and ends is a part of the measurement.
struct Steps<'a>(&'a dyn Observer);

impl Observer for Steps<'_> {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.0.advance(steps);
    }
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        self.0.stop()
    }
}
