//! Explicit surfaces against statistical models.

mod case_report;
mod files;
mod outcome;
pub(crate) mod plan;
#[cfg(test)]
mod tests;

use asperity_analysis::SmithSlopes;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, Outcome, StoppedBy, SurfaceSource, counted};
use asperity_surface::LengthUnit;
use rayon::prelude::*;
use serde::Serialize;

use self::case_report::verify_table;
use self::files::verify_summary;
pub use self::outcome::VerifyOutcome;

use crate::comparison::judgement::Judgement;
use crate::comparison::model_rays::add_expected_seconds;
use crate::comparison::models::{Compared, Testing, compare_models};
use crate::comparison::other_slopes::OtherSlopes;
use crate::comparison::slope_tables::SlopeSymmetry;
use crate::config::VerifyConfig;
use crate::config::case_model::ModelledSurface;
use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, PlannedRow, Study, first_of, tracing};
use crate::verify::plan::Plan;

impl VerifyConfig {
    /// Identity of the results of this configuration.
    #[must_use]
    pub fn header(&self) -> Header {
        Header::new("verify", self.run.seed, self.document())
    }
}

/// Random surfaces against scattering models.
pub struct VerifyStudy {
    /// The configuration.
    pub config: VerifyConfig,
    /// Its cases, and how they are simulated. Cases of equal surfaces share them.
    pub plan: Plan,
    notes: Vec<String>,
}

impl VerifyStudy {
    /// Plans a configuration.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn new(config: VerifyConfig) -> Result<Self, StudyError> {
        Ok(Self {
            plan: config.plan()?,
            config,
            notes: Vec::new(),
        })
    }
}

impl Study for VerifyStudy {
    type Kept = CaseResult;
    type Findings<'a> = VerifyOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: VerifyConfig = document.read()?;
        let notes = config.surface.read_files()?;
        config.choose_models(document);
        Ok(Self {
            notes,
            ..Self::new(config)?
        })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn views<'a>(&self) -> Result<Views<'a, VerifyOutcome<'a>>, ConfigError> {
        self.config.views(&self.plan.cases)
    }

    fn header(&self) -> Result<Header, ConfigError> {
        Ok(self.config.header())
    }

    fn first_surfaces(&self) -> Option<(SurfaceSource, LengthUnit)> {
        first_of(&self.plan.cases)
    }

    fn compute(
        &self,
        found: &mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<(), StudyError> {
        let follows = !self.config.compare.models.is_empty() || self.config.output.plots;
        let tracing = &tracing(observer, self.config.run.max_time, follows);
        Ok(found.run_missing(0, &self.plan.cases, &self.plan.settings, tracing)?)
    }

    fn plan_work(
        &self,
        found: &mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<Vec<PlannedRow>, StudyError> {
        let Plan {
            cases, settings, ..
        } = &self.plan;
        let mut work = found.plan_missing(cases, settings, observer)?;
        add_expected_seconds(&mut work, &self.config.compare, &self.config.run);
        Ok(PlannedRow::of_cases(cases, work))
    }

    /// Compares the results of the plan with the models.
    fn judge<'a>(
        &'a self,
        found: &'a ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<VerifyOutcome<'a>, StudyError> {
        let cases: Vec<&CaseResult> = found.cases().map(|(_, case)| case).collect();
        observer.begin("comparing", cases.len() as u64);
        let cases = cases
            .into_par_iter()
            .map(|one| {
                let judged = judge_case(&self.config, &one.outcome, Testing::Tests, observer);
                observer.advance(1);
                judged
            })
            .collect::<Result<Vec<_>, _>>()?;
        observer.end();
        let lacks_models = cases.iter().any(|case| self.config.lacks_models(case));
        let stopped = || observer.stop().or(Some(StoppedBy::Interrupt));
        Ok(VerifyOutcome {
            config: &self.config,
            plan: &self.plan,
            found,
            stopped_by: match lacks_models {
                true => found.stopped_by().or_else(stopped),
                false => found.stopped_by(),
            },
            cases,
            seconds: found.seconds(),
        })
    }
}

impl Findings for VerifyOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        verify_summary(self)
    }

    fn headline(&self) -> Vec<String> {
        self.headline_of(&self.cases)
    }

    fn tables(&self) -> String {
        verify_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.stopped_by
    }

    fn work(&self) -> Option<String> {
        let cases = counted(self.cases.len() as u64, "case");
        Some(format!("{cases} in {:.1} s", self.seconds))
    }
}

/// The slopes of the surfaces, if a model is made of them and they are not Gaussian.
fn other_slopes(
    config: &VerifyConfig,
    outcome: &Outcome,
) -> Result<Option<OtherSlopes>, StudyError> {
    let is_requested = config.compare.models.iter().any(|m| m == SmithSlopes::NAME);
    let SurfaceSource::Random(surfaces) = &outcome.case.surface else {
        return Ok(None);
    };
    if !is_requested || surfaces.recipe().gaussian().is_some() {
        return Ok(None);
    }
    let symmetry = match config.any_azimuth() {
        true => SlopeSymmetry::Turned,
        false => SlopeSymmetry::None,
    };
    OtherSlopes::of_random(surfaces, outcome, symmetry).map(Some)
}

/// The comparison of one case with every model, tested or not; with none if the run gives that up.
pub(crate) fn judge_case<'a>(
    config: &VerifyConfig,
    outcome: &'a Outcome,
    testing: Testing,
    observer: &dyn Observer,
) -> Result<Judgement<'a>, StudyError> {
    let free_azimuth = config.free_azimuth(&outcome.case);
    let other = other_slopes(config, outcome)?;
    let Some(mut surface) = ModelledSurface::of(&outcome.case) else {
        let needed = "random surfaces, not given ones";
        return Err(ConfigError::missing("a verification", needed).into());
    };
    if let (Some(other), Ok(slopes)) = (&other, &surface.slopes) {
        surface.slopes = Ok(other.distribution(slopes));
    }
    let compared = Compared {
        config: &config.compare,
        seed: config.run.seed,
        free_azimuth,
        surface,
        outcome,
        testing,
        has_target: config.run.target_error.is_some(),
        regions: None,
        tables: other.as_ref().and_then(OtherSlopes::tables),
    };
    let (models, level) = compare_models(&compared, observer)?;
    Ok(Judgement {
        outcome,
        models,
        level,
        free_azimuth,
    })
}
