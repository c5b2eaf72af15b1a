//! Erosion of a height map that was read.

use asperity_studies::settings::Document;
use asperity_surface::{Erosion, Etch, HeightField, Slip};
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

/// `field` after the processes requested, without provenance then; as it is if none is.
pub(crate) fn eroded(document: &Document, field: HeightField) -> Result<HeightField, Failure> {
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
    let processes = slip.into_iter().chain(etch);
    processes.into_iter().try_fold(field, |field, process| {
        let eroded = process.of(&field).map_err(Failure::usage)?;
        Ok(eroded.with_provenance(None))
    })
}
