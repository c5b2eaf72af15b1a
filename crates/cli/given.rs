//! Reading given surfaces: height maps, triangle meshes and the flat surface.

use std::path::Path;

use asperity_io::SurfaceFormat;
use asperity_studies::settings::Document;
use asperity_studies::{GivenShape, GivenSurface, GivenSurfaces, MeasuredConfig};
use asperity_surface::{HeightField, LengthUnit};
use serde::de::DeserializeOwned;

use crate::common::Common;
use crate::failure::Failure;
use crate::input::{Input, name_of, read_mesh_surface, read_surface};
use crate::output_files::is_same_file;

/// The settings of `document` with lengths as numbers in `unit`, that of the surface.
pub(crate) fn settings_for<T: DeserializeOwned>(
    document: &Document,
    unit: LengthUnit,
) -> Result<T, Failure> {
    let document = document.clone().in_unit(unit);
    document
        .and_then(|document| document.read())
        .map_err(Failure::usage)
}

/// Reads a further surface, or the bottom of a layer, with lengths in the unit of `surface`.
pub(crate) fn read_like(
    surface: &GivenSurface,
    path: &Path,
    measured: &MeasuredConfig,
    common: &Common,
) -> Result<GivenSurface, Failure> {
    let physical = Some(surface.unit).filter(|unit| *unit != LengthUnit::Arbitrary);
    let measured = MeasuredConfig {
        unit: physical.or(measured.unit),
        ..measured.clone()
    };
    let read = read_given(path, &measured, common)?;
    if read.unit == surface.unit || surface.file.is_none() {
        return Ok(read);
    }
    Err(Failure::usage(format!(
        "{}: its lengths are in {}, but {} states no unit; say what its numbers are in with --assume-unit",
        path.display(),
        read.unit,
        surface.name
    )))
}

/// Reads the surfaces of a configuration, of which `command` needs one at least.
pub(crate) fn required_surfaces(
    measured: &MeasuredConfig,
    document: &Document,
    common: &Common,
) -> Result<GivenSurfaces, Failure> {
    let command = document.command();
    given_surfaces(measured, document, common)?
        .ok_or_else(|| Failure::usage(format!("{command} needs a surface: FILE or --flat")))
}

/// Reads the surfaces of a configuration, if it has any.
pub(crate) fn given_surfaces(
    measured: &MeasuredConfig,
    document: &Document,
    common: &Common,
) -> Result<Option<GivenSurfaces>, Failure> {
    let files: Vec<&Path> = measured.files().collect();
    for (i, path) in files.iter().enumerate() {
        if files[..i].iter().any(|other| is_same_file(other, path)) {
            return Err(Failure::usage(format!(
                "{} is given twice; give each surface once",
                path.display()
            )));
        }
    }
    let (first, others) = match files.split_first() {
        Some((first, others)) => (read_given(first, measured, common)?, others),
        None if measured.flat => (flat_surface(document.own_unit())?, &[][..]),
        None => return Ok(None),
    };
    let others = others.iter();
    let others = others.map(|path| read_like(&first, path, measured, common));
    let surfaces = GivenSurfaces {
        others: others.collect::<Result<_, _>>()?,
        first,
    };
    let all: Vec<&GivenSurface> = surfaces.iter().collect();
    for (i, one) in all.iter().enumerate() {
        if let Some(other) = all[..i].iter().find(|other| are_equal(other, one)) {
            return Err(Failure::usage(format!(
                "{} and {} hold the same heights; give each surface once",
                other.name, one.name
            )));
        }
    }
    Ok(Some(surfaces))
}

/// Whether two height maps have the same heights, of which the scatter would be none.
fn are_equal(a: &GivenSurface, b: &GivenSurface) -> bool {
    match (&a.shape, &b.shape) {
        (GivenShape::Field(a), GivenShape::Field(b)) => a.heights() == b.heights(),
        _ => false,
    }
}

/// Reads a surface from a file.
fn read_given(
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
