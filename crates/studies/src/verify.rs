//! Explicit surfaces against statistical models.

use asperity_simulate::{
    Case, Deadline, ErrorBudget, MeshErrors, Observer, RaySettings, Refinement, RunError, Sharing,
    Stopping, Traced, check_results, with_least_errors,
};
use std::time::{Duration, Instant};

use asperity_analysis::{ComparisonError, ModelError, SlopeError, sidak_level};
use asperity_surface::{CoarseningError, HeightField, Synthesis, SynthesisError};
use asperity_tally::{TallyResult, TallySpec, TallyStatistics, TallyValues};
use rayon::prelude::*;

use crate::config::VerifyConfig;
use crate::config_error::ConfigError;
use crate::models::{ModelOutcome, compare_models};
use crate::values::{Count, Number, PerAxis};
use asperity_simulate::{RunPlan, SimulateError, SummaryWork};

/// Why a verification fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The surfaces cannot be drawn.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// The rays cannot be traced.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The slopes of the surfaces have no density.
    #[error(transparent)]
    Slopes(#[from] SlopeError),
    /// A model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Every second sample makes no surface.
    #[error(transparent)]
    Coarsening(#[from] CoarseningError),
    /// There are no results yet.
    #[error("interrupted before the first surface was finished; nothing is written")]
    Interrupted,
    /// Results and model do not fit each other.
    #[error(transparent)]
    Comparison(#[from] ComparisonError),
}

impl From<SimulateError> for VerifyError {
    fn from(error: SimulateError) -> Self {
        match error {
            SimulateError::Synthesis(error) => Self::Synthesis(error),
            SimulateError::Run(error) => Self::Run(error),
            SimulateError::Slopes(error) => Self::Slopes(error),
            SimulateError::Model(error) => Self::Model(error),
            SimulateError::Coarsening(error) => Self::Coarsening(error),
        }
    }
}

/// What was found for one case.
pub struct CaseOutcome {
    /// The case.
    pub case: Case,
    /// Flux fractions by the spec of the run; a batch is a surface.
    pub statistics: TallyStatistics,
    /// What the batches are: `surfaces`, or `ray blocks` where there was one surface.
    pub errors_from: &'static str,
    /// The errors of the fluxes by where they come from.
    pub errors: ErrorBudget,
    /// Whether what leaves is spread evenly over azimuth: every bin holds its share of its ring.
    pub free_azimuth: bool,
    /// The models.
    pub models: Vec<ModelOutcome>,
    /// Level of each test: that of the configuration, shared among the shares that models claim.
    pub level: f64,
    /// What the fluxes are sure not to differ by, if nothing was traced.
    pub deviation_bound: Option<f64>,
    /// Samples of its surfaces along x and y.
    pub size: [usize; 2],
    /// Length units a sample along x and y.
    pub spacing: [f64; 2],
    /// How the run came to its end, if that was to be found out.
    pub stopping: Option<Stopping>,
    /// What was done.
    pub work: SummaryWork,
}

/// What a verification found.
pub struct VerifyOutcome {
    /// The configuration that was run.
    pub config: VerifyConfig,
    /// Where each quantity stands in the statistics.
    pub spec: TallySpec,
    /// The cases, in the order of [`VerifyConfig::cases`].
    pub cases: Vec<CaseOutcome>,
    /// Those that an interrupt came before.
    pub left_out: Vec<Case>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl VerifyOutcome {
    /// Whether there were several cases to run.
    pub(crate) fn several(&self) -> bool {
        self.cases.len() + self.left_out.len() > 1
    }
}

impl VerifyConfig {
    /// The same for surfaces of `size` samples, `spacing` apart, along x and y.
    pub(crate) fn on_grid(&self, size: [usize; 2], spacing: [f64; 2]) -> Self {
        let mut config = self.clone();
        config.surface.size = PerAxis::Each(size.map(|n| Count(n as u64)));
        config.surface.spacing = PerAxis::Each(spacing.map(Number));
        config
    }

    /// Checks that the grid can resolve and hold the surfaces.
    ///
    /// # Errors
    /// [`VerifyError`] as from [`verify`].
    pub fn check_surfaces(&self) -> Result<(), VerifyError> {
        self.recipes().map(|_| ())
    }

    /// How many surfaces are drawn, and how light falls on them.
    pub(crate) fn plan(&self) -> RunPlan {
        RunPlan {
            realisations: self.run.realisations.0,
            incident: self.light.from.into(),
            any_azimuth: self.any_azimuth(),
            limited: self.run.max_time.is_some(),
        }
    }

    /// The first surface of a case, drawn again.
    pub(crate) fn first_surface(&self, case: &Case) -> Result<HeightField, VerifyError> {
        Ok(self.recipe(case)?.draw(self.run.seed, 0)?)
    }

    fn recipe(&self, case: &Case) -> Result<Synthesis, VerifyError> {
        let spacing = self.surface.spacing.xy().map(|s| s.0);
        Ok(Synthesis::new(
            case.psd,
            self.shape()?,
            spacing,
            self.surface.insist,
        )?)
    }

    /// One recipe a smoothness, with the cases that share it.
    fn recipes(&self) -> Result<Vec<(Synthesis, Vec<Case>)>, VerifyError> {
        let mut recipes: Vec<(Synthesis, Vec<Case>)> = Vec::new();
        for case in self.cases()? {
            match recipes.last_mut() {
                Some((synthesis, cases)) if *synthesis.psd() == case.psd => cases.push(case),
                _ => recipes.push((self.recipe(&case)?, vec![case])),
            }
        }
        Ok(recipes)
    }
}

/// Draws fresh surfaces, traces every case on them, and compares with the models.
///
/// Cases of equal smoothness share their surfaces.
///
/// # Errors
/// [`VerifyError`] if the configuration makes no sense or does not fit into memory.
pub fn verify(
    config: &VerifyConfig,
    progress: &dyn Observer,
) -> Result<VerifyOutcome, VerifyError> {
    let began = Instant::now();
    let time = config.run.max_time.map(|time| time.0);
    let time = time.and_then(|time| Duration::try_from_secs_f64(time).ok());
    let progress: &dyn Observer = &Deadline::new(progress, time);
    let settings = config.ray_settings()?;
    let plan = config.plan();
    // All recipes are checked before the first is run.
    let recipes = config.recipes()?;
    let all_cases = recipes.iter().map(|(_, cases)| cases.len()).sum();
    let mut sharings = recipes
        .into_iter()
        .map(|(synthesis, cases)| Sharing::new(&plan, settings, synthesis, cases))
        .collect::<Result<Vec<_>, _>>()?;
    if settings.target.is_some() {
        let pilots = sharings.iter().map(Sharing::pilot_rays).sum();
        progress.begin("planning", pilots);
        for sharing in &mut sharings {
            sharing.plan(all_cases, progress)?;
        }
        progress.end();
    }
    let realisations = sharings.iter().map(|s| s.realisations).max();
    check_results(
        &settings.spec,
        realisations.unwrap_or(0),
        all_cases,
        settings.refine,
    )?;
    progress.begin("tracing", sharings.iter().map(Sharing::rays).sum());
    let mut traced = Vec::new();
    let mut left_out = Vec::new();
    for sharing in sharings {
        let (done, missing) = sharing.run(all_cases, progress)?;
        traced.extend(done);
        left_out.extend(missing);
    }
    progress.end();
    if traced.is_empty() {
        return Err(VerifyError::Interrupted);
    }

    progress.begin("comparing", traced.len() as u64);
    let cases = traced
        .into_par_iter()
        .map(|traced| {
            let outcome = judge(config, &settings, traced);
            progress.advance(1);
            outcome
        })
        .collect::<Result<_, _>>()?;
    progress.end();
    Ok(VerifyOutcome {
        config: config.clone(),
        spec: settings.spec,
        cases,
        left_out,
        seconds: began.elapsed().as_secs_f64(),
    })
}

/// Statistics of one case and its comparison with every model.
fn judge(
    config: &VerifyConfig,
    settings: &RaySettings,
    traced: Traced,
) -> Result<CaseOutcome, VerifyError> {
    let spec = &settings.spec;
    let Traced {
        case,
        method,
        ensemble,
        ..
    } = &traced;
    // With one surface the scatter between its blocks is all there is.
    let errors_from = match &ensemble.blocks_of_one {
        _ if traced.deviation_bound.is_some() => "deviation bound",
        Some(_) => "ray blocks",
        None => "surfaces",
    };
    let batches = ensemble.statistics();
    let batches = match traced.deviation_bound {
        Some(_) => batches,
        None => with_least_errors(method, batches, ensemble.work.rays),
    };
    let errors = errors(config, settings, &traced, &batches)?;
    let (models, tests) = compare_models(config, spec, (case, method), ensemble, &batches)?;
    let level = sidak_level(config.compare.level, tests.max(1));
    let realisations = match traced.deviation_bound {
        Some(_) => 0,
        None => ensemble.tallies.len() as u64,
    };
    Ok(CaseOutcome {
        case: *case,
        statistics: batches,
        errors_from,
        errors,
        free_azimuth: config.free_azimuth(case),
        models,
        level,
        deviation_bound: traced.deviation_bound,
        size: traced.size,
        spacing: traced.spacing,
        work: SummaryWork {
            realisations,
            generate_seconds: ensemble.seconds.generate,
            build_seconds: ensemble.seconds.build,
            trace_seconds: ensemble.seconds.trace,
            seconds: traced.seconds,
            ..SummaryWork::new(
                ensemble.work,
                ensemble.used.clone(),
                method,
                settings.sampling,
            )
        },
        stopping: traced.stopping,
    })
}

/// The errors of one case by where they come from.
fn errors(
    config: &VerifyConfig,
    settings: &RaySettings,
    traced: &Traced,
    statistics: &TallyStatistics,
) -> Result<ErrorBudget, VerifyError> {
    let spec = &settings.spec;
    let Traced {
        case,
        method,
        ensemble,
        ..
    } = traced;
    let rays = ensemble.work.rays;
    if traced.deviation_bound.is_some() {
        let bound = |entry| statistics.at(entry).se.unwrap_or(0.0);
        let bounds = TallyValues::from_fn(*spec, bound);
        return Ok(ErrorBudget::of_bounds(bounds));
    }
    let [nx, ny] = traced.size;
    let synthesis = Synthesis::new(case.psd, [ny, nx], traced.spacing, config.surface.insist)?;
    let mesh = MeshErrors::of_case(
        &synthesis,
        (case, method),
        spec,
        config.any_azimuth(),
        Refinement::of_surfaces(synthesis.spacing(), &ensemble.shifts),
    );
    Ok(match ensemble.blocks_of_one {
        Some(_) => ErrorBudget::of_one(statistics, method, rays, mesh),
        None => ErrorBudget::of_surfaces(statistics, &ensemble.ray_squares, method, rays, mesh),
    })
}

#[cfg(test)]
mod tests;
