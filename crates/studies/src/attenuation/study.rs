//! Shadowing and masking as a study.

use asperity_results::{Container, Header};
use asperity_simulate::{Observer, PlannedWork, SimulateError, StoppedBy, SurfaceSource, counted};
use asperity_surface::LengthUnit;
use serde::Serialize;

use super::files::attenuation_summary;
use super::tables::{attenuation_table, headline};
use super::{AttenuationConfig, AttenuationOutcome, AttenuationStudy, SurveyedSurface};
use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, PlannedRow, Study};

/// Expected time in which a point is found to be lit or seen.
const SECONDS_PER_MARK: f64 = 1e-7;

impl Study for AttenuationStudy {
    type Kept = SurveyedSurface;
    type Findings<'a> = AttenuationOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        let config: AttenuationConfig = document.read()?;
        if document.is_given("view.phi") && !document.is_given("view.theta") {
            let needed =
                "--view-theta: the viewer is straight above, where the azimuth has no meaning";
            return Err(ConfigError::missing("--view-phi", needed).into());
        }
        config.plan()
    }

    fn views<'a>(&self) -> Result<Views<'a, AttenuationOutcome<'a>>, ConfigError> {
        Ok(self.config.views())
    }

    fn header(&self) -> Result<Header, ConfigError> {
        Ok(self.identity())
    }

    fn first_surfaces(&self) -> Option<(SurfaceSource, LengthUnit)> {
        let first = SurfaceSource::random(self.surfaces[0].drawn.clone());
        Some((first, self.config.surface.unit))
    }

    fn compute(
        &self,
        found: &mut Container<'_, SurveyedSurface>,
        observer: &dyn Observer,
    ) -> Result<(), StudyError> {
        let costs = vec![1.0; self.config.run.realisations.0 as usize];
        found.truncate(costs.len());
        let missing = found.to_compute(&costs).len();
        observer.begin("measuring", (missing * self.surfaces.len()) as u64);
        found.compute_missing(&costs, observer, |number| {
            SurveyedSurface::of(self, number as u64, observer)
        })?;
        observer.end();
        if found.share().is_whole() && found.cases().next().is_none() {
            return Err(SimulateError::Interrupted.into());
        }
        Ok(())
    }

    fn plan_work(
        &self,
        _found: &mut Container<'_, SurveyedSurface>,
        _observer: &dyn Observer,
    ) -> Result<Vec<PlannedRow>, StudyError> {
        let points: usize = self.surfaces[0].drawn.shape().iter().product();
        let directions = self.lights.len() + self.views.len();
        let marks = points * directions * self.surfaces.len();
        let row = |number| {
            let work = PlannedWork {
                case: number,
                surfaces: self.surfaces.len() as u64,
                rays: 0,
                seconds: SECONDS_PER_MARK * marks as f64,
            };
            PlannedRow::numbered("surface", work)
        };
        let count = self.config.run.realisations.0 as usize;
        Ok((0..count).map(row).collect())
    }

    fn judge<'a>(
        &'a self,
        found: &'a Container<'_, SurveyedSurface>,
        _observer: &dyn Observer,
    ) -> Result<AttenuationOutcome<'a>, StudyError> {
        self.outcome(found)
    }
}

impl Findings for AttenuationOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        attenuation_summary(self)
    }

    fn headline(&self) -> Vec<String> {
        headline(self)
    }

    fn tables(&self) -> String {
        attenuation_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.stopped_by
    }

    fn progress(&self) -> Option<String> {
        let surfaces = counted(self.work.realisations, "surface");
        Some(format!("results are of {surfaces} that finished"))
    }

    fn work(&self) -> Option<String> {
        let work = &self.work;
        Some(format!(
            "{} of {} points by {} in {:.2} s",
            counted(work.realisations, "surface"),
            work.points,
            work.method,
            work.seconds
        ))
    }
}
