//! Light on given surfaces.

mod comparison;
mod comparison_text;
mod description;
mod files;
mod region_plan;
mod text;

use asperity_results::{CaseResult, Header, ResultSet, Stored};
use asperity_simulate::{
    Case, Deadline, Lobe, Observer, Outcome, Settings, SimulateError, StoppedBy, Stopping,
};
use asperity_tally::TallySpec;
use serde::Serialize;
use serde_json::{Value, json};

use self::comparison::PlannedComparison;
pub use self::comparison::TraceComparison;
use self::files::trace_summary;
use self::text::trace_table;
use crate::config::error::ConfigError;
use crate::config::lobes::BinnedLobe;
use crate::config::trace::TraceConfig;
use crate::config::values::Seconds;
use crate::error::StudyError;
use crate::given::{GivenError, GivenShape, GivenSurface, GivenSurfaces};
use crate::report::energies::lost_warning;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, Study};
use crate::validity::Validity;

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
    /// [`StudyError`] if the configuration makes no sense on these surfaces.
    pub fn new(
        config: TraceConfig,
        tops: GivenSurfaces,
        bottom: Option<GivenSurface>,
    ) -> Result<Self, StudyError> {
        for surface in tops.iter().filter(|_| config.run.refine) {
            if let (GivenShape::Mesh(_), Some(path)) = (&surface.shape, &surface.file) {
                let name = path.display().to_string();
                return Err(GivenError::RefinedMesh { name }.into());
            }
        }
        let settings = config.ray_settings()?;
        let mut warnings = tops.warnings();
        let theta = config.incidence()?.theta();
        let validity = Validity::new(&tops.lengths(), theta, config.light.wavelength_nm());
        let description = description::Surfaces::of(&tops, bottom.as_ref(), &config);
        let cells = config.surface.cells.of_given();
        let shapes = tops.clone().simulated(bottom, cells)?;
        let case = config.case(shapes, tops.first.unit)?;
        let comparison = PlannedComparison::new(&config, &tops, &case, &settings)?;
        let of_comparison = comparison.as_ref().map(|planned| planned.warnings.clone());
        warnings.extend(of_comparison.into_iter().flatten());
        Ok(Self {
            described: description.config(&config, &case),
            config,
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
}

impl Study for TracePlan {
    type Kept = CaseResult;
    type Findings<'a> = TraceOutcome<'a>;

    fn plan(document: &Document, observer: &dyn Observer) -> Result<Self, StudyError> {
        let config: TraceConfig = document.read()?;
        // Checked before the surfaces are read, which may take long.
        config.check()?;
        let unit = document.own_unit();
        let tops = config.measured.read_surfaces(unit, observer)?;
        let tops = tops.ok_or_else(|| GivenError::NoSurface {
            command: document.command(),
            needed: "a surface: FILE or --flat",
        })?;
        let bottom = config.medium.as_ref().and_then(|m| m.bottom_surface.file());
        let bottom = bottom.map(|path| config.measured.read_like(&tops.first, path, observer));
        let bottom = bottom.transpose()?;
        let config = document.clone().in_unit(tops.first.unit)?.read()?;
        Self::new(config, tops, bottom)
    }

    fn views<'a>(&self) -> Result<Views<'a, TraceOutcome<'a>>, ConfigError> {
        self.config.views()
    }

    /// The time that a run is given, its plots and the wavelength, which changes nothing that is traced, do not belong to the header.
    fn header(&self) -> Result<Header, ConfigError> {
        let mut settings = self.config.clone();
        settings.run.max_time = None;
        settings.light.wavelength = None;
        settings.output.plots = true;
        let mut settings = json!(settings);
        settings["points"] = json!(self.case.surface);
        Ok(Header::new("trace", self.config.run.seed, settings))
    }

    fn run<'a>(
        &'a self,
        found: &'a mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<TraceOutcome<'a>, StudyError> {
        let time = self.config.run.max_time.and_then(Seconds::duration);
        let deadline = Deadline::new(observer, time);
        let cases = std::slice::from_ref(&self.case);
        found.run_missing(0, cases, &self.settings, &deadline)?;
        if let (Some(planned), Some(whole)) = (&self.comparison, found.case(0)) {
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
        let compared = self.comparison.as_ref().zip(found.case(1));
        let compared = compared.filter(|(_, regions)| !regions.is_cut_short());
        let comparison = compared.map(|(planned, regions)| {
            let seed = self.config.run.seed;
            planned.judge(&self.case, &regions.outcome, seed, &deadline)
        });
        let mut outcome = TraceOutcome {
            plan: self,
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
}

impl Findings for TraceOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        trace_summary(self)
    }

    fn text(&self) -> String {
        trace_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.stopped_by
    }

    fn work(&self) -> Option<String> {
        let work = &self.outcome.work.machine;
        let (build, trace) = (work.build_seconds, work.trace_seconds);
        Some(format!("built in {build:.3} s, traced in {trace:.3} s"))
    }
}
