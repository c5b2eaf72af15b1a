//! Group run: traces the cases of a group, and hands over the tallies of each with the end of its run.

use std::time::Instant;

use asperity_numerics::elementary::hypot;
use asperity_tally::TallyStatistics;

use super::draft::Draft;
use super::tallies::CaseTallies;
use crate::engine::context::Context;
use crate::engine::prepare::case_run::CaseRun;
use crate::engine::prepare::group::{AnalyticCase, Group};
use crate::engine::trace::rounds::Rounds;
use crate::error::SimulateError;
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::target::Quantity;
use crate::methods::control_variates::slopes::{ControlMoments, Observed, SlopeControlVariate};
use crate::output::chosen_paths::ChosenPaths;
use crate::output::stopped_by::StoppedBy;
use crate::output::stopping::Stopping;
use crate::store::Stage;

/// Factor on the target error that allows for the mesh: a third of the target, added in squares.
pub const MESH_ALLOWANCE: f64 = 1.055;

impl Group {
    /// Traces all cases: as planned, and more until the error is reached. Cases that were not begun before a stop, or given up
    /// after it, are left out, and so are all of a group that is traced in part.
    pub(in crate::engine) fn run(
        self,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<Vec<Draft>, SimulateError> {
        let clock = Instant::now();
        let (tallies, rounds) = self.trace(all_cases, context)?;
        if self.slice().is_part() {
            return Ok(Vec::new());
        }
        let built_seconds = self.built.as_ref().map_or(0.0, |built| built.seconds);
        let seconds = clock.elapsed().as_secs_f64() / self.cases.len().max(1) as f64;
        let common = self.stopping(rounds);
        let analytic = self
            .analytic
            .iter()
            .map(|one| self.analytic_draft(one, &common));
        let mut drafts: Vec<Draft> = analytic.collect();
        for (run, mut tallies) in self.cases.iter().zip(tallies) {
            // From fewer than two blocks of rays there is no error.
            let blocks = tallies.blocks_of_one.as_ref().map(TallyStatistics::batches);
            if tallies.work.rays == 0 || common.is_cut_short() && blocks == Some(1) {
                continue;
            }
            let error = self.error(run, &tallies);
            let reached = error.and_then(|error| self.reached(error, run.mesh_error));
            let slope_control = self.slope_control(run, &tallies);
            if let Some(control) = &slope_control {
                tallies.adjust(control);
            }
            tallies.seconds.build += built_seconds;
            let stopping = Stopping {
                error,
                mesh_error: run.mesh_error,
                pilot: run.pilot,
                paths: common.target_error.map(|_| ChosenPaths {
                    strategy: run.strategy(),
                    tried: run.tried.clone(),
                }),
                stopped_by: match reached {
                    Some(reached) if !common.is_cut_short() => reached,
                    _ => common.stopped_by,
                },
                ..common.clone()
            };
            drafts.push(Draft {
                run: self.as_traced(run),
                tallies,
                slope_control: slope_control.map(|control| control.remaining()),
                seconds: seconds + built_seconds,
                stopping: stopping.with_warning(),
                deviation_bound: None,
            });
        }
        Ok(drafts)
    }

    /// The parts of the stopping that all cases have in common.
    fn stopping(&self, rounds: Rounds) -> Stopping {
        let rays = self.run_of(Stage::Result).rays_of_surface();
        let random = self.random();
        Stopping {
            size: random.and_then(|_| self.source.size()),
            spacing: random.map(RandomSurfaces::spacing),
            warnings: self.warnings.clone(),
            ..rounds.stopping(&self.settings, self.plan.surfaces, rays)
        }
    }

    /// The case on the surfaces that were traced, whose spacing the pilot run may have changed.
    fn as_traced(&self, run: &CaseRun) -> CaseRun {
        let mut run = run.clone();
        run.case.surface = self.source.clone();
        run
    }

    /// The result of a case that needs no rays.
    fn analytic_draft(&self, one: &AnalyticCase, common: &Stopping) -> Draft {
        Draft {
            run: self.as_traced(&one.run),
            tallies: CaseTallies::analytic(one.result.statistics.clone()),
            slope_control: None,
            seconds: 0.0,
            stopping: Stopping {
                error: Some(one.result.error),
                realisations: 0,
                rays_per_surface: 0,
                rounds: 0,
                stopped_by: StoppedBy::Bound,
                warnings: Vec::new(),
                ..common.clone()
            },
            deviation_bound: Some(one.result.bound),
        }
    }

    /// The error of the target quantity of a traced case.
    pub(in crate::engine) fn error(&self, run: &CaseRun, tallies: &CaseTallies) -> Option<f64> {
        let statistics = match self.slope_control(run, tallies) {
            Some(control) => tallies.adjusted_statistics(&control),
            None => tallies.statistics(),
        };
        let least = tallies.least_errors(run, &statistics);
        let statistics = statistics.with_least_errors(least.all);
        self.target()?.of().error(&statistics)
    }

    /// The control variate of a traced case by the slopes of its surfaces, if it lowers the error of the target, or of the bins
    /// without a target.
    fn slope_control(&self, run: &CaseRun, tallies: &CaseTallies) -> Option<SlopeControlVariate> {
        let surfaces = self.random()?;
        let folded = run.method().mirror.is_some();
        let moments = ControlMoments::of(&run.case.light, surfaces.recipe(), folded);
        let of = self.target().map_or(Quantity::Bins, |target| target.of());
        let observed = Observed {
            tallies: &tallies.surfaces,
            slopes: &tallies.slopes,
            expected_slopes: surfaces.expected_slope_moments()?,
        };
        let spec = self.settings.spec_of(&run.case);
        SlopeControlVariate::fit(observed, moments, &of.entries(&spec))
    }

    /// The end of a case whose `error` lies within the target: that, unless the mesh adds too much to it.
    fn reached(&self, error: f64, mesh_error: Option<f64>) -> Option<StoppedBy> {
        let target = self.target()?.error();
        let mesh = mesh_error.unwrap_or(0.0);
        (error <= target).then(|| {
            if hypot(error, mesh) <= target * MESH_ALLOWANCE {
                StoppedBy::Target
            } else {
                StoppedBy::Mesh
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Incidence, Material};
    use asperity_synthesis::{Psd, Synthesis};
    use asperity_tracer::HalfSpace;

    use super::*;
    use crate::engine::trace::stage::SurfacePlan;
    use crate::input::case::{Case, Light};
    use crate::input::estimator::Estimator;
    use crate::input::settings::{Effort, Settings};
    use crate::input::share::Division;
    use crate::input::surface_source::SurfaceSource;
    use crate::input::target::Target;
    use crate::observer::Silent;

    /// A plan of too few surfaces, as a pilot run may make one by chance, is made up for by new ones.
    #[test]
    fn surfaces_are_added_until_the_target_is_reached() {
        for (seed, rounds) in [(2, 1), (3, 2)] {
            let psd = Psd::gaussian(4.0, 8.0).unwrap();
            let synthesis = Synthesis::new(psd, [128, 128], [1.0, 1.0], false).unwrap();
            let source = SurfaceSource::random(synthesis);
            let light = Light {
                incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
                from: HalfSpace::Above,
                spread: None,
                random_azimuth: true,
                stokes: [0.0; 3],
            };
            let glass = Material::Dielectric { eta: 1.5 };
            let case = Case::new(source, glass, light);
            let target = Target::new(0.02, Quantity::Rings).unwrap();
            let settings = Settings {
                estimator: Estimator::Plain,
                seed,
                effort: Effort::TargetError(target),
                ..Settings::default()
            };
            let mut groups =
                Group::of_cases(&[case], &settings, &Division::WHOLE, |_| false).unwrap();
            let mut group = groups.remove(0).prepared(&Silent).unwrap();
            group.plan = SurfacePlan {
                surfaces: 3,
                rays: 3 * 128,
            };
            let draft = group
                .run(1, Context::without_store(&Silent))
                .unwrap()
                .remove(0);
            let stopping = draft.stopping;
            println!("{stopping:?}");
            assert_eq!(stopping.rounds, rounds);
            assert_eq!(stopping.stopped_by, StoppedBy::Target);
            assert!(stopping.error.unwrap() <= 0.02);
            // No surface counts twice.
            let tallies = draft.tallies.surfaces;
            let surfaces = tallies.len();
            assert_eq!(
                draft.tallies.work.rays,
                stopping.rays_per_surface * surfaces as u64
            );
            assert!(surfaces > 3);
            for (i, tally) in tallies.iter().enumerate() {
                assert!(!tallies[..i].contains(tally), "{i}");
            }
        }
    }
}
