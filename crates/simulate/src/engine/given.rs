//! Cases on given surfaces: what is refused, and the surface built where there is one.

use std::mem::discriminant;
use std::sync::Arc;
use std::time::Instant;

use asperity_surface::{Border, RefinementError};
use asperity_tracer::{BottomSurface, Shape};

use super::built_surface::{BuiltSurface, Meshes};
use super::context::Context;
use super::ensemble_run::{EnsembleRun, Members};
use super::given_run::{GivenCase, GivenRun};
use super::ready_group::ReadyGroup;
use super::traced_case::NumberedCase;
use crate::error::SimulateError;
use crate::input::estimator::Estimator;
use crate::input::limits::{check_memory, check_results, check_shape, shape_bytes};
use crate::input::settings::Settings;
use crate::methods::method::Method;

/// Cases on given surfaces.
#[derive(Clone)]
pub(crate) struct GivenGroup {
    shapes: Vec<Shape>,
    settings: Settings,
    cases: Vec<NumberedCase>,
}

impl GivenGroup {
    /// Refuses what no run on these surfaces does.
    pub(crate) fn new(
        shapes: Vec<Shape>,
        cases: Vec<NumberedCase>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        let mut layers = cases.iter().filter_map(|one| one.case.layer);
        if layers.any(|layer| layer.bottom == BottomSurface::Independent) {
            return Err(SimulateError::IndependentBottom);
        }
        let group = Self {
            shapes,
            settings: *settings,
            cases,
        };
        group.check_number()?;
        for shape in &group.shapes {
            group.check(shape)?;
        }
        let tallies = settings
            .regions
            .map_or(group.shapes.len() as u64, |regions| regions.count());
        let spec = settings.largest_spec(group.cases.iter().map(|one| &one.case));
        check_results(&spec, tallies, group.cases.len(), settings.refine)?;
        Ok(group)
    }

    /// Refuses no surface at all, and what is for one surface alone where there are several.
    fn check_number(&self) -> Result<(), SimulateError> {
        let Some((first, others)) = self.shapes.split_first() else {
            return Err(SimulateError::NoSurface);
        };
        let settings = &self.settings;
        let what = if settings.target().is_some() {
            "a target error"
        } else if settings.estimator == Estimator::Controlled {
            "the controlled estimator"
        } else if settings.regions.is_some() {
            "a division into regions"
        } else {
            let is_other = |shape| discriminant(shape) != discriminant(first);
            return match others.iter().any(is_other) {
                true => Err(SimulateError::MixedCells),
                false => Ok(()),
            };
        };
        match others {
            [] => Ok(()),
            _ => Err(SimulateError::OnlyOfOne { what }),
        }
    }

    fn check(&self, shape: &Shape) -> Result<(), SimulateError> {
        let settings = &self.settings;
        let is_controlled = settings.estimator == Estimator::Controlled;
        let what = match shape {
            Shape::HeightField { top, .. } => {
                if settings.refine && top.field().border() == Border::Open {
                    return Err(RefinementError::Open.into());
                }
                let random_azimuth = self.cases.iter().any(|one| one.case.light.random_azimuth);
                if random_azimuth && is_controlled {
                    return Err(SimulateError::AzimuthControl);
                }
                "tracing this surface"
            }
            Shape::Smooth { .. } => {
                if settings.refine {
                    return Err(SimulateError::SmoothRefinement);
                }
                if is_controlled {
                    return Err(SimulateError::SmoothControl);
                }
                "tracing this surface"
            }
            Shape::TriangleMesh { .. } if is_controlled => return Err(SimulateError::MeshControl),
            Shape::TriangleMesh { .. } => "this mesh with its hierarchy",
        };
        check_memory(what, shape_bytes(shape, settings))
    }

    /// The same with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        Self {
            settings: *settings,
            ..self.clone()
        }
    }

    /// Rays of all cases, as far as they are planned without a pilot run.
    pub(crate) fn rays(&self) -> u64 {
        let cases = self.cases.len() as u64;
        self.settings.effort.total_rays().saturating_mul(cases)
    }

    /// Builds the accelerators of one surface, and finds how each case is estimated on each mesh. Several surfaces are built while
    /// they are traced.
    pub(crate) fn build(self, context: Context<'_>) -> Result<Box<dyn ReadyGroup>, SimulateError> {
        let Self {
            mut shapes,
            settings,
            cases,
        } = self;
        let shape = match shapes.pop() {
            Some(shape) if shapes.is_empty() => shape,
            last => {
                shapes.extend(last);
                let members = Members::Surfaces(shapes);
                return Ok(Box::new(EnsembleRun::new(members, cases, settings, 0.0)));
            }
        };
        context.observer.begin("building", 1);
        let clock = Instant::now();
        let meshes = Meshes::new(shape, settings.refine)?;
        let built = BuiltSurface::build(meshes, settings.accelerator, context.engine)?;
        if let Some(regions) = settings.regions {
            context.observer.end();
            let members = Members::Regions(Arc::new(built), regions);
            let seconds = clock.elapsed().as_secs_f64() / cases.len().max(1) as f64;
            return Ok(Box::new(EnsembleRun::new(
                members, cases, settings, seconds,
            )));
        }
        let prepare = |NumberedCase { number, case }| {
            let method = |mesh| {
                check_shape(mesh, case.light.incidence)?;
                Method::of_shape(mesh, &case, &settings).map(Arc::new)
            };
            let methods = built.shapes().map(method).collect::<Result<_, _>>()?;
            Ok(GivenCase {
                number,
                case,
                methods,
                tried: Vec::new(),
                rays: settings.effort.total_rays(),
            })
        };
        let cases = cases.into_iter().map(prepare);
        let cases = cases.collect::<Result<Vec<_>, SimulateError>>()?;
        context.observer.end();
        Ok(Box::new(GivenRun {
            built,
            build_seconds: clock.elapsed().as_secs_f64() / cases.len().max(1) as f64,
            cases,
            settings,
        }))
    }
}
