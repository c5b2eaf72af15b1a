//! Writing: height maps to files, with a note of what the format leaves out.

use std::path::Path;

use asperity_io::{HeightMapFormat, write_height_map};
use asperity_surface::{HeightField, LengthUnit};

use super::border::ASSUMED_BORDER;
use super::error::GivenError;

/// Writes a height map; returns a note if the format cannot hold spacing, unit or border.
pub(crate) fn write_surface(
    path: &Path,
    field: &HeightField,
) -> Result<Option<String>, GivenError> {
    write_height_map(path, field)?;
    let ([dx, dy], unit, border) = (field.spacing(), field.unit(), field.border());
    let is_default =
        [dx, dy] == [1.0; 2] && unit == LengthUnit::Arbitrary && border == ASSUMED_BORDER;
    let format = HeightMapFormat::from_path(path);
    let is_npy = format == Some(HeightMapFormat::Npy);
    let assumed = match unit {
        LengthUnit::Arbitrary => String::new(),
        unit => format!(" --assume-unit {unit}"),
    };
    let spacing = (is_npy && !is_default).then(|| {
        format!(
            "NPY holds heights alone: read them with --spacing {dx},{dy}{assumed} --border {border}"
        )
    });
    let keeps_cells = format == Some(HeightMapFormat::Exr);
    let cells = (field.turned_cells().is_some() && !keeps_cells).then(|| {
        "the file does not tell along which diagonals cells are split at the edges of the structure, as an EXR does: read back, all are split along the same one".to_owned()
    });
    Ok([spacing, cells]
        .into_iter()
        .flatten()
        .reduce(|a, b| format!("{a}; {b}")))
}
