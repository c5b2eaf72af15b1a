//! Accelerator: the interface by which rays are intersected with a tile.

use super::kind::AcceleratorKind;
use crate::geometry::Geometry;
use crate::ray::{Hit, Query, RayBatch, RayColumns};

/// Finds where rays meet the facets of one tile.
///
/// All accelerators return the same hit for the same ray: the facet of smallest `t`, and among
/// equals the first in the order of [`Geometry::Facet`].
pub trait Accelerator<G: Geometry>: Send + Sync {
    /// Which accelerator this is.
    fn kind(&self) -> AcceleratorKind;

    /// Bytes that it holds, in addition to the geometry.
    fn bytes(&self) -> usize;

    /// The instructions with which it searches, where there is a choice.
    fn instructions(&self) -> Option<String> {
        None
    }

    /// First facet of the tile that a ray passes through.
    fn closest_hit(&self, geometry: &G, query: &Query) -> Option<Hit<G::Facet>>;

    /// Finds the hits of those of many `rays` whose numbers are in `which`. `hits` is cleared and gets one entry per
    /// number.
    fn closest_hits(
        &self,
        geometry: &G,
        rays: RayColumns<'_>,
        which: &[u32],
        hits: &mut Vec<Option<Hit<G::Facet>>>,
    ) {
        let query = |&i: &u32| rays.query(i as usize);
        hits.clear();
        hits.extend(which.iter().map(|i| self.closest_hit(geometry, &query(i))));
    }

    /// Finds the hits of rays given one by one. `hits` is cleared and gets one entry per query.
    fn closest_hits_of(
        &self,
        geometry: &G,
        queries: &[Query],
        hits: &mut Vec<Option<Hit<G::Facet>>>,
    ) {
        let rays: RayBatch = queries.iter().collect();
        let all: Vec<u32> = (0..queries.len() as u32).collect();
        self.closest_hits(geometry, rays.columns(), &all, hits);
    }
}

/// A surface, and how hits on it are found.
pub struct SearchedSurface<'a, G: Geometry> {
    /// The surface.
    pub geometry: &'a G,
    /// Accelerator that finds hits on it.
    pub accelerator: &'a dyn Accelerator<G>,
}

impl<G: Geometry> Clone for SearchedSurface<'_, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G: Geometry> Copy for SearchedSurface<'_, G> {}

/// Height range, in columns, up to which surfaces are traced: beyond, single precision would no
/// longer tell neighbouring columns apart, and heights and spacing are hardly in the same unit.
pub(super) const MAX_HEIGHT_RANGE: f64 = 1e5;

/// Error of an accelerator that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// Too many facets.
    #[error("a hierarchy over {facets} facets is too large; {most} is the most")]
    TooManyFacets {
        /// Facets of the surface.
        facets: usize,
        /// Facets that one hierarchy can hold.
        most: usize,
    },
    /// Heights out of proportion to the spacing.
    #[error(
        "the heights span {columns:.3e} column spacings, more than {MAX_HEIGHT_RANGE:e}: are heights and spacing in the same unit?"
    )]
    TooTall {
        /// Height range over the column spacing.
        columns: f64,
    },
    /// An accelerator for flat surfaces, and another one, or smooth cells.
    #[error("the accelerator flat is for flat surfaces of flat cells; take auto")]
    NotFlat,
    /// An accelerator for height fields, and a mesh.
    #[error(
        "the accelerator {kind} needs a height field, but this is a triangle mesh; take auto, mesh or brute-force"
    )]
    NeedsHeightField {
        /// The requested accelerator.
        kind: AcceleratorKind,
    },
}
