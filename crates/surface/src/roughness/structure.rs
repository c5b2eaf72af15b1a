//! Requested and realised statistics of a structured surface.

use serde::Serialize;

use super::compared::Compared;
use crate::{HeightField, Structure, StructureSynthesis};

/// Requested and realised statistics of a structured surface. Requested is what is expected of the continuous surface, `None` where
/// that is not known in closed form.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealisedStructure {
    /// Highest to lowest point, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<Compared>,
    /// Fraction of the mean plane that features cover; samples off the plane are counted, if there is no roughness on top.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Compared>,
    /// Mean of the squared gradient over both axes together, of the facets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_square_slope: Option<Compared>,
    /// Period of grooves, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period: Option<Compared>,
    /// Angle from +x to the direction along grooves, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth_degrees: Option<Compared>,
    /// Distances between columns and rows of a lattice, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitches: Option<[f64; 2]>,
}

impl RealisedStructure {
    /// Compares the height from the lowest to the highest point and the mean square slope of `field` with its provenance; `None`
    /// of other surfaces.
    pub(super) fn of(field: &HeightField, height: f64, square_slope: f64) -> Option<Self> {
        let surface = field.provenance()?.recipe.structured()?;
        let structure = *surface.structure();
        let synthesis =
            StructureSynthesis::new(structure, field.shape(), field.spacing(), true).ok()?;
        let expected = synthesis.expected();
        let compared = |requested: f64, realised: f64| Compared {
            requested,
            realised: Some(realised),
            expected_deviation: None,
        };
        let is_bare = surface.roughness().is_none();
        let added = surface.roughness().map_or(0.0, |psd| {
            let [xx, _, yy] = psd.slope_covariance();
            xx + yy
        });
        let grooves = match (structure, synthesis.period_and_azimuth()) {
            (Structure::Grooves(grooves), Some(found)) => Some((grooves, found)),
            _ => None,
        };
        let slope = |slope: f64| compared(slope + added, square_slope);
        Some(Self {
            depth: expected
                .depth
                .filter(|_| is_bare)
                .map(|depth| compared(depth, height)),
            coverage: expected
                .coverage
                .filter(|_| is_bare)
                .map(|coverage| compared(coverage, coverage_of(field, &structure))),
            mean_square_slope: expected.mean_square_slope.map(slope),
            period: grooves.map(|(grooves, [period, _])| compared(grooves.width, period)),
            azimuth_degrees: grooves.map(|(grooves, [_, azimuth])| {
                compared(grooves.azimuth.to_degrees(), azimuth.to_degrees())
            }),
            pitches: synthesis.pitches(),
        })
    }
}

/// Fraction of samples off the plane, which is the lowest level of features that stand on it and the highest of all others.
fn coverage_of(field: &HeightField, structure: &Structure) -> f64 {
    let heights = field.heights().iter().copied();
    let plane = match structure {
        Structure::Caps(_) | Structure::Pyramids(_) => heights.fold(f64::INFINITY, f64::min),
        _ => heights.fold(f64::NEG_INFINITY, f64::max),
    };
    let off = field.heights().iter().filter(|h| **h != plane).count();
    off as f64 / field.heights().len() as f64
}
