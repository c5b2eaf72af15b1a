//! Layer bins: a model of flat layers, bin by bin.

use asperity_simulate::short;
use std::path::Path;

use asperity_analysis::{FlatLayers, LayerPaths, UnscatteredBeam};
use asperity_optics::{Incidence, Layer};
use asperity_tally::{Component, Side, TallyResult, TallyValues};
use serde::Serialize;
use serde_json::{Value, json};

use super::config::{ModelConfig, azimuth};
use super::evaluation::{Evaluation, columns};
use crate::config::error::ConfigError;
use crate::output::{
    BySide, Column, Head, Table, bin_columns, projected_solid_angle, solid_angle_column,
};
use crate::report::views::Csv;

/// A model of flat layers, and the layers.
pub(super) struct LayerModel {
    pub(super) model: FlatLayers,
    /// From above, one or more.
    pub(super) layers: Vec<Layer>,
}

/// The components that such a model describes.
const DESCRIBED: [Component; 2] = [Component::Unscattered, Component::ScatteredOnce];

/// A model of flat layers over bins, and its energies by how often light was scattered.
pub(super) struct LayerBins {
    layer: LayerModel,
    incidence: Incidence,
    expected: TallyValues,
    notes: Vec<String>,
}

impl LayerBins {
    pub(super) fn of(
        config: &ModelConfig,
        layer: LayerModel,
        incidence: Incidence,
    ) -> Result<Self, ConfigError> {
        let spec = config.spec()?.with_medium();
        let azimuth = azimuth(incidence, true);
        Ok(Self {
            expected: layer.model.tally(incidence, &spec, azimuth),
            notes: unscattered_notes(&layer.model, incidence),
            layer,
            incidence,
        })
    }
}

impl Evaluation for LayerBins {
    fn table(&self) -> Csv<'_> {
        table(&self.expected).with_rows(self.expected.spec().recorded_bins())
    }

    fn rows(&self) -> (usize, &'static str) {
        (self.expected.spec().recorded_bins().len(), "bins")
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn description(&self) -> &'static str {
        self.layer.model.paths().description()
    }

    fn text(&self) -> String {
        energy_table(&self.expected)
    }

    /// An infinite optical thickness is null.
    fn summary(&self, file: Option<&Path>) -> Value {
        let model = &self.layer.model;
        let paths: LayerPaths = model.paths();
        let sides = |component| BySide::of(|side| self.expected.flux(side, component));
        let beams = model.unscattered(self.incidence.wi());
        json!(Summary {
            head: Head::of("model"),
            model: paths.name(),
            description: paths.description(),
            valid_range: paths.valid_range(),
            layer: &self.layer.layers[0],
            layers: &self.layer.layers,
            optical_thickness: model.optical_thickness(),
            energy: Energy {
                unscattered: sides(Component::Unscattered),
                once: sides(Component::ScatteredOnce),
            },
            unscattered: beams.iter().map(Beam::of).collect(),
            columns: columns(&self.table(), file),
        })
    }
}

/// A row per bin: its place, solid angle, flux and BSDF, and the fluxes never scattered and scattered
/// once apart. Unscattered light goes one way and fills one bin, whose BSDF it dominates.
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
            "flux of light that was never scattered inside the layers",
            unscattered,
        ))
        .column(Column::new(
            "flux_once",
            "flux of light that was scattered inside the layers once",
            once,
        ))
}

/// The fluxes never scattered and scattered once that leave on each side, and what neither is.
fn energy_table(expected: &TallyValues) -> String {
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
pub(super) fn unscattered_notes(model: &FlatLayers, incidence: Incidence) -> Vec<String> {
    let beams = model.unscattered(incidence.wi());
    let sentence = |beam: &UnscatteredBeam| {
        let [theta, phi] = beam.angles_deg();
        format!(
            "{}, unscattered: flux {} at theta {}, phi {} deg (a delta)",
            beam.side,
            short(beam.flux),
            short(theta),
            short(phi),
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
    /// The uppermost layer.
    layer: &'a Layer,
    /// All layers, from above.
    layers: &'a [Layer],
    optical_thickness: f64,
    energy: Energy,
    unscattered: Vec<Beam>,
    columns: Value,
}

#[derive(Serialize)]
struct Energy {
    unscattered: BySide<f64>,
    once: BySide<f64>,
}

/// A direction into which unscattered light goes.
#[derive(Serialize)]
struct Beam {
    side: Side,
    theta_deg: f64,
    phi_deg: f64,
    flux: f64,
}

impl Beam {
    fn of(beam: &UnscatteredBeam) -> Self {
        let [theta_deg, phi_deg] = beam.angles_deg();
        Self {
            side: beam.side,
            theta_deg,
            phi_deg,
            flux: beam.flux,
        }
    }
}
