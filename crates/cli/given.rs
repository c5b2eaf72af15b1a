//! Reading given surfaces: height maps, triangle meshes and the flat surface.

use std::path::Path;

use asperity_io::SurfaceFormat;
use asperity_studies::settings::Command;
use asperity_studies::{GivenShape, GivenSurface, MeasuredConfig};
use asperity_surface::HeightField;

use crate::common::Common;
use crate::failure::Failure;
use crate::input::{name_of, read_mesh_surface, read_surface};

/// Reads the surface of a configuration, which `command` needs.
pub(crate) fn required_surface(
    measured: &MeasuredConfig,
    command: Command,
    common: &Common,
) -> Result<GivenSurface, Failure> {
    given_surface(measured, common)?
        .ok_or_else(|| Failure::usage(format!("{command} needs a surface: FILE or --flat")))
}

/// Reads the surface of a configuration, if it has one.
pub(crate) fn given_surface(
    measured: &MeasuredConfig,
    common: &Common,
) -> Result<Option<GivenSurface>, Failure> {
    match &measured.file {
        Some(path) => read_given(path, measured, common).map(Some),
        None if measured.flat => flat_surface().map(Some),
        None => Ok(None),
    }
}

/// Reads a surface from a file.
pub(crate) fn read_given(
    path: &Path,
    measured: &MeasuredConfig,
    common: &Common,
) -> Result<GivenSurface, Failure> {
    let (shape, filled, notes) = match SurfaceFormat::from_path(path).map_err(Failure::failed)? {
        SurfaceFormat::Mesh(_) => {
            let mesh = read_mesh_surface(path, measured, common)?;
            (GivenShape::Mesh(mesh), 0, Vec::new())
        }
        SurfaceFormat::HeightMap(_) => {
            let input = read_surface(path, measured, common)?;
            (GivenShape::Field(input.field), input.filled, input.notes)
        }
    };
    Ok(GivenSurface {
        shape,
        name: name_of(path),
        file: Some(path.to_owned()),
        filled,
        notes,
    })
}

/// One flat periodic cell.
fn flat_surface() -> Result<GivenSurface, Failure> {
    let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).map_err(Failure::failed)?;
    Ok(GivenSurface {
        shape: GivenShape::Field(field),
        name: "flat surface".to_owned(),
        file: None,
        filled: 0,
        notes: Vec::new(),
    })
}
