//! Light on one given surface.

mod comparison;
mod comparison_text;
mod description;
mod files;
mod region_plan;
mod text;

use asperity_analysis::ModelError;
use asperity_io::ResultFolder;
use asperity_simulate::{
    Cells, Deadline, DescribedShape, Lobe, Observer, Outcome, Shape, SimulateError, Simulation,
    StoppedBy, Stopping, short,
};
use asperity_surface::LengthUnit;
use asperity_tally::TallySpec;
use serde_json::{Value, json};

use self::comparison::PlannedComparison;
pub use self::comparison::TraceComparison;
pub use self::files::{trace_report, trace_summary};
use self::region_plan::{MIN_REGIONS, MIN_WIDTH};
pub use self::text::trace_table;
use crate::comparison::error::CompareError;
use crate::comparison::models::ModelOutcome;
use crate::config::error::ConfigError;
use crate::config::lobes::BinnedLobe;
use crate::config::trace::TraceConfig;
use crate::config::values::Seconds;
use crate::given::{GivenShape, GivenSurface};
use crate::output::{CheckpointError, SurfaceCheckpoints};
use crate::report::energies::lost_warning;
use crate::validity::Validity;

/// Why light on a surface is not traced.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A mesh is to be refined, which has no surface between its corners.
    #[error(
        "--refine: {name} is a triangle mesh, which says nothing of the surface between its corners; only height maps can be refined"
    )]
    RefinedMesh {
        /// The file of the mesh.
        name: String,
    },
    /// A height map over a mesh, or a mesh over a height map.
    #[error(
        "--bottom-surface: one of surface and bottom is a height map, the other a triangle mesh; both must be of one kind"
    )]
    OtherBottom,
    /// A mesh is to be compared with models.
    #[error(
        "--models: {name} is a triangle mesh; models are compared with height maps, whose slopes and correlation lengths are known"
    )]
    ComparedMesh {
        /// The name of the mesh.
        name: String,
    },
    /// Heights that are to be compared with models do not lose their correlation.
    #[error(
        "--models: the heights of {name} are all equal, or keep their correlation over half of its width: errors by parts of a surface need parts that are independent; remove its form (--remove plane or parabola), or leave out --models"
    )]
    Correlated {
        /// The name of the surface.
        name: String,
    },
    /// A surface that is to be compared with models is too small.
    #[error(
        "--models: {name} is {x:.1} x {y:.1} correlation lengths wide; errors by parts of a surface need {} parts, each {} correlation lengths wide or more: take a larger surface, or leave out --models",
        MIN_REGIONS,
        MIN_WIDTH
    )]
    FewRegions {
        /// The name of the surface.
        name: String,
        /// Its width along x, in correlation lengths.
        x: f64,
        /// Its width along y, in correlation lengths.
        y: f64,
    },
    /// The slopes of the surface are not isotropic, and a model is of isotropic ones.
    #[error(
        "--models: slope variances of {name} along its principal axes, {} and {}, differ by more than their errors: {error}",
        short(.variances[0]),
        short(.variances[1])
    )]
    Anisotropic {
        /// The name of the surface.
        name: String,
        /// The variances, the larger first.
        variances: [f64; 2],
        /// The refusal of the model.
        error: ModelError,
    },
    /// The surface cannot be compared with models.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// The simulation was refused or failed.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

/// A given surface, and the one below it.
#[derive(Clone, Debug)]
pub struct TracedSurfaces {
    /// The surface that light falls on.
    pub surface: GivenSurface,
    /// The bottom of the layer, if it is given too.
    pub bottom: Option<GivenSurface>,
}

impl TracedSurfaces {
    /// Refuses to refine a mesh.
    ///
    /// # Errors
    /// [`TraceError::RefinedMesh`].
    pub fn check(&self, config: &TraceConfig) -> Result<(), TraceError> {
        match (&self.surface.shape, &self.surface.file) {
            (GivenShape::Mesh(_), Some(path)) if config.run.refine => {
                Err(TraceError::RefinedMesh {
                    name: path.display().to_string(),
                })
            }
            _ => Ok(()),
        }
    }

    /// The surface over the one below it, if there is one.
    fn shape(self, cells: Cells) -> Result<Shape, TraceError> {
        let top = self.surface.shape.simulated(cells)?;
        match self.bottom {
            None => Ok(top),
            Some(bottom) => top
                .over(bottom.shape.simulated(cells)?)
                .ok_or(TraceError::OtherBottom),
        }
    }
}

/// What was found on a surface.
pub struct TraceOutcome {
    /// The configuration that was run.
    pub config: TraceConfig,
    /// Name of the surface.
    pub name: String,
    /// Unit of its lengths.
    pub unit: LengthUnit,
    /// Where each quantity stands in the statistics.
    pub spec: TallySpec,
    /// What the engine found.
    pub outcome: Outcome,
    /// The surface against models; `None` without any, or if a stop came before.
    pub comparison: Option<TraceComparison>,
    /// What ended the run before all that was planned was done.
    pub stopped_by: Option<StoppedBy>,
    /// What a reader should know.
    pub warnings: Vec<String>,
    /// Lengths of the surface against the wavelength, where its unit is known.
    pub validity: Option<Validity>,
    /// The lobes of single scattering next to the bins.
    lobes: Vec<BinnedLobe>,
    /// The configuration as summary.json holds it.
    described: Value,
}

impl TraceOutcome {
    /// Whether a stop came before the comparison that was requested.
    fn lacks_comparison(&self) -> bool {
        self.comparison.is_none() && !self.config.compare.models.is_empty()
    }

    /// The models that the surface is compared with.
    fn models(&self) -> &[ModelOutcome] {
        let comparison = self.comparison.as_ref();
        comparison.map_or(&[], |comparison| &comparison.models)
    }

    /// How the run came to its end, if that was to be found out.
    #[must_use]
    pub fn stopping(&self) -> Option<&Stopping> {
        let has_target = self.config.run.target_error.is_some();
        let stopping = &self.outcome.stopping;
        (has_target || stopping.is_cut_short()).then_some(stopping)
    }
}

/// Light on a given surface, checked and ready to be traced.
pub struct PlannedTrace {
    config: TraceConfig,
    name: String,
    unit: LengthUnit,
    spec: TallySpec,
    lobes: [Option<Lobe>; 2],
    shape: Shape,
    simulation: Simulation,
    comparison: Option<PlannedComparison>,
    warnings: Vec<String>,
    validity: Option<Validity>,
    described: Value,
}

impl PlannedTrace {
    /// Checks everything that can be before a ray is traced.
    ///
    /// # Errors
    /// [`TraceError`] if the configuration makes no sense on this surface.
    pub fn new(config: &TraceConfig, surfaces: TracedSurfaces) -> Result<Self, TraceError> {
        surfaces.check(config)?;
        let settings = config.ray_settings()?;
        let name = surfaces.surface.name.clone();
        let unit = surfaces.surface.unit;
        let surface = surfaces.surface.clone();
        let mut warnings = surface.warnings();
        let theta = config.incidence()?.theta();
        let validity = Validity::new(&surface.lengths(), theta, config.light.wavelength_nm());
        let description = description::Surfaces::of(&surfaces, config);
        let shape = surfaces.shape(config.surface.cells.of_given())?;
        let case = config.case(shape.clone(), unit)?;
        let described = description.config(config, &case);
        let comparison = PlannedComparison::new(config, &surface, &case, &settings)?;
        let of_comparison = comparison.as_ref().map(|planned| planned.warnings.clone());
        warnings.extend(of_comparison.into_iter().flatten());
        Ok(Self {
            config: config.clone(),
            name,
            unit,
            spec: settings.spec_of(&case),
            lobes: Lobe::of_case(&case),
            shape,
            simulation: Simulation::new(&[case], &settings)?,
            comparison,
            warnings,
            validity,
            described,
        })
    }

    /// What an earlier run of this configuration on this surface has left in `folder`. The time that a run is given,
    /// its plots and the wavelength, which changes nothing that is traced, do not belong to it.
    ///
    /// # Errors
    /// [`CheckpointError`] if a checkpoint cannot be read, or is of another results epoch, of other settings or of
    /// another surface.
    pub fn checkpoints<'a>(
        &self,
        folder: &'a ResultFolder,
    ) -> Result<SurfaceCheckpoints<'a>, CheckpointError> {
        let mut settings = self.config.clone();
        settings.run.max_time = None;
        settings.light.wavelength = None;
        settings.output.plots = true;
        let mut settings = json!(settings);
        settings["points"] = json!(DescribedShape::of(&self.shape));
        SurfaceCheckpoints::open(folder, "trace", settings)
    }

    /// Traces, until the time of the configuration is over, with what `checkpoints` keep of an earlier run.
    ///
    /// # Errors
    /// [`TraceError::Simulate`] and [`TraceError::Compare`].
    pub fn run(
        self,
        checkpoints: Option<&SurfaceCheckpoints<'_>>,
        observer: &dyn Observer,
    ) -> Result<TraceOutcome, TraceError> {
        let time = self.config.run.max_time.and_then(Seconds::duration);
        let deadline = Deadline::new(observer, time);
        let outcomes = match checkpoints {
            Some(checkpoints) => checkpoints.resume(self.simulation, &deadline),
            None => self.simulation.run(&deadline),
        };
        let outcome = outcomes?.into_iter().next();
        let outcome = outcome.ok_or(SimulateError::Interrupted)?;
        let comparison = self.comparison;
        let comparison = comparison.map(|planned| planned.run(&outcome, checkpoints, &deadline));
        let comparison = comparison.transpose()?.flatten();
        let mut found = TraceOutcome {
            lobes: BinnedLobe::of_lobes(self.lobes, &self.spec),
            config: self.config,
            name: self.name,
            unit: self.unit,
            spec: self.spec,
            outcome,
            comparison,
            stopped_by: None,
            warnings: self.warnings,
            validity: self.validity,
            described: self.described,
        };
        let stopping = &found.outcome.stopping;
        found.stopped_by = if stopping.is_cut_short() {
            Some(stopping.stopped_by)
        } else if found.lacks_comparison() {
            deadline.stop().or(Some(StoppedBy::Interrupt))
        } else {
            None
        };
        let lost = lost_warning(&found.outcome.statistics);
        let ending = found.stopping().map(|stopping| stopping.warnings.clone());
        found.warnings.extend(lost);
        found.warnings.extend(ending.into_iter().flatten());
        let rim = found
            .comparison
            .as_ref()
            .and_then(TraceComparison::rim_warning);
        found.warnings.extend(rim);
        if found.lacks_comparison() {
            found.warnings.push(
                "the run was ended before the surface was compared with models; the same command resumes it"
                    .to_owned(),
            );
        }
        let mesh = found.outcome.errors.mesh_warning();
        found.warnings.extend(mesh.map(str::to_owned));
        let narrow = found.lobes.iter().filter_map(BinnedLobe::warning);
        found.warnings.extend(narrow.collect::<Vec<_>>());
        Ok(found)
    }
}
