//! Erosion of a height map that was read.

use asperity_simulate::short;
use asperity_studies::settings::Document;
use asperity_surface::HeightField;
use asperity_synthesis::{Erosion, Etch, Slip};
use serde::Deserialize;

use crate::failure::Failure;

/// What is read.
#[derive(Deserialize)]
struct Settings {
    erosion: ErosionSettings,
}

/// The processes.
#[derive(Deserialize)]
struct ErosionSettings {
    repose: Option<f64>,
    slip_steps: u32,
    etch: Option<f64>,
}

/// `field` after the processes requested, without provenance then, and a note if one changes no shape; as it is if none is requested.
pub(crate) fn eroded(
    document: &Document,
    field: HeightField,
) -> Result<(HeightField, Option<String>), Failure> {
    // Lengths in the unit of the surface
    let document = document.clone().in_unit(field.unit());
    let document = document.map_err(Failure::usage)?;
    let Settings { erosion } = document.read().map_err(Failure::usage)?;
    if erosion.repose.is_none() && document.is_given("erosion.slip_steps") {
        return Err(Failure::usage("--slip-steps needs --repose"));
    }
    let slip = erosion.repose.map(|repose| {
        Erosion::Slip(Slip {
            slope: repose.to_radians().tan(),
            steps: erosion.slip_steps,
        })
    });
    let etch = erosion.etch.map(|depth| Erosion::Etch(Etch { depth }));
    let note = erosion.etch.and_then(|depth| shallow_note(depth, &field));
    let mut processes = slip.into_iter().chain(etch);
    let field = processes.try_fold(field, |field, process| {
        let eroded = process.of(&field).map_err(Failure::usage)?;
        Ok(eroded.with_provenance(None))
    })?;
    Ok((field, note))
}

/// That a depth of etching reaches no other sample, so that the surface sinks as it is.
fn shallow_note(depth: f64, field: &HeightField) -> Option<String> {
    let [dx, dy] = field.spacing();
    let spacing = dx.min(dy);
    (depth < spacing).then(|| {
        let unit = field.unit().suffix();
        let (depth, spacing) = (short(depth), short(spacing));
        format!(
            "--etch {depth}{unit} is less than the spacing of {spacing}{unit}: the surface sinks by it and keeps its shape"
        )
    })
}
