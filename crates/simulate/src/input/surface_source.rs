//! Source of the surface of a case.

use std::borrow::Cow;

use asperity_surface::{HeightField, SplineSurface};
use asperity_synthesis::SurfaceRecipe;
use asperity_tracer::{MeshSurface, Shape};
use serde::{Deserialize, Serialize};

use super::cells::Cells;
use super::described_shape::DescribedShape;
use super::limits::{check_memory, smooth_bytes};
use super::random_surfaces::RandomSurfaces;
use crate::error::SimulateError;

/// Source of the surface of a case.
///
/// Cases whose sources are equal share their surfaces: each surface is drawn, or prepared, once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "SavedSource", from = "SavedSource")]
pub enum SurfaceSource {
    /// Random surfaces, drawn by a recipe. The result is a mean over them.
    Random(Box<RandomSurfaces>),
    /// One surface, whose result is that of this surface alone; or several, such as scans of one sample, whose result is their mean,
    /// with the errors that their scatter shows. All have the same kind of cells; sizes may differ.
    Given(Vec<Shape>),
    /// Surfaces that were given to the run whose results were read from a file, which does not hold their points. They cannot be traced.
    Described(Vec<DescribedShape>),
}

/// A source as it is written.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SavedSource {
    Random(Box<RandomSurfaces>),
    Given(Vec<DescribedShape>),
}

impl From<SurfaceSource> for SavedSource {
    fn from(source: SurfaceSource) -> Self {
        match source {
            SurfaceSource::Random(surfaces) => Self::Random(surfaces),
            SurfaceSource::Given(shapes) => {
                Self::Given(shapes.iter().map(DescribedShape::of).collect())
            }
            SurfaceSource::Described(shapes) => Self::Given(shapes),
        }
    }
}

impl From<SavedSource> for SurfaceSource {
    fn from(saved: SavedSource) -> Self {
        match saved {
            SavedSource::Random(surfaces) => Self::Random(surfaces),
            SavedSource::Given(shapes) => Self::Described(shapes),
        }
    }
}

impl SurfaceSource {
    /// Random surfaces of a [`Synthesis`](asperity_synthesis::Synthesis), of flat cells, or of a
    /// [`SplineSynthesis`](asperity_synthesis::SplineSynthesis), of smooth ones.
    #[must_use]
    pub fn random(surfaces: impl Into<RandomSurfaces>) -> Self {
        Self::Random(Box::new(surfaces.into()))
    }

    /// A surface given by its heights.
    #[must_use]
    pub fn height_field(field: HeightField) -> Self {
        Self::Given(vec![Shape::height_field(field)])
    }

    /// A surface given by its triangles.
    #[must_use]
    pub fn triangle_mesh(mesh: MeshSurface) -> Self {
        Self::Given(vec![Shape::triangle_mesh(mesh)])
    }

    /// Recipe of random surfaces; `None` for a given surface.
    #[must_use]
    pub const fn recipe(&self) -> Option<&SurfaceRecipe> {
        match self {
            Self::Random(surfaces) => Some(surfaces.recipe()),
            Self::Given(_) | Self::Described(_) => None,
        }
    }

    /// Given surfaces; none of random ones, or of described ones.
    #[must_use]
    pub fn shapes(&self) -> &[Shape] {
        match self {
            Self::Random(_) | Self::Described(_) => &[],
            Self::Given(shapes) => shapes,
        }
    }

    /// Cells between heights; `None` for triangle meshes.
    #[must_use]
    pub fn cells(&self) -> Option<Cells> {
        match self {
            Self::Random(surfaces) => Some(surfaces.cells()),
            Self::Given(shapes) => Cells::of(shapes.first()?),
            Self::Described(shapes) => shapes.first()?.cells,
        }
    }

    /// Returns `true` if surfaces are given and all heights are equal.
    #[must_use]
    pub fn is_level(&self) -> bool {
        match self {
            Self::Random(_) => false,
            Self::Given(shapes) => shapes.iter().all(Shape::is_level),
            Self::Described(shapes) => shapes.iter().all(|shape| shape.top.is_level),
        }
    }

    /// The heights of the first given surface; `None` for random surfaces and for triangle meshes.
    #[must_use]
    pub fn heights(&self) -> Option<Cow<'_, HeightField>> {
        match self.shapes().first()? {
            Shape::HeightField { top, .. } => Some(Cow::Borrowed(top.field())),
            Shape::Smooth { top, .. } => Some(Cow::Owned(top.spline().samples())),
            Shape::TriangleMesh { .. } => None,
        }
    }

    /// Samples along x and y, of the first of given surfaces; `None` for triangle meshes.
    #[must_use]
    pub fn size(&self) -> Option<[usize; 2]> {
        let ([ny, nx], _) = self.grid()?;
        Some([nx, ny])
    }

    /// Length units per sample along x and y, of the first of given surfaces; `None` for triangle meshes.
    #[must_use]
    pub fn spacing(&self) -> Option<[f64; 2]> {
        Some(self.grid()?.1)
    }

    fn grid(&self) -> Option<([usize; 2], [f64; 2])> {
        match self {
            Self::Random(surfaces) => Some((surfaces.shape(), surfaces.spacing())),
            Self::Given(shapes) => match shapes.first()? {
                Shape::HeightField { top, .. } => {
                    Some((top.field().shape(), top.field().spacing()))
                }
                Shape::Smooth { top, .. } => Some((top.spline().shape(), top.spline().spacing())),
                Shape::TriangleMesh { .. } => None,
            },
            Self::Described(shapes) => {
                let top = &shapes.first()?.top;
                let [nx, ny] = top.size?;
                Some(([ny, nx], top.spacing?))
            }
        }
    }

    /// A source without the points of a given surface, which then cannot be traced.
    #[must_use]
    pub fn described(&self) -> Self {
        match self {
            Self::Given(shapes) => Self::Described(shapes.iter().map(DescribedShape::of).collect()),
            described => described.clone(),
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
