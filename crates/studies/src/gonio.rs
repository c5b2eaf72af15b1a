//! The virtual gonioreflectometer: the whole BRDF and BTDF, direction by direction.
//!
//! All directions are cases of one simulation. They share their surfaces and their random numbers, so their errors are correlated.

mod components;
mod config;
mod distinction;
mod figures;
mod files;
mod json;
mod peak;
mod sample;
mod summary;
mod tables;

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Case, Deadline, Lobe, Observer, Outcome, StoppedBy};
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Estimate, Side, TallyResult, TallySpec, TallyStatistics};
use serde::Serialize;
use serde_json::Value;

use self::json::gonio_summary;
use self::summary::gonio_table;

use crate::config::error::ConfigError;
use crate::config::lobes::BinnedLobe;
use crate::config::values::Seconds;
use crate::error::StudyError;
use crate::output::{EstimateWithLimit, over, projected_solid_angle};
use crate::report::flux_basis::FluxBasis;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, Study, finished};
use crate::surface_lengths::SurfaceLengths;
use crate::validity::Validity;
use crate::verify::plan::Plan;

pub use config::{GonioConfig, GonioLight, GonioOutput, PlotScale};
pub use sample::{AboutSample, Sample};

/// One direction of a measurement: a case, and what was found of it.
#[derive(Clone, Copy)]
pub struct Direction<'a> {
    /// Number of its setting.
    pub setting: usize,
    /// What is measured, and the direction towards the light.
    pub case: &'a Case,
    /// What is recorded of it, in its own bins.
    pub spec: TallySpec,
    /// What was found; `None` where the run ended before.
    pub outcome: Option<&'a Outcome>,
    lobes: [Option<Lobe>; 2],
}

impl Direction<'_> {
    /// Its lobes, next to its bins.
    fn lobes(&self) -> Vec<BinnedLobe> {
        BinnedLobe::of_lobes(self.lobes, &self.spec)
    }

    /// Statistics of its light.
    fn statistics(&self) -> Option<&TallyStatistics> {
        self.outcome.map(|outcome| &outcome.statistics)
    }

    /// Flux of a component that left on `side`; `None` if it is not recorded or was not measured.
    fn flux(&self, component: Component, side: Side) -> Option<EstimateWithLimit> {
        let outcome = self.outcome.filter(|_| self.spec.records(side))?;
        let flux = outcome.statistics.flux(side, component);
        Some(FluxBasis::of(outcome).flux(side, flux))
    }

    /// Flux of a component into bin `bin` of the grid; `None` if its side is not recorded or it was not measured.
    fn bin(&self, component: Component, bin: usize) -> Option<Estimate> {
        let recorded = self.spec.recorded_bins().contains(&bin);
        let statistics = self.statistics().filter(|_| recorded)?;
        Some(statistics.at(self.spec.grid_entries(component).get(bin)))
    }

    /// BSDF of all light in bin `bin` of the grid.
    fn bsdf(&self, bin: usize) -> Option<Estimate> {
        let flux = self.bin(Component::All, bin)?;
        Some(over(flux, projected_solid_angle(&self.spec.grid(), bin)))
    }

    /// Flux of a component into in-plane bin `i` of `side`; `None` if it is not recorded or was not measured.
    fn in_plane(&self, component: Component, side: Side, i: usize) -> Option<Estimate> {
        let statistics = self.statistics().filter(|_| self.spec.records(side))?;
        Some(components::in_plane(statistics, side, component, i))
    }

    /// Flux that was absorbed, truncated and lost.
    fn endings(&self) -> Option<[EstimateWithLimit; 3]> {
        let outcome = self.outcome?;
        let (support, budget) = (FluxBasis::of(outcome), outcome.statistics.budget());
        Some([
            support.absorbed(budget.absorbed),
            support.ended(budget.truncated),
            support.ended(budget.lost),
        ])
    }
}

/// A measurement, as far as it has come.
pub struct GonioOutcome<'a> {
    /// The configuration.
    pub config: &'a GonioConfig,
    /// The given surfaces, if there are any.
    pub sample: Option<&'a AboutSample>,
    /// What is measured: by setting, polar angle and azimuth, in that order of nesting.
    pub plan: &'a Plan,
    /// What was found.
    pub found: &'a ResultSet<'a>,
    /// Polar angles of the light, degrees, as in the configuration.
    pub thetas: Vec<f64>,
    /// Azimuths of the light, degrees.
    pub phis: Vec<f64>,
}

impl<'a> GonioOutcome<'a> {
    /// What is recorded of all directions, in bins that are the same for all unless directions have their own.
    #[must_use]
    pub const fn spec(&self) -> &'a TallySpec {
        &self.plan.settings.tally
    }

    /// Unit of the lengths of all surfaces.
    #[must_use]
    pub fn unit(&self) -> LengthUnit {
        self.plan
            .cases
            .first()
            .map_or_else(LengthUnit::default, |case| case.at.unit)
    }

    /// The directions.
    pub fn directions(&self) -> impl ExactSizeIterator<Item = Direction<'a>> + Clone {
        (0..self.plan.cases.len()).map(|number| self.numbered(number))
    }

    /// Directions that are still to be found.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.directions()
            .filter(|one| one.outcome.is_none())
            .count()
    }

    /// Lengths of the surface of a direction against the wavelength, where their unit is known.
    fn validity(&self, direction: &Direction<'_>) -> Option<Validity> {
        let case = direction.case;
        let lengths = match (&self.sample, case.surface.recipe()) {
            (Some(sample), _) => sample.lengths,
            (None, recipe) => SurfaceLengths::of_recipe(recipe?, case.at.unit),
        };
        let wavelength = self.config.light.wavelength_nm();
        Validity::new(&lengths, case.light.incidence.theta(), wavelength)
    }

    fn per_setting(&self) -> usize {
        self.thetas.len() * self.phis.len()
    }

    /// A case of each setting.
    fn settings(&self) -> impl ExactSizeIterator<Item = &'a Case> {
        self.plan
            .cases
            .chunks(self.per_setting())
            .map(|cases| &cases[0])
    }

    fn numbered(&self, number: usize) -> Direction<'a> {
        let case = &self.plan.cases[number];
        Direction {
            setting: number / self.per_setting(),
            case,
            spec: self.plan.settings.spec_of(case),
            outcome: self.found.case(number).map(|found| &found.outcome),
            lobes: self.plan.lobes[number],
        }
    }

    /// The direction of a setting, polar angle and azimuth, each by number.
    fn direction(&self, setting: usize, theta: usize, phi: usize) -> Direction<'a> {
        self.numbered((setting * self.thetas.len() + theta) * self.phis.len() + phi)
    }
}

/// Folder of the tables of directions within that of the measurement.
const FOLDER: &str = "directions";

/// BRDF and BTDF of random or given surfaces, direction by direction.
pub struct GonioStudy {
    /// The configuration.
    pub config: GonioConfig,
    /// Description of the given surfaces, if there are any.
    pub sample: Option<AboutSample>,
    /// The directions, and how they are simulated.
    pub plan: Plan,
    header: Header,
    notes: Vec<String>,
}

impl GonioStudy {
    /// Plans a configuration on a given sample, or on random surfaces.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn new(config: GonioConfig, sample: Option<Sample>) -> Result<Self, StudyError> {
        Ok(Self {
            plan: config.plan(sample.as_ref())?,
            header: config.header(sample.as_ref())?,
            sample: sample.map(|sample| sample.about),
            config,
            notes: Vec::new(),
        })
    }

    /// The measurement by the results of the plan, as far as they are there.
    ///
    /// # Errors
    /// [`StudyError`] if the angles make no sense.
    pub fn judge<'a>(&'a self, found: &'a ResultSet<'_>) -> Result<GonioOutcome<'a>, StudyError> {
        let [thetas, phis] = self.config.light.angles()?;
        Ok(GonioOutcome {
            config: &self.config,
            sample: self.sample.as_ref(),
            plan: &self.plan,
            found,
            thetas,
            phis,
        })
    }
}

impl Study for GonioStudy {
    type Kept = CaseResult;
    type Findings<'a> = GonioOutcome<'a>;

    fn plan(document: &Document, observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: GonioConfig = document.read()?;
        let unit = document.own_unit();
        let surfaces = config.measured.read_surfaces(unit, observer)?;
        if let Some(surfaces) = &surfaces {
            config = document.clone().in_unit(surfaces.first.unit)?.read()?;
        }
        let notes = config.surface.read_files()?;
        let (form, cells) = (config.measured.remove, config.surface.cells.of_given());
        let sample = surfaces.map(|surfaces| Sample::of(surfaces, form, cells));
        Ok(Self {
            notes,
            ..Self::new(config, sample.transpose()?)?
        })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn views<'a>(&self) -> Result<Views<'a, GonioOutcome<'a>>, ConfigError> {
        self.config.views(&self.plan)
    }

    fn header(&self) -> Result<Header, ConfigError> {
        Ok(self.header.clone())
    }

    fn open<'f>(&self, folder: &'f ResultFolder) -> Result<ResultSet<'f>, StudyError> {
        Ok(ResultSet::open_cases(
            folder,
            self.header()?,
            &self.plan.cases,
        )?)
    }

    fn run<'a>(
        &'a self,
        found: &'a mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<GonioOutcome<'a>, StudyError> {
        let time = self.config.run.max_time.and_then(Seconds::duration);
        let observer = &Deadline::new(observer, time).between_cases();
        // Of each direction moments alone are kept.
        let derive = |_: &Outcome| Ok::<_, StudyError>(Value::Null);
        found.run_missing_moments(&self.plan.cases, &self.plan.settings, observer, derive)?;
        found.close()?;
        self.judge(found)
    }
}

impl Findings for GonioOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        gonio_summary(self)
    }

    fn text(&self) -> String {
        gonio_table(self) + "\n"
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.found.stopped_by()
    }

    fn progress(&self) -> Option<String> {
        let all = self.found.len();
        let done = (0..all).filter(|&case| self.found.is_complete(case));
        Some(finished(done.count(), all, "direction"))
    }
}
