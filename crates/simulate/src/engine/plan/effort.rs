//! Effort: paths, surfaces, rays and spacing that reach a target, by a pilot run.

use super::pilot::{self, Figures, PilotRun};
use crate::engine::context::Context;
use crate::engine::prepare::case_run::CaseRun;
use crate::engine::prepare::group::Group;
use crate::engine::reduce::tallies::CaseTallies;
use crate::engine::trace::rounds::{MAX_RAYS, RAY_MARGIN};
use crate::engine::trace::stage::StageRun;
use crate::engine::trace::surfaces::surface_bytes;
use crate::error::SimulateError;
use crate::input::limits::{check_memory, most_realisations};
use crate::input::surface_source::SurfaceSource;
use crate::input::target::Target;
use crate::store::Stage;
use crate::text::{error_in_short, short};

/// Fewest rays of a run with a target on one surface.
const MIN_RAYS: f64 = 65_536.0;

impl Group {
    /// Plans paths, surfaces, rays and spacing by a pilot run, where they follow from a target error. If that is stopped, all stays as it
    /// is. `all_cases`: cases of the run.
    pub(in crate::engine) fn make_plan(
        &mut self,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<(), SimulateError> {
        let Some(target) = self.target().filter(|_| !self.cases.is_empty()) else {
            return Ok(());
        };
        let Some(mut fine) = self.run_pilot(Stage::Pilot, &self.cases, context)? else {
            return Ok(());
        };
        self.choose_paths(target, &mut fine, all_cases, context)?;
        if self.has_ray_blocks() {
            let error = self.error_over_target(&self.cases[0], &fine[0]);
            let needed = self.run_of(Stage::Pilot).rays() as f64 * error.powi(2);
            self.plan.rays = (RAY_MARGIN * needed).clamp(MIN_RAYS, MAX_RAYS).ceil() as u64;
            return Ok(());
        }
        let coarse = if self.has_coarser() {
            self.run_pilot(Stage::CoarsePilot, &self.cases, context)?
        } else {
            None
        };
        let figures = self.figures(&fine, coarse.as_deref());
        let scale = self.choose_spacing(target, &figures);
        self.choose_effort(target, &figures, scale, all_cases);
        for (run, figures) in self.cases.iter_mut().zip(figures) {
            run.pilot = Some(figures.figures);
        }
        Ok(())
    }

    /// Rays of the pilot run.
    pub(in crate::engine) fn pilot_rays(&self) -> u64 {
        let runs = if self.has_coarser() { 2 } else { 1 };
        runs * self.run_of(Stage::Pilot).rays() * self.cases.len() as u64
    }

    /// `true` if the pilot run has surfaces of twice its spacing.
    fn has_coarser(&self) -> bool {
        let pilot = self.pilot_surfaces.as_ref();
        pilot.is_some_and(|pilot| pilot.coarse.is_some())
    }

    /// A pilot run of `cases`, whose rays are not used again for the result; `None` if it was stopped.
    pub(super) fn run_pilot(
        &self,
        stage: Stage,
        cases: &[CaseRun],
        context: Context<'_>,
    ) -> Result<Option<Vec<CaseTallies>>, SimulateError> {
        let run = StageRun {
            cases,
            ..self.run_of(stage)
        };
        let found = run.run(pilot::FIRST..pilot::FIRST + run.plan.surfaces, context)?;
        // Of a share of nothing the pilot run may be missing.
        let is_whole = |tallies: &CaseTallies| tallies.work.rays == run.rays();
        let is_complete = found.len() == cases.len() && found.iter().all(is_whole);
        Ok(is_complete.then_some(found))
    }

    /// The error of a case over its target; zero where no light scatters yet.
    pub(super) fn error_over_target(&self, run: &CaseRun, tallies: &CaseTallies) -> f64 {
        let error = self.error(run, tallies).zip(self.target());
        error.map_or(0.0, |(error, target)| error / target.error())
    }

    /// Figures of the pilot run by traced case.
    pub(super) fn figures(
        &self,
        fine: &[CaseTallies],
        coarse: Option<&[CaseTallies]>,
    ) -> Vec<Figures> {
        let of_case = |(i, fine)| self.figures_of(fine, coarse.map(|coarse| &coarse[i]));
        fine.iter().enumerate().flat_map(of_case).collect()
    }

    /// Figures of the pilot run of a traced case; `None` without a target, or of a given surface.
    pub(super) fn figures_of(
        &self,
        fine: &CaseTallies,
        coarse: Option<&CaseTallies>,
    ) -> Option<Figures> {
        let run = PilotRun {
            fine,
            coarse,
            cost_of_surface_ns: pilot::cost_of_surface_ns(self.random()?),
        };
        Some(Figures::new(self.target()?, &run))
    }

    /// Chooses the spacing whose mesh adds little enough to the error, if this machine can hold it. Returns it over that given.
    fn choose_spacing(&mut self, target: Target, figures: &[Figures]) -> f64 {
        let Some(pilot) = &self.pilot_surfaces else {
            return 1.0;
        };
        let candidates = self.random().map(|surfaces| pilot.candidates(surfaces));
        let mut candidates = candidates.unwrap_or_default();
        candidates.retain(|(scale, surfaces)| {
            let bytes = surface_bytes(surfaces, &self.cases, &self.settings);
            *scale == 1.0 || check_memory("", bytes).is_ok()
        });
        let scales: Vec<f64> = candidates.iter().map(|(scale, _)| *scale).collect();
        let chosen = pilot.choose(figures, target, &scales);
        for (run, figures) in self.cases.iter_mut().zip(figures) {
            run.mesh_error = pilot.mesh_error(figures, chosen.scale);
        }
        if let Some((_, surfaces)) = candidates.into_iter().find(|(s, _)| *s == chosen.scale) {
            self.source = SurfaceSource::random(surfaces);
        }
        if let (Some(error), false) = (chosen.mesh_error, chosen.fine_enough) {
            let spacing = self.random().map_or(0.0, |surfaces| surfaces.spacing()[0]);
            let spacing = short(spacing);
            self.warnings.push(format!(
                "at the spacing {spacing} the mesh adds an error of up to {}, above a third of the target: give a finer spacing",
                error_in_short(error)
            ));
            self.warnings.extend(pilot.warning().map(str::to_owned));
        }
        chosen.scale
    }

    /// Chooses the surfaces and rays that reach the target in the least time.
    fn choose_effort(&mut self, target: Target, figures: &[Figures], scale: f64, all_cases: usize) {
        let most = most_realisations(&self.largest_spec(), all_cases);
        let Some(effort) = pilot::plan(figures, target.error(), scale, most) else {
            return;
        };
        if effort.expected > target.error() {
            self.warnings.push(format!(
                "the target {} needs more than {} surfaces, the most whose results fit into memory; the expected error is {}",
                error_in_short(target.error()),
                effort.surfaces,
                error_in_short(effort.expected)
            ));
        }
        self.plan = effort.plan();
    }
}
