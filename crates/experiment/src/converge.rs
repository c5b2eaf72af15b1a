//! Run time against error: how long each way of computing takes to come how near.
//!
//! # Definitions
//! - The *error* of a run is relative and over the bins of the sides asked for:
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
//!   turns, so that a machine that slows down does so for all. What a control is expected to give is
//!   integrated once for a case; that takes `setup_seconds`, which are told apart.
//! - The *slope* is that of a least-squares line through the logarithms of seconds and error; the line
//!   also gives the seconds to an error, beyond what was measured with a mark. A line knows nothing of
//!   what lies beyond: plain rays, which see the mesh alone, come no nearer to the reference than the mesh
//!   error of what the control takes from the continuous surface.
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
mod method;
mod tables;
#[cfg(test)]
mod tests;

use std::time::Instant;

use asperity_analysis::{
    Masking, ModelError, SlopeCovariance, Smith, bin_fluxes, hemispherical_energy,
};
use asperity_optics::Material;
use asperity_surface::Synthesis;
use asperity_tally::{BatchStatistics, Layout, Share, Side};
use asperity_tracer::{PathSettings, Work};
use serde::Serialize;

use crate::blocks::RaySettings;
use crate::case::Case;
use crate::config::ConfigError;
use crate::ensemble::{Group, Seconds};
use crate::estimator::Estimator;
use crate::method as estimate;
use crate::progress::Progress;
use crate::values::{Number, PerAxis};
use crate::verify::{VerifyError, slopes};

pub use config::{ConvergeConfig, ConvergenceConfig};
pub use deviation::RepeatedError;
pub use files::{converge_report, converge_summary};
pub use fit::{Fit, SecondsTo};
pub use method::{Effort, Method};
pub use tables::converge_table;

use config::Plan;
use deviation::Target;
use method::{reference_seed, run_seed};

/// An error below so many times that of the reference says more about the reference.
const AT_THE_REFERENCE: f64 = 2.0;

/// Smith's Lambda up to which nothing counts as hidden.
const NOTHING_HIDDEN: f64 = 1e-12;

/// What single scattering may miss of all light to count as all there is.
const NOTHING_MISSING: f64 = 1e-9;

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
        "no light reaches the bins of the side asked for; without any, no error can be a fraction of it"
    )]
    NoLight,
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
    pub rays_a_surface: u64,
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
    pub rays_a_surface: u64,
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
    /// a side is not asked for.
    pub energy_error: Option<f64>,
    /// Whether the error is well above that of the reference.
    pub usable: bool,
}

/// What was found for one method.
#[derive(Clone, Debug)]
pub struct MethodOutcome {
    /// The method.
    pub method: Method,
    /// Seconds spent once, before its runs and not counted in theirs: on the mean of its control.
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
    /// rays beside themselves.
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
    /// Errors to which the seconds are asked.
    pub errors: Vec<f64>,
    /// The cases.
    pub cases: Vec<ConvergedCase>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl ConvergedCase {
    /// Plain random rays on the grid of `method` and with its accelerator, if they were measured.
    fn baseline(&self, method: &Method) -> Option<&MethodOutcome> {
        let is_it = |m: &&MethodOutcome| m.method.is_baseline() && m.method.shares_grid(method);
        self.methods.iter().find(is_it)
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
    progress: &dyn Progress,
) -> Result<ConvergeOutcome, ConvergeError> {
    let began = Instant::now();
    config.check()?;
    let plan = config.plan()?;
    let mut stages = Vec::new();
    for case in &plan.cases {
        stages.push(Stage::new(config, &plan, *case)?);
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
        errors: plan.errors,
        cases,
        seconds: began.elapsed().as_secs_f64(),
    })
}

/// One case, ready to be measured.
struct Stage<'a> {
    plan: &'a Plan,
    case: Case,
    slopes: SlopeCovariance,
    /// How surfaces are drawn at each spacing.
    recipes: Vec<(PerAxis<Number>, Synthesis)>,
    /// What each estimator does, and the seconds that it took to know.
    estimators: Vec<(Estimator, estimate::Method, f64)>,
}

/// What one run found and took.
struct Run {
    statistics: BatchStatistics,
    rays_a_surface: u64,
    work: Work,
    spent: Seconds,
    seconds: f64,
}

impl<'a> Stage<'a> {
    fn new(config: &ConvergeConfig, plan: &'a Plan, case: Case) -> Result<Self, ConvergeError> {
        let mut recipes: Vec<(PerAxis<Number>, Synthesis)> = Vec::new();
        for method in plan.methods.iter().chain([&plan.reference.0]) {
            if recipes
                .iter()
                .all(|(spacing, _)| *spacing != method.spacing)
            {
                recipes.push((method.spacing, config.recipe(&case, method)?));
            }
        }
        let slopes = slopes(&case.psd).map_err(VerifyError::from)?;
        let mut estimators: Vec<(Estimator, estimate::Method, f64)> = Vec::new();
        for method in plan.methods.iter().chain([&plan.reference.0]) {
            let estimator = method.estimator;
            if estimators.iter().all(|(known, ..)| *known != estimator) {
                let clock = Instant::now();
                let (material, incidence) = (case.material, case.incidence);
                let method = estimate::Method::of_ensemble(
                    estimator,
                    &slopes,
                    material,
                    incidence,
                    &plan.layout,
                )?;
                estimators.push((estimator, method, clock.elapsed().as_secs_f64()));
            }
        }
        Ok(Self {
            plan,
            case,
            slopes,
            recipes,
            estimators,
        })
    }

    /// What an estimator does, and the seconds that it took to know.
    fn estimator(&self, method: &Method) -> &(Estimator, estimate::Method, f64) {
        let known = self
            .estimators
            .iter()
            .find(|(e, ..)| *e == method.estimator);
        known.unwrap_or(&self.estimators[0])
    }

    /// Rays of all runs.
    fn rays(&self) -> u64 {
        let plan = self.plan;
        let (reference, effort) = &plan.reference;
        let of = |method, effort: &Effort| {
            let rays = |group: &Group<'_>| group.blocks().rays() * effort.surfaces;
            self.with_group(method, *effort, 0, rays)
        };
        let one_of_each: u64 = plan
            .methods
            .iter()
            .flat_map(|method| plan.efforts.iter().map(move |effort| of(method, effort)))
            .sum();
        plan.repeats * one_of_each + of(reference, effort)
    }

    /// Hands over what the engine runs: the only place that knows how to ask it.
    fn with_group<T>(
        &self,
        method: &Method,
        effort: Effort,
        seed: u64,
        then: impl FnOnce(&Group<'_>) -> T,
    ) -> T {
        let recipe = self
            .recipes
            .iter()
            .find(|(spacing, _)| *spacing == method.spacing);
        let (_, synthesis) = recipe.unwrap_or(&self.recipes[0]);
        then(&Group {
            synthesis,
            cases: &[self.case],
            methods: std::slice::from_ref(&self.estimator(method).1),
            realisations: effort.surfaces,
            settings: &RaySettings {
                rays: effort.rays * effort.surfaces,
                seed,
                layout: self.plan.layout,
                paths: PathSettings::default(),
                accelerator: method.accelerator,
                estimator: method.estimator,
                sampling: method.sampling,
                refine: false,
                target: None,
            },
            incident: self.plan.incident,
            any_azimuth: self.plan.any_azimuth,
            coarsened: false,
        })
    }

    /// One run of the engine, by the clock.
    fn run(
        &self,
        method: &Method,
        effort: Effort,
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<Run, ConvergeError> {
        let clock = Instant::now();
        let ensembles = self.with_group(method, effort, seed, |group| {
            group.run(0..effort.surfaces, progress)
        })?;
        let seconds = clock.elapsed().as_secs_f64();
        if progress.stop().is_some() {
            return Err(ConvergeError::Interrupted);
        }
        let mut statistics = BatchStatistics::new(self.plan.layout.len());
        let mut run = Run {
            statistics: BatchStatistics::default(),
            rays_a_surface: 0,
            work: Work::default(),
            spent: Seconds::default(),
            seconds,
        };
        for ensemble in ensembles {
            ensemble
                .records
                .iter()
                .for_each(|record| statistics.push(record));
            run.rays_a_surface = ensemble.work.rays / effort.surfaces;
            run.work = ensemble.work;
            run.spent = ensemble.seconds;
        }
        run.statistics = statistics;
        Ok(run)
    }

    /// The reference first, which also warms the machine up, then all methods in turns.
    fn measure(&self, progress: &dyn Progress) -> Result<ConvergedCase, ConvergeError> {
        let began = Instant::now();
        let plan = self.plan;
        let (method, effort) = plan.reference;
        let run = self.run(
            &method,
            effort,
            reference_seed(plan.seed, &self.case),
            progress,
        )?;
        let target = Target::new(self.fluxes(&run)).ok_or(ConvergeError::NoLight)?;
        let exact = self.exact_fluxes()?.and_then(Target::new);
        let standard_errors: Vec<f64> = self
            .bins()
            .map(|bin| run.statistics.estimate(bin).se.unwrap_or(0.0))
            .collect();
        let reference = Reference {
            method,
            size: self.size(&method),
            rays_a_surface: run.rays_a_surface,
            surfaces: effort.surfaces,
            error: target.own_error(&standard_errors),
            error_exact: exact
                .as_ref()
                .map(|exact| exact.relative_rms(&self.fluxes(&run))),
            seconds: run.seconds,
        };
        let mut work = ConvergeWork::default();
        work.add(&run, effort);

        let cells = plan.methods.len() * plan.efforts.len();
        let mut samples: Vec<Vec<RunSample>> = Vec::new();
        samples.resize_with(cells, Vec::new);
        for repeat in 0..plan.repeats {
            for (e, &effort) in plan.efforts.iter().enumerate() {
                for turn in 0..plan.methods.len() {
                    // Another one begins each time, so that none always follows the same.
                    let m = (turn + repeat as usize) % plan.methods.len();
                    let method = &plan.methods[m];
                    let seed = run_seed(plan.seed, &self.case, method, effort, repeat);
                    let run = self.run(method, effort, seed, progress)?;
                    work.add(&run, effort);
                    samples[m * plan.efforts.len() + e].push(self.sample(
                        &run,
                        &target,
                        exact.as_ref(),
                    ));
                }
            }
        }
        let methods = plan
            .methods
            .iter()
            .zip(samples.chunks_exact(plan.efforts.len()))
            .map(|(method, samples)| {
                let measurements = plan.efforts.iter().zip(samples);
                let measurements = measurements
                    .map(|(effort, samples)| Measurement::over(*effort, samples, reference.error));
                let setup_seconds = self.estimator(method).2;
                MethodOutcome::new(*method, setup_seconds, measurements.collect())
            })
            .collect();
        work.seconds = began.elapsed().as_secs_f64();
        Ok(ConvergedCase {
            case: self.case,
            reference,
            is_exact: exact.is_some(),
            methods,
            work,
        })
    }

    /// Samples `[nx, ny]` of a method's surfaces.
    fn size(&self, method: &Method) -> [usize; 2] {
        let run_nothing = Effort {
            rays: 1,
            surfaces: 1,
        };
        let [ny, nx] = self.with_group(method, run_nothing, 0, |group| group.synthesis.shape());
        [nx, ny]
    }

    /// Entries of the bins that are compared.
    fn bins(&self) -> impl Iterator<Item = usize> + use<> {
        let start = self.plan.layout.bins(Share::Total).start;
        self.plan.layout.asked_bins().map(move |bin| start + bin)
    }

    /// Mean fluxes of the bins that are compared.
    fn fluxes(&self, run: &Run) -> Vec<f64> {
        let means = run.statistics.means();
        self.bins().map(|bin| means[bin]).collect()
    }

    fn sample(&self, run: &Run, target: &Target, exact: Option<&Target>) -> RunSample {
        let fluxes = self.fluxes(run);
        let means = run.statistics.means();
        let left = means[Layout::REFLECTED] + means[Layout::TRANSMITTED];
        RunSample {
            seconds: run.seconds,
            rays_a_surface: run.rays_a_surface,
            error: target.relative_rms(&fluxes),
            error_exact: exact.map(|exact| exact.relative_rms(&fluxes)),
            energy_error: self.returns_all_light().then_some(left - 1.0),
        }
    }

    /// Whether all light must be found on the sides that are asked for.
    fn returns_all_light(&self) -> bool {
        let asks = |side| self.plan.layout.asks(side);
        match self.case.material {
            Material::Mirror => asks(Side::Reflected),
            Material::Dielectric { .. } => asks(Side::Reflected) && asks(Side::Transmitted),
            _ => false,
        }
    }

    /// What each bin holds exactly, where every facet is lit and seen and light meets only one.
    fn exact_fluxes(&self) -> Result<Option<Vec<f64>>, ConvergeError> {
        let Case {
            material,
            incidence,
            psd,
            ..
        } = &self.case;
        let wi = incidence.wi();
        if !psd.is_isotropic() || self.slopes.lambda(wi) >= NOTHING_HIDDEN {
            return Ok(None);
        }
        let of = |material| Smith::new(self.slopes, material, Masking::HeightCorrelated);
        let model = of(*material)?;
        // What a conductor absorbs is none of the light that facets hide; a mirror in its place tells.
        let lossless = match material {
            Material::Conductor { .. } => of(Material::Mirror)?,
            _ => model,
        };
        let energy = hemispherical_energy(&lossless, wi);
        if (energy.reflected + energy.transmitted - 1.0).abs() > NOTHING_MISSING {
            return Ok(None);
        }
        let grid = self.plan.layout.grid();
        let expected = bin_fluxes(&model, wi, &grid);
        Ok(Some(expected[self.plan.layout.asked_bins()].to_vec()))
    }
}

/// What one run gives to a measurement.
struct RunSample {
    seconds: f64,
    rays_a_surface: u64,
    error: f64,
    error_exact: Option<f64>,
    energy_error: Option<f64>,
}

impl Measurement {
    fn over(effort: Effort, samples: &[RunSample], reference_error: f64) -> Self {
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
            rays_a_surface: samples[0].rays_a_surface,
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
            setup_seconds,
            fit: Fit::over(&points),
            measurements,
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
    fn add(&mut self, run: &Run, effort: Effort) {
        self.runs += 1;
        self.surfaces += effort.surfaces;
        self.rays += run.work.rays;
        self.segments += run.work.segments;
        self.segments_skipped += run.work.segments_skipped;
        self.generate_seconds += run.spent.generate;
        self.build_seconds += run.spent.build;
        self.trace_seconds += run.spent.trace;
        self.lost = self.lost.max(run.statistics.means()[Layout::LOST].abs());
    }
}
