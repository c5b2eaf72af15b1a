//! A given surface as a measurement takes it.

use asperity_simulate::{Cells, Shape, SimulateError, corners_hash, heights_hash};
use asperity_surface::{Form, HeightField, LengthUnit};
use asperity_tracer::{Geometry, MeshSurface};
use serde_json::{Value, json};

use crate::given::{GivenShape, GivenSurface};
use crate::surface_lengths::SurfaceLengths;

/// A given surface.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Its shape.
    pub shape: Shape,
    /// What is said of it.
    pub about: AboutSample,
}

/// What is said of a given surface.
#[derive(Clone, Debug)]
pub struct AboutSample {
    /// Its name, for titles.
    pub name: String,
    /// Unit of its lengths.
    pub unit: LengthUnit,
    /// What it is, with a hash of its heights: results are those of another sample where this differs.
    pub description: Value,
    /// Its lengths, to be compared with the wavelength.
    pub lengths: SurfaceLengths,
    /// What a reader of the results should know about it.
    pub warnings: Vec<String>,
}

impl Sample {
    /// A surface from which `form` was removed when it was read, with these `cells` between heights.
    ///
    /// # Errors
    /// As [`GivenShape::simulated`].
    pub fn of(surface: GivenSurface, form: Form, cells: Cells) -> Result<Self, SimulateError> {
        let warnings = match surface.file {
            Some(_) => surface.warnings(),
            None => Vec::new(),
        };
        let description = match &surface.shape {
            GivenShape::Field(field) => {
                let reading = surface.file.as_ref().map(|_| {
                    json!({
                        "points_filled": surface.filled,
                        "form_removed": form.to_string(),
                        "generated": field.provenance(),
                    })
                });
                field_description(field, &surface.name, reading)
            }
            GivenShape::Mesh(mesh) => mesh_description(mesh, &surface.name, surface.unit),
        };
        let lengths = surface.lengths();
        Ok(Self {
            shape: surface.shape.simulated(cells)?,
            about: AboutSample {
                name: surface.name,
                unit: surface.unit,
                description,
                lengths,
                warnings,
            },
        })
    }
}

/// A height field; `reading` says how its file was read.
fn field_description(field: &HeightField, name: &str, reading: Option<Value>) -> Value {
    json!({
        "name": name,
        "shape": field.shape(),
        "spacing": field.spacing(),
        "unit": field.unit(),
        "border": field.border(),
        "reading": reading,
        "heights": heights_hash(field),
    })
}

fn mesh_description(mesh: &MeshSurface, name: &str, unit: LengthUnit) -> Value {
    json!({
        "name": name,
        "vertices": mesh.vertex_count(),
        "triangles": mesh.facet_count(),
        "extent": mesh.size(),
        "unit": unit,
        "border": mesh.border(),
        "corners": corners_hash(mesh),
    })
}
