//! Run time against error as a study.

use std::sync::Arc;
use std::time::Instant;

use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{
    Observer, Outcome, PlannedWork, SimulateError, Simulation, StoppedBy, SurfaceSource, counted,
};
use asperity_surface::LengthUnit;
use asperity_tracer::Engine;
use serde::Serialize;
use serde_json::json;

use super::ConvergeOutcome;
use super::case::{ConvergedCase, SETUP_SECONDS, StoredRun};
use super::config::{ConvergeConfig, ConvergePlan};
use super::json::converge_summary;
use super::method::ConvergeRun;
use super::tables::{converge_table, headline};
use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, PlannedRow, Study, finished, first_of};

/// Run time against error, method by method.
pub struct ConvergeStudy {
    /// The configuration.
    pub config: ConvergeConfig,
    /// Its cases, methods and runs.
    pub plan: ConvergePlan,
    notes: Vec<String>,
}

/// Expected time of a ray.
const SECONDS_PER_RAY: f64 = 1e-6;

impl ConvergeStudy {
    /// Plans a configuration.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn new(config: ConvergeConfig) -> Result<Self, StudyError> {
        Ok(Self {
            plan: config.plan()?,
            config,
            notes: Vec::new(),
        })
    }

    /// Times that runs are expected to take, in rays.
    fn costs(&self) -> Vec<f64> {
        let runs = self.plan.runs.iter();
        runs.map(|run| run.effort.total_rays() as f64).collect()
    }
}

impl Study for ConvergeStudy {
    type Kept = CaseResult;
    type Findings<'a> = ConvergeOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: ConvergeConfig = document.read()?;
        let notes = config.surface.read_files()?;
        Ok(Self {
            notes,
            ..Self::new(config)?
        })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn views<'a>(&self) -> Result<Views<'a, ConvergeOutcome<'a>>, ConfigError> {
        Ok(self.config.views(&self.plan))
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
        let mut prepared: Vec<Prepared<'_>> = Vec::new();
        let mut rays = 0;
        let costs = self.costs();
        for number in found.to_compute(&costs) {
            let run = &self.plan.runs[number];
            let known = prepared.iter().position(|one| one.serves(run));
            let place = known.unwrap_or(prepared.len());
            if known.is_none() {
                prepared.push(Prepared::new(&self.config, run, found.engine())?);
            }
            rays += prepared[place].simulation(run).rays();
        }
        observer.begin("tracing", rays);
        found.compute_missing(&costs, observer, |number| {
            let run = &self.plan.runs[number];
            let prepared = prepared.iter().find(|one| one.serves(run));
            prepared.map_or(Ok(None), |one| one.result(number, run, observer))
        })?;
        observer.end();
        if found.share().is_whole() && found.cases().next().is_none() {
            return Err(SimulateError::Interrupted.into());
        }
        Ok(())
    }

    fn plan_work(
        &self,
        _found: &mut ResultSet<'_>,
        _observer: &dyn Observer,
    ) -> Result<Vec<PlannedRow>, StudyError> {
        let runs = self.plan.runs.iter().enumerate();
        let row = |(number, run): (usize, &ConvergeRun)| {
            let rays = run.effort.total_rays();
            let work = PlannedWork {
                case: number,
                surfaces: run.effort.surfaces(),
                rays,
                seconds: SECONDS_PER_RAY * rays as f64,
            };
            PlannedRow::numbered("run", work)
        };
        Ok(runs.map(row).collect())
    }

    /// Outcome by the results of the plan. Cases that lack a run are left out.
    fn judge<'a>(
        &'a self,
        found: &'a ResultSet<'_>,
        _observer: &dyn Observer,
    ) -> Result<ConvergeOutcome<'a>, StudyError> {
        let plan = &self.plan;
        let mut cases = Vec::new();
        for (case_number, case) in plan.cases.iter().enumerate() {
            let runs = plan.runs.iter().enumerate();
            let runs = runs.filter(|(_, run)| run.case_number == case_number);
            let stored = runs.map(|(number, run)| {
                Some(StoredRun {
                    run,
                    result: found.case(number)?,
                })
            });
            if let Some(runs) = stored.collect::<Option<Vec<_>>>() {
                cases.push(ConvergedCase::of(plan, case, &runs)?);
            }
        }
        Ok(ConvergeOutcome {
            config: &self.config,
            plan,
            found,
            cases,
            seconds: found.seconds(),
        })
    }
}

impl Findings for ConvergeOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        converge_summary(self)
    }

    fn headline(&self) -> Vec<String> {
        headline(&self.cases)
    }

    fn tables(&self) -> String {
        converge_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.found.stopped_by()
    }

    fn progress(&self) -> Option<String> {
        Some(finished(self.cases.len(), self.plan.cases.len(), "case"))
    }

    fn work(&self) -> Option<String> {
        let cases = counted(self.cases.len() as u64, "case");
        Some(format!("{cases} in {:.1} s", self.seconds))
    }
}

/// A method, prepared for the runs of one case.
struct Prepared<'a> {
    /// The first of the runs.
    run: &'a ConvergeRun,
    simulation: Simulation,
    /// Seconds that it took to prepare.
    seconds: f64,
}

impl<'a> Prepared<'a> {
    fn new(
        config: &ConvergeConfig,
        run: &'a ConvergeRun,
        engine: Arc<dyn Engine>,
    ) -> Result<Self, StudyError> {
        let settings = config.settings(&run.method)?;
        let clock = Instant::now();
        Ok(Self {
            run,
            simulation: Simulation::new(std::slice::from_ref(&run.case), &settings)?.on(engine),
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    fn serves(&self, run: &ConvergeRun) -> bool {
        self.run.case_number == run.case_number && self.run.method == run.method
    }

    fn simulation(&self, run: &ConvergeRun) -> Simulation {
        self.simulation.repeated(run.effort, run.seed)
    }

    /// One run of the engine, by its clock; `None` if it was interrupted, since it is no sample then.
    fn result(
        &self,
        number: usize,
        run: &ConvergeRun,
        observer: &dyn Observer,
    ) -> Result<Option<CaseResult>, StudyError> {
        let outcomes = self.simulation(run).run(&Steps(observer));
        if observer.stop().is_some() {
            return Ok(None);
        }
        let result = |outcome: Outcome| CaseResult {
            findings: json!({ "repeat": run.repeat, "machine": { SETUP_SECONDS: self.seconds } }),
            outcome: Outcome {
                number,
                ..outcome.without_details()
            },
        };
        Ok(outcomes?.into_iter().next().map(result))
    }
}

/// Passes on steps and the stop; what a run begins and ends is a part of the measurement.
struct Steps<'a>(&'a dyn Observer);

impl Observer for Steps<'_> {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.0.advance(steps);
    }
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        self.0.stop()
    }
    fn gives_up(&self) -> bool {
        self.0.gives_up()
    }
    fn gives_up_first(&self) -> bool {
        self.0.gives_up_first()
    }
}
