//! Shape: a surface of any kind, with the bottoms below it, as an engine is given it.

use std::sync::Arc;

use asperity_optics::{BottomSurface, Layer};
use asperity_surface::{Border, HeightField, SplineSurface};

use super::Geometry;
use super::height_field::Surface;
use super::mesh::MeshSurface;
use super::smooth::SmoothSurface;

/// The shape of a surface, and of the bottoms of the layers below it, from above, where they have a shape of their own.
///
/// A clone shares the memory of the original. Shapes are equal if they are one in memory.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Heights on a grid, two triangles per cell.
    HeightField {
        /// The surface.
        top: Arc<Surface>,
        /// The bottoms of the layers.
        below: Vec<Option<Arc<Surface>>>,
    },
    /// A bicubic B-spline.
    Smooth {
        /// The surface.
        top: Arc<SmoothSurface>,
        /// The bottoms of the layers.
        below: Vec<Option<Arc<SmoothSurface>>>,
    },
    /// Triangles, also with overhangs.
    TriangleMesh {
        /// The surface.
        top: Arc<MeshSurface>,
        /// The bottoms of the layers.
        below: Vec<Option<Arc<MeshSurface>>>,
    },
}

impl Shape {
    /// Heights on a grid, two triangles per cell.
    #[must_use]
    pub fn height_field(field: HeightField) -> Self {
        Self::HeightField {
            top: Arc::new(Surface::new(field)),
            below: Vec::new(),
        }
    }

    /// A bicubic B-spline.
    #[must_use]
    pub fn smooth(spline: SplineSurface) -> Self {
        Self::Smooth {
            top: Arc::new(SmoothSurface::new(spline)),
            below: Vec::new(),
        }
    }

    /// Triangles.
    #[must_use]
    pub fn triangle_mesh(mesh: MeshSurface) -> Self {
        Self::TriangleMesh {
            top: Arc::new(mesh),
            below: Vec::new(),
        }
    }

    /// This shape with `bottom` as the shape of the bottom of layer number `layer`; `None` if they are not of one kind.
    #[must_use]
    pub fn over(self, layer: usize, bottom: Self) -> Option<Self> {
        fn put<G>(
            mut below: Vec<Option<Arc<G>>>,
            layer: usize,
            bottom: Arc<G>,
        ) -> Vec<Option<Arc<G>>> {
            below.resize(below.len().max(layer + 1), None);
            below[layer] = Some(bottom);
            below
        }
        match (self, bottom) {
            (Self::HeightField { top, below }, Self::HeightField { top: bottom, .. }) => {
                let below = put(below, layer, bottom);
                Some(Self::HeightField { top, below })
            }
            (Self::Smooth { top, below }, Self::Smooth { top: bottom, .. }) => {
                let below = put(below, layer, bottom);
                Some(Self::Smooth { top, below })
            }
            (Self::TriangleMesh { top, below }, Self::TriangleMesh { top: bottom, .. }) => {
                let below = put(below, layer, bottom);
                Some(Self::TriangleMesh { top, below })
            }
            _ => None,
        }
    }

    /// This shape with the layers below it turned over, by a mirror at the horizontal plane: light that fell on the lowest bottom from
    /// below falls on the surface from above. All bottoms have a shape of their own there, but for planes.
    #[must_use]
    pub fn turned_over(&self, layers: &[Layer]) -> Self {
        match self {
            Self::HeightField { top, below } => {
                let (top, below) = turned_over(top, below, layers, Surface::scaled);
                Self::HeightField { top, below }
            }
            Self::Smooth { top, below } => {
                let (top, below) = turned_over(top, below, layers, SmoothSurface::scaled);
                Self::Smooth { top, below }
            }
            Self::TriangleMesh { top, below } => {
                let (top, below) = turned_over(top, below, layers, MeshSurface::scaled);
                Self::TriangleMesh { top, below }
            }
        }
    }

    /// Number of surfaces with points of their own.
    #[must_use]
    pub fn surfaces(&self) -> usize {
        1 + match self {
            Self::HeightField { below, .. } => below.iter().flatten().count(),
            Self::Smooth { below, .. } => below.iter().flatten().count(),
            Self::TriangleMesh { below, .. } => below.iter().flatten().count(),
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
        fn same<T>(tops: [&Arc<T>; 2], below: [&Vec<Option<Arc<T>>>; 2]) -> bool {
            let [a, b] = tops;
            let [c, d] = below.map(|bottoms| {
                let bottoms = bottoms.iter();
                let pointers = bottoms.map(|bottom| bottom.as_ref().map(Arc::as_ptr));
                pointers.collect::<Vec<_>>()
            });
            Arc::ptr_eq(a, b) && c == d
        }
        match (self, other) {
            (Self::HeightField { top: a, below: c }, Self::HeightField { top: b, below: d }) => {
                same([a, b], [c, d])
            }
            (Self::Smooth { top: a, below: c }, Self::Smooth { top: b, below: d }) => {
                same([a, b], [c, d])
            }
            (Self::TriangleMesh { top: a, below: c }, Self::TriangleMesh { top: b, below: d }) => {
                same([a, b], [c, d])
            }
            _ => false,
        }
    }
}

/// Surface and bottoms, turned over. `scaled`: a surface whose heights are multiplied by a factor.
fn turned_over<G>(
    top: &Arc<G>,
    below: &[Option<Arc<G>>],
    layers: &[Layer],
    scaled: impl Fn(&G, f64) -> G,
) -> (Arc<G>, Vec<Option<Arc<G>>>) {
    let own = |number: usize| below.get(number).and_then(Option::as_ref);
    let is_same = |layer: &Layer| {
        let shape = layer.end().map(|slab| slab.shape);
        shape == Some(BottomSurface::Same)
    };
    let bottoms = layers.iter().enumerate();
    let bottoms = bottoms.map(|(number, layer)| own(number).or(is_same(layer).then_some(top)));
    let faces: Vec<Option<&Arc<G>>> = std::iter::once(Some(top)).chain(bottoms).collect();
    let mut turned: Vec<Option<Arc<G>>> = faces
        .into_iter()
        .rev()
        .map(|face| face.map(|face| Arc::new(scaled(face, -1.0))))
        .collect();
    let below = turned.split_off(1);
    let top = turned
        .pop()
        .flatten()
        .unwrap_or_else(|| Arc::new(scaled(top, 0.0)));
    (top, below)
}
