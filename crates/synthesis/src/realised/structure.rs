//! Expected and realised statistics of a structured surface.

use serde::Serialize;

use crate::{Provenance, Structure, StructureSynthesis};
use asperity_surface::HeightField;

/// Expected and realised statistics of a structured surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RealisedStructure {
    /// Highest to lowest point, length units; without roughness on top.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<Expectation>,
    /// Fraction of the samples that features cover; of structures in or on a plane, without roughness on top. Left out of pyramids that touch,
    /// where samples on the edges between them lie in the plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Expectation>,
    /// Mean of the squared gradient over both axes together, of the facets.
    pub mean_square_slope: Expectation,
    /// `true` if features meet the plane at right angles, as hemispheres do: the mean square slope of the continuous surface is infinite.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_vertical_edges: bool,
    /// Period of grooves, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period: Option<Expectation>,
    /// Angle from +x to the direction along grooves, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth_degrees: Option<Expectation>,
    /// Distances between columns and rows of a lattice as they fit the tile, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitches: Option<[f64; 2]>,
}

/// One number, as expected and as realised.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Expectation {
    /// Value expected of the continuous surface, on average over realisations; `None` if it is not known in closed form.
    pub expected: Option<f64>,
    /// Value of this surface.
    pub realised: f64,
}

impl RealisedStructure {
    /// Figures of a `field` of a structure with this height from the lowest to the highest point and this mean square slope; `None` for other
    /// surfaces.
    pub(super) fn of(field: &HeightField, height: f64, square_slope: f64) -> Option<Self> {
        let surface = Provenance::of(field.provenance())?.recipe.structured()?;
        let structure = *surface.structure();
        let synthesis =
            StructureSynthesis::new(structure, field.shape(), field.spacing(), true).ok()?;
        let of_structure = synthesis.expected();
        let is_bare = surface.roughness().is_none();
        let added = surface.roughness().map_or(0.0, |psd| {
            let [xx, _, yy] = psd.slope_covariance();
            xx + yy
        });
        let grooves = match (structure, synthesis.period_and_azimuth()) {
            (Structure::Grooves(grooves), Some(found)) => Some((grooves, found)),
            _ => None,
        };
        let square_slope_expected = of_structure.mean_square_slope;
        let adjusted = |requested: f64, realised: f64| Expectation {
            expected: Some(requested),
            realised,
        };
        Some(Self {
            depth: is_bare.then_some(Expectation {
                expected: of_structure.depth,
                realised: height,
            }),
            coverage: (is_bare && grooves.is_none() && !touches(&structure, &synthesis)).then(
                || Expectation {
                    expected: of_structure.coverage,
                    realised: coverage_of(field, &structure),
                },
            ),
            mean_square_slope: Expectation {
                expected: square_slope_expected
                    .map(|slope| slope + added)
                    .filter(|slope| slope.is_finite()),
                realised: square_slope,
            },
            has_vertical_edges: square_slope_expected == Some(f64::INFINITY),
            period: grooves.map(|(grooves, [period, _])| adjusted(grooves.width, period)),
            azimuth_degrees: grooves.map(|(grooves, [_, azimuth])| {
                adjusted(grooves.azimuth.to_degrees(), azimuth.to_degrees())
            }),
            pitches: synthesis.pitches(),
        })
    }
}

/// Returns `true` if the bases of pyramids on a lattice share their sides.
fn touches(structure: &Structure, synthesis: &StructureSynthesis) -> bool {
    match structure {
        Structure::Pyramids(pyramids) | Structure::Inverted(pyramids) => {
            let touching = pyramids.width * (1.0 + 1e-9);
            synthesis
                .pitches()
                .is_some_and(|pitches| pitches.iter().any(|pitch| *pitch <= touching))
        }
        _ => false,
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
