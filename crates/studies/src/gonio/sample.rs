//! A given surface, from a file or flat.

use asperity_analysis::fnv1a;
use asperity_simulate::Shape;
use asperity_surface::HeightField;
use asperity_tracer::{Geometry, MeshSurface};
use serde_json::{Value, json};

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
        let bytes: Vec<u8> = field
            .heights()
            .iter()
            .flat_map(|h| h.to_le_bytes())
            .collect();
        let description = json!({
            "name": name,
            "shape": field.shape(),
            "spacing": field.spacing(),
            "unit": field.unit(),
            "border": field.border(),
            "reading": reading,
            "heights": format!("{:016x}", fnv1a(&bytes)),
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
        let corners = (0..mesh.facet_count()).flat_map(|i| mesh.corners(mesh.facet(i)));
        let bytes: Vec<u8> = corners
            .flat_map(|corner| corner.to_array())
            .flat_map(f64::to_le_bytes)
            .collect();
        let description = json!({
            "name": name,
            "vertices": mesh.vertex_count(),
            "triangles": mesh.facet_count(),
            "extent": mesh.size(),
            "border": mesh.border(),
            "corners": format!("{:016x}", fnv1a(&bytes)),
        });
        Self {
            shape: Shape::triangle_mesh(mesh),
            name,
            description,
            warnings,
        }
    }
}
