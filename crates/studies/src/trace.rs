//! Light on given surfaces.

mod comparison;
mod comparison_text;
mod description;
mod files;
mod region_plan;
mod text;

use asperity_analysis::ModelError;
use asperity_results::{Header, ResultSet, ResultsError, Stored};
use asperity_simulate::{
    Case, Cells, Deadline, Lobe, Observer, Outcome, Settings, Shape, SimulateError, StoppedBy,
    Stopping, short,
};
use asperity_tally::TallySpec;
use serde_json::{Value, json};

use self::comparison::PlannedComparison;
pub use self::comparison::TraceComparison;
pub use self::files::{trace_report, trace_summary};
use self::region_plan::{MIN_REGIONS, MIN_WIDTH};
pub use self::text::trace_table;
use crate::comparison::error::CompareError;
use crate::config::error::ConfigError;
use crate::config::lobes::BinnedLobe;
use crate::config::trace::TraceConfig;
use crate::config::values::Seconds;
use crate::given::{GivenShape, GivenSurface, GivenSurfaces};
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
    /// Several surfaces are to be compared with models.
    #[error(
        "--models: models are compared with one surface, whose slopes they are made for, but {count} are given; give one, or leave out --models"
    )]
    ComparedSeveral {
        /// Number of surfaces.
        count: usize,
    },
    /// The surface cannot be compared with models.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// The simulation was refused or failed.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// Results cannot be kept.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

/// Given surfaces, and the one below each of them.
#[derive(Clone, Debug)]
pub struct TracedSurfaces {
    /// The surfaces that light falls on.
    pub tops: GivenSurfaces,
    /// The bottom of the layer, if it is given too.
    pub bottom: Option<GivenSurface>,
}

impl TracedSurfaces {
    /// Refuses to refine a mesh.
    ///
    /// # Errors
    /// [`TraceError::RefinedMesh`].
    pub fn check(&self, config: &TraceConfig) -> Result<(), TraceError> {
        for surface in self.tops.iter().filter(|_| config.run.refine) {
            if let (GivenShape::Mesh(_), Some(path)) = (&surface.shape, &surface.file) {
                return Err(TraceError::RefinedMesh {
                    name: path.display().to_string(),
                });
            }
        }
        Ok(())
    }

    /// The surfaces over the one below them, if there is one.
    fn shapes(self, cells: Cells) -> Result<Vec<Shape>, TraceError> {
        let tops = self.tops.simulated(cells)?;
        let Some(bottom) = self.bottom else {
            return Ok(tops);
        };
        let bottom = bottom.shape.simulated(cells)?;
        let tops = tops.into_iter();
        let both = tops.map(|top| top.over(bottom.clone()));
        both.collect::<Option<_>>().ok_or(TraceError::OtherBottom)
    }
}

/// What was found on a surface.
pub struct TraceOutcome<'a> {
    /// What was planned.
    pub plan: &'a TracePlan,
    /// What the engine found.
    pub outcome: &'a Outcome,
    /// The surface against models; `None` without any, or if a stop came before.
    pub comparison: Option<TraceComparison<'a>>,
    /// What ended the run before all that was planned was done.
    pub stopped_by: Option<StoppedBy>,
}

impl TraceOutcome<'_> {
    /// Whether a stop came before the comparison that was requested.
    const fn lacks_comparison(&self) -> bool {
        self.comparison.is_none() && self.plan.comparison.is_some()
    }

    /// Where each quantity stands in the statistics.
    const fn spec(&self) -> &TallySpec {
        self.outcome.statistics.spec()
    }

    /// The lobes of single scattering next to the bins.
    fn lobes(&self) -> Vec<BinnedLobe> {
        BinnedLobe::of_lobes(self.plan.lobes, self.spec())
    }

    /// How the run came to its end, if that was to be found out.
    #[must_use]
    pub fn stopping(&self) -> Option<&Stopping> {
        let has_target = self.plan.config.run.target_error.is_some();
        let stopping = &self.outcome.stopping;
        (has_target || stopping.is_cut_short()).then_some(stopping)
    }

    /// What a reader should know.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.plan.warnings.clone();
        warnings.extend(lost_warning(&self.outcome.statistics));
        let stopping = self.stopping().into_iter();
        warnings.extend(stopping.flat_map(|stopping| stopping.warnings.clone()));
        let comparison = self.comparison.as_ref();
        warnings.extend(comparison.and_then(TraceComparison::rim_warning));
        if self.lacks_comparison() {
            warnings.push(
                "the run was ended before the surface was compared with models; the same command resumes it"
                    .to_owned(),
            );
        }
        warnings.extend(self.outcome.errors.mesh_warning().map(str::to_owned));
        warnings.extend(self.lobes().iter().filter_map(BinnedLobe::warning));
        warnings
    }
}

/// Light on given surfaces, checked and ready to be traced.
pub struct TracePlan {
    /// The configuration.
    pub config: TraceConfig,
    /// Names of the surfaces.
    pub name: String,
    /// Name of the first of them.
    pub(crate) first: String,
    /// Lengths of the surfaces against the wavelength, where its unit is known.
    pub validity: Option<Validity>,
    case: Case,
    settings: Settings,
    lobes: [Option<Lobe>; 2],
    comparison: Option<PlannedComparison>,
    warnings: Vec<String>,
    /// The configuration as summary.json holds it.
    described: Value,
}

impl TracePlan {
    /// Checks everything that can be before a ray is traced.
    ///
    /// # Errors
    /// [`TraceError`] if the configuration makes no sense on these surfaces.
    pub fn new(config: &TraceConfig, surfaces: TracedSurfaces) -> Result<Self, TraceError> {
        surfaces.check(config)?;
        let settings = config.ray_settings()?;
        let tops = surfaces.tops.clone();
        let mut warnings = tops.warnings();
        let theta = config.incidence()?.theta();
        let validity = Validity::new(&tops.lengths(), theta, config.light.wavelength_nm());
        let description = description::Surfaces::of(&surfaces, config);
        let shapes = surfaces.shapes(config.surface.cells.of_given())?;
        let case = config.case(shapes, tops.first.unit)?;
        let comparison = PlannedComparison::new(config, &tops, &case, &settings)?;
        let of_comparison = comparison.as_ref().map(|planned| planned.warnings.clone());
        warnings.extend(of_comparison.into_iter().flatten());
        Ok(Self {
            described: description.config(config, &case),
            config: config.clone(),
            name: tops.name(),
            first: tops.first.name,
            validity,
            lobes: Lobe::of_case(&case),
            case,
            settings,
            comparison,
            warnings,
        })
    }

    /// What the results of this configuration on these surfaces are kept under. The time that a run is given, its plots and the
    /// wavelength, which changes nothing that is traced, do not belong to it.
    #[must_use]
    pub fn header(&self) -> Header {
        let mut settings = self.config.clone();
        settings.run.max_time = None;
        settings.light.wavelength = None;
        settings.output.plots = true;
        let mut settings = json!(settings);
        settings["points"] = json!(self.case.surface);
        Header::new("trace", self.config.run.seed, settings)
    }
}

/// Traces what `found` lacks until the time of the configuration is over, and compares the surface with the models.
///
/// # Errors
/// [`TraceError::Simulate`], [`TraceError::Results`] and [`TraceError::Compare`].
pub fn trace<'a>(
    plan: &'a TracePlan,
    found: &'a mut ResultSet<'_>,
    observer: &dyn Observer,
) -> Result<TraceOutcome<'a>, TraceError> {
    let time = plan.config.run.max_time.and_then(Seconds::duration);
    let deadline = Deadline::new(observer, time);
    let cases = std::slice::from_ref(&plan.case);
    found.run_missing(0, cases, &plan.settings, &deadline)?;
    if let (Some(planned), Some(whole)) = (&plan.comparison, found.case(0)) {
        let rays = whole.outcome.work.rays;
        if !whole.is_cut_short() {
            // All regions together have as many rays.
            let settings = planned.settings(rays);
            match found.run_missing(1, cases, &settings, &deadline) {
                Err(SimulateError::Interrupted) => {}
                run => run?,
            }
        }
    }
    found.close()?;
    let found = &*found;
    let whole = found.case(0).ok_or(SimulateError::Interrupted)?;
    let compared = plan.comparison.as_ref().zip(found.case(1));
    let compared = compared.filter(|(_, regions)| !regions.is_cut_short());
    let comparison = compared.map(|(planned, regions)| {
        planned.judge(
            &plan.case,
            &regions.outcome,
            plan.config.run.seed,
            &deadline,
        )
    });
    let mut outcome = TraceOutcome {
        plan,
        outcome: &whole.outcome,
        comparison: comparison.transpose()?,
        stopped_by: None,
    };
    outcome.stopped_by = if whole.is_cut_short() {
        Some(whole.outcome.stopping.stopped_by)
    } else if outcome.lacks_comparison() {
        deadline.stop().or(Some(StoppedBy::Interrupt))
    } else {
        None
    };
    Ok(outcome)
}
