//! Ensemble run: cases on several given surfaces, or on one whose regions are lit on their own, like surfaces of their own.
//!
//! Rays fall on one region; what they meet afterwards is the whole surface, so that shadows and multiple scattering are those of
//! its true neighbourhood. Regions have equally many rays, so that the mean of their tallies is that of the surface.

use std::sync::Arc;
use std::time::Instant;

use asperity_tracer::Shape;

use super::built_surface::BuiltSurface;
use super::context::Context;
use super::draft::Draft;
use super::ready_group::ReadyGroup;
use super::rounds::Rounds;
use super::surfaces::{SurfaceGroup, SurfacePlan, Surfaces};
use super::tallies::CaseTallies;
use super::traced_case::{NumberedCase, TracedCase};
use crate::error::SimulateError;
use crate::input::regions::Regions;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::output::stopped_by::StoppedBy;
use crate::store::Stage;

/// Cases on several given surfaces, or on the regions of one.
pub(crate) struct EnsembleRun {
    pub(super) members: Members,
    pub(super) cases: Vec<TracedCase>,
    pub(super) settings: Settings,
    /// Of each case, before the run.
    build_seconds: f64,
}

/// What an ensemble consists of.
pub(crate) enum Members {
    /// Surfaces.
    Surfaces(Vec<Shape>),
    /// Regions of a surface, which is built.
    Regions(Arc<BuiltSurface>, Regions),
}

impl EnsembleRun {
    /// By the plain estimator: what other estimators subtract is that of one whole surface.
    pub(crate) fn new(
        members: Members,
        cases: Vec<NumberedCase>,
        settings: Settings,
        build_seconds: f64,
    ) -> Self {
        let method = Arc::new(Method::plain(&settings));
        let traced = |NumberedCase { number, case }| TracedCase {
            number,
            case,
            method: method.clone(),
        };
        Self {
            members,
            cases: cases.into_iter().map(traced).collect(),
            settings,
            build_seconds,
        }
    }

    pub(super) fn group(&self) -> SurfaceGroup<'_> {
        let (surfaces, stage) = match &self.members {
            Members::Surfaces(shapes) => (Surfaces::Given(shapes), Stage::Result),
            Members::Regions(built, regions) => {
                (Surfaces::Regions(built, *regions), Stage::Regions)
            }
        };
        SurfaceGroup {
            surfaces,
            cases: &self.cases,
            settings: self.settings,
            plan: SurfacePlan {
                surfaces: self.surfaces(),
                rays: self.settings.effort.total_rays(),
            },
            stage,
        }
    }
}

impl ReadyGroup for EnsembleRun {
    fn explanations(&self) -> Vec<String> {
        self.explained()
    }

    fn surfaces(&self) -> u64 {
        match &self.members {
            Members::Surfaces(shapes) => shapes.len() as u64,
            Members::Regions(_, regions) => regions.count(),
        }
    }

    fn rays(&self) -> u64 {
        self.surfaces() * self.group().rays_of_surface() * self.cases.len() as u64
    }

    fn run(
        self: Box<Self>,
        _all_cases: usize,
        context: Context<'_>,
    ) -> Result<Vec<Draft>, SimulateError> {
        let clock = Instant::now();
        let (group, surfaces) = (self.group(), self.surfaces());
        let tallies = group.run(0..surfaces, context)?;
        let seconds =
            self.build_seconds + clock.elapsed().as_secs_f64() / self.cases.len().max(1) as f64;
        let rays_per_surface = group.rays_of_surface();
        let draft = |(traced, tallies): (&TracedCase, CaseTallies)| {
            let stopped_by = if tallies.work.rays == surfaces * rays_per_surface {
                StoppedBy::Plan
            } else {
                context.observer.stop().unwrap_or(StoppedBy::Interrupt)
            };
            let rounds = Rounds::as_planned(stopped_by);
            let stopping = rounds.stopping(&self.settings, surfaces, rays_per_surface);
            Draft {
                number: traced.number,
                case: traced.case.clone(),
                method: traced.method.clone(),
                tallies,
                slope_control: None,
                seconds,
                stopping: stopping.with_warning(),
                deviation_bound: None,
            }
        };
        Ok(self.cases.iter().zip(tallies).map(draft).collect())
    }
}
