//! Source: the height map that random surfaces are to be like, and what it is too small for.
//!
//! The numbers that are estimated from a surface of `n` correlation areas scatter like means of `n` independent ones: its root mean square
//! height by `1 / (2 sqrt(n))` of itself. A Hann window, which all but periodic maps get, leaves the middle of a map: its periodogram
//! scatters as that of `n / 3.78`.

use std::f64::consts::PI;
use std::path::Path;

use asperity_io::{read_height_map, shown};
use asperity_surface::{Border, HeightField, LengthUnit, MissingPolicy};
use asperity_synthesis::Psd;

use super::error::SurfaceFileError;

/// Fewest samples along each side: as many as the waves that have a node of their own in an estimated spectrum.
const MIN_SIDE: usize = 8;

/// `mean(w^4) / mean(w^2)^2` of a Hann window, along both axes: (35/18)^2.
const HANN: f64 = 35.0 / 18.0 * (35.0 / 18.0);

/// A height map without missing points, its spectrum, and what a reader of the results should know about it.
pub(super) struct Source {
    pub(super) field: HeightField,
    pub(super) psd: Psd,
    pub(super) notes: Vec<String>,
}

impl Source {
    /// Reads a height map, in `unit` if that is given.
    pub(super) fn read(path: &Path, unit: LengthUnit) -> Result<Self, SurfaceFileError> {
        let mut raw = read_height_map(path)?;
        let failed = |error| SurfaceFileError::Missing {
            path: path.to_owned(),
            error,
        };
        if raw.unit == LengthUnit::Arbitrary {
            raw.unit = unit;
        }
        if unit != LengthUnit::Arbitrary {
            raw = raw.in_unit(unit).map_err(|error| failed(error.into()))?;
        }
        let mut notes = std::mem::take(&mut raw.notes);
        notes.extend(raw.spacing_note());
        match raw.missing() {
            0 => {}
            1 => notes.push("1 missing point was filled".to_owned()),
            missing => notes.push(format!("{missing} missing points were filled")),
        }
        let field = raw
            .into_height_field(MissingPolicy::Fill, Border::Open)
            .map_err(failed)?;
        check_size(path, &field)?;
        let psd = Psd::like(&field).map_err(|error| SurfaceFileError::Spectrum {
            path: path.to_owned(),
            error,
        })?;
        let is_windowed = field.border() != Border::Periodic;
        if is_windowed {
            notes.push("its plane of best fit is removed".to_owned());
        }
        notes.push(areas_note(&field, &psd, is_windowed));
        let name = path.file_name().unwrap_or(path.as_os_str());
        let name = shown(&name.to_string_lossy());
        let notes = notes.iter().map(|note| format!("{name}: {note}")).collect();
        Ok(Self { field, psd, notes })
    }
}

fn check_size(path: &Path, field: &HeightField) -> Result<(), SurfaceFileError> {
    let (nx, ny) = (field.nx(), field.ny());
    if nx.min(ny) >= MIN_SIDE {
        return Ok(());
    }
    Err(SurfaceFileError::Content {
        path: path.to_owned(),
        subject: "a spectrum or a distribution",
        needed: format!("at least {MIN_SIDE} x {MIN_SIDE} samples"),
        found: format!("{nx} x {ny}"),
    })
}

/// Note on the number of correlation areas of a map, and on the error of `sigma` that follows.
fn areas_note(field: &HeightField, psd: &Psd, is_windowed: bool) -> String {
    let [dx, dy] = field.spacing();
    let [tau_x, tau_y] = psd.axis_correlation_lengths();
    let tile = field.nx() as f64 * dx * field.ny() as f64 * dy;
    let areas = tile / (PI * tau_x * tau_y);
    let effective = if is_windowed { areas / HANN } else { areas };
    let uncertainty = 100.0 / (2.0 * effective.sqrt());
    format!("it has {areas:.0} correlation areas, which tell sigma within about {uncertainty:.1} %")
}
