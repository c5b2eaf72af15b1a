//! Points hash: tells given surfaces apart by their points, so that no run resumes on another surface.

use asperity_analysis::fnv1a;
use asperity_simulate::{Cells, Shape};
use asperity_surface::{HeightField, SplineSurface};
use asperity_tracer::{Geometry, MeshSurface, Triangles};
use serde_json::{Value, json};

/// Of the heights of a field.
pub(crate) fn heights_hash(field: &HeightField) -> String {
    text(field.heights().iter().copied())
}

/// Of the corners of all triangles.
pub(crate) fn corners_hash(mesh: &MeshSurface) -> String {
    let corners = (0..mesh.facet_count()).flat_map(|i| mesh.corners(mesh.facet(i)));
    text(corners.flat_map(|corner| corner.to_array()))
}

/// Of a surface and of the bottom below it, with what else of them is not in the settings of a run.
pub(crate) fn shape_hash(shape: &Shape) -> Value {
    let of_field = |field: &HeightField| {
        json!({
            "shape": field.shape(),
            "spacing": field.spacing(),
            "border": field.border(),
            "heights": heights_hash(field),
        })
    };
    let of_mesh = |mesh: &MeshSurface| {
        json!({
            "size": mesh.size(),
            "border": mesh.border(),
            "corners": corners_hash(mesh),
        })
    };
    let of_spline = |spline: &SplineSurface| {
        json!({
            "shape": spline.shape(),
            "spacing": spline.spacing(),
            "border": spline.border(),
            "coefficients": text(spline.coefficients().iter().copied()),
        })
    };
    match shape {
        Shape::HeightField { top, bottom } => json!({
            "cells": Cells::Flat,
            "top": of_field(top.field()),
            "bottom": bottom.as_ref().map(|bottom| of_field(bottom.field())),
        }),
        Shape::Smooth { top, bottom } => json!({
            "cells": Cells::Smooth,
            "top": of_spline(top.spline()),
            "bottom": bottom.as_ref().map(|bottom| of_spline(bottom.spline())),
        }),
        Shape::TriangleMesh { top, bottom } => json!({
            "top": of_mesh(top),
            "bottom": bottom.as_ref().map(|bottom| of_mesh(bottom)),
        }),
    }
}

fn text(numbers: impl Iterator<Item = f64>) -> String {
    format!("{:016x}", fnv1a(numbers.flat_map(f64::to_le_bytes)))
}
