//! Given surfaces as a measurement takes them.

use asperity_simulate::{Cells, Shape, corners_hash, heights_hash};
use asperity_surface::{HeightField, LengthUnit};
use asperity_synthesis::Provenance;
use asperity_tracer::{Geometry, MeshSurface};
use serde_json::{Value, json};

use crate::config::measured::MeasuredConfig;
use crate::config::medium::MediumConfig;
use crate::given::{GivenError, GivenShape, GivenSurface, GivenSurfaces};
use crate::surface_lengths::SurfaceLengths;

/// Given surfaces.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Their shapes.
    pub shapes: Vec<Shape>,
    /// Their names, for titles.
    pub name: String,
    /// `true` if y points north in them, as far as they have compass directions.
    pub y_is_north: bool,
    /// Unit of their lengths.
    pub unit: LengthUnit,
    /// Their description, with a hash of the heights of each: results are those of another sample where this differs.
    pub description: Value,
    /// The shortest of their lengths, to be compared with the wavelength; `None` where their unit is not known.
    pub lengths: Option<SurfaceLengths>,
    /// Those of the bottom of the lowest layer, where a file gives it.
    pub of_bottom: Option<SurfaceLengths>,
    /// Notes on them, one sentence each.
    pub warnings: Vec<String>,
}

impl Sample {
    /// Surfaces that were read as `reading` says, with these `cells` between heights, over the layers of `medium`; `bottom` is the
    /// shape of the lowest face, where a file gives it.
    ///
    /// # Errors
    /// [`GivenError`] if smooth cells are requested of a mesh or exceed the memory, or surface and bottom are of two kinds.
    pub fn of(
        surfaces: GivenSurfaces,
        bottom: Option<GivenSurface>,
        medium: Option<&MediumConfig>,
        reading: &MeasuredConfig,
        cells: Cells,
    ) -> Result<Self, GivenError> {
        let below = bottom.as_ref().map(|bottom| description(bottom, reading));
        let lowest = medium.map_or(0, MediumConfig::lowest);
        let is_known = SurfaceLengths::are_comparable(surfaces.first.unit);
        Ok(Self {
            name: surfaces.name(),
            y_is_north: surfaces.first.y_is_north,
            unit: surfaces.first.unit,
            description: surfaces.described(|surface| {
                let mut described = description(surface, reading);
                if let Some(below) = &below {
                    described["bottom"] = below.clone();
                }
                described
            }),
            lengths: is_known.then(|| surfaces.lengths()),
            of_bottom: bottom
                .as_ref()
                .filter(|_| is_known)
                .map(GivenSurface::lengths),
            warnings: match surfaces.first.file {
                Some(_) => surfaces.warnings(),
                None => Vec::new(),
            },
            shapes: surfaces.simulated(bottom, lowest, cells)?,
        })
    }
}

fn description(surface: &GivenSurface, reading: &MeasuredConfig) -> Value {
    match &surface.shape {
        GivenShape::Field(field) => {
            let read = surface.file.as_ref().map(|_| {
                let mut read = json!({
                    "points_filled": surface.filled,
                    "generated": Provenance::of(field.provenance()),
                });
                reading.describe_filtering(&mut read);
                read
            });
            field_description(field, &surface.name, read)
        }
        GivenShape::Mesh(mesh) => mesh_description(mesh, &surface.name, surface.unit),
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
