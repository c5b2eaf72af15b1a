//! Explicit surfaces against statistical models.

pub(crate) mod error;
#[cfg(test)]
mod tests;

use std::time::Instant;

use asperity_analysis::{SmithSlopes, sidak_level};
use asperity_io::ResultFolder;
use asperity_simulate::{
    Case, Cells, Deadline, LayerBelow, Light, Lobe, Observer, Outcome, RandomSurfaces,
    SimulateError, Simulation, StoppedBy, Stopping, SurfaceSource, check_memory,
};
use asperity_surface::FieldSynthesis;
use asperity_tally::TallySpec;
use rayon::prelude::*;
use serde_json::json;

use self::error::VerifyError;
use crate::comparison::compared_case::ComparedCase;
use crate::comparison::models::{Compared, ModelOutcome, compare_models};
use crate::comparison::other_slopes::OtherSlopes;
use crate::comparison::slope_tables::SlopeSymmetry;
use crate::config::VerifyConfig;
use crate::config::error::ConfigError;
use crate::config::lobes::BinnedLobe;
use crate::config::sweep_case::SweepCase;
use crate::config::values::Seconds;
use crate::output::{CheckpointError, SurfaceCheckpoints};
use crate::validity::Validity;

/// What was found for one case.
pub struct CaseOutcome {
    /// The case.
    pub case: SweepCase,
    /// What was simulated.
    pub outcome: Outcome,
    /// Whether what leaves is spread evenly over azimuth: every bin holds its fraction of the light of its ring.
    pub free_azimuth: bool,
    /// The models.
    pub models: Vec<ModelOutcome>,
    /// Level of each test: that of the configuration, shared among the components that models claim.
    pub level: f64,
    /// How the run came to its end, if that was to be found out.
    pub stopping: Option<Stopping>,
}

impl CaseOutcome {
    /// What was recorded of it, in its own bins.
    #[must_use]
    pub const fn spec(&self) -> &TallySpec {
        self.outcome.statistics.spec()
    }

    /// Its lobes, next to its bins.
    pub(crate) fn lobes(&self) -> Vec<BinnedLobe> {
        BinnedLobe::of_lobes(Lobe::of_case(&self.outcome.case), self.spec())
    }

    /// Samples of its surfaces along x and y.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        self.outcome.case.surface.size().unwrap_or_default()
    }

    /// Length units per sample along x and y.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        self.outcome.case.surface.spacing().unwrap_or_default()
    }

    /// Lengths of its surfaces against the wavelength; `None` if their unit is not known.
    pub(crate) fn validity(&self, config: &VerifyConfig) -> Option<Validity> {
        let SweepCase {
            recipe,
            unit,
            incidence,
            ..
        } = &self.case;
        Validity::of_recipe(recipe, *unit, *incidence, config.light.wavelength_nm())
    }

    /// What comparisons are reported of.
    pub(crate) fn compared<'a>(&'a self, spec: &'a TallySpec) -> ComparedCase<'a> {
        ComparedCase {
            spec,
            outcome: &self.outcome,
            models: &self.models,
            level: self.level,
            free_azimuth: self.free_azimuth,
        }
    }

    /// What lies between the heights of its surfaces.
    #[must_use]
    pub(crate) fn cells(&self) -> Option<Cells> {
        self.outcome.case.surface.cells()
    }
}

/// What a verification found.
pub struct VerifyOutcome {
    /// The configuration that was run.
    pub config: VerifyConfig,
    /// What is recorded of all cases, in bins that are the same for all unless cases have their own.
    pub spec: TallySpec,
    /// The cases, in the order of [`VerifyConfig::cases`].
    pub cases: Vec<CaseOutcome>,
    /// Those that an interrupt came before.
    pub left_out: Vec<SweepCase>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl VerifyOutcome {
    /// Whether there were several cases to run.
    pub(crate) fn several(&self) -> bool {
        self.cases.len() + self.left_out.len() > 1
    }

    /// What ended the run before all that was planned was done; an interrupt, if that and the time limit ended cases.
    #[must_use]
    pub fn stopped_by(&self) -> Option<StoppedBy> {
        let ends = self.cases.iter().filter_map(|case| case.stopping.as_ref());
        let ended = |by| ends.clone().any(|stopping| stopping.stopped_by == by);
        if !self.left_out.is_empty() || ended(StoppedBy::Interrupt) {
            Some(StoppedBy::Interrupt)
        } else {
            ended(StoppedBy::Time).then_some(StoppedBy::Time)
        }
    }
}

impl VerifyConfig {
    /// The surfaces that an earlier run of this configuration has left in `folder`. The time that a run is given, its
    /// plots and the wavelength, which changes nothing that is traced, do not belong to it.
    ///
    /// # Errors
    /// [`CheckpointError`] if a checkpoint cannot be read, or is of another results epoch.
    pub fn checkpoints<'a>(
        &self,
        folder: &'a ResultFolder,
    ) -> Result<SurfaceCheckpoints<'a>, CheckpointError> {
        let mut settings = self.clone();
        settings.run.max_time = None;
        settings.light.wavelength = None;
        settings.output.plots = true;
        SurfaceCheckpoints::open(folder, "verify", json!(settings))
    }

    /// Checks that the grid can resolve and hold the surfaces.
    ///
    /// # Errors
    /// [`VerifyError`] as from [`verify`].
    pub fn check_surfaces(&self) -> Result<(), VerifyError> {
        self.simulated(&self.cases()?).map(|_| ())
    }

    fn recipe(&self, case: &SweepCase) -> Result<RandomSurfaces, VerifyError> {
        let surface = &self.surface;
        let (shape, spacing) = (
            surface.shape().map_err(ConfigError::from)?,
            surface.spacing(),
        );
        let planning = FieldSynthesis::planning_bytes(&case.recipe, shape);
        check_memory("planning these surfaces", planning)?;
        let surfaces = RandomSurfaces::new(
            surface.cells(),
            case.recipe.clone(),
            shape,
            spacing,
            surface.insist,
        );
        Ok(surfaces.map_err(SimulateError::from)?)
    }

    /// The cases as they are simulated.
    fn simulated(&self, cases: &[SweepCase]) -> Result<Vec<Case>, VerifyError> {
        let mut simulated: Vec<Case> = Vec::new();
        let mut last: Option<(&SweepCase, RandomSurfaces)> = None;
        for case in cases {
            // A recipe takes time to plan, so that neighbours of equal surfaces share it.
            let surfaces = match last.take() {
                Some((same, surfaces)) if same.recipe == case.recipe => surfaces,
                _ => self.recipe(case)?,
            };
            last = Some((case, surfaces.clone()));
            let bottom = self
                .medium
                .as_ref()
                .map(|medium| medium.bottom_surface.named());
            let mut simulated_case = Case {
                bins: None,
                surface: SurfaceSource::random(surfaces),
                material: case.material,
                layer: case.layer.map(|layer| LayerBelow {
                    layer,
                    bottom: bottom.unwrap_or_default(),
                }),
                light: Light {
                    incidence: case.incidence,
                    from: self.light.from.into(),
                    random_azimuth: self.any_azimuth(),
                    stokes: [0.0; 3],
                },
            };
            simulated_case.bins = self.run.bins_around(Lobe::of_case(&simulated_case));
            simulated.push(simulated_case);
        }
        Ok(simulated)
    }
}

/// Draws random surfaces, traces every case on them, and compares with the models.
///
/// Cases of equal smoothness share their surfaces.
///
/// # Errors
/// [`VerifyError`] if the configuration makes no sense or does not fit into memory.
pub fn verify(
    config: &VerifyConfig,
    observer: &dyn Observer,
) -> Result<VerifyOutcome, VerifyError> {
    verify_with(config, observer, Simulation::run)
}

/// The same with what `checkpoints` keep of an earlier run of this configuration, to the same bytes.
///
/// # Errors
/// As [`verify`].
pub fn resume_verify(
    config: &VerifyConfig,
    checkpoints: &SurfaceCheckpoints<'_>,
    observer: &dyn Observer,
) -> Result<VerifyOutcome, VerifyError> {
    verify_with(config, observer, |simulation, observer| {
        checkpoints.resume(simulation, observer)
    })
}

/// `run`: runs the simulation of all cases.
fn verify_with(
    config: &VerifyConfig,
    observer: &dyn Observer,
    run: impl FnOnce(Simulation, &dyn Observer) -> Result<Vec<Outcome>, SimulateError>,
) -> Result<VerifyOutcome, VerifyError> {
    let began = Instant::now();
    let time = config.run.max_time.and_then(Seconds::duration);
    let observer: &dyn Observer = &Deadline::new(observer, time);
    let settings = config.ray_settings()?;
    let cases = config.cases()?;
    let simulation = Simulation::new(&config.simulated(&cases)?, &settings)?;
    let outcomes = run(simulation, observer)?;
    let is_missing = |number: &usize| outcomes.iter().all(|outcome| outcome.number != *number);
    let left_out = (0..cases.len())
        .filter(is_missing)
        .map(|i| cases[i].clone());
    let left_out = left_out.collect();

    observer.begin("comparing", outcomes.len() as u64);
    let cases = outcomes
        .into_par_iter()
        .map(|outcome| {
            let case = cases[outcome.number].clone();
            let compared = judge(config, case, outcome);
            observer.advance(1);
            compared
        })
        .collect::<Result<_, _>>()?;
    observer.end();
    Ok(VerifyOutcome {
        config: config.clone(),
        spec: settings.tally,
        cases,
        left_out,
        seconds: began.elapsed().as_secs_f64(),
    })
}

/// The slopes of the surfaces, if a model is made of them and they are not Gaussian.
fn other_slopes(
    config: &VerifyConfig,
    case: &SweepCase,
    outcome: &Outcome,
) -> Result<Option<OtherSlopes>, VerifyError> {
    let is_requested = config.compare.models.iter().any(|m| m == SmithSlopes::NAME);
    let SurfaceSource::Random(surfaces) = &outcome.case.surface else {
        return Ok(None);
    };
    if !is_requested || case.recipe.gaussian().is_some() {
        return Ok(None);
    }
    let symmetry = match config.any_azimuth() {
        true => SlopeSymmetry::Turned,
        false => SlopeSymmetry::None,
    };
    OtherSlopes::of_random(surfaces, outcome, symmetry).map(Some)
}

/// The comparison of one case with every model.
fn judge(
    config: &VerifyConfig,
    case: SweepCase,
    outcome: Outcome,
) -> Result<CaseOutcome, VerifyError> {
    let free_azimuth = config.free_azimuth(&case);
    let other = other_slopes(config, &case, &outcome)?;
    let mut surface = case.modelled();
    if let (Some(other), Ok(slopes)) = (&other, &surface.slopes) {
        surface.slopes = Ok(other.distribution(slopes.covariance()));
    }
    let compared = Compared {
        config: &config.compare,
        seed: config.run.seed,
        spec: outcome.statistics.spec(),
        incidence: case.incidence,
        free_azimuth,
        surface,
        outcome: &outcome,
        regions: None,
        tables: other.as_ref().and_then(OtherSlopes::tables),
    };
    let (models, tests) = compare_models(&compared)?;
    let level = sidak_level(config.compare.level, tests.max(1));
    let limited = config.run.target_error.is_some() || config.run.max_time.is_some();
    Ok(CaseOutcome {
        case,
        free_azimuth,
        models,
        level,
        stopping: Some(&outcome.stopping)
            .filter(|stopping| limited || stopping.is_cut_short())
            .cloned(),
        outcome,
    })
}
