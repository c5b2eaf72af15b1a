//! Klems: XML of Radiance, WINDOW and EnergyPlus with the transmission and reflection of a slab between 145 patches, from both sides.
//!
//! The value of a matrix is the mean BSDF between two patches, 1/sr, of light that is uniform over the patch that it comes from: rows are patches of
//! light that leaves, columns of light that comes. Patches of incidence are named by the direction in which light travels, which turns their azimuth by
//! half a turn. *Back* is light from above, *Front* light from below.

use std::fmt::Write;

use asperity_optics::{ColourObserver, KLEMS, Layer, Spread, colour_weights};
use asperity_simulate::Outcome;
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Estimate, Side, TallyResult};
use asperity_tracer::HalfSpace;

use super::contents::{Agreement, Contents};
use super::error::ExportError;
use super::measurement::Measurement;
use super::ranges::Range;

/// Patches of incidence.
const PATCHES: usize = 145;

/// A patch: its polar angles, its azimuths, and the azimuth of its centre, degrees.
#[derive(Clone, Copy)]
struct Patch {
    range: Range,
    centre_deg: f64,
}

/// Rings of the basis: lower and upper polar angle, degrees, and number of patches.
fn rings() -> impl Iterator<Item = (f64, f64, f64)> {
    let lower = std::iter::once(0.0).chain(KLEMS.map(|(upper, _)| upper));
    lower
        .zip(KLEMS)
        .map(|(lower, (upper, count))| (lower, upper, count))
}

/// Patches of all rings, in the order of rows and columns.
fn patches() -> impl Iterator<Item = Patch> {
    rings().flat_map(|(lower, upper, count)| {
        let width = 360.0 / count;
        (0..count as usize).map(move |k| {
            let centre_deg = k as f64 * width;
            Patch {
                range: Range {
                    theta_deg: [lower, upper],
                    phi_deg: [centre_deg - 0.5 * width, centre_deg + 0.5 * width],
                },
                centre_deg,
            }
        })
    })
}

fn unfit(reason: impl Into<String>) -> ExportError {
    let reason = reason.into();
    ExportError::Unfit {
        format: "a Klems file",
        reason,
    }
}

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, ExportError> {
    let outcomes: Vec<&Outcome> = measurement.cases.iter().map(|case| &case.outcome).collect();
    for outcome in &outcomes {
        check(outcome)?;
    }
    let bands = Band::all(&outcomes)?;
    let case = &outcomes[0].case;
    let slabs = case.layers.iter().filter_map(Layer::end);
    let thickness: f64 = slabs.map(|slab| slab.thickness).sum();
    let metres = case.at.unit.conversion(LengthUnit::Metre);
    let metres = metres.map(|metres| metres(thickness));
    let mut text = HEAD.replace("THICKNESS", &metres.unwrap_or(0.0).to_string());
    for (lower, upper, count) in rings() {
        let middle = if lower == 0.0 {
            0.0
        } else {
            0.5 * (lower + upper)
        };
        let _ = writeln!(
            text,
            "<AngleBasisBlock><Theta>{middle}</Theta><nPhis>{count}</nPhis><ThetaBounds><LowerTheta>{lower}</LowerTheta><UpperTheta>{upper}</UpperTheta></ThetaBounds></AngleBasisBlock>"
        );
    }
    text.push_str("</AngleBasis>\n</DataDefinition>\n");
    let mut agreement = Vec::new();
    for band in &bands {
        for (from, light) in [(HalfSpace::Above, "Back"), (HalfSpace::Below, "Front")] {
            for (side, kind, scatter) in [
                (Side::Transmitted, "Transmission", "BTDF"),
                (Side::Reflected, "Reflection", "BRDF"),
            ] {
                let matrix = band.matrix(from, side)?;
                if std::ptr::eq(band, &bands[0]) {
                    agreement.extend(band.agreement(from, side, &matrix)?);
                }
                band.write(&mut text, &format!("{kind} {light}"), scatter, &matrix);
            }
        }
    }
    text.push_str("</Layer>\n</Optical>\n</WindowElement>\n");
    let mut notes = vec![
        "not in the file: standard errors, polarisation, orders of scattering".to_owned(),
        "Back is light from above, Front light from below".to_owned(),
    ];
    if metres.is_none() {
        notes.push(
            "the lengths of the sample have no unit: the file says a thickness of 0".to_owned(),
        );
    }
    if bands.len() == 1 {
        notes.push("the Visible band alone: solar weighting is not supported".to_owned());
    } else {
        notes.push("the same values stand for both bands, Visible and Solar".to_owned());
    }
    Ok(Contents {
        bytes: text.into_bytes(),
        agreement,
        notes,
    })
}

/// Checks that a case is a slab between equal media whose patches of light are those of the basis.
fn check(outcome: &Outcome) -> Result<(), ExportError> {
    let case = &outcome.case;
    if case.layers.is_empty() {
        return Err(unfit(
            "describes a slab between equal media, as Radiance and WINDOW take it: give the sample a --thickness, or layers",
        ));
    }
    if !case.passes_on() {
        return Err(unfit(
            "describes a slab between equal media, as Radiance and WINDOW take it: what lies behind this one is opaque or another medium",
        ));
    }
    let spec = outcome.statistics.spec();
    if !Side::BOTH.into_iter().all(|side| spec.records(side)) {
        return Err(unfit("needs light on both sides: measure with --side both"));
    }
    if case.light.is_polarised() {
        return Err(unfit("is of unpolarised light: measure without --stokes"));
    }
    let patch = Spread::klems(case.light.incidence).ok();
    if patch.is_none() || case.light.spread != patch {
        return Err(unfit(
            "needs patches that are lit as a whole: measure with --from both --light-spread klems --theta 0,10,20,30,40,50,60,70,82.5",
        ));
    }
    if !case.light.random_azimuth {
        return Err(unfit(
            "takes one patch per ring, whose results are turned to the others: measure a sample without a direction of its own, or its mean over azimuths by --light-azimuth random",
        ));
    }
    Ok(())
}

/// Outcomes of one band, with the weight of each.
struct Band<'a> {
    name: &'static str,
    /// Outcomes of each patch: the wavelengths.
    per_patch: usize,
    outcomes: Vec<(&'a Outcome, f64)>,
}

impl<'a> Band<'a> {
    fn all(outcomes: &[&'a Outcome]) -> Result<Vec<Self>, ExportError> {
        let wavelength = |outcome: &Outcome| outcome.case.at.wavelength_nm();
        let mut wavelengths: Vec<f64> = outcomes.iter().filter_map(|one| wavelength(one)).collect();
        wavelengths.sort_by(f64::total_cmp);
        wavelengths.dedup();
        if wavelengths.len() < 2 {
            let all: Vec<(&Outcome, f64)> = outcomes.iter().map(|one| (*one, 1.0)).collect();
            return Ok(vec![
                Self {
                    name: "Visible",
                    per_patch: 1,
                    outcomes: all.clone(),
                },
                Self {
                    name: "Solar",
                    per_patch: 1,
                    outcomes: all,
                },
            ]);
        }
        let weights = colour_weights(&wavelengths, ColourObserver::Cie1931).ok_or_else(|| {
            unfit("needs one wavelength, or those of the Visible band, from 400 to 700 nm in steps of at most 20 nm")
        })?;
        let weighted = outcomes.iter().filter_map(|one| {
            let place = wavelengths
                .iter()
                .position(|nm| Some(*nm) == wavelength(one))?;
            Some((*one, weights[place][1]))
        });
        Ok(vec![Self {
            name: "Visible",
            per_patch: wavelengths.len(),
            outcomes: weighted.collect(),
        }])
    }

    /// Outcomes of light from the ring of a patch, with their weights.
    fn lit_by(
        &self,
        from: HalfSpace,
        patch: &Patch,
    ) -> Result<Vec<(&'a Outcome, f64)>, ExportError> {
        let [lower, upper] = patch.range.theta_deg;
        let is_lit = |(outcome, _): &(&Outcome, f64)| {
            let light = &outcome.case.light;
            light.from == from && (lower..upper).contains(&light.incidence.theta_deg())
        };
        let found: Vec<(&Outcome, f64)> = self.outcomes.iter().copied().filter(is_lit).collect();
        if found.len() > self.per_patch {
            return Err(unfit(
                "describes one sample, and there are results of several: measure one at a time",
            ));
        }
        if found.len() < self.per_patch {
            let from = match from {
                HalfSpace::Above => "above",
                HalfSpace::Below => "below",
            };
            return Err(unfit(format!(
                "needs light from {from} between {lower} and {upper} degrees: measure with --from both --light-spread klems --theta 0,10,20,30,40,50,60,70,82.5"
            )));
        }
        Ok(found)
    }

    /// Mean BSDF, row by row of patches of light that leaves on `side`.
    fn matrix(&self, from: HalfSpace, side: Side) -> Result<Vec<f64>, ExportError> {
        let mut matrix = vec![0.0; PATCHES * PATCHES];
        for (column, incident) in patches().enumerate() {
            for (outcome, weight) in self.lit_by(from, &incident)? {
                // Light travels towards the azimuth of the patch
                let turn = incident.centre_deg + 180.0 - outcome.case.light.incidence.phi_deg();
                for (row, leaving) in patches().enumerate() {
                    let turned = Range {
                        phi_deg: leaving.range.phi_deg.map(|phi| phi - turn),
                        ..leaving.range
                    };
                    let light = turned.light(outcome, side).map_or(0.0, |light| light.mean);
                    matrix[row * PATCHES + column] +=
                        weight * light / leaving.range.projected_solid_angle();
                }
            }
        }
        Ok(matrix)
    }

    /// The light of the first patch of each ring.
    fn agreement(
        &self,
        from: HalfSpace,
        side: Side,
        matrix: &[f64],
    ) -> Result<Vec<Agreement>, ExportError> {
        let mut rows = Vec::new();
        for (column, incident) in patches()
            .enumerate()
            .filter(|(_, patch)| patch.centre_deg == 0.0)
        {
            let lit = self.lit_by(from, &incident)?;
            let exported = patches().enumerate().map(|(row, leaving)| {
                matrix[row * PATCHES + column] * leaving.range.projected_solid_angle()
            });
            let (mut mean, mut variance) = (0.0, Some(0.0));
            for (outcome, weight) in &lit {
                let flux = outcome.statistics.flux(side, Component::All);
                mean += weight * flux.mean;
                variance = variance.and_then(|sum: f64| Some(sum + (weight * flux.se?).powi(2)));
            }
            let se = variance.map(f64::sqrt);
            let case = &lit[0].0.case;
            rows.push(Agreement::of(
                case,
                side,
                Estimate { mean, se },
                exported.sum(),
            ));
        }
        Ok(rows)
    }

    fn write(&self, text: &mut String, direction: &str, scatter: &str, matrix: &[f64]) {
        let [source, eye] = match self.name {
            "Visible" => ["CIE Illuminant D65 1nm.ssp", "ASTM E308 1931 Y.dsp"],
            _ => ["None", "None"],
        };
        let _ = write!(
            text,
            "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">{}</Wavelength>\n<SourceSpectrum>{source}</SourceSpectrum>\n<DetectorSpectrum>{eye}</DetectorSpectrum>\n<WavelengthDataBlock>\n<WavelengthDataDirection>{direction}</WavelengthDataDirection>\n<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems Full</RowAngleBasis>\n<ScatteringDataType>{scatter}</ScatteringDataType>\n<ScatteringData>\n",
            self.name
        );
        for row in matrix.chunks(PATCHES) {
            for value in row {
                // Radiance takes no negative values, which a control variate may give within its error
                let _ = write!(text, "{:.6e},", value.max(0.0));
            }
            text.push('\n');
        }
        text.push_str("</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n");
    }
}

/// The file up to the rings of its basis.
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
<IncidentDataStructure>Columns</IncidentDataStructure>
<AngleBasis>
<AngleBasisName>LBNL/Klems Full</AngleBasisName>
"#;
