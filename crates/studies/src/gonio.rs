//! The virtual gonioreflectometer: the whole BRDF and BTDF, direction by direction.
//!
//! A direction is one run of [`verify`](crate::verify()) without models, or one simulation of a
//! given surface, and its file is written as soon as it is found, so that an interrupted run
//! resumes. All directions share their surfaces and their random numbers.

mod config;
mod figures;
mod files;
mod json;
mod peak;
mod plan;
mod results;
mod sample;
mod specimen;
mod summary;
mod tables;

use asperity_simulate::{
    BottomSurface, Case, LayerBelow, Light, Observer, Settings, SurfaceSource, simulate,
};
use asperity_surface::LengthUnit;
use std::path::PathBuf;

use asperity_io::{ResultFolder, ResultFolderError};
use asperity_optics::Incidence;
use asperity_tally::TallySpec;

use crate::config::error::ConfigError;
use crate::config::lobes::BinnedLobe;
use crate::output::{CHANGED, CheckpointCase, CheckpointError, Checkpoints, Completion};
use crate::validity::Validity;
use crate::verify::error::VerifyError;
use crate::verify::{VerifyOutcome, verify};

pub use config::{GonioConfig, GonioLight, GonioOutput, PlotScale};
pub use files::gonio_report;
pub use json::gonio_summary;
pub use results::{DirectionResults, Means, MeasuredComponent};
pub use sample::{AboutSample, Sample};
pub use specimen::Specimen;
pub use summary::gonio_table;

use plan::{Plan, Plans, Work};

/// Why there is no measurement.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GonioError {
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A direction cannot be measured.
    #[error("{direction}: {error}")]
    Direction {
        /// Its name.
        direction: String,
        /// Why.
        error: Box<VerifyError>,
    },
    /// A checkpoint cannot be read, written or used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A table of a direction cannot be written.
    #[error(transparent)]
    Write(#[from] ResultFolderError),
    /// The folder holds a direction that is not among those planned.
    #[error(
        "{} holds directions of another measurement, as {name}: take another folder",
        folder.display()
    )]
    Unplanned {
        /// The folder of the measurement.
        folder: PathBuf,
        /// Name of the direction, the first of several.
        name: String,
    },
    /// There is nothing to write yet.
    #[error("stopped before the first direction was finished; nothing is written")]
    Interrupted,
}

/// One direction of a measurement.
#[derive(Clone, Debug)]
pub struct Direction {
    /// Number of its setting.
    pub setting: usize,
    /// The direction towards the light.
    pub incidence: Incidence,
    /// Name of its files.
    pub name: String,
    /// What is recorded of it, in its own bins.
    pub spec: TallySpec,
    /// Its lobes, next to its bins.
    pub(crate) lobes: Vec<BinnedLobe>,
    /// Lengths of the surface against the wavelength, where its unit is known.
    pub validity: Option<Validity>,
    /// What was found; `None` where the run ended before.
    pub results: Option<DirectionResults>,
}

/// A measurement, as far as it has come.
#[derive(Clone, Debug)]
pub struct GonioOutcome {
    /// The configuration.
    pub config: GonioConfig,
    /// The given surface, if there is one.
    pub sample: Option<AboutSample>,
    /// What is recorded of all directions, in bins that are the same for all unless directions have their own.
    pub spec: TallySpec,
    /// What is measured.
    pub settings: Vec<Specimen>,
    /// Polar angles of the light, degrees, as in the configuration.
    pub thetas: Vec<f64>,
    /// Azimuths of the light, degrees.
    pub phis: Vec<f64>,
    /// The directions: by setting, polar angle and azimuth, in that order of nesting.
    pub directions: Vec<Direction>,
    /// How the directions came about.
    pub completion: Completion,
}

impl GonioOutcome {
    /// Unit of the lengths of all surfaces.
    #[must_use]
    pub fn unit(&self) -> LengthUnit {
        let sample = self.sample.as_ref();
        sample.map_or(self.config.surface.unit, |sample| sample.unit)
    }

    /// Directions that are still to be found.
    #[must_use]
    pub fn missing(&self) -> usize {
        let missing = |direction: &&Direction| direction.results.is_none();
        self.directions.iter().filter(missing).count()
    }

    /// The direction of a setting, polar angle and azimuth, each by number.
    pub(crate) fn direction(&self, setting: usize, theta: usize, phi: usize) -> &Direction {
        &self.directions[(setting * self.thetas.len() + theta) * self.phis.len() + phi]
    }
}

/// Folder of the files of directions within that of the measurement.
pub(crate) const FOLDER: &str = "directions";

/// Measures the directions that have no checkpoint in `folder` yet. Each is written as soon as it is measured: a
/// checkpoint and a table. `sample` is the given surface, if the configuration names one.
///
/// A damaged checkpoint is replaced, with a note. When the time of the configuration is over no direction is
/// begun, but one is finished in any case; an interrupt gives up the direction that is being traced.
///
/// # Errors
/// [`GonioError`] if the configuration makes no sense, a direction cannot be traced or written, or a
/// direction of another configuration or results epoch is in the folder.
pub fn gonio(
    config: &GonioConfig,
    sample: Option<&Sample>,
    folder: &ResultFolder,
    progress: &dyn Observer,
) -> Result<GonioOutcome, GonioError> {
    let Plans {
        settings,
        directions: plans,
    } = config.plans(sample)?;
    let spec = config.ray_settings()?.tally;
    files::refuse_unplanned(folder.path(), &plans)?;
    let tasks: Vec<Task<'_>> = plans
        .iter()
        .map(|plan| Task {
            config,
            plan,
            setting: &settings[plan.setting],
            sample,
            folder,
        })
        .collect();
    let checkpoints = Checkpoints {
        folder,
        study: "gonio",
        place: FOLDER,
        stage: "directions",
    };
    let completed = checkpoints.complete(&tasks, config.run.max_time, progress)?;
    let directions = plans.iter().zip(completed.results);
    let directions = directions.map(|(plan, results)| Direction {
        setting: plan.setting,
        incidence: plan.incidence,
        name: plan.name.clone(),
        spec: plan.spec,
        lobes: plan.lobes.clone(),
        validity: plan.validity,
        results,
    });
    let [thetas, phis] = config.light.angles()?;
    let outcome = GonioOutcome {
        config: config.clone(),
        sample: sample.map(|sample| sample.about.clone()),
        spec,
        directions: directions.collect(),
        settings,
        thetas,
        phis,
        completion: completed.completion,
    };
    if outcome.missing() == outcome.directions.len() {
        return Err(GonioError::Interrupted);
    }
    Ok(outcome)
}

/// One direction to be measured.
struct Task<'a> {
    config: &'a GonioConfig,
    plan: &'a Plan,
    setting: &'a Specimen,
    sample: Option<&'a Sample>,
    folder: &'a ResultFolder,
}

impl CheckpointCase for Task<'_> {
    type Results = DirectionResults;
    type Error = GonioError;

    fn name(&self) -> String {
        self.plan.name.clone()
    }

    fn title(&self) -> String {
        self.plan.name.clone()
    }

    fn settings(&self) -> serde_json::Value {
        self.plan.identity.clone()
    }

    fn invalid(&self, results: &DirectionResults) -> Option<&'static str> {
        (!results.is_sound(&self.plan.spec)).then_some(CHANGED)
    }

    fn compute(&self, observer: &dyn Observer) -> Result<Option<DirectionResults>, GonioError> {
        let results = match (&self.plan.work, self.sample) {
            (Work::Given(rays), Some(sample)) => self.on_sample(rays, sample, observer),
            (Work::Random(config), _) => match verify(config, observer) {
                Err(error) if error.is_interrupt() => return Ok(None),
                outcome => outcome.map(on_random_surfaces),
            },
            (Work::Given(_), None) => Ok(None),
        };
        let results = results.map_err(|error| GonioError::Direction {
            direction: self.plan.name.clone(),
            error: Box::new(error),
        })?;
        if let Some(results) = results.as_ref().filter(|_| observer.stop().is_none()) {
            files::write_direction(self.folder, &self.plan.name, &self.plan.spec, results)?;
        }
        Ok(results)
    }
}

/// What a measurement keeps of a verification without models.
fn on_random_surfaces(outcome: VerifyOutcome) -> Option<DirectionResults> {
    let case = outcome.cases.into_iter().next()?;
    Some(DirectionResults::of(&case.outcome))
}

impl Task<'_> {
    /// Traces one direction on a given surface.
    fn on_sample(
        &self,
        settings: &Settings,
        sample: &Sample,
        observer: &dyn Observer,
    ) -> Result<Option<DirectionResults>, VerifyError> {
        let medium = self.config.medium.as_ref();
        let case = Case {
            bins: self.plan.bins,
            surface: SurfaceSource::Given(vec![sample.shape.clone()]),
            material: self.setting.material,
            layer: self.setting.layer.map(|layer| LayerBelow {
                layer,
                bottom: medium.map_or(BottomSurface::Flat, |medium| medium.bottom_surface.named()),
            }),
            light: Light {
                incidence: self.plan.incidence,
                from: self.config.light.from.into(),
                random_azimuth: self.config.any_azimuth(),
                stokes: [0.0; 3],
            },
        };
        let outcomes = simulate(&[case], settings, observer)?;
        Ok(outcomes.first().map(DirectionResults::of))
    }
}
