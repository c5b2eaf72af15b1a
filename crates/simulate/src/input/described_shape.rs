//! Described shape: a given surface without its points, and a hash that distinguishes them.

use std::sync::Arc;

use asperity_numerics::hash_numbers;
use asperity_surface::{Border, HeightField, SplineSurface};
use asperity_tracer::{Geometry, MeshSurface, Shape, Triangles};
use serde::{Deserialize, Serialize};

use super::cells::Cells;

/// A given surface, and the bottoms of the layers below it where they have a shape of their own, without their points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescribedShape {
    /// Cells between heights; `None` for a triangle mesh.
    pub cells: Option<Cells>,
    /// The surface.
    pub top: DescribedSurface,
    /// The bottoms of the layers, from above.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub below: Vec<Option<DescribedSurface>>,
}

/// A surface without its points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescribedSurface {
    /// Samples along x and y; `None` for a triangle mesh.
    pub size: Option<[usize; 2]>,
    /// Length units per sample along x and y; `None` for a triangle mesh.
    pub spacing: Option<[f64; 2]>,
    /// Border.
    pub border: Border,
    /// `true` if all heights are equal.
    pub is_level: bool,
    /// Hash of its heights, spline coefficients or corners.
    pub points: String,
}

impl DescribedShape {
    /// Describes a shape, whose points are all read once.
    #[must_use]
    pub fn of(shape: &Shape) -> Self {
        fn with_bottoms<G>(
            (top, below): (&Arc<G>, &[Option<Arc<G>>]),
            of: impl Fn(&G) -> DescribedSurface,
        ) -> (DescribedSurface, Vec<Option<DescribedSurface>>) {
            let bottoms = below.iter().map(|bottom| Some(of(bottom.as_ref()?)));
            (of(top), bottoms.collect())
        }
        let (top, below) = match shape {
            Shape::HeightField { top, below } => {
                with_bottoms((top, below), |surface| of_heights(surface.field()))
            }
            Shape::Smooth { top, below } => {
                with_bottoms((top, below), |surface| of_spline(surface.spline()))
            }
            Shape::TriangleMesh { top, below } => with_bottoms((top, below), of_mesh),
        };
        Self {
            cells: Cells::of(shape),
            top,
            below,
        }
    }
}

fn of_heights(field: &HeightField) -> DescribedSurface {
    let [ny, nx] = field.shape();
    DescribedSurface {
        size: Some([nx, ny]),
        spacing: Some(field.spacing()),
        border: field.border(),
        is_level: field.is_flat(),
        points: heights_hash(field),
    }
}

fn of_spline(spline: &SplineSurface) -> DescribedSurface {
    let [ny, nx] = spline.shape();
    DescribedSurface {
        size: Some([nx, ny]),
        spacing: Some(spline.spacing()),
        border: spline.border(),
        is_level: spline.samples().is_flat(),
        points: hash(spline.coefficients().iter().copied()),
    }
}

fn of_mesh(mesh: &MeshSurface) -> DescribedSurface {
    DescribedSurface {
        size: None,
        spacing: None,
        border: mesh.border(),
        is_level: mesh.size()[2] == 0.0,
        points: corners_hash(mesh),
    }
}

/// Hash of the heights of a field.
#[must_use]
pub fn heights_hash(field: &HeightField) -> String {
    hash(field.heights().iter().copied())
}

/// Hash of the corners of all triangles of a mesh.
#[must_use]
pub fn corners_hash(mesh: &MeshSurface) -> String {
    let corners = (0..mesh.facet_count()).flat_map(|i| mesh.corners(mesh.facet(i)));
    hash(corners.flat_map(|corner| corner.to_array()))
}

fn hash(numbers: impl Iterator<Item = f64>) -> String {
    format!("{:016x}", hash_numbers(numbers))
}
