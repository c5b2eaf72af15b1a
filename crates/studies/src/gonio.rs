//! The virtual gonioreflectometer: the whole BRDF and BTDF, direction by direction.
//!
//! A direction is one run of [`verify`](crate::verify()) without models, or of [`trace`](crate::trace()) on a
//! given surface, and its file is written as soon as it is found, so that a run that was ended goes on where
//! it was left. All directions share their surfaces and their random numbers.

mod config;
mod figures;
mod files;
mod plan;
mod results;
mod sample;
mod setting;
mod summary;
mod tables;

use asperity_simulate::{Observer, RaySettings, RunError, Scene, StoppedBy, trace, trace_mesh};
use std::path::{Path, PathBuf};

use asperity_io::{ReadError, WriteError, create_output_folder};
use asperity_optics::Incidence;
use asperity_tally::TallySpec;

use crate::config::ConfigError;
use crate::energies::lost_warning;
use crate::store::{self, CHANGED, StoreError, Unseen, finish};
use crate::verify::{VerifyError, verify};

pub use config::{GonioConfig, GonioLight, GonioOutput, MeasuredConfig, PlotScale};
pub use files::gonio_report;
pub use results::{DirectionResults, Means, MeasuredPart};
pub use sample::{Sample, SampleShape};
pub use setting::Setting;
pub use summary::{gonio_summary, gonio_table};

use plan::{Plan, Work};

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
    /// A file of a direction cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file of a direction cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file holds a direction of another measurement.
    #[error(
        "{} holds a direction of another measurement ({what}); take another folder, or remove its directions",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What differs.
        what: String,
    },
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
    /// What was found; `None` where the run ended before.
    pub results: Option<DirectionResults>,
}

/// A measurement, as far as it has come.
#[derive(Clone, Debug)]
pub struct GonioOutcome {
    /// The configuration.
    pub config: GonioConfig,
    /// The given surface without its shape: name, description and warnings.
    pub sample: Option<(String, serde_json::Value, Vec<String>)>,
    /// Where quantities stand in records, and the bins.
    pub spec: TallySpec,
    /// What is measured.
    pub settings: Vec<Setting>,
    /// Polar angles of the light, degrees, as in the configuration.
    pub thetas: Vec<f64>,
    /// Azimuths of the light, degrees.
    pub phis: Vec<f64>,
    /// The directions: by setting, polar angle and azimuth, in that order of nesting.
    pub directions: Vec<Direction>,
    /// Directions that an earlier run had left.
    pub taken_up: usize,
    /// Directions found by this run.
    pub computed: usize,
    /// What a reader should know of the files that were there: a sentence each.
    pub notes: Vec<String>,
    /// What ended the run before all directions were there.
    pub stopped_by: Option<StoppedBy>,
}

impl GonioOutcome {
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

/// Measures the directions that are not in `folder` yet, each as soon as it is found into a file of numbers to
/// go on from and a table. `sample` is the given surface, if the configuration names one.
///
/// A file that is damaged is replaced, with a note. When the time of the configuration is over no direction is
/// begun, but one is finished in any case; an interrupt gives up the direction that is being traced.
///
/// # Errors
/// [`GonioError`] if the configuration makes no sense, a direction cannot be traced or written, or a whole
/// direction of another configuration or version is in its place or beside them.
pub fn gonio(
    config: &GonioConfig,
    sample: Option<&Sample>,
    folder: &Path,
    progress: &dyn Observer,
) -> Result<GonioOutcome, GonioError> {
    let (settings, plans) = config.plans(sample)?;
    let spec = config.ray_settings()?.spec;
    let path_of = |plan: &Plan| folder.join(FOLDER).join(format!("{}.json", plan.name));
    // All files are looked at before the first is written.
    files::refuse_unplanned(folder, &plans)?;
    let pieces = plans
        .into_iter()
        .map(|plan| {
            let doubt = |results: &DirectionResults| (!results.is_sound(&spec)).then_some(CHANGED);
            match store::read(&path_of(&plan), &plan.identity, doubt) {
                Ok(stored) => Ok((plan, stored)),
                Err(StoreError::Read(error)) => Err(GonioError::Read(error)),
                Err(StoreError::Foreign { path, what }) => Err(GonioError::Foreign { path, what }),
            }
        })
        .collect::<Result<Vec<_>, _>>()?;
    create_output_folder(folder.join(FOLDER))?;
    let mut directions: Vec<Direction> = pieces
        .iter()
        .map(|(plan, _)| Direction {
            setting: plan.setting,
            incidence: plan.incidence,
            name: plan.name.clone(),
            results: None,
        })
        .collect();
    let finished = finish(
        "directions",
        pieces,
        config.run.max_time,
        progress,
        |plan| (plan.name.clone(), path_of(plan)),
        |plan| {
            let setting = &settings[plan.setting];
            let results = measure(config, plan, setting, sample, progress)?;
            if let Some(results) = &results {
                files::write_direction(folder, &plan.name, &spec, results)?;
                store::write(&path_of(plan), &plan.name, plan.identity.clone(), results)?;
            }
            Ok::<_, GonioError>(results)
        },
    )?;
    for (direction, results) in directions.iter_mut().zip(finished.results) {
        direction.results = results;
    }
    let [thetas, phis] = config.light.angles()?;
    let outcome = GonioOutcome {
        config: config.clone(),
        sample: sample.map(|s| (s.name.clone(), s.description.clone(), s.warnings.clone())),
        spec,
        settings,
        thetas,
        phis,
        directions,
        taken_up: finished.taken_up,
        computed: finished.computed,
        notes: finished.notes,
        stopped_by: finished.stopped_by,
    };
    if outcome.missing() == outcome.directions.len() {
        return Err(GonioError::Interrupted);
    }
    Ok(outcome)
}

/// Traces one direction; `None` if an interrupt came before it was whole.
fn measure(
    config: &GonioConfig,
    plan: &Plan,
    setting: &Setting,
    sample: Option<&Sample>,
    progress: &dyn Observer,
) -> Result<Option<DirectionResults>, GonioError> {
    let unseen = Unseen(progress);
    let results = match (&plan.work, sample) {
        (Work::Given(rays), Some(sample)) => {
            on_sample(config, (plan, setting), rays, sample, &unseen).map(Some)
        }
        (Work::Fresh(config), _) => match verify(config, &unseen) {
            Err(VerifyError::Interrupted) => return Ok(None),
            other => other.map(|outcome| {
                let case = outcome.cases.into_iter().next()?;
                let warnings: Vec<String> = lost_warning(&case.statistics).into_iter().collect();
                Some(DirectionResults::of(
                    &case.statistics,
                    (case.work.realisations, case.work.rays),
                    case.errors_from,
                    warnings,
                ))
            }),
        },
        (Work::Given(_), None) => Ok(None),
    };
    let results = results.map_err(|error| GonioError::Direction {
        direction: plan.name.clone(),
        error: Box::new(error),
    })?;
    // One that was whole before the interrupt came cannot be told from one that was not.
    Ok(results.filter(|_| progress.stop().is_none()))
}

/// Traces one direction on a given surface.
fn on_sample(
    config: &GonioConfig,
    (plan, setting): (&Plan, &Setting),
    rays: &RaySettings,
    sample: &Sample,
    progress: &dyn Observer,
) -> Result<DirectionResults, VerifyError> {
    let scene = Scene {
        material: setting.material,
        layer: setting.layer,
        incidence: plan.incidence,
        incident: config.light.from.into(),
        any_azimuth: config.any_azimuth(),
    };
    let outcome: Result<_, RunError> = match &sample.shape {
        SampleShape::Field(field) => trace(field.clone(), None, &scene, rays, progress),
        SampleShape::Mesh(mesh) => trace_mesh(mesh.clone(), None, &scene, rays, progress),
    };
    let outcome = outcome?;
    let warnings: Vec<String> = lost_warning(&outcome.statistics).into_iter().collect();
    Ok(DirectionResults::of(
        &outcome.statistics,
        (1, outcome.work.rays),
        "ray blocks",
        warnings,
    ))
}
