//! The plan of cases that share random surfaces: paths, surfaces, rays and spacing that reach a target, by a pilot run.

use super::context::Context;
use super::ensemble::EnsembleGroup;
use super::pilot::{self, Figures, PilotRun};
use super::surfaces::{SurfaceGroup, surface_bytes};
use super::tallies::CaseTallies;
use super::traced_case::TracedCase;
use crate::error::SimulateError;
use crate::input::limits::{check_memory, most_realisations};
use crate::input::surface_source::SurfaceSource;
use crate::store::Stage;
use crate::text::{error_in_short, short};

impl EnsembleGroup {
    /// Plans paths, surfaces, rays and spacing by a pilot run. If that is stopped, all stays as it is.
    pub(super) fn plan_by_pilot(
        &mut self,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<(), SimulateError> {
        let Some(target) = self.target().filter(|_| !self.traced.is_empty()) else {
            return Ok(());
        };
        let Some(mut fine) = self.run_pilot(Stage::Pilot, &self.traced, context)? else {
            return Ok(());
        };
        self.choose_paths(target, &mut fine, all_cases, context)?;
        let coarse = if self.has_coarser() {
            self.run_pilot(Stage::CoarsePilot, &self.traced, context)?
        } else {
            None
        };
        self.pilot.figures = self.figures(&fine, coarse.as_deref());
        self.choose_spacing();
        self.choose_effort(all_cases);
        Ok(())
    }

    /// Whether the pilot run has surfaces of twice its spacing.
    pub(super) fn has_coarser(&self) -> bool {
        let pilot = self.pilot_surfaces.as_ref();
        pilot.is_some_and(|pilot| pilot.coarse.is_some())
    }

    /// A pilot run of `cases`; `None` if it was stopped.
    pub(super) fn run_pilot(
        &self,
        stage: Stage,
        cases: &[TracedCase],
        context: Context<'_>,
    ) -> Result<Option<Vec<CaseTallies>>, SimulateError> {
        let surfaces = pilot::FIRST..pilot::FIRST + pilot::SURFACES;
        let group = SurfaceGroup {
            cases,
            ..self.group(stage)
        };
        let found = group.run(surfaces, context)?;
        let first = found.first();
        let complete = first.is_some_and(|t| t.surfaces.len() as u64 == pilot::SURFACES);
        Ok(complete.then_some(found))
    }

    /// What the pilot run tells of each traced case.
    pub(super) fn figures(
        &self,
        fine: &[CaseTallies],
        coarse: Option<&[CaseTallies]>,
    ) -> Vec<Figures> {
        let of_case = |(i, fine)| self.figures_of(fine, coarse.map(|coarse| &coarse[i]));
        fine.iter().enumerate().flat_map(of_case).collect()
    }

    /// What the pilot run tells of a traced case; `None` without a target.
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

    /// Chooses the spacing whose mesh adds little enough to the error, if this machine can hold it.
    fn choose_spacing(&mut self) {
        let (Some(target), Some(pilot)) = (self.target(), &self.pilot_surfaces) else {
            return;
        };
        let candidates = self.random().map(|surfaces| pilot.candidates(surfaces));
        let mut candidates = candidates.unwrap_or_default();
        candidates.retain(|(scale, surfaces)| {
            let bytes = surface_bytes(surfaces, &self.traced, &self.settings);
            *scale == 1.0 || check_memory("", bytes).is_ok()
        });
        let scales: Vec<f64> = candidates.iter().map(|(scale, _)| *scale).collect();
        let chosen = pilot.choose(&self.pilot.figures, target, &scales);
        let figures = self.pilot.figures.iter();
        self.pilot.mesh_errors = figures
            .map(|figures| pilot.mesh_error(figures, chosen.scale))
            .collect();
        if let Some((_, surfaces)) = candidates.into_iter().find(|(s, _)| *s == chosen.scale) {
            self.source = SurfaceSource::random(surfaces);
        }
        self.pilot.scale = chosen.scale;
        if let (Some(error), false) = (chosen.mesh_error, chosen.fine_enough) {
            let spacing = self.random().map_or(0.0, |surfaces| surfaces.spacing()[0]);
            let spacing = short(spacing);
            self.pilot.warnings.push(format!(
                "at the spacing {spacing} the mesh adds an error of up to {}, above a third of the target: give a finer spacing",
                error_in_short(error)
            ));
            self.pilot
                .warnings
                .extend(pilot.warning().map(str::to_owned));
        }
    }

    /// Chooses the surfaces and rays that reach the target in the least time.
    fn choose_effort(&mut self, all_cases: usize) {
        let Some(target) = self.target() else {
            return;
        };
        let most = most_realisations(&self.largest_spec(), all_cases);
        let (figures, scale) = (&self.pilot.figures, self.pilot.scale);
        let Some(effort) = pilot::plan(figures, target.error(), scale, most) else {
            return;
        };
        if effort.expected > target.error() {
            self.pilot.warnings.push(format!(
                "the target {} needs more than {} surfaces, the most whose results fit into memory; the expected error is {}",
                error_in_short(target.error()),
                effort.surfaces,
                error_in_short(effort.expected)
            ));
        }
        self.plan = effort.plan();
    }
}
