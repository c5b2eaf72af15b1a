//! Structures of `[surface]`: pits, caps, grooves, scratches, cracks and pyramids.

use std::f64::consts::PI;

use asperity_synthesis::{
    Arrangement, Cracks, GrooveProfile, Grooves, Pyramids, Scratches, SphericalSegments, Structure,
};
use serde::{Deserialize, Serialize};

use crate::config::values::{Number, OneOrMany};

/// Width of features where it is not given, length units.
const WIDTH: f64 = 16.0;

/// Side of a tile in widths of features where its size is not given.
const TILE: f64 = 16.0;

/// The structure of `[surface]`. What is not given has the default of its features.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StructureConfig {
    /// Its features.
    #[serde(flatten)]
    pub features: Features,
    /// Depth of features, one or several, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<OneOrMany<Number>>,
    /// Width of features, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<Number>,
}

/// The features of a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "structure", rename_all = "kebab-case")]
pub enum Features {
    /// Spherical pits.
    Pits(SegmentFeatures),
    /// Spherical caps.
    Caps(SegmentFeatures),
    /// V grooves.
    VGrooves(GrooveFeatures),
    /// Sine grooves, which have no edges.
    SineGrooves {
        /// Half the range of sizes, as a fraction of their mean.
        #[serde(skip_serializing_if = "Option::is_none")]
        randomness: Option<Number>,
    },
    /// Blazed grooves.
    BlazedGrooves(GrooveFeatures),
    /// Scratches.
    Scratches(ScratchFeatures),
    /// Cracks.
    Cracks(CrackFeatures),
    /// Upright pyramids.
    Pyramids(PyramidFeatures),
    /// Inverted pyramids.
    InvertedPyramids(PyramidFeatures),
}

/// Pits or caps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SegmentFeatures {
    /// Area of all features over that of the tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<Number>,
    /// Radius of curvature of edges, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge_radius: Option<Number>,
    /// Half the range of sizes, as a fraction of their mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub randomness: Option<Number>,
    /// Arrangement of features.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrangement: Option<Arrangement>,
}

/// Grooves with edges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GrooveFeatures {
    /// Radius of curvature of edges, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge_radius: Option<Number>,
    /// Half the range of sizes, as a fraction of their mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub randomness: Option<Number>,
}

/// Scratches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScratchFeatures {
    /// Length of scratches, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scratch_length: Option<Number>,
    /// Area of all scratches over that of the tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<Number>,
    /// Standard deviation of their directions, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<Number>,
    /// Radius of curvature of edges, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge_radius: Option<Number>,
    /// Half the range of sizes, as a fraction of their mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub randomness: Option<Number>,
}

/// Cracks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrackFeatures {
    /// Area of all cracks over that of the tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<Number>,
    /// Radius of curvature of edges, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge_radius: Option<Number>,
}

/// Pyramids.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PyramidFeatures {
    /// Area of all features over that of the tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<Number>,
    /// Half the range of sizes, as a fraction of their mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub randomness: Option<Number>,
    /// Arrangement of features.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrangement: Option<Arrangement>,
}

fn or(value: Option<Number>, otherwise: f64) -> f64 {
    value.map_or(otherwise, |value| value.0)
}

impl StructureConfig {
    /// The structure with its parameters, which are not checked here, and the first of several depths. `azimuth`: radians.
    #[must_use]
    pub fn structure(&self, azimuth: f64) -> Structure {
        let width = self.width();
        let first = self.depth.as_ref().and_then(OneOrMany::first);
        let depth = or(first, 0.25 * width);
        let segments = |own: &SegmentFeatures, otherwise| {
            let arrangement = own.arrangement.unwrap_or(otherwise);
            let density = match arrangement {
                // Touching
                Arrangement::Lattice => PI / (2.0 * 3_f64.sqrt()),
                Arrangement::Random => 0.5,
                Arrangement::Separate => 0.3,
            };
            SphericalSegments {
                depth,
                width,
                density: or(own.density, density),
                edge_radius: or(own.edge_radius, 0.0),
                randomness: or(own.randomness, 0.0),
                arrangement,
            }
        };
        let grooves = |profile, edge_radius, randomness| {
            Structure::Grooves(Grooves {
                profile,
                depth,
                width,
                azimuth,
                edge_radius: or(edge_radius, 0.0),
                randomness: or(randomness, 0.0),
            })
        };
        let pyramids = |own: &PyramidFeatures, otherwise| {
            let arrangement = own.arrangement.unwrap_or(otherwise);
            let density = match arrangement {
                Arrangement::Lattice => 1.0,
                Arrangement::Random | Arrangement::Separate => 5.0,
            };
            Pyramids {
                depth: or(first, Pyramids::crystal_height(width)),
                width,
                density: or(own.density, density),
                randomness: or(own.randomness, 0.0),
                arrangement,
            }
        };
        match &self.features {
            Features::Pits(own) => Structure::Pits(segments(own, Arrangement::Random)),
            Features::Caps(own) => Structure::Caps(segments(own, Arrangement::Lattice)),
            Features::VGrooves(own) => grooves(GrooveProfile::V, own.edge_radius, own.randomness),
            Features::SineGrooves { randomness } => grooves(GrooveProfile::Sine, None, *randomness),
            Features::BlazedGrooves(own) => {
                grooves(GrooveProfile::Blazed, own.edge_radius, own.randomness)
            }
            Features::Scratches(own) => Structure::Scratches(Scratches {
                depth,
                width,
                length: or(own.scratch_length, 20.0 * width),
                density: or(own.density, 0.5),
                azimuth,
                spread: or(own.spread, 5.0).to_radians(),
                edge_radius: or(own.edge_radius, 0.0),
                randomness: or(own.randomness, 0.0),
            }),
            Features::Cracks(own) => Structure::Cracks(Cracks {
                depth,
                width,
                density: or(own.density, 0.3),
                edge_radius: or(own.edge_radius, 0.0),
            }),
            Features::Pyramids(own) => Structure::Pyramids(pyramids(own, Arrangement::Random)),
            Features::InvertedPyramids(own) => {
                Structure::Inverted(pyramids(own, Arrangement::Lattice))
            }
        }
    }

    /// Returns `true` if it has a direction that the azimuth turns.
    pub(super) fn has_direction(&self) -> bool {
        let structure = self.structure(0.0);
        matches!(structure, Structure::Grooves(_) | Structure::Scratches(_))
    }

    /// Length units per sample where that is not given: a sixteenth of the width, an eighth of that of long features.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        match self.features {
            Features::Scratches(_) | Features::Cracks(_) => self.width() / 8.0,
            _ => self.width() / 16.0,
        }
    }

    /// Side of the tile where its size is not given, length units: 16 widths, the length of scratches, or ten cells between cracks.
    #[must_use]
    pub fn tile(&self) -> f64 {
        let side = TILE * self.width();
        match self.structure(0.0) {
            Structure::Scratches(scratches) => side.max(scratches.length),
            Structure::Cracks(cracks) => side.max(10.0 * 2.0 * cracks.width / cracks.density),
            _ => side,
        }
    }

    fn width(&self) -> f64 {
        or(self.width, WIDTH)
    }
}
