//! The one interface behind which rays are intersected with a tile.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::accelerators::pyramid::Pyramid;
use crate::geometry::Geometry;
use crate::ray::{HalfSpace, Hit, TileRay};

/// A ray, and the half space that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray.
    pub ray: TileRay,
    /// Where it is.
    pub half_space: HalfSpace,
}

/// Finds where rays meet the facets of one tile.
///
/// All accelerators return the same hit for the same ray: the facet of smallest `t`, and among
/// equals the first in the order of [`Geometry::Facet`].
pub trait Accelerator<G: Geometry>: Send + Sync {
    /// Which accelerator this is.
    fn kind(&self) -> AcceleratorKind;

    /// Bytes that it holds, beside the geometry.
    fn bytes(&self) -> usize;

    /// The instructions with which it searches, where there is a choice.
    fn instructions(&self) -> Option<String> {
        None
    }

    /// First facet of the tile that a ray passes through.
    fn closest_hit(&self, geometry: &G, query: &Query) -> Option<Hit<G::Facet>>;

    /// The same for many rays; `hits` is cleared and gets one entry a query.
    fn closest_hits(&self, geometry: &G, queries: &[Query], hits: &mut Vec<Option<Hit<G::Facet>>>) {
        hits.clear();
        hits.extend(queries.iter().map(|q| self.closest_hit(geometry, q)));
    }
}

/// Height range, in columns, up to which surfaces are traced: beyond, single precision would no
/// longer tell neighbouring columns apart, and heights and spacing are hardly in the same unit.
pub(crate) const TALLEST: f64 = 1e5;

/// Why an accelerator cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// Too many facets.
    #[error("a hierarchy over {facets} triangles is too large; {most} is the most")]
    TooManyFacets {
        /// Facets of the surface.
        facets: usize,
        /// Facets that one hierarchy can hold.
        most: usize,
    },
    /// Heights out of proportion to the spacing.
    #[error(
        "the heights span {columns:.3e} column spacings, more than {TALLEST:e}: are heights and spacing in the same unit?"
    )]
    TooTall {
        /// Height range over the column spacing.
        columns: f64,
    },
    /// An accelerator for flat surfaces, and another one.
    #[error("the accelerator flat is for surfaces without any height; take auto")]
    NotFlat,
    /// An accelerator for height fields, and a mesh.
    #[error(
        "the accelerator {kind} needs a height field, but this is a triangle mesh; take auto, mesh or brute-force"
    )]
    NeedsHeightField {
        /// The accelerator asked for.
        kind: AcceleratorKind,
    },
}

/// Accelerators by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum AcceleratorKind {
    /// The best one for the scene.
    #[default]
    Auto,
    /// A bounding volume hierarchy over all triangles.
    Mesh,
    /// A pyramid of height bounds over the cells, searched by many rays at a time.
    Pyramid,
    /// A bounding volume hierarchy over square blocks of cells.
    Tiles,
    /// The plane of a surface whose heights are all equal.
    Flat,
    /// Every triangle for every ray: the reference, for small surfaces.
    BruteForce,
}

impl AcceleratorKind {
    /// What stands for `auto` on a height field of `[columns, rows]` cells; all others stay what they
    /// are.
    ///
    /// `flat` if it is flat, else `pyramid` up to the size that it can hold, else `tiles`.
    #[must_use]
    pub const fn on_height_field(self, cells: [usize; 2], flat: bool) -> Self {
        match self {
            Self::Auto if flat => Self::Flat,
            Self::Auto if Pyramid::holds(cells) => Self::Pyramid,
            Self::Auto => Self::Tiles,
            chosen => chosen,
        }
    }
}

impl fmt::Display for AcceleratorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Mesh => "mesh",
            Self::Pyramid => "pyramid",
            Self::Tiles => "tiles",
            Self::Flat => "flat",
            Self::BruteForce => "brute-force",
        })
    }
}

impl FromStr for AcceleratorKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            "mesh" => Ok(Self::Mesh),
            "pyramid" => Ok(Self::Pyramid),
            "tiles" => Ok(Self::Tiles),
            "flat" => Ok(Self::Flat),
            "brute-force" => Ok(Self::BruteForce),
            _ => Err(format!(
                "unknown accelerator `{text}`; allowed are auto, mesh, tiles, pyramid, flat and brute-force"
            )),
        }
    }
}
