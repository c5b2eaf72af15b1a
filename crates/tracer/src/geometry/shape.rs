//! Shape: a surface of any kind, with the bottom below it, as an engine is given it.

use std::sync::Arc;

use asperity_surface::{Border, HeightField, SplineSurface};

use super::Geometry;
use super::height_field::Surface;
use super::mesh::MeshSurface;
use super::smooth::SmoothSurface;

/// The shape of a surface, and of the bottom of a layer below it where that has a shape of its own.
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
    /// Heights on a grid, two triangles per cell.
    #[must_use]
    pub fn height_field(field: HeightField) -> Self {
        Self::HeightField {
            top: Arc::new(Surface::new(field)),
            bottom: None,
        }
    }

    /// A bicubic B-spline.
    #[must_use]
    pub fn smooth(spline: SplineSurface) -> Self {
        Self::Smooth {
            top: Arc::new(SmoothSurface::new(spline)),
            bottom: None,
        }
    }

    /// Triangles.
    #[must_use]
    pub fn triangle_mesh(mesh: MeshSurface) -> Self {
        Self::TriangleMesh {
            top: Arc::new(mesh),
            bottom: None,
        }
    }

    /// This shape with `bottom` as the shape of the bottom of a layer; `None` if they are not of one kind.
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

    /// Returns `true` if the bottom has a shape of its own.
    #[must_use]
    pub const fn has_bottom(&self) -> bool {
        match self {
            Self::HeightField { bottom, .. } => bottom.is_some(),
            Self::Smooth { bottom, .. } => bottom.is_some(),
            Self::TriangleMesh { bottom, .. } => bottom.is_some(),
        }
    }

    /// Returns `true` if all heights of the surface are equal.
    #[must_use]
    pub fn is_level(&self) -> bool {
        match self {
            Self::HeightField { top, .. } => top.is_flat(),
            Self::Smooth { top, .. } => top.spline().samples().is_flat(),
            Self::TriangleMesh { top, .. } => top.size()[2] == 0.0,
        }
    }

    /// Continuation beyond the border of the tile.
    #[must_use]
    pub fn border(&self) -> Border {
        match self {
            Self::HeightField { top, .. } => top.border(),
            Self::Smooth { top, .. } => top.border(),
            Self::TriangleMesh { top, .. } => top.border(),
        }
    }
}

impl PartialEq for Shape {
    fn eq(&self, other: &Self) -> bool {
        fn same<T>([a, b]: [&Arc<T>; 2], below: [&Option<Arc<T>>; 2]) -> bool {
            let [c, d] = below.map(|bottom| bottom.as_ref().map(Arc::as_ptr));
            Arc::ptr_eq(a, b) && c == d
        }
        match (self, other) {
            (Self::HeightField { top: a, bottom: c }, Self::HeightField { top: b, bottom: d }) => {
                same([a, b], [c, d])
            }
            (Self::Smooth { top: a, bottom: c }, Self::Smooth { top: b, bottom: d }) => {
                same([a, b], [c, d])
            }
            (
                Self::TriangleMesh { top: a, bottom: c },
                Self::TriangleMesh { top: b, bottom: d },
            ) => same([a, b], [c, d]),
            _ => false,
        }
    }
}
