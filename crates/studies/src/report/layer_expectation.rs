//! What a model of a flat layer expects, as tables and JSON.

use asperity_simulate::short;
use std::path::Path;

use asperity_analysis::{FlatLayer, LayerPaths, UnscatteredBeam};
use asperity_io::WriteError;
use asperity_optics::{Incidence, Layer};
use asperity_tally::{Component, Side, TallyResult, TallyValues};
use serde::Serialize;
use serde_json::{Value, json};

use crate::output::{Column, Head, Table, bin_columns, projected_solid_angle, solid_angle_column};

/// The components that such a model describes.
const DESCRIBED: [Component; 2] = [Component::Unscattered, Component::ScatteredOnce];

/// Writes a row per bin: its place, solid angle, flux and BSDF, and the fluxes never scattered and scattered
/// once apart. Unscattered light goes one way and fills one bin, whose BSDF it dominates.
///
/// `expected`: what [`FlatLayer::tally`] gives for a spec with a medium.
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
pub fn write_layer_expectation(path: &Path, expected: &TallyValues) -> Result<(), WriteError> {
    table(expected).write_csv(path, expected.spec().recorded_bins())
}

fn table(expected: &TallyValues) -> Table<'_, usize> {
    let spec = expected.spec();
    let grid = spec.grid();
    let of = move |component| {
        let bins = spec.grid_entries(component);
        move |bin: &usize| expected[bins.get(*bin)]
    };
    let [unscattered, once] = DESCRIBED.map(of);
    let both = move |bin: &usize| unscattered(bin) + once(bin);
    Table::new()
        .columns(bin_columns(grid, |bin| *bin))
        .column(solid_angle_column(grid, |bin| *bin))
        .column(Column::new("flux", "expected flux into the bin", both))
        .column(
            Column::new("bsdf", "mean BSDF of the bin", move |bin: &usize| {
                both(bin) / projected_solid_angle(&grid, *bin)
            })
            .unit("1/sr"),
        )
        .column(Column::new(
            "flux_unscattered",
            "flux of light that was never scattered inside the layer",
            unscattered,
        ))
        .column(Column::new(
            "flux_once",
            "flux of light that was scattered inside the layer once",
            once,
        ))
}

/// The fluxes never scattered and scattered once that leave on each side, and what neither is.
#[must_use]
pub fn layer_energy_table(expected: &TallyValues) -> String {
    let spec = expected.spec();
    let flux = |side, component| expected.flux(side, component);
    let both = |side| -> f64 {
        DESCRIBED
            .map(|component| flux(side, component))
            .iter()
            .sum()
    };
    let column =
        |heading, component| Column::new(heading, "", move |side: &Side| flux(*side, component));
    let table = Table::new()
        .column(Column::new("side", "", |side: &Side| side.to_string()))
        .column(column("never scattered", Component::Unscattered))
        .column(column("scattered once", Component::ScatteredOnce))
        .column(Column::new("both", "", |side: &Side| both(*side)));
    let accounted: f64 = spec.sides().map(both).sum();
    let rest = short((1.0 - accounted).max(0.0));
    format!(
        "{}  {rest} of the flux is absorbed, scattered more often, or on paths that the model leaves out\n",
        table.text(spec.sides())
    )
}

/// One sentence per direction into which unscattered light goes: a delta, of which a BSDF has no value.
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

#[derive(Serialize)]
struct Summary<'a> {
    #[serde(flatten)]
    head: Head,
    model: &'static str,
    description: &'static str,
    valid_range: &'static str,
    layer: &'a Layer,
    optical_thickness: f64,
    energy: Energy,
    unscattered: Vec<Beam>,
}

#[derive(Serialize)]
struct Energy {
    unscattered: Sides,
    once: Sides,
}

#[derive(Serialize)]
struct Sides {
    reflected: f64,
    transmitted: f64,
}

/// A direction into which unscattered light goes.
#[derive(Serialize)]
struct Beam {
    side: Side,
    theta_deg: f64,
    phi_deg: f64,
    flux: f64,
}

/// The energies that a model of `layer` expects, and where unscattered light goes. An infinite optical
/// thickness is null.
#[must_use]
pub fn layer_expectation_json(
    (model, layer): (&FlatLayer, &Layer),
    incidence: Incidence,
    expected: &TallyValues,
) -> Value {
    let paths: LayerPaths = model.paths();
    let beams = model.unscattered(incidence.wi());
    let beams = beams.iter().map(|beam| {
        let [theta_deg, phi_deg] = beam.angles_deg();
        Beam {
            side: beam.side,
            theta_deg,
            phi_deg,
            flux: beam.flux,
        }
    });
    let sides = |component| Sides {
        reflected: expected.flux(Side::Reflected, component),
        transmitted: expected.flux(Side::Transmitted, component),
    };
    json!(Summary {
        head: Head::of("model"),
        model: paths.name(),
        description: paths.description(),
        valid_range: paths.valid_range(),
        layer,
        optical_thickness: model.optical_thickness(),
        energy: Energy {
            unscattered: sides(Component::Unscattered),
            once: sides(Component::ScatteredOnce),
        },
        unscattered: beams.collect(),
    })
}
