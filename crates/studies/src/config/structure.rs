//! Structures of `[surface]`: pits, caps, grooves, scratches, cracks and pyramids.

use asperity_synthesis::{
    Arrangement, Cracks, GrooveProfile, Grooves, Pyramids, Scratches, SphericalSegments, Structure,
};
use serde::{Deserialize, Serialize};

use crate::config::values::{Number, OneOrMany};

/// Width of features where it is not given, length units.
const WIDTH: f64 = 16.0;

/// Side of a tile in widths of features where its size is not given.
const TILE: f64 = 16.0;

/// Name of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StructureKind {
    /// Spherical pits.
    Pits,
    /// Spherical caps.
    Caps,
    /// V grooves.
    VGrooves,
    /// Sine grooves.
    SineGrooves,
    /// Blazed grooves.
    BlazedGrooves,
    /// Scratches.
    Scratches,
    /// Cracks.
    Cracks,
    /// Upright pyramids.
    Pyramids,
    /// Inverted pyramids.
    InvertedPyramids,
}

/// The structure of `[surface]`. What is not given has the default of its kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StructureConfig {
    /// Its kind.
    #[serde(rename = "structure")]
    pub kind: StructureKind,
    /// Depth of features, one or several, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<OneOrMany<Number>>,
    /// Width of features, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<Number>,
    /// Length of scratches, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scratch_length: Option<Number>,
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
    /// Standard deviation of the directions of scratches, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<Number>,
}

impl StructureConfig {
    /// The structure with its parameters, which are not checked here, and the first of several depths. `azimuth`: radians.
    #[must_use]
    pub fn structure(&self, azimuth: f64) -> Structure {
        let or = |value: Option<Number>, otherwise: f64| value.map_or(otherwise, |v| v.0);
        let width = self.width();
        let depth = self.depth.as_ref().and_then(OneOrMany::first);
        let depth = |otherwise| or(depth, otherwise);
        let density = |otherwise| or(self.density, otherwise);
        let edge_radius = or(self.edge_radius, 0.0);
        let randomness = or(self.randomness, 0.0);
        let arrangement = |otherwise| self.arrangement.unwrap_or(otherwise);
        let segments = |otherwise| {
            let arrangement = arrangement(otherwise);
            SphericalSegments {
                depth: depth(0.25 * width),
                width,
                density: density(match arrangement {
                    // Touching
                    Arrangement::Lattice => std::f64::consts::PI / (2.0 * 3_f64.sqrt()),
                    Arrangement::Random => 0.5,
                    Arrangement::Separate => 0.3,
                }),
                edge_radius,
                randomness,
                arrangement,
            }
        };
        let grooves = |profile| {
            Structure::Grooves(Grooves {
                profile,
                depth: depth(0.25 * width),
                width,
                azimuth,
                edge_radius,
                randomness,
            })
        };
        let pyramids = |otherwise| {
            let arrangement = arrangement(otherwise);
            Pyramids {
                depth: depth(Pyramids::crystal_height(width)),
                width,
                density: density(match arrangement {
                    Arrangement::Lattice => 1.0,
                    Arrangement::Random | Arrangement::Separate => 5.0,
                }),
                randomness,
                arrangement,
            }
        };
        match self.kind {
            StructureKind::Pits => Structure::Pits(segments(Arrangement::Random)),
            StructureKind::Caps => Structure::Caps(segments(Arrangement::Lattice)),
            StructureKind::VGrooves => grooves(GrooveProfile::V),
            StructureKind::SineGrooves => grooves(GrooveProfile::Sine),
            StructureKind::BlazedGrooves => grooves(GrooveProfile::Blazed),
            StructureKind::Scratches => Structure::Scratches(Scratches {
                depth: depth(0.25 * width),
                width,
                length: self.scratch_length(),
                density: density(0.5),
                azimuth,
                spread: or(self.spread, 5.0).to_radians(),
                edge_radius,
                randomness,
            }),
            StructureKind::Cracks => Structure::Cracks(Cracks {
                depth: depth(0.25 * width),
                width,
                density: density(0.3),
                edge_radius,
            }),
            StructureKind::Pyramids => Structure::Pyramids(pyramids(Arrangement::Random)),
            StructureKind::InvertedPyramids => Structure::Inverted(pyramids(Arrangement::Lattice)),
        }
    }

    /// Returns `true` if it has a direction that the azimuth turns.
    pub(super) const fn has_direction(&self) -> bool {
        use StructureKind::{BlazedGrooves, Scratches, SineGrooves, VGrooves};
        matches!(
            self.kind,
            VGrooves | SineGrooves | BlazedGrooves | Scratches
        )
    }

    /// Length units per sample where that is not given: a sixteenth of the width, an eighth of that of long features.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        match self.kind {
            StructureKind::Scratches | StructureKind::Cracks => self.width() / 8.0,
            _ => self.width() / 16.0,
        }
    }

    /// Side of the tile where its size is not given, length units: 16 widths, the length of scratches, or ten cells between cracks.
    #[must_use]
    pub fn tile(&self) -> f64 {
        let side = TILE * self.width();
        match self.kind {
            StructureKind::Scratches => side.max(self.scratch_length()),
            StructureKind::Cracks => {
                let density = self.density.map_or(0.3, |d| d.0);
                side.max(10.0 * 2.0 * self.width() / density)
            }
            _ => side,
        }
    }

    fn width(&self) -> f64 {
        self.width.map_or(WIDTH, |width| width.0)
    }

    fn scratch_length(&self) -> f64 {
        self.scratch_length
            .map_or(20.0 * self.width(), |length| length.0)
    }
}
