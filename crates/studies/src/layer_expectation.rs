//! What a model of a flat layer expects, as tables and JSON.

use asperity_simulate::short;
use std::path::Path;

use asperity_analysis::{FlatLayer, LayerPaths, UnscatteredBeam};
use asperity_io::{CsvField as Field, WriteError, write_csv};
use asperity_optics::{Incidence, Layer};
use asperity_tally::{History, Layout, Side};
use serde_json::{Value, json};

use crate::csv::{PLACE, place};
use crate::tables::aligned;

/// The histories that such a model describes.
const HISTORIES: [History; 2] = [History::Unscattered, History::Once];

/// Writes a row a bin: its place, solid angle, flux and BSDF, and the fluxes never scattered and scattered
/// once apart. Unscattered light goes one way and fills one bin, whose BSDF it dominates.
///
/// `record`: what [`FlatLayer::record`] makes of `layout`, which has histories.
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
pub fn write_layer_expectation(
    path: &Path,
    layout: &Layout,
    record: &[f64],
) -> Result<(), WriteError> {
    let mut header = PLACE.to_vec();
    header.extend([
        "solid_angle_sr",
        "flux",
        "bsdf",
        "flux_unscattered",
        "flux_once",
    ]);
    let grid = layout.grid();
    let rows = layout.asked_bins().map(|i| {
        let bin = grid.bin(i);
        let fluxes = HISTORIES.map(|history| record[layout.history_bins(history).start + i]);
        let flux: f64 = fluxes.iter().sum();
        let mut row = place(&grid, i);
        row.extend(
            [
                bin.solid_angle,
                flux,
                flux / (bin.solid_angle * bin.mean_abs_cos()),
            ]
            .map(Field::from),
        );
        row.extend(fluxes.map(Field::from));
        row
    });
    write_csv(path, &header, rows)
}

/// The fluxes never scattered and scattered once that leave on each side, and what neither is.
#[must_use]
pub fn layer_energy_table(layout: &Layout, record: &[f64]) -> String {
    let mut rows = vec![
        ["", "never scattered", "scattered once", "both"]
            .map(str::to_owned)
            .to_vec(),
    ];
    let mut accounted = 0.0;
    for side in layout.sides() {
        let fluxes = HISTORIES.map(|history| record[layout.history(side, history)]);
        let both: f64 = fluxes.iter().sum();
        accounted += both;
        rows.push(vec![
            side.to_string(),
            short(fluxes[0]),
            short(fluxes[1]),
            short(both),
        ]);
    }
    let rest = short((1.0 - accounted).max(0.0));
    format!(
        "{}  {rest} of the flux is absorbed, scattered more often, or on paths that the model leaves out\n",
        aligned(&rows)
    )
}

/// One sentence a direction into which light goes that was never scattered: a delta, of which a BSDF has
/// no value.
#[must_use]
pub fn unscattered_notes(model: &FlatLayer, incidence: Incidence) -> Vec<String> {
    let beams = model.unscattered(incidence.wi());
    let sentence = |beam: &UnscatteredBeam| {
        let [theta, phi] = beam.angles_deg();
        format!(
            "{}, never scattered: {} of the flux at theta {theta}, phi {phi} deg, a delta",
            beam.side,
            short(beam.flux)
        )
    };
    beams.iter().map(sentence).collect()
}

/// The energies that a model of `layer` expects, and where unscattered light goes. An infinite optical
/// thickness is null.
#[must_use]
pub fn layer_expectation_json(
    (model, layer): (&FlatLayer, &Layer),
    incidence: Incidence,
    layout: &Layout,
    record: &[f64],
) -> Value {
    let paths: LayerPaths = model.paths();
    let beams: Vec<Value> = model
        .unscattered(incidence.wi())
        .iter()
        .map(|beam| {
            let [theta, phi] = beam.angles_deg();
            json!({"side": beam.side, "theta_deg": theta, "phi_deg": phi, "flux": beam.flux})
        })
        .collect();
    let energy = |history| {
        let of = |side| record[layout.history(side, history)];
        json!({"reflected": of(Side::Reflected), "transmitted": of(Side::Transmitted)})
    };
    json!({
        "schema": 1,
        "command": "model",
        "version": env!("CARGO_PKG_VERSION"),
        "model": paths.name(),
        "description": paths.description(),
        "valid_range": paths.valid_range(),
        "layer": layer,
        "optical_thickness": model.optical_thickness(),
        "energy": {
            "unscattered": energy(History::Unscattered),
            "once": energy(History::Once),
        },
        "unscattered": beams,
    })
}
