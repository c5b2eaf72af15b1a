//! Zygo MetroPro (.dat): the connected phase of an interferometer.
//!
//! Big endian, header formats 1 to 3. Heights are `number * S * O * W / R` in metres: the interferometric scale
//! factor, the obliquity factor, the wavelength, and the resolution of the phase, 4096, 32768 or 131072 steps in a
//! fringe. Rows begin at the top; numbers from 2147483640 on are missing points.

use super::bytes::{ByteOrder, Bytes, Raster};
use super::measured::{Length, METRE, Measured};
use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;

/// Length of the shortest header.
const HEADER: usize = 834;
/// Least number of a missing point.
const MISSING: f64 = 2_147_483_640.0;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let file = &file.in_order(ByteOrder::Big);
    file.check_header(HEADER)?;
    let raster = raster(file)?;
    let mut step = height_step(file)?;
    let mut notes = Vec::new();
    if file.i16(232)? != 0 {
        step = -step;
        notes.push("the header states an inverted phase: heights change sign".to_owned());
    }
    let pixel = file.f32(184)?;
    let spacing = Length {
        value: pixel,
        unit: METRE,
    };

    let mut heights = file.samples(&raster)?;
    for height in &mut heights {
        *height = if *height >= MISSING {
            f64::NAN
        } else {
            *height * step
        };
    }
    Ok(Measured {
        heights,
        height_unit: METRE,
        shape: raster.shape,
        spacing: (pixel != 0.0).then_some([spacing; 2]),
        notes,
    })
}

/// The phase, which follows the header and the intensities.
fn raster(file: &Bytes<'_>) -> Result<Raster, ReadProblem> {
    let header = file.u32(6)? as usize;
    let intensity = file.u32(60)? as usize;
    let [columns, rows] = [file.u16(68)?, file.u16(70)?].map(u64::from);
    let size = u64::from(file.u32(72)?);
    if size == 0 {
        return Err(ReadProblem::unsupported(
            "it holds intensities, but no heights",
        ));
    }
    if size != columns * rows * 4 {
        return Err(ReadProblem::malformed(format_args!(
            "its heights take {size} bytes, but {columns} x {rows} numbers of 4 bytes are needed"
        )));
    }
    Ok(Raster {
        shape: [rows, columns],
        kind: SampleKind::I32,
        at: header.saturating_add(intensity),
    })
}

/// Metres for each step of the phase.
fn height_step(file: &Bytes<'_>) -> Result<f64, ReadProblem> {
    let resolution = match file.i16(218)? {
        0 => 4096.0,
        1 => 32768.0,
        2 => 131_072.0,
        other => {
            return Err(ReadProblem::unsupported(format_args!(
                "the resolution of its phase is of type {other}, but 0, 1 or 2 is needed"
            )));
        }
    };
    let [scale, wavelength, obliquity] = [file.f32(164)?, file.f32(168)?, file.f32(176)?];
    let step = scale * obliquity * wavelength / resolution;
    if step.is_finite() && step != 0.0 {
        return Ok(step);
    }
    Err(ReadProblem::malformed(format_args!(
        "its scale factor {scale}, obliquity {obliquity} and wavelength {wavelength} m give no height"
    )))
}
