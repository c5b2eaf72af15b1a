//! A given surface, from a file or flat.

use asperity_simulate::Shape;
use asperity_surface::HeightField;
use asperity_tracer::{Geometry, MeshSurface};
use serde_json::{Value, json};

use crate::output::{corners_hash, heights_hash};

/// A given surface.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Its shape.
    pub shape: Shape,
    /// Its name, for titles.
    pub name: String,
    /// What it is, with a hash of its heights: results are those of another sample where this differs.
    pub description: Value,
    /// What a reader of the results should know about it.
    pub warnings: Vec<String>,
}

impl Sample {
    /// A height field; `reading` says how it was read.
    #[must_use]
    pub fn of_field(
        field: HeightField,
        name: String,
        reading: Value,
        warnings: Vec<String>,
    ) -> Self {
        let description = json!({
            "name": name,
            "shape": field.shape(),
            "spacing": field.spacing(),
            "unit": field.unit(),
            "border": field.border(),
            "reading": reading,
            "heights": heights_hash(&field),
        });
        Self {
            shape: Shape::height_field(field),
            name,
            description,
            warnings,
        }
    }

    /// A triangle mesh.
    #[must_use]
    pub fn of_mesh(mesh: MeshSurface, name: String, warnings: Vec<String>) -> Self {
        let description = json!({
            "name": name,
            "vertices": mesh.vertex_count(),
            "triangles": mesh.facet_count(),
            "extent": mesh.size(),
            "border": mesh.border(),
            "corners": corners_hash(&mesh),
        });
        Self {
            shape: Shape::triangle_mesh(mesh),
            name,
            description,
            warnings,
        }
    }
}
