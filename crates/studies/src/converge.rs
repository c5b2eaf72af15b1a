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
//! else; seconds do.

mod config;
mod deviation;
mod files;
mod fit;
mod json;
mod method;
mod stage;
mod tables;
#[cfg(test)]
mod tests;

use asperity_simulate::{Case, Observer, SimulateError, StoppedBy};
use std::time::Instant;

use asperity_analysis::ModelError;
use asperity_tally::TallyResult;
use asperity_tracer::Branching;
use serde::Serialize;

use crate::config::error::ConfigError;
use crate::verify::error::VerifyError;

pub use config::{ConvergeConfig, ConvergenceConfig};
pub use deviation::RepeatedError;
pub use files::converge_report;
pub use fit::{Fit, SecondsTo};
pub use json::converge_summary;
pub use method::{Method, RunEffort};
pub use tables::converge_table;

use stage::{Run, RunSample, Stage};

/// An error below this multiple of the reference's own error says more about the reference than about the run.
const AT_THE_REFERENCE: f64 = 2.0;

/// Why a convergence run fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConvergeError {
    /// An interrupt came before the first case was finished.
    #[error("interrupted before a case was finished: there is nothing to write")]
    Interrupted,
    /// The surfaces or their light cannot be had.
    #[error(transparent)]
    Run(#[from] VerifyError),
    /// No light at all in the bins that are compared.
    #[error(
        "no light reaches the bins of the side requested; without any, no error can be a fraction of it"
    )]
    NoLight,
}

impl From<SimulateError> for ConvergeError {
    fn from(error: SimulateError) -> Self {
        Self::Run(error.into())
    }
}

impl From<ConfigError> for ConvergeError {
    fn from(error: ConfigError) -> Self {
        Self::Run(error.into())
    }
}

impl From<ModelError> for ConvergeError {
    fn from(error: ModelError) -> Self {
        Self::Run(error.into())
    }
}

/// What errors are measured against.
#[derive(Clone, Debug, Serialize)]
pub struct Reference {
    /// How it was computed.
    #[serde(flatten)]
    pub method: Method,
    /// Samples `[nx, ny]` of a surface.
    pub size: [usize; 2],
    /// Rays on each surface.
    pub rays_per_surface: u64,
    /// Surfaces.
    pub surfaces: u64,
    /// What its own standard errors are expected to add to every error.
    pub error: f64,
    /// Its error against the exact fluxes, where there are such.
    pub error_exact: Option<f64>,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Runs of one method and effort.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// Rays on each surface.
    pub rays_per_surface: u64,
    /// Surfaces of a run.
    pub surfaces: u64,
    /// Runs.
    pub repeats: u64,
    /// Seconds of a run: median, least and most.
    pub seconds: f64,
    /// Seconds of the fastest run.
    pub seconds_min: f64,
    /// Seconds of the slowest run.
    pub seconds_max: f64,
    /// Relative error against the reference.
    pub error: RepeatedError,
    /// The same against the exact fluxes, where there are such.
    pub error_exact: Option<RepeatedError>,
    /// By how much the light of a surface that absorbs nothing misses one; `None` for others, and where
    /// a side is not requested.
    pub energy_error: Option<f64>,
    /// Whether the error is well above that of the reference.
    pub usable: bool,
}

/// What was found for one method.
#[derive(Clone, Debug)]
pub struct MethodOutcome {
    /// The method.
    pub method: Method,
    /// Rays per second of a peer, by which its seconds are computed; `None` for what was timed.
    pub peer_rate: Option<f64>,
    /// Seconds spent once, before its runs and not counted in theirs: on the mean of its control variate.
    pub setup_seconds: f64,
    /// Its runs, in the order of the efforts.
    pub measurements: Vec<Measurement>,
    /// The line through those that are usable.
    pub fit: Option<Fit>,
}

/// How many times longer plain random rays take to the same error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Efficiency {
    /// So many times.
    pub ratio: f64,
    /// What the standard errors of the errors make of it; `None` for single runs, and for plain random
    /// rays in addition to the rays themselves.
    pub se: Option<f64>,
}

/// What was found for one case.
pub struct ConvergedCase {
    /// The case.
    pub case: Case,
    /// What errors are measured against.
    pub reference: Reference,
    /// Whether exact fluxes are known.
    pub is_exact: bool,
    /// The methods.
    pub methods: Vec<MethodOutcome>,
    /// What the engine did, the reference included.
    pub work: ConvergeWork,
}

/// What was done, and how long it took.
#[derive(Clone, Debug, Serialize)]
pub struct ConvergeWork {
    /// Runs.
    pub runs: u64,
    /// Surfaces drawn.
    pub surfaces: u64,
    /// Incident rays.
    pub rays: u64,
    /// Segments searched for a hit.
    pub segments: u64,
    /// Segments that needed no search.
    pub segments_skipped: u64,
    /// Seconds spent on drawing surfaces, summed over surfaces.
    pub generate_seconds: f64,
    /// Seconds spent on building accelerators, summed over surfaces.
    pub build_seconds: f64,
    /// Seconds spent on tracing, summed over surfaces.
    pub trace_seconds: f64,
    /// Seconds from beginning to end.
    pub seconds: f64,
    /// Threads.
    pub threads: usize,
    /// The largest part of the flux that a run lost to numerical failure.
    pub lost: f64,
}

/// What a convergence run found.
pub struct ConvergeOutcome {
    /// The configuration that was run.
    pub config: ConvergeConfig,
    /// Errors for which run times are computed.
    pub errors: Vec<f64>,
    /// The cases.
    pub cases: Vec<ConvergedCase>,
    /// Number of cases that an interrupt came before.
    pub left_out: usize,
    /// Names of the files of all cases.
    files: Vec<String>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl ConvergeOutcome {
    /// Whether there were several cases to measure.
    fn several(&self) -> bool {
        self.cases.len() + self.left_out > 1
    }

    /// What ended the run before all cases were measured: nothing but an interrupt does.
    #[must_use]
    pub fn stopped_by(&self) -> Option<StoppedBy> {
        (self.left_out > 0).then_some(StoppedBy::Interrupt)
    }
}

impl ConvergedCase {
    /// Plain random rays on the grid of `method` and with its accelerator, if they were measured: those that split, else
    /// those that pick.
    fn baseline(&self, method: &Method) -> Option<&MethodOutcome> {
        let timed = self.methods.iter().filter(|m| m.peer_rate.is_none());
        let plain = timed.filter(|m| m.method.is_plain_and_random());
        let on_grid = plain.filter(|m| m.method.shares_grid(method));
        on_grid.min_by_key(|m| m.method.branching == Branching::Pick)
    }

    /// How many times longer plain random rays take to `error` than `method`, by the fitted lines.
    #[must_use]
    pub fn speedup(&self, method: &MethodOutcome, error: f64) -> Option<SecondsTo> {
        let [plain, own] = [self.baseline(&method.method)?, method]
            .map(|m| m.fit.and_then(|fit| fit.seconds_to(error)));
        let (plain, own) = (plain?, own?);
        Some(SecondsTo {
            seconds: plain.seconds / own.seconds,
            extrapolated: plain.extrapolated || own.extrapolated,
        })
    }

    /// `err_plain^2 t_plain / (err^2 t)`, the geometric mean over the efforts at which both are usable.
    #[must_use]
    pub fn efficiency(&self, method: &MethodOutcome) -> Option<Efficiency> {
        let plain = self.baseline(&method.method)?;
        let is_itself = plain.method == method.method;
        let cost = |m: &Measurement| m.error.rms.powi(2) * m.seconds;
        // The variance of twice the logarithm of an error.
        let variance = |m: &Measurement| m.error.se.map(|se| (2.0 * se / m.error.rms).powi(2));
        let (mut efforts, mut logs, mut variances) = (0.0, 0.0, Some(0.0));
        for (plain, own) in plain.measurements.iter().zip(&method.measurements) {
            if plain.usable && own.usable {
                efforts += 1.0;
                logs += (cost(plain) / cost(own)).ln();
                variances = (|| Some(variances? + variance(plain)? + variance(own)?))();
            }
        }
        if efforts == 0.0 {
            return None;
        }
        let ratio = (logs / efforts).exp();
        let variances = variances.filter(|_| !is_itself);
        Some(Efficiency {
            ratio,
            se: variances.map(|sum| ratio * f64::sqrt(sum) / efforts),
        })
    }
}

/// Measures run time against error for every case and method.
///
/// # Errors
/// [`ConvergeError`] if the configuration makes no sense or does not fit into memory.
pub fn converge(
    config: &ConvergeConfig,
    progress: &dyn Observer,
) -> Result<ConvergeOutcome, ConvergeError> {
    let began = Instant::now();
    let files = config.check()?;
    let plan = config.plan()?;
    let mut stages = Vec::new();
    for case in &plan.cases {
        stages.push(Stage::new(config, &plan, case.clone())?);
    }
    let rays = stages.iter().map(Stage::rays).sum();
    progress.begin("tracing", rays);
    let mut cases = Vec::new();
    for stage in &stages {
        match stage.measure(progress) {
            Ok(case) => cases.push(case),
            // The cases that are finished stand for themselves.
            Err(ConvergeError::Interrupted) if !cases.is_empty() => break,
            Err(error) => return Err(error),
        }
    }
    progress.end();
    Ok(ConvergeOutcome {
        config: config.clone(),
        files,
        errors: plan.errors,
        left_out: plan.cases.len() - cases.len(),
        cases,
        seconds: began.elapsed().as_secs_f64(),
    })
}

impl Measurement {
    fn over(effort: RunEffort, samples: &[RunSample], reference_error: f64) -> Self {
        let mut seconds: Vec<f64> = samples.iter().map(|sample| sample.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        let middle = seconds.len() / 2;
        let errors: Vec<f64> = samples.iter().map(|sample| sample.error).collect();
        let error = RepeatedError::over(&errors);
        let all = |of: fn(&RunSample) -> Option<f64>| -> Option<RepeatedError> {
            let values: Option<Vec<f64>> = samples.iter().map(of).collect();
            values.map(|values| RepeatedError::over(&values))
        };
        Self {
            rays_per_surface: samples[0].rays_per_surface,
            surfaces: effort.surfaces,
            repeats: samples.len() as u64,
            seconds: 0.5 * (seconds[middle] + seconds[(seconds.len() - 1) / 2]),
            seconds_min: seconds[0],
            seconds_max: seconds[seconds.len() - 1],
            error,
            error_exact: all(|sample| sample.error_exact),
            energy_error: all(|sample| sample.energy_error).map(|error| error.rms),
            usable: error.rms > 0.0 && error.rms >= AT_THE_REFERENCE * reference_error,
        }
    }
}

impl MethodOutcome {
    fn new(method: Method, setup_seconds: f64, measurements: Vec<Measurement>) -> Self {
        let usable = measurements.iter().filter(|m| m.usable);
        let points: Vec<(f64, f64)> = usable.map(|m| (m.seconds, m.error.rms)).collect();
        Self {
            method,
            peer_rate: None,
            setup_seconds,
            fit: Fit::over(&points),
            measurements,
        }
    }

    /// The same rays at the rate of a peer, whose surfaces take no time.
    fn of_peer(&self, rate: f64) -> Self {
        let timed = |own: &Measurement| {
            let seconds = (own.rays_per_surface * own.surfaces) as f64 / rate;
            Measurement {
                seconds,
                seconds_min: seconds,
                seconds_max: seconds,
                ..own.clone()
            }
        };
        let measurements = self.measurements.iter().map(timed).collect();
        Self {
            peer_rate: Some(rate),
            ..Self::new(self.method, 0.0, measurements)
        }
    }
}

impl Default for ConvergeWork {
    fn default() -> Self {
        Self {
            runs: 0,
            surfaces: 0,
            rays: 0,
            segments: 0,
            segments_skipped: 0,
            generate_seconds: 0.0,
            build_seconds: 0.0,
            trace_seconds: 0.0,
            seconds: 0.0,
            threads: rayon::current_num_threads(),
            lost: 0.0,
        }
    }
}

impl ConvergeWork {
    fn add(&mut self, run: &Run, effort: RunEffort) {
        self.runs += 1;
        self.surfaces += effort.surfaces;
        self.rays += run.work.rays;
        self.segments += run.work.segments;
        self.segments_skipped += run.work.segments_skipped;
        self.generate_seconds += run.work.machine.generate_seconds;
        self.build_seconds += run.work.machine.build_seconds;
        self.trace_seconds += run.work.machine.trace_seconds;
        self.lost = self.lost.max(run.statistics.means().budget().lost.abs());
    }
}
