//! Error: the reasons for which triangles are refused.

use asperity_surface::Border;

/// Error of triangles that form no surface on which light can be traced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshSurfaceError {
    /// No triangle with an area.
    #[error("none of {0} triangles has an area; at least one is needed")]
    NoTriangles(usize),
    /// More triangles than 31 bits can number.
    #[error("{0} triangles are too many; 2147483648 is the most")]
    TooManyTriangles(usize),
    /// A corner that does not exist.
    #[error(
        "triangle {triangle}, counted from zero, has the corners {corners:?}, but there are {vertices} vertices"
    )]
    NoSuchVertex {
        /// Number of the triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate that is not finite.
    #[error("vertex {vertex}, counted from zero, is at {position:?}; coordinates must be finite")]
    NotFinite {
        /// Number of the vertex.
        vertex: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// An extent beyond what can be scaled.
    #[error(
        "the mesh extends over {extent:?} along x, y and z; along x and y an extent is needed, and the longest must be from 1e-150 to 1e150"
    )]
    BadExtent {
        /// Extent along x, y and z.
        extent: [f64; 3],
    },
    /// Two triangles run along their common edge in the same direction.
    #[error(
        "the two triangles of the edge from {from:?} to {to:?} face opposite sides of the surface; all triangles must run counter-clockwise seen from the same side"
    )]
    Inconsistent {
        /// One end of the edge.
        from: [f64; 3],
        /// Its other end.
        to: [f64; 3],
    },
    /// More than two triangles share an edge.
    #[error(
        "{triangles} triangles share the edge from {from:?} to {to:?}; a surface has two at most on each edge"
    )]
    Branching {
        /// Number of triangles.
        triangles: usize,
        /// One end of the edge.
        from: [f64; 3],
        /// Its other end.
        to: [f64; 3],
    },
    /// Two triangles lie in each other.
    #[error(
        "triangles lie in each other at {place:?}, so that light between them would be reflected without end; they may meet at edges alone"
    )]
    Overlapping {
        /// A point of both.
        place: [f64; 3],
    },
    /// Opposite borders of a periodic tile differ.
    #[error(
        "the border must be periodic along {axis}, but the vertex at {place:?} has no counterpart on the opposite border"
    )]
    NotPeriodic {
        /// The axis along which the tile would repeat.
        axis: char,
        /// The vertex without counterpart.
        place: [f64; 3],
    },
    /// A tile that continues beyond its border, but whose mesh does not reach the border everywhere.
    #[error(
        "{edges} edges inside the tile, or without their like on its opposite border, have one triangle only, one of them from {from:?} to {to:?}; a {border} border needs a ground without gaps from rim to rim"
    )]
    Gaps {
        /// Number of edges.
        edges: usize,
        /// One end of one of them.
        from: [f64; 3],
        /// Its other end.
        to: [f64; 3],
        /// The requested border.
        border: Border,
    },
    /// A tile that continues beyond its border, but whose mesh does not separate above from below.
    #[error(
        "seen from above, the triangles cover the tile {layers} times, those that face down counted as negative; a {border} border needs a mesh that covers the tile exactly once"
    )]
    NotOneGround {
        /// Layers that face up, less those that face down: none for a closed body.
        layers: i64,
        /// The requested border.
        border: Border,
    },
}
