//! Where the surface of a case comes from.

use std::borrow::Cow;
use std::sync::Arc;

use asperity_surface::{HeightField, SplineSurface};
use asperity_tracer::{MeshSurface, SmoothSurface, Surface};
use serde::{Deserialize, Serialize};

use super::cells::Cells;
use super::described_shape::DescribedShape;
use super::limits::{check_memory, smooth_bytes};
use super::random_surfaces::RandomSurfaces;
use crate::error::SimulateError;

/// Where the surface of a case comes from.
///
/// Cases whose sources are equal share their surfaces: each surface is drawn, or prepared, once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "SavedSource", from = "SavedSource")]
pub enum SurfaceSource {
    /// Random surfaces, drawn by a recipe. The result is a mean over them.
    Random(Box<RandomSurfaces>),
    /// One surface. The result is that of this surface alone.
    Given(Shape),
    /// A surface that was given to the run whose results were read from a file, which does not hold its points. It cannot be traced.
    Described(Box<DescribedShape>),
}

/// A source as it is written.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SavedSource {
    Random(Box<RandomSurfaces>),
    Given(Box<DescribedShape>),
}

impl From<SurfaceSource> for SavedSource {
    fn from(source: SurfaceSource) -> Self {
        match source {
            SurfaceSource::Random(surfaces) => Self::Random(surfaces),
            SurfaceSource::Given(shape) => Self::Given(Box::new(DescribedShape::of(&shape))),
            SurfaceSource::Described(shape) => Self::Given(shape),
        }
    }
}

impl From<SavedSource> for SurfaceSource {
    fn from(saved: SavedSource) -> Self {
        match saved {
            SavedSource::Random(surfaces) => Self::Random(surfaces),
            SavedSource::Given(shape) => Self::Described(shape),
        }
    }
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
            Self::Given(shape) => shape.cells(),
            Self::Described(shape) => shape.cells,
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
            Self::Described(shape) => shape.top.is_level,
        }
    }

    /// The heights of a given surface; `None` for random surfaces, for one that is only described, and for a triangle mesh.
    #[must_use]
    pub fn heights(&self) -> Option<Cow<'_, HeightField>> {
        match self {
            Self::Random(_) | Self::Described(_) | Self::Given(Shape::TriangleMesh { .. }) => None,
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
            Self::Described(shape) => return shape.top.size,
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
            Self::Described(shape) => shape.top.spacing,
        }
    }

    /// Without the points of a given surface, which then cannot be traced.
    #[must_use]
    pub fn described(&self) -> Self {
        match self {
            Self::Given(shape) => Self::Described(Box::new(DescribedShape::of(shape))),
            described => described.clone(),
        }
    }
}

/// The shape of a given surface, and of the bottom of a layer below it where that has a shape of its own.
///
/// A clone shares the memory of the original. Shapes are equal if they are one in memory.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Heights on a grid, two triangles per cell.
    HeightField {
        /// The surface.
        top: Arc<Surface>,
        /// The bottom of the layer.
        bottom: Option<Arc<Surface>>,
    },
    /// A bicubic B-spline.
    Smooth {
        /// The surface.
        top: Arc<SmoothSurface>,
        /// The bottom of the layer.
        bottom: Option<Arc<SmoothSurface>>,
    },
    /// Triangles, also with overhangs.
    TriangleMesh {
        /// The surface.
        top: Arc<MeshSurface>,
        /// The bottom of the layer.
        bottom: Option<Arc<MeshSurface>>,
    },
}

impl Shape {
    /// What lies between heights; `None` for a triangle mesh.
    #[must_use]
    pub const fn cells(&self) -> Option<Cells> {
        match self {
            Self::HeightField { .. } => Some(Cells::Flat),
            Self::Smooth { .. } => Some(Cells::Smooth),
            Self::TriangleMesh { .. } => None,
        }
    }

    /// Heights on a grid, two triangles per cell.
    #[must_use]
    pub fn height_field(field: HeightField) -> Self {
        Self::HeightField {
            top: Arc::new(Surface::new(field)),
            bottom: None,
        }
    }

    /// Heights on a grid, and the bicubic B-spline through them.
    ///
    /// # Errors
    /// [`SimulateError::NotEnoughMemory`].
    pub fn smooth(field: &HeightField) -> Result<Self, SimulateError> {
        check_memory(
            "a smooth surface of these heights",
            smooth_bytes(field.shape()),
        )?;
        let spline = SplineSurface::through(field);
        Ok(Self::Smooth {
            top: Arc::new(SmoothSurface::new(spline)),
            bottom: None,
        })
    }

    /// Triangles.
    #[must_use]
    pub fn triangle_mesh(mesh: MeshSurface) -> Self {
        Self::TriangleMesh {
            top: Arc::new(mesh),
            bottom: None,
        }
    }

    /// The same with `bottom` as the shape of the bottom of a layer; `None` if they are not of one kind.
    #[must_use]
    pub fn over(self, bottom: Self) -> Option<Self> {
        match (self, bottom) {
            (Self::HeightField { top, .. }, Self::HeightField { top: bottom, .. }) => {
                let bottom = Some(bottom);
                Some(Self::HeightField { top, bottom })
            }
            (Self::Smooth { top, .. }, Self::Smooth { top: bottom, .. }) => {
                let bottom = Some(bottom);
                Some(Self::Smooth { top, bottom })
            }
            (Self::TriangleMesh { top, .. }, Self::TriangleMesh { top: bottom, .. }) => {
                let bottom = Some(bottom);
                Some(Self::TriangleMesh { top, bottom })
            }
            _ => None,
        }
    }
}

impl PartialEq for Shape {
    fn eq(&self, other: &Self) -> bool {
        fn same<T>(a: &Arc<T>, b: &Arc<T>) -> bool {
            Arc::ptr_eq(a, b)
        }
        fn same_bottom<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
            match (a, b) {
                (Some(a), Some(b)) => same(a, b),
                (None, None) => true,
                _ => false,
            }
        }
        match (self, other) {
            (Self::HeightField { top: a, bottom: c }, Self::HeightField { top: b, bottom: d }) => {
                same(a, b) && same_bottom(c.as_ref(), d.as_ref())
            }
            (Self::Smooth { top: a, bottom: c }, Self::Smooth { top: b, bottom: d }) => {
                same(a, b) && same_bottom(c.as_ref(), d.as_ref())
            }
            (
                Self::TriangleMesh { top: a, bottom: c },
                Self::TriangleMesh { top: b, bottom: d },
            ) => same(a, b) && same_bottom(c.as_ref(), d.as_ref()),
            _ => false,
        }
    }
}
