//! Given surfaces: refuses cases that cannot be simulated on them.

use std::mem::discriminant;

use asperity_surface::{Border, RefinementError};
use asperity_tracer::Shape;

use super::case_run::{CaseRun, independent_bottoms};
use crate::error::SimulateError;
use crate::input::estimator::Estimator;
use crate::input::limits::check_shape_memory;
use crate::input::settings::Settings;

const ONE_AZIMUTH: &str =
    "of one surface needs light from one azimuth; with a random azimuth take auto or plain";

const FLAT_CELLS: &str = "of one surface is a sum over flat facets; these cells are smooth, so take auto or plain, or flat cells";

const HEIGHT_FIELD: &str = "is for height fields; this is a triangle mesh, so take auto or plain";

/// Refuses cases and settings that given surfaces do not allow.
pub(crate) fn check(
    shapes: &[Shape],
    cases: &[CaseRun],
    settings: &Settings,
) -> Result<(), SimulateError> {
    if !independent_bottoms(cases).is_empty() {
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
    let uncontrolled = |needs| SimulateError::NoControlVariate { needs };
    Err(match shape {
        Shape::HeightField { .. } if settings.refine && shape.border() == Border::Open => {
            RefinementError::Open.into()
        }
        Shape::HeightField { top, .. }
            if settings.refine && top.field().turned_cells().is_some() =>
        {
            RefinementError::Edges.into()
        }
        Shape::HeightField { .. } if is_controlled && any_azimuth => uncontrolled(ONE_AZIMUTH),
        Shape::Smooth { .. } if settings.refine => SimulateError::SmoothRefinement,
        Shape::Smooth { .. } if is_controlled => uncontrolled(FLAT_CELLS),
        Shape::TriangleMesh { .. } if is_controlled => uncontrolled(HEIGHT_FIELD),
        _ => return Ok(()),
    })
}
