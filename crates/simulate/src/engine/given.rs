//! Cases on given surfaces: what is refused, and how those on one surface are prepared.

use std::mem::discriminant;
use std::sync::Arc;
use std::time::Instant;

use asperity_surface::{Border, RefinementError};
use asperity_tracer::{BottomSurface, Shape};

use super::built_surface::{BuiltSurface, Meshes};
use super::context::Context;
use super::given_run::{GivenCase, GivenRun};
use super::traced_case::NumberedCase;
use crate::error::SimulateError;
use crate::input::estimator::Estimator;
use crate::input::limits::{check_shape, check_shape_memory};
use crate::input::settings::Settings;
use crate::methods::method::Method;

/// Refuses what no run on given surfaces does.
pub(crate) fn check(
    shapes: &[Shape],
    cases: &[NumberedCase],
    settings: &Settings,
) -> Result<(), SimulateError> {
    let mut layers = cases.iter().filter_map(|one| one.case.layer);
    if layers.any(|layer| layer.bottom == BottomSurface::Independent) {
        return Err(SimulateError::IndependentBottom);
    }
    check_number(shapes, settings)?;
    let any_azimuth = cases.iter().any(|one| one.case.light.random_azimuth);
    for shape in shapes {
        check_estimator(shape, any_azimuth, settings)?;
        check_shape_memory(shape, settings.accelerator, settings.refine)?;
    }
    Ok(())
}

/// Refuses no surface at all, and what is for one surface alone where there are several.
fn check_number(shapes: &[Shape], settings: &Settings) -> Result<(), SimulateError> {
    let only_of_one = [
        ("a target error", settings.target().is_some()),
        (
            "the controlled estimator",
            settings.estimator == Estimator::Controlled,
        ),
        ("a division into regions", settings.regions.is_some()),
    ];
    let what = only_of_one.into_iter().find(|(_, requested)| *requested);
    let kind = shapes.first().map(discriminant);
    let is_other = |shape| Some(discriminant(shape)) != kind;
    Err(match (shapes, what) {
        ([], _) => SimulateError::NoSurface,
        ([_], _) => return Ok(()),
        (_, Some((what, _))) => SimulateError::OnlyOfOne { what },
        (shapes, _) if shapes.iter().any(is_other) => SimulateError::MixedCells,
        _ => return Ok(()),
    })
}

fn check_estimator(
    shape: &Shape,
    any_azimuth: bool,
    settings: &Settings,
) -> Result<(), SimulateError> {
    let is_controlled = settings.estimator == Estimator::Controlled;
    Err(match shape {
        Shape::HeightField { .. } if settings.refine && shape.border() == Border::Open => {
            RefinementError::Open.into()
        }
        Shape::HeightField { .. } if is_controlled && any_azimuth => SimulateError::AzimuthControl,
        Shape::Smooth { .. } if settings.refine => SimulateError::SmoothRefinement,
        Shape::Smooth { .. } if is_controlled => SimulateError::SmoothControl,
        Shape::TriangleMesh { .. } if is_controlled => SimulateError::MeshControl,
        _ => return Ok(()),
    })
}

impl GivenRun {
    /// Builds the accelerators of the surface, and finds how each case is estimated on each mesh.
    pub(crate) fn new(
        shape: Shape,
        cases: Vec<NumberedCase>,
        settings: Settings,
        context: Context<'_>,
    ) -> Result<Self, SimulateError> {
        context.observer.begin("building", 1);
        let clock = Instant::now();
        let meshes = Meshes::new(shape, settings.refine)?;
        let built = BuiltSurface::build(meshes, settings.accelerator, context.engine)?;
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
        Ok(Self {
            built,
            build_seconds: clock.elapsed().as_secs_f64() / cases.len().max(1) as f64,
            cases,
            settings,
        })
    }
}
