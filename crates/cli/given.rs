//! Reading given surfaces: height maps, triangle meshes and the flat surface.

use std::path::Path;

use asperity_io::SurfaceFormat;
use asperity_studies::settings::Document;
use asperity_studies::{GivenShape, GivenSurface, MeasuredConfig};
use asperity_surface::{HeightField, LengthUnit};
use serde::de::DeserializeOwned;

use crate::common::Common;
use crate::failure::Failure;
use crate::input::{Input, name_of, read_mesh_surface, read_surface};

/// The settings of `document` with lengths as numbers in the unit of that surface.
pub(crate) fn settings_for<T: DeserializeOwned>(
    document: &Document,
    surface: &GivenSurface,
) -> Result<T, Failure> {
    let document = document.clone().in_unit(surface.unit);
    document
        .and_then(|document| document.read())
        .map_err(Failure::usage)
}

/// Reads the bottom of a layer below `surface`, with lengths in the same unit.
pub(crate) fn read_bottom(
    path: &Path,
    measured: &MeasuredConfig,
    surface: &GivenSurface,
    common: &Common,
) -> Result<GivenSurface, Failure> {
    let physical = Some(surface.unit).filter(|unit| *unit != LengthUnit::Arbitrary);
    let measured = MeasuredConfig {
        unit: physical.or(measured.unit),
        ..measured.clone()
    };
    let bottom = read_given(path, &measured, common)?;
    if bottom.unit == surface.unit || surface.file.is_none() {
        return Ok(bottom);
    }
    Err(Failure::usage(format!(
        "{}: its lengths are in {}, but {} states no unit; say what its numbers are in with --assume-unit",
        path.display(),
        bottom.unit,
        surface.name
    )))
}

/// Reads the surface of a configuration, which `command` needs.
pub(crate) fn required_surface(
    measured: &MeasuredConfig,
    document: &Document,
    common: &Common,
) -> Result<GivenSurface, Failure> {
    let command = document.command();
    given_surface(measured, document, common)?
        .ok_or_else(|| Failure::usage(format!("{command} needs a surface: FILE or --flat")))
}

/// Reads the surface of a configuration, if it has one.
pub(crate) fn given_surface(
    measured: &MeasuredConfig,
    document: &Document,
    common: &Common,
) -> Result<Option<GivenSurface>, Failure> {
    match &measured.file {
        Some(path) => read_given(path, measured, common).map(Some),
        None if measured.flat => flat_surface(document.own_unit()).map(Some),
        None => Ok(None),
    }
}

/// Reads a surface from a file.
pub(crate) fn read_given(
    path: &Path,
    measured: &MeasuredConfig,
    common: &Common,
) -> Result<GivenSurface, Failure> {
    let (shape, unit, filled, notes) =
        match SurfaceFormat::from_path(path).map_err(Failure::failed)? {
            SurfaceFormat::Mesh(_) => {
                let (mesh, unit) = read_mesh_surface(path, measured, common)?;
                (GivenShape::Mesh(mesh), unit, 0, Vec::new())
            }
            SurfaceFormat::HeightMap(_) => {
                let Input {
                    field,
                    filled,
                    notes,
                } = read_surface(path, measured, common)?;
                let unit = field.unit();
                (GivenShape::Field(field), unit, filled, notes)
            }
        };
    Ok(GivenSurface {
        shape,
        name: name_of(path),
        file: Some(path.to_owned()),
        unit,
        filled,
        notes,
    })
}

/// One flat periodic cell, with lengths in `unit`.
fn flat_surface(unit: LengthUnit) -> Result<GivenSurface, Failure> {
    let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).map_err(Failure::failed)?;
    Ok(GivenSurface {
        shape: GivenShape::Field(field.with_unit(unit)),
        name: "flat surface".to_owned(),
        file: None,
        unit,
        filled: 0,
        notes: Vec::new(),
    })
}
