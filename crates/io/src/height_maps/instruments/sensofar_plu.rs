//! Sensofar PLU (.plu): confocal and interferometric profilers.
//!
//! Little endian, without a mark: a date, a comment, the calibration, the settings of the measurement, then layers of
//! `ny`, `nx` and heights in micrometres in single precision, row by row from the top; 1000001 is a missing point.

use super::bytes::{Bytes, Raster};
use super::measured::{Length, MICROMETRE, Measured};
use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;

/// The type of a measurement that is a topography.
const TOPOGRAPHY: u32 = 3;
/// The number of a missing point.
const MISSING: f64 = 1_000_001.0;
/// Offset of the first layer.
const LAYER: usize = 500;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    file.check_header(LAYER + 8)?;
    let kind = file.u32(428)?;
    if kind != TOPOGRAPHY {
        return Err(ReadProblem::malformed(format_args!(
            "its measurement is of type {kind}, but a topography (type {TOPOGRAPHY}) is needed"
        )));
    }
    let [rows, columns] = [file.u32(LAYER)?, file.u32(LAYER + 4)?].map(u64::from);
    let calibrated = [file.u32(388)?, file.u32(392)?].map(u64::from);
    if [rows, columns] != calibrated {
        return Err(ReadProblem::malformed(format_args!(
            "its calibration is of {} x {} points, but its first layer has {columns} x {rows}",
            calibrated[1], calibrated[0]
        )));
    }
    let spacing = [file.f32(404)?, file.f32(408)?].map(|value| Length {
        value,
        unit: MICROMETRE,
    });
    let layers = file.u8(489)?;
    let mut heights = file.samples(&Raster {
        shape: [rows, columns],
        kind: SampleKind::F32,
        at: LAYER + 8,
    })?;
    // The least and the largest height close a layer
    file.part(LAYER + 8 + 4 * heights.len(), 8)?;
    for height in &mut heights {
        if *height == MISSING {
            *height = f64::NAN;
        }
    }
    Ok(Measured {
        heights,
        height_unit: MICROMETRE,
        shape: [rows, columns],
        spacing: Some(spacing),
        notes: (layers > 1)
            .then(|| format!("the first of {layers} layers is read"))
            .into_iter()
            .collect(),
    })
}
