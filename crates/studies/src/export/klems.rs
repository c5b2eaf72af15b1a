//! Klems: XML of Radiance, WINDOW and EnergyPlus with the transmission and reflection of a slab between 145 patches, from both sides.
//!
//! The value of a matrix is the mean BSDF between two patches, 1/sr, of light that is uniform over the patch that it comes from: rows are patches of
//! light that leaves, columns of light that comes.

use std::fmt::Write;

use asperity_optics::{KLEMS, Spread};
use asperity_simulate::Light;
use asperity_tally::Side;
use asperity_tracer::HalfSpace;

use super::contents::{Agreement, Contents};
use super::measurement::Measurement;
use super::planned::Planned;
use super::ranges::Range;
use super::window_element::{
    BLOCKS, Block, Weighted, WindowElement, check_slab, in_solar, in_visible, weighted_flux,
};

/// Patches of incidence.
const PATCHES: usize = 145;

/// A patch: its polar angles, its azimuths, and the azimuth of its centre, degrees.
#[derive(Clone, Copy)]
struct Patch {
    range: Range,
    centre_deg: f64,
}

impl Patch {
    /// Azimuth towards light that travels towards the patch, degrees from 0 to 360.
    fn light_deg(&self) -> f64 {
        (self.centre_deg + 180.0).rem_euclid(360.0)
    }

    /// Returns `true` if light travels towards the patch, or, from random azimuths, towards one of its ring.
    fn is_lit_by(&self, light: &Light) -> bool {
        let [lower, upper] = self.range.theta_deg;
        let is_turned = lower == 0.0 || light.random_azimuth;
        let centre = light.incidence.phi_deg().rem_euclid(360.0);
        (lower..upper).contains(&light.incidence.theta_deg())
            && (is_turned || (centre - self.light_deg()).abs() < 1e-6)
    }
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

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, String> {
    let outcomes = measurement.outcomes()?;
    let visible = in_visible(&outcomes)?;
    let solar = in_solar(&outcomes);
    let is_of_one = visible.len() == outcomes.len() && visible[0].1 == 1.0;
    let nm = outcomes[0].case.at.wavelength_nm();
    let (names, note): (&[&str], _) = match (is_of_one, &solar) {
        (true, _) => (
            &["Visible", "Solar"],
            nm.map_or_else(
                || "the same values stand for both bands, Visible and Solar".to_owned(),
                |nm| format!("values of {nm} nm stand for both bands, Visible and Solar"),
            ),
        ),
        (false, Some(_)) => (
            &["Visible"],
            "the Solar band is weighted by ASTM G173-03 from 300 to 2500 nm".to_owned(),
        ),
        (false, None) => (
            &["Visible"],
            "the Visible band alone: Solar needs wavelengths from 350 to 2000 nm in steps of at most 100 nm".to_owned(),
        ),
    };
    let mut file = WindowElement::new(outcomes[0], "Columns", &definition());
    let mut agreement = Vec::new();
    let bands = [(names, Some(visible)), (&["Solar"], solar)];
    for (names, weighted) in &bands {
        let weighted = weighted
            .iter()
            .flatten()
            .copied()
            .collect::<Vec<Weighted>>();
        if weighted.is_empty() {
            continue;
        }
        for block in BLOCKS {
            let columns = Columns::of(block, &weighted)?;
            let matrix = columns.matrix(block.side);
            if names[0] == "Visible" {
                agreement.extend(columns.agreement(block.side, &matrix));
            }
            for band in *names {
                file.add(band, block, BASES, &text_of(&matrix));
            }
        }
    }
    let mut notes = file.notes();
    notes.push(note);
    Ok(Contents {
        bytes: file.into_bytes(),
        agreement,
        notes,
    })
}

/// Bases of rows and columns.
const BASES: &str = "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems Full</RowAngleBasis>";

/// XML of the basis.
fn definition() -> String {
    let mut text = "<AngleBasis>\n<AngleBasisName>LBNL/Klems Full</AngleBasisName>\n".to_owned();
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
    text + "</AngleBasis>\n"
}

/// Checks that a file can hold such cases.
pub(super) fn check(cases: &[Planned]) -> Result<(), String> {
    check_slab(cases)?;
    let is_patch = |one: &Planned| {
        let light = &one.case.light;
        light.spread.is_some() && light.spread == Spread::klems(light.incidence).ok()
    };
    if !cases.iter().all(is_patch) {
        return Err(
            "needs patches that are lit as a whole: measure with gonio --for klems".to_owned(),
        );
    }
    for from in [HalfSpace::Above, HalfSpace::Below] {
        let mut lights: Vec<&Light> = cases.iter().map(|one| &one.case.light).collect();
        lights.retain(|light| light.from == from);
        if !patches().all(|patch| lights.iter().any(|light| patch.is_lit_by(light))) {
            return Err("needs light from all patches: measure with gonio --for klems, without --theta, --phi or --directions".to_owned());
        }
    }
    Ok(())
}

/// Outcomes of each patch of incidence, with their weights.
struct Columns<'a>(Vec<Vec<Weighted<'a>>>);

impl<'a> Columns<'a> {
    fn of(block: Block, weighted: &[Weighted<'a>]) -> Result<Self, String> {
        let lit = block.lit(weighted);
        let mut wavelengths: Vec<Option<f64>> = weighted
            .iter()
            .map(|(one, _)| one.case.at.wavelength_nm())
            .collect();
        wavelengths.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        wavelengths.dedup();
        let per_patch = wavelengths.len();
        let columns = patches().map(|patch| {
            let is_of_patch = |(outcome, _): &&Weighted| patch.is_lit_by(&outcome.case.light);
            let found: Vec<Weighted> = lit.iter().filter(is_of_patch).copied().collect();
            match found.len() == per_patch {
                true => Ok(found),
                false => Err("needs the same patches of the light at all wavelengths".to_owned()),
            }
        });
        columns.collect::<Result<_, _>>().map(Self)
    }

    /// Mean BSDF, row by row of patches of light that leaves on `side`.
    fn matrix(&self, side: Side) -> Vec<f64> {
        let mut matrix = vec![0.0; PATCHES * PATCHES];
        for (column, (incident, lit)) in patches().zip(&self.0).enumerate() {
            for (outcome, weight) in lit {
                let light = outcome.case.light;
                // A sample without a direction of its own is turned below the light
                let turn = match light.random_azimuth {
                    true => incident.light_deg() - light.incidence.phi_deg(),
                    false => 0.0,
                };
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
        // Radiance takes no negative values, which a control variate may give within its error
        matrix.iter().map(|value| value.max(0.0)).collect()
    }

    /// The light of each patch that was measured.
    fn agreement(&self, side: Side, matrix: &[f64]) -> Vec<Agreement> {
        let columns = self.0.iter().enumerate();
        let measured = columns.filter(|(column, lit)| {
            *column == 0 || !std::ptr::eq(self.0[column - 1][0].0, lit[0].0)
        });
        measured
            .map(|(column, lit)| {
                let exported = patches().enumerate().map(|(row, leaving)| {
                    matrix[row * PATCHES + column] * leaving.range.projected_solid_angle()
                });
                Agreement::of(
                    &lit[0].0.case,
                    side,
                    weighted_flux(lit, side),
                    exported.sum(),
                )
            })
            .collect()
    }
}

/// A matrix as text: all numbers with commas between them, none of them negative.
fn text_of(matrix: &[f64]) -> String {
    let mut text = String::new();
    for row in matrix.chunks(PATCHES) {
        for value in row {
            let _ = write!(text, "{value:.6e},");
        }
        text.push('\n');
    }
    text
}
