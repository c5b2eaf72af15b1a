//! Where the surface of a case comes from.

use std::sync::Arc;

use asperity_surface::{HeightField, Synthesis};
use asperity_tracer::{MeshSurface, Surface};

/// Where the surface of a case comes from.
///
/// Cases whose sources are equal share their surfaces: each surface is drawn, or prepared, once.
#[derive(Clone, Debug)]
pub enum SurfaceSource {
    /// Random surfaces, drawn by a recipe. The result is a mean over them.
    Random(Synthesis),
    /// One surface. The result is that of this surface alone.
    Given(Shape),
}

impl SurfaceSource {
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

    /// The heights of a given surface; `None` for random surfaces and for a triangle mesh.
    #[must_use]
    pub fn field(&self) -> Option<&HeightField> {
        match self {
            Self::Random(_) => None,
            Self::Given(shape) => shape.field(),
        }
    }

    /// Samples along x and y; `None` for a triangle mesh.
    #[must_use]
    pub fn size(&self) -> Option<[usize; 2]> {
        let [ny, nx] = match self {
            Self::Random(synthesis) => synthesis.shape(),
            Self::Given(shape) => shape.field()?.shape(),
        };
        Some([nx, ny])
    }

    /// Length units per sample along x and y; `None` for a triangle mesh.
    #[must_use]
    pub fn spacing(&self) -> Option<[f64; 2]> {
        match self {
            Self::Random(synthesis) => Some(synthesis.spacing()),
            Self::Given(shape) => Some(shape.field()?.spacing()),
        }
    }
}

/// Two recipes are equal if they draw the same surfaces.
impl PartialEq for SurfaceSource {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Random(a), Self::Random(b)) => {
                a.psd() == b.psd() && a.shape() == b.shape() && a.spacing() == b.spacing()
            }
            (Self::Given(a), Self::Given(b)) => a == b,
            _ => false,
        }
    }
}

/// The shape of a given surface, and of the bottom of a layer below it where that has a shape of its own.
///
/// A clone shares the memory of the original. Shapes are equal if they are one in memory.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Heights on a grid.
    HeightField {
        /// The surface.
        top: Arc<Surface>,
        /// The bottom of the layer.
        bottom: Option<Arc<Surface>>,
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
    /// Heights on a grid.
    #[must_use]
    pub fn height_field(field: HeightField) -> Self {
        Self::HeightField {
            top: Arc::new(Surface::new(field)),
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

    /// The same with `bottom` as the shape of the bottom of a layer; `None` if one is a height field and the
    /// other a triangle mesh.
    #[must_use]
    pub fn over(self, bottom: Self) -> Option<Self> {
        match (self, bottom) {
            (Self::HeightField { top, .. }, Self::HeightField { top: bottom, .. }) => {
                let bottom = Some(bottom);
                Some(Self::HeightField { top, bottom })
            }
            (Self::TriangleMesh { top, .. }, Self::TriangleMesh { top: bottom, .. }) => {
                let bottom = Some(bottom);
                Some(Self::TriangleMesh { top, bottom })
            }
            _ => None,
        }
    }

    /// The heights of the surface; `None` for a triangle mesh.
    #[must_use]
    pub fn field(&self) -> Option<&HeightField> {
        match self {
            Self::HeightField { top, .. } => Some(top.field()),
            Self::TriangleMesh { .. } => None,
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
            (
                Self::TriangleMesh { top: a, bottom: c },
                Self::TriangleMesh { top: b, bottom: d },
            ) => same(a, b) && same_bottom(c.as_ref(), d.as_ref()),
            _ => false,
        }
    }
}
