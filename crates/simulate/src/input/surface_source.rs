//! Where the surface of a case comes from.

use std::borrow::Cow;

use asperity_surface::{HeightField, SplineSurface};
use asperity_tracer::{MeshSurface, Shape};

use super::cells::Cells;
use super::limits::{check_memory, smooth_bytes};
use super::random_surfaces::RandomSurfaces;
use crate::error::SimulateError;

/// Where the surface of a case comes from.
///
/// Cases whose sources are equal share their surfaces: each surface is drawn, or prepared, once.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceSource {
    /// Random surfaces, drawn by a recipe. The result is a mean over them.
    Random(Box<RandomSurfaces>),
    /// One surface. The result is that of this surface alone.
    Given(Shape),
}

impl SurfaceSource {
    /// Random surfaces of a [`Synthesis`](asperity_surface::Synthesis), of flat cells, or of a
    /// [`SplineSynthesis`](asperity_surface::SplineSynthesis), of smooth ones.
    #[must_use]
    pub fn random(surfaces: impl Into<RandomSurfaces>) -> Self {
        Self::Random(Box::new(surfaces.into()))
    }

    /// A surface given by its heights.
    #[must_use]
    pub fn height_field(field: HeightField) -> Self {
        Self::Given(Shape::height_field(field))
    }

    /// A surface given by its triangles.
    #[must_use]
    pub fn triangle_mesh(mesh: MeshSurface) -> Self {
        Self::Given(Shape::triangle_mesh(mesh))
    }

    /// What lies between heights; `None` for a triangle mesh.
    #[must_use]
    pub const fn cells(&self) -> Option<Cells> {
        match self {
            Self::Random(surfaces) => Some(surfaces.cells()),
            Self::Given(Shape::HeightField { .. }) => Some(Cells::Flat),
            Self::Given(Shape::Smooth { .. }) => Some(Cells::Smooth),
            Self::Given(Shape::TriangleMesh { .. }) => None,
        }
    }

    /// Whether it is one given surface without any relief.
    #[must_use]
    pub fn is_level(&self) -> bool {
        match self {
            Self::Random(_) => false,
            Self::Given(Shape::HeightField { top, .. }) => top.is_flat(),
            Self::Given(Shape::Smooth { top, .. }) => top.spline().samples().is_flat(),
            Self::Given(Shape::TriangleMesh { top, .. }) => top.size()[2] == 0.0,
        }
    }

    /// The heights of a given surface; `None` for random surfaces and for a triangle mesh.
    #[must_use]
    pub fn heights(&self) -> Option<Cow<'_, HeightField>> {
        match self {
            Self::Random(_) | Self::Given(Shape::TriangleMesh { .. }) => None,
            Self::Given(Shape::HeightField { top, .. }) => Some(Cow::Borrowed(top.field())),
            Self::Given(Shape::Smooth { top, .. }) => Some(Cow::Owned(top.spline().samples())),
        }
    }

    /// Samples along x and y; `None` for a triangle mesh.
    #[must_use]
    pub fn size(&self) -> Option<[usize; 2]> {
        let [ny, nx] = match self {
            Self::Random(surfaces) => surfaces.shape(),
            Self::Given(Shape::HeightField { top, .. }) => top.field().shape(),
            Self::Given(Shape::Smooth { top, .. }) => top.spline().shape(),
            Self::Given(Shape::TriangleMesh { .. }) => return None,
        };
        Some([nx, ny])
    }

    /// Length units per sample along x and y; `None` for a triangle mesh.
    #[must_use]
    pub fn spacing(&self) -> Option<[f64; 2]> {
        match self {
            Self::Random(surfaces) => Some(surfaces.spacing()),
            Self::Given(Shape::HeightField { top, .. }) => Some(top.field().spacing()),
            Self::Given(Shape::Smooth { top, .. }) => Some(top.spline().spacing()),
            Self::Given(Shape::TriangleMesh { .. }) => None,
        }
    }
}

/// Heights on a grid, and the bicubic B-spline through them.
///
/// # Errors
/// [`SimulateError::NotEnoughMemory`].
pub fn smooth_shape(field: &HeightField) -> Result<Shape, SimulateError> {
    check_memory(
        "a smooth surface of these heights",
        smooth_bytes(field.shape()),
    )?;
    Ok(Shape::smooth(SplineSurface::through(field)))
}
