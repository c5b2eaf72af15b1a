//! Given surfaces: height maps, triangle meshes and the flat surface, with what is to be said about them.

use std::path::{Path, PathBuf};

use asperity_io::SurfaceFormat;
use asperity_studies::MeasuredConfig;
use asperity_studies::settings::Command;
use asperity_surface::{Border, HeightField, Roughness};
use asperity_tracer::{Geometry, MeshSurface};

use crate::common::Common;
use crate::failure::Failure;
use crate::input::{name_of, read_mesh_surface, read_surface};

/// A given surface.
pub(crate) struct GivenSurface {
    pub(crate) shape: GivenShape,
    pub(crate) name: String,
    /// The file; `None` for the flat surface.
    pub(crate) file: Option<PathBuf>,
    /// Missing points that were filled.
    pub(crate) filled: usize,
    /// What a reader of the results should know about how the file was read.
    pub(crate) notes: Vec<String>,
}

/// The geometry of a given surface.
pub(crate) enum GivenShape {
    Field(HeightField),
    Mesh(MeshSurface),
}

impl GivenShape {
    /// The same as it is simulated.
    pub(crate) fn simulated(self) -> asperity_simulate::Shape {
        match self {
            Self::Field(field) => asperity_simulate::Shape::height_field(field),
            Self::Mesh(mesh) => asperity_simulate::Shape::triangle_mesh(mesh),
        }
    }
}

impl GivenSurface {
    /// The surface of a configuration, which `command` needs.
    pub(crate) fn required(
        measured: &MeasuredConfig,
        command: Command,
        common: &Common,
    ) -> Result<Self, Failure> {
        Self::of(measured, common)?
            .ok_or_else(|| Failure::usage(format!("{command} needs a surface: FILE or --flat")))
    }

    /// The surface of a configuration, if it has one.
    pub(crate) fn of(measured: &MeasuredConfig, common: &Common) -> Result<Option<Self>, Failure> {
        match &measured.file {
            Some(path) => Self::read(path, measured, common).map(Some),
            None if measured.flat => Self::flat().map(Some),
            None => Ok(None),
        }
    }

    /// Reads a surface from a file.
    pub(crate) fn read(
        path: &Path,
        measured: &MeasuredConfig,
        common: &Common,
    ) -> Result<Self, Failure> {
        let (shape, filled, notes) =
            match SurfaceFormat::from_path(path).map_err(Failure::failed)? {
                SurfaceFormat::Mesh(_) => {
                    let mesh = read_mesh_surface(path, measured, common)?;
                    (GivenShape::Mesh(mesh), 0, Vec::new())
                }
                SurfaceFormat::HeightMap(_) => {
                    let input = read_surface(path, measured, common)?;
                    (GivenShape::Field(input.field), input.filled, input.notes)
                }
            };
        Ok(Self {
            shape,
            name: name_of(path),
            file: Some(path.to_owned()),
            filled,
            notes,
        })
    }

    /// One flat periodic cell.
    fn flat() -> Result<Self, Failure> {
        let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).map_err(Failure::failed)?;
        Ok(Self {
            shape: GivenShape::Field(field),
            name: "flat surface".to_owned(),
            file: None,
            filled: 0,
            notes: Vec::new(),
        })
    }

    /// Lengths of the tile along x and y.
    pub(crate) fn extent(&self) -> [f64; 2] {
        match &self.shape {
            GivenShape::Field(field) => field.extent(),
            GivenShape::Mesh(mesh) => {
                let [x, y, _] = mesh.size();
                [x, y]
            }
        }
    }

    /// What a reader of the results should know about the surface.
    pub(crate) fn warnings(&self) -> Vec<String> {
        match &self.shape {
            GivenShape::Field(field) => field_warnings(field, self.notes.clone()),
            GivenShape::Mesh(mesh) => mesh_warnings(mesh),
        }
    }
}

/// Slope above which the steepest facet is reported.
const STEEP: f64 = 50.0;

/// What a reader of the results should know about the surface.
fn field_warnings(field: &HeightField, mut warnings: Vec<String>) -> Vec<String> {
    let steepest = Roughness::of(field).steepest;
    if steepest.slope > STEEP {
        warnings.push(format!(
            "the steepest facet stands at {:.2} deg: are heights and spacing in the same unit?",
            steepest.angle_degrees
        ));
    }
    warnings.extend(border_warning(field.border()));
    warnings.push(ONE_SURFACE.to_owned());
    warnings
}

/// What a reader of the results should know about the mesh.
fn mesh_warnings(mesh: &MeshSurface) -> Vec<String> {
    let repairs = mesh.repairs();
    let mut warnings = Vec::new();
    if repairs.turned_over {
        warnings.push(
            "the mesh faced away from +z (or inwards, being closed) and was turned over".to_owned(),
        );
    }
    if repairs.dropped > 0 {
        warnings.push(format!(
            "{} triangles without area were left out",
            repairs.dropped
        ));
    }
    // Under other borders than an open one such meshes are refused.
    if repairs.closed {
        warnings.push(
            "the mesh is closed: paths below it hit nothing and count as truncated".to_owned(),
        );
    }
    if repairs.open_edges > 0 {
        warnings.push(format!(
            "{} edges inside the tile have one triangle only: paths that pass them count as truncated",
            repairs.open_edges
        ));
    }
    warnings.extend(border_warning(mesh.border()));
    warnings.push(ONE_SURFACE.to_owned());
    warnings
}

const ONE_SURFACE: &str =
    "one surface: errors hold for this surface, not for the ensemble it may come from";

fn border_warning(border: Border) -> Option<String> {
    (border == Border::Open).then(|| {
        "the patch is open: paths that leave it sideways count as truncated, and grazing light sees it too bright"
            .to_owned()
    })
}
