//! Draft: the tallies of one case, before its errors are worked out.

use asperity_tally::{TallyResult, TallyValues};

use super::tallies::CaseTallies;
use crate::engine::prepare::case_run::CaseRun;
use crate::errors::budget::ErrorBudget;
use crate::errors::convergence::Convergence;
use crate::errors::mesh_error::MeshErrors;
use crate::errors::refinement::Refinement;
use crate::input::random_surfaces::Planned;
use crate::input::settings::Settings;
use crate::input::surface_source::SurfaceSource;
use crate::output::outcome::{ErrorSource, Outcome};
use crate::output::stopping::Stopping;
use crate::output::work::SummaryWork;

/// Tallies of one case, before its errors are worked out.
pub(crate) struct Draft {
    /// The case, on the surfaces that were traced.
    pub(crate) run: CaseRun,
    pub(crate) tallies: CaseTallies,
    /// Variance between surfaces that a control variate by their slopes has left, where there is one.
    pub(crate) slope_control: Option<f64>,
    pub(crate) seconds: f64,
    pub(crate) stopping: Stopping,
    /// Largest deviation of any sum of fluxes, of an analytic result.
    pub(crate) deviation_bound: Option<f64>,
}

impl Draft {
    /// The outcome, with its errors by where they come from.
    pub(crate) fn finish(self, settings: &Settings) -> Outcome {
        let mut statistics = self.tallies.statistics();
        let is_analytic = self.deviation_bound.is_some();
        let least = (!is_analytic).then(|| self.tallies.least_errors(&self.run, &statistics));
        if let Some(least) = &least {
            statistics = statistics.with_least_errors(least.all.clone());
        }
        let errors_from = match self.tallies.blocks_of_one {
            _ if is_analytic => ErrorSource::DeviationBound,
            Some(_) => ErrorSource::RayBlocks,
            None if self.run.case.surface.shapes().len() == 1 => ErrorSource::Regions,
            None => ErrorSource::Surfaces,
        };
        let errors = match least {
            None => {
                let spec = settings.spec_of(&self.run.case);
                ErrorBudget::of_bounds(TallyValues::from_fn(spec, |entry| {
                    statistics.at(entry).se.unwrap_or(0.0)
                }))
            }
            Some(least) => {
                let mesh = self.mesh_errors(settings);
                let method = self.run.method();
                match errors_from {
                    ErrorSource::RayBlocks => {
                        ErrorBudget::of_one(&statistics, method, &least, mesh)
                    }
                    _ => {
                        let of_rays = self.tallies.error_squares_of_rays();
                        ErrorBudget::of_surfaces(&statistics, of_rays, &least, mesh)
                    }
                }
            }
        };
        let (tallies, run) = (self.tallies, self.run);
        let mut work =
            SummaryWork::new(tallies.work, tallies.used, run.method(), settings.sampling);
        work.realisations = if is_analytic {
            0
        } else {
            tallies.surfaces.len() as u64
        };
        work.slope_control = self.slope_control;
        work.machine.generate_seconds = tallies.seconds.generate;
        work.machine.build_seconds = tallies.seconds.build;
        work.machine.trace_seconds = tallies.seconds.trace;
        work.machine.seconds = self.seconds;
        Outcome {
            number: run.number,
            case: run.case,
            statistics,
            errors_from,
            errors,
            deviation_bound: self.deviation_bound,
            work,
            surfaces: tallies.surfaces,
            stopping: self.stopping,
            seed: settings.seed,
        }
    }

    /// Mesh errors of the result.
    fn mesh_errors(&self, settings: &Settings) -> MeshErrors {
        let refinement = self.refinement();
        let spec = settings.spec_of(&self.run.case);
        match &self.run.case.surface {
            SurfaceSource::Random(surfaces) => {
                let by_pilot_run = self.stopping.mesh_by_pilot_run(surfaces.cells());
                let by_pilot_run = by_pilot_run.as_deref();
                match surfaces.planned() {
                    Ok(Planned::Flat(synthesis)) => MeshErrors::of_random(
                        &self.run.case,
                        synthesis,
                        self.run.method(),
                        settings,
                        refinement,
                        by_pilot_run,
                    ),
                    Ok(Planned::Smooth(_)) => MeshErrors::of_random_smooth(
                        self.run.method(),
                        spec,
                        refinement,
                        by_pilot_run,
                    ),
                    // They are planned, since they were traced.
                    Ok(Planned::Fields(_)) | Err(_) => MeshErrors::of_random_fields(
                        // Known since their stage began
                        surfaces.is_exact_structure(settings.seed).unwrap_or(None),
                        self.run.method(),
                        spec,
                        refinement,
                        by_pilot_run,
                    ),
                }
            }
            SurfaceSource::Given(shapes) => MeshErrors::of_given(shapes, spec, refinement),
            SurfaceSource::Described(_) => MeshErrors::unknown(spec, "not estimated"),
        }
    }

    /// Refinement by meshes of several spacings, if there were several.
    fn refinement(&self) -> Option<Refinement> {
        let shifts = &self.tallies.shifts;
        let surface = Some(&self.run.case.surface).filter(|_| !shifts.is_empty())?;
        let convergence = match surface {
            SurfaceSource::Random(surfaces) => Convergence::of_random(surfaces, 1.0),
            SurfaceSource::Given(_) | SurfaceSource::Described(_) => {
                Convergence::of_field(&*surface.heights()?)
            }
        };
        Refinement::of_surfaces(surface.spacing()?, convergence, shifts)
    }
}
