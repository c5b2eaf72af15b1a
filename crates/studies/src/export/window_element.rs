//! Window element: what the XML files of Radiance and WINDOW have in common, whatever basis their values are over.
//!
//! They describe a slab between equal media by four functions, reflection and transmission of light from either side. *Back* is light from above,
//! *Front* light from below. Directions of incidence are those in which light travels, which turns their azimuth by half a turn.

use std::fmt::Write;

use asperity_optics::{ColourObserver, Layer, colour_weights, solar_weights};
use asperity_simulate::Outcome;
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Estimate, Side, TallyResult};
use asperity_tracer::HalfSpace;

use super::directions::ascending;
use super::planned::{OfCase, Planned, check_one_sample, check_unpolarised};

/// A function of the file: the half space that light comes from, and the side on which it leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) from: HalfSpace,
    pub(super) side: Side,
}

/// The functions of a file.
pub(super) const BLOCKS: [Block; 4] = [
    block(HalfSpace::Above, Side::Transmitted),
    block(HalfSpace::Above, Side::Reflected),
    block(HalfSpace::Below, Side::Transmitted),
    block(HalfSpace::Below, Side::Reflected),
];

const fn block(from: HalfSpace, side: Side) -> Block {
    Block { from, side }
}

impl Block {
    /// Outcomes of light from its half space, with their weights.
    pub(super) fn lit<'a>(&self, weighted: &[Weighted<'a>]) -> Vec<Weighted<'a>> {
        let is_lit = |(outcome, _): &&Weighted| outcome.case.light.from == self.from;
        weighted.iter().filter(is_lit).copied().collect()
    }
}

/// Wavelengths that count for the visible band, nm.
const VISIBLE_NM: std::ops::RangeInclusive<f64> = 380.0..=780.0;

/// An outcome, and its weight in a band.
pub(super) type Weighted<'a> = (&'a Outcome, f64);

/// Checks that the cases are of one slab between equal media, lit by unpolarised light from both sides, and recorded on both.
///
/// # Errors
/// A sentence on what a file needs.
pub(super) fn check_slab(cases: &[Planned]) -> Result<(), String> {
    check_unpolarised(cases)?;
    check_one_sample(cases)?;
    let slab = "describes a slab between equal media, as Radiance and WINDOW take it";
    if cases.iter().any(|one| one.case.layers.is_empty()) {
        return Err(format!("{slab}: give the sample a --thickness, or layers"));
    }
    if !cases.iter().all(|one| one.case.passes_on()) {
        return Err(format!(
            "{slab}: what lies behind this one is opaque or another medium"
        ));
    }
    let is_recorded = |one: &Planned| Side::BOTH.iter().all(|side| one.spec.records(*side));
    if !cases.iter().all(is_recorded) {
        return Err("needs light on both sides: measure with --side both".to_owned());
    }
    let is_lit = |from| cases.iter().any(|one| one.case.light.from == from);
    if !(is_lit(HalfSpace::Above) && is_lit(HalfSpace::Below)) {
        return Err("needs light from both sides: measure with --from both".to_owned());
    }
    visible(&wavelengths(cases)).map(drop)
}

/// Wavelengths, nm, ascending.
fn wavelengths<T: OfCase>(cases: &[T]) -> Vec<f64> {
    let all = cases.iter().filter_map(|one| one.case().at.wavelength_nm());
    ascending(all)
}

/// Wavelengths of the visible band with their weights; none if all results have one wavelength, or none.
///
/// # Errors
/// A sentence on what a file needs.
fn visible(nm: &[f64]) -> Result<Vec<(f64, f64)>, String> {
    if nm.len() < 2 {
        return Ok(Vec::new());
    }
    let nm: Vec<f64> = nm
        .iter()
        .copied()
        .filter(|nm| VISIBLE_NM.contains(nm))
        .collect();
    let weights = colour_weights(&nm, ColourObserver::Cie1931).ok_or(
        "needs one wavelength, or those of the Visible band, from 400 to 700 nm in steps of at most 20 nm",
    )?;
    let luminosity = weights.iter().map(|xyz| xyz[1]);
    Ok(nm.into_iter().zip(luminosity).collect())
}

/// Outcomes with their weights in the visible band: equal weights if they have one wavelength, or none.
///
/// # Errors
/// A sentence on what a file needs.
pub(super) fn in_visible<'a>(outcomes: &[&'a Outcome]) -> Result<Vec<Weighted<'a>>, String> {
    let weights = visible(&wavelengths(outcomes))?;
    Ok(match weights.is_empty() {
        true => outcomes.iter().map(|one| (*one, 1.0)).collect(),
        false => weighted(outcomes, &weights),
    })
}

/// Outcomes with their weights in the solar band, if their wavelengths cover it.
pub(super) fn in_solar<'a>(outcomes: &[&'a Outcome]) -> Option<Vec<Weighted<'a>>> {
    let nm = wavelengths(outcomes);
    let weights = solar_weights(&nm)?;
    let weights: Vec<(f64, f64)> = nm.into_iter().zip(weights).collect();
    Some(weighted(outcomes, &weights))
}

/// Outcomes at some wavelengths, with the weight of each.
fn weighted<'a>(outcomes: &[&'a Outcome], weights: &[(f64, f64)]) -> Vec<Weighted<'a>> {
    let weighted = outcomes.iter().filter_map(|one| {
        let wavelength = one.case.at.wavelength_nm();
        let (_, weight) = weights.iter().find(|(nm, _)| Some(*nm) == wavelength)?;
        Some((*one, *weight))
    });
    weighted.collect()
}

/// Flux that leaves on a side, over a band.
pub(super) fn weighted_flux(weighted: &[Weighted], side: Side) -> Estimate {
    let (mut mean, mut variance) = (0.0, Some(0.0));
    for (outcome, weight) in weighted {
        let flux = outcome.statistics.flux(side, Component::All);
        mean += weight * flux.mean;
        variance = variance.and_then(|sum: f64| Some(sum + (weight * flux.se?).powi(2)));
    }
    let se = variance.map(f64::sqrt);
    Estimate { mean, se }
}

/// The text of a file, in the order in which it is written.
pub(super) struct WindowElement {
    text: String,
    has_thickness: bool,
}

impl WindowElement {
    /// A file up to its data; `definition` is the XML between the structure and the data.
    pub(super) fn new(outcome: &Outcome, structure: &str, definition: &str) -> Self {
        let case = &outcome.case;
        let slabs = case.layers.iter().filter_map(Layer::end);
        let thickness: f64 = slabs.map(|slab| slab.thickness).sum();
        let metres = case.at.unit.conversion(LengthUnit::Metre);
        let metres = metres.map(|metres| metres(thickness));
        let text = HEAD
            .replace("THICKNESS", &metres.unwrap_or(0.0).to_string())
            .replace("STRUCTURE", structure)
            .replace("DEFINITION", definition);
        Self {
            text,
            has_thickness: metres.is_some(),
        }
    }

    /// Adds a function over a band; `bases` is the XML that names the basis of its values.
    pub(super) fn add(&mut self, band: &str, block: Block, bases: &str, values: &str) {
        let [source, eye] = match band {
            "Visible" => ["CIE Illuminant D65 1nm.ssp", "ASTM E308 1931 Y.dsp"],
            _ => ["ASTM G173-03 global", "None"],
        };
        let (kind, scatter) = match block.side {
            Side::Transmitted => ("Transmission", "BTDF"),
            Side::Reflected => ("Reflection", "BRDF"),
        };
        let light = match block.from {
            HalfSpace::Above => "Back",
            HalfSpace::Below => "Front",
        };
        let _ = write!(
            self.text,
            "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">{band}</Wavelength>\n<SourceSpectrum>{source}</SourceSpectrum>\n<DetectorSpectrum>{eye}</DetectorSpectrum>\n<WavelengthDataBlock>\n<WavelengthDataDirection>{kind} {light}</WavelengthDataDirection>\n{bases}\n<ScatteringDataType>{scatter}</ScatteringDataType>\n<ScatteringData>\n{values}</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n"
        );
    }

    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = vec![
            "not in the file: standard errors, polarisation, orders of scattering".to_owned(),
            "Back is light from above, Front light from below".to_owned(),
        ];
        if !self.has_thickness {
            notes.push(
                "the lengths of the sample have no unit: the file says a thickness of 0".to_owned(),
            );
        }
        notes
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        let mut text = self.text;
        text.push_str("</Layer>\n</Optical>\n</WindowElement>\n");
        text.into_bytes()
    }
}

/// The file up to its data.
const HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="http://windows.lbl.gov/BSDF-v1.4.xsd">
<WindowElementType>System</WindowElementType>
<FileType>BSDF</FileType>
<Optical>
<Layer>
<Material>
<Name>asperity</Name>
<Manufacturer>asperity</Manufacturer>
<Thickness unit="Meter">THICKNESS</Thickness>
<DeviceType>Other</DeviceType>
</Material>
<DataDefinition>
<IncidentDataStructure>STRUCTURE</IncidentDataStructure>
DEFINITION</DataDefinition>
"#;
