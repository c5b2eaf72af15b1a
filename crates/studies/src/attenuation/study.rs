//! Shadowing and masking as a study.

use std::time::Instant;

use asperity_results::{Container, Header};
use asperity_simulate::{Observer, StoppedBy, SurfaceSource, counted};
use serde::Serialize;

use super::files::attenuation_summary;
use super::tables::attenuation_table;
use super::{AttenuationConfig, AttenuationOutcome, AttenuationStudy, SurveyedSurface};
use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, Study};

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

    fn run<'a>(
        &'a self,
        found: &'a mut Container<'_, SurveyedSurface>,
        observer: &dyn Observer,
    ) -> Result<AttenuationOutcome<'a>, StudyError> {
        let began = Instant::now();
        let count = self.config.run.realisations.0 as usize;
        let missing = count.saturating_sub(found.resumed().cases);
        observer.begin("measuring", (missing * self.surfaces.len()) as u64);
        found.compute_missing(count, observer, |number| {
            SurveyedSurface::of(self, number as u64, observer)
        })?;
        observer.end();
        let mut outcome = self.judge(found)?;
        let first = SurfaceSource::random(self.surfaces[0].drawn.clone());
        found.keep_thumbnail(&first, self.config.surface.unit, observer)?;
        found.close()?;
        outcome.work.seconds = began.elapsed().as_secs_f64();
        Ok(outcome)
    }
}

impl Findings for AttenuationOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        attenuation_summary(self)
    }

    fn text(&self) -> String {
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
