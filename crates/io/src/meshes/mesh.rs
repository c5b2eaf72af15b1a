//! Triangle meshes: owned as read, borrowed for writing.

/// A triangle mesh as a file holds it.
///
/// None of the formats says in which unit its lengths are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Positions `[x, y, z]`, finite, each different from all others.
    pub vertices: Vec<[f64; 3]>,
    /// Three indices into `vertices` each, in the order of the file; one triangle at least.
    pub triangles: Vec<[u32; 3]>,
}

/// A borrowed triangle mesh.
///
/// Triangles run counter-clockwise as seen from +z, so that their normals point upwards; which is not
/// checked.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    /// Positions `[x, y, z]` in length units.
    pub vertices: &'a [[f64; 3]],
    /// Three indices into `vertices` each.
    pub triangles: &'a [[u32; 3]],
    /// One line of ASCII about the mesh, for the head of the file; empty for none. STL keeps its first 75 characters.
    pub comment: &'a str,
}
