//! Export: the surface as a list of vertices and triangles.

use crate::geometry::height_field::Surface;

/// Error of a mesh that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// Vertices are numbered by 32 bits.
    #[error("a mesh of {vertices} vertices is too large; 4,294,967,295 is the most")]
    TooLarge {
        /// Number of vertices of the mesh.
        vertices: usize,
    },
}

/// Vertices and triangles of one tile in length units, as they are traced.
///
/// A periodic tile of `nx` by `ny` cells gets `nx + 1` by `ny + 1` vertices, the last column and row
/// repeating the heights of the first, so that copies of the mesh join without a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// `[x, y, z]` in length units, row by row.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex numbers, counter-clockwise seen from above; two triangles per cell, row by row.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// The mesh of one tile of `surface`.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if vertices cannot be numbered by 32 bits.
    pub fn new(surface: &Surface) -> Result<Self, MeshError> {
        let [cx, cy] = surface.cells();
        let [dx, dy] = surface.field().spacing();
        let count = (cx + 1) * (cy + 1);
        let columns = match u32::try_from(count) {
            Ok(_) => (cx + 1) as u32,
            Err(_) => return Err(MeshError::TooLarge { vertices: count }),
        };
        let vertices = (0..=cy)
            .flat_map(|iy| (0..=cx).map(move |ix| (ix, iy)))
            .map(|(ix, iy)| {
                [
                    ix as f64 * dx,
                    iy as f64 * dy,
                    surface.field().height(ix, iy),
                ]
            })
            .collect();
        let triangles = surface
            .facets()
            .map(|facet| {
                let corner = |i: u32, j: u32| (facet.iy + j) * columns + facet.ix + i;
                surface.corners_of(facet).map(|[i, j]| corner(i, j))
            })
            .collect();
        Ok(Self {
            vertices,
            triangles,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Geometry, Triangles};
    use asperity_surface::{Border, HeightField, TurnedCells};

    #[test]
    fn exported_triangles_are_those_that_are_traced() {
        let heights = vec![0.0, 1.0, 2.0, 0.5, -1.0, 0.25];
        for border in [Border::Periodic, Border::Open] {
            let field = HeightField::new(heights.clone(), [2, 3], [0.5, 2.0]).unwrap();
            let turned = TurnedCells::new([2, 3], |ix, _| ix == 1);
            let turned = Some(std::sync::Arc::new(turned));
            let surface = Surface::new(field.with_border(border).with_turned_cells(turned));
            let mesh = TriangleMesh::new(&surface).unwrap();
            assert_eq!(mesh.triangles.len(), surface.facet_count());
            for (facet, triangle) in surface.facets().zip(&mesh.triangles) {
                let p = triangle.map(|i| glam::DVec3::from(mesh.vertices[i as usize]));
                let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
                assert!((normal - surface.normal(facet)).length() < 1e-14);
            }
        }
    }
}
