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
use crate::input::limits::{check_results, check_shape, check_shape_memory};
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
        let settings = &self.settings;
        let only_of_one = [
            ("a target error", settings.target().is_some()),
            (
                "the controlled estimator",
                settings.estimator == Estimator::Controlled,
            ),
            ("a division into regions", settings.regions.is_some()),
        ];
        let what = only_of_one.into_iter().find(|(_, requested)| *requested);
        let kind = self.shapes.first().map(discriminant);
        let is_other = |shape| Some(discriminant(shape)) != kind;
        Err(match (self.shapes.as_slice(), what) {
            ([], _) => SimulateError::NoSurface,
            ([_], _) => return Ok(()),
            (_, Some((what, _))) => SimulateError::OnlyOfOne { what },
            (shapes, _) if shapes.iter().any(is_other) => SimulateError::MixedCells,
            _ => return Ok(()),
        })
    }

    fn check(&self, shape: &Shape) -> Result<(), SimulateError> {
        let settings = &self.settings;
        let is_controlled = settings.estimator == Estimator::Controlled;
        let random_azimuth = || self.cases.iter().any(|one| one.case.light.random_azimuth);
        Err(match shape {
            Shape::HeightField { .. } if settings.refine && shape.border() == Border::Open => {
                RefinementError::Open.into()
            }
            Shape::HeightField { .. } if is_controlled && random_azimuth() => {
                SimulateError::AzimuthControl
            }
            Shape::Smooth { .. } if settings.refine => SimulateError::SmoothRefinement,
            Shape::Smooth { .. } if is_controlled => SimulateError::SmoothControl,
            Shape::TriangleMesh { .. } if is_controlled => SimulateError::MeshControl,
            _ => return check_shape_memory(shape, settings.accelerator, settings.refine),
        })
    }

    /// The same with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        Self {
            settings: *settings,
            ..self.clone()
        }
    }

    /// Number of cases.
    pub(crate) const fn len(&self) -> usize {
        self.cases.len()
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
                // No control variate foresees the light of curved cells and of triangle meshes.
                let method = match mesh {
                    Shape::HeightField { top, .. } => Method::of_surface(top, &case, &settings)?,
                    _ => Method::plain(&settings),
                };
                Ok(Arc::new(method))
            };
            let methods = built
                .shapes()
                .map(method)
                .collect::<Result<_, SimulateError>>()?;
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
