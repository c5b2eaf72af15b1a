//! The one interface behind which rays are intersected with a tile.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::brute_force::BruteForce;
use crate::bvh::MeshBvh;
use crate::ray::{Hit, Medium, TileRay};
use crate::surface::Surface;

/// Finds where rays meet the facets of one tile.
///
/// All accelerators return the same hit for the same ray: the facet of smallest `t`, and among
/// equals the first in the order of [`crate::Facet`].
pub trait Accelerator: Send + Sync {
    /// First facet of `surface`'s tile that a ray in `medium` passes through.
    fn closest_hit(&self, surface: &Surface, ray: &TileRay, medium: Medium) -> Option<Hit>;

    /// Whether any facet of the tile stands in the way.
    fn occluded(&self, surface: &Surface, ray: &TileRay, medium: Medium) -> bool {
        self.closest_hit(surface, ray, medium).is_some()
    }
}

/// Height range, in columns, up to which surfaces are traced: beyond, single precision would no
/// longer tell neighbouring columns apart, and heights and spacing are hardly in the same unit.
const TALLEST: f64 = 1e5;

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
    /// Every triangle for every ray: the reference, for small surfaces.
    BruteForce,
}

impl AcceleratorKind {
    /// The accelerator that `auto` stands for.
    #[must_use]
    pub const fn resolve(self) -> Self {
        match self {
            Self::Auto => Self::Mesh,
            chosen => chosen,
        }
    }

    /// Builds the accelerator for one tile.
    ///
    /// # Errors
    /// [`BuildError`] if the surface is too large or too tall.
    pub fn build(self, surface: &Surface) -> Result<Box<dyn Accelerator>, BuildError> {
        let [low, high] = surface.z_range();
        let columns = high - low;
        if columns.is_nan() || columns > TALLEST {
            return Err(BuildError::TooTall { columns });
        }
        Ok(match self.resolve() {
            Self::Auto | Self::Mesh => Box::new(MeshBvh::build(surface)?),
            Self::BruteForce => Box::new(BruteForce),
        })
    }
}

impl fmt::Display for AcceleratorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Mesh => "mesh",
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
            "brute-force" => Ok(Self::BruteForce),
            _ => Err(format!(
                "unknown accelerator `{text}`; allowed are auto, mesh and brute-force"
            )),
        }
    }
}
