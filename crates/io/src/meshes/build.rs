//! Mesh builder: joins vertices, cuts polygons and strips into triangles, refuses invalid meshes.

use std::collections::HashMap;

use super::mesh::MeshData;
use super::polygon;
use crate::error::ReadProblem;
use crate::text_lines::{Line, short};

/// A mesh that grows while its file is read.
#[derive(Default)]
pub(super) struct Builder {
    /// Number of each vertex of the file in `mesh`.
    numbers: Vec<u32>,
    /// Number of the vertex at these coordinates.
    known: HashMap<[u64; 3], u32>,
    mesh: MeshData,
}

impl Builder {
    /// Vertices of the file so far.
    pub(super) fn vertices(&self) -> usize {
        self.numbers.len()
    }

    /// Adds the next vertex; an error says what is wrong with it.
    pub(super) fn vertex(&mut self, vertex: [f64; 3]) -> Result<(), String> {
        let number = self.join(vertex)?;
        self.numbers.push(number);
        Ok(())
    }

    /// The number of the vertex at these coordinates, a new one if there is none yet.
    fn join(&mut self, vertex: [f64; 3]) -> Result<u32, String> {
        if vertex.iter().any(|x| !x.is_finite()) {
            return Err(format!("{vertex:?}, but coordinates must be finite"));
        }
        // Adding zero makes -0 the same place as +0.
        let vertex = vertex.map(|x| x + 0.0);
        let next = self.mesh.vertices.len();
        let number = *self
            .known
            .entry(vertex.map(f64::to_bits))
            .or_insert(u32::try_from(next).map_err(|_| "one vertex more than 2^32".to_owned())?);
        if number as usize == next {
            self.mesh.vertices.push(vertex);
        }
        Ok(number)
    }

    /// Adds a polygon of vertices of the file, as triangles.
    ///
    /// An error says what is wrong: too few corners, corners that do not exist, or an outline that crosses itself.
    pub(super) fn polygon(&mut self, corners: &[i64]) -> Result<(), String> {
        match corners.len() {
            0 => return Err("no corners, at least 3 are needed".to_owned()),
            count @ (1 | 2) => return Err(format!("{count} corners, at least 3 are needed")),
            _ => {}
        }
        let numbers = corners.iter().map(|corner| self.number(*corner));
        let numbers = numbers.collect::<Result<Vec<u32>, _>>()?;
        let place = |k: &u32| self.mesh.vertices[*k as usize];
        let places: Vec<[f64; 3]> = numbers.iter().map(place).collect();
        let triangles = polygon::triangles(&places)?;
        let named = triangles.iter().map(|t| t.map(|k| numbers[k]));
        self.mesh.triangles.extend(named);
        Ok(())
    }

    /// Adds strips of triangles, each of one vertex and the two before it; -1 parts strips.
    ///
    /// An error says what is wrong: corners that do not exist.
    pub(super) fn strips(&mut self, corners: &[i64]) -> Result<(), String> {
        for strip in corners.split(|corner| *corner == -1) {
            let numbers = strip.iter().map(|corner| self.number(*corner));
            let numbers = numbers.collect::<Result<Vec<u32>, _>>()?;
            for (i, three) in numbers.windows(3).enumerate() {
                let [a, b, c] = [three[0], three[1], three[2]];
                // Every other triangle runs the other way; one with a corner twice moves the strip elsewhere.
                let triangle = if i % 2 == 0 { [a, b, c] } else { [b, a, c] };
                if a != b && b != c && c != a {
                    self.mesh.triangles.push(triangle);
                }
            }
        }
        Ok(())
    }

    /// The number in the mesh of a vertex of the file.
    fn number(&self, corner: i64) -> Result<u32, String> {
        let number = usize::try_from(corner).ok();
        let number = number.and_then(|k| self.numbers.get(k));
        number.copied().ok_or_else(|| {
            format!(
                "the vertex number {corner}, counted from zero, but there are {} vertices",
                self.numbers.len()
            )
        })
    }

    /// Adds a triangle given by the coordinates of its corners.
    pub(super) fn triangle(&mut self, corners: [[f64; 3]; 3]) -> Result<(), String> {
        let [a, b, c] = corners;
        let triangle = [self.join(a)?, self.join(b)?, self.join(c)?];
        self.mesh.triangles.push(triangle);
        Ok(())
    }

    pub(super) fn finish(self) -> Result<MeshData, ReadProblem> {
        if self.mesh.triangles.is_empty() {
            return Err(ReadProblem::malformed(
                "it holds no faces, but at least one triangle is needed",
            ));
        }
        Ok(self.mesh)
    }
}

/// Three coordinates from `words` of a line, of which more may follow.
pub(super) fn coordinates<'a>(
    line: Line<'a>,
    words: &mut impl Iterator<Item = &'a str>,
) -> Result<[f64; 3], ReadProblem> {
    let mut vertex = [0.0_f64; 3];
    for (i, x) in vertex.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| {
            let what = format_args!("this vertex has {i} coordinates, but 3 are needed");
            line.refuse(line.text, what)
        })?;
        *x = word.parse().map_err(|_| {
            line.refuse(
                word,
                format_args!("`{}` is not a number; coordinates are needed", short(word)),
            )
        })?;
        if !x.is_finite() {
            let what = format_args!("`{}` is not finite; coordinates must be", short(word));
            return Err(line.refuse(word, what));
        }
    }
    Ok(vertex)
}
