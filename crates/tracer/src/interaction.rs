//! What a surface does with light: one interaction at a facet, the layer below, and the sum of first interactions
//! over all facets.

pub(crate) mod below;
pub(crate) mod facet;
pub(crate) mod layer;
pub(crate) mod polarised;
pub(crate) mod rayleigh;
pub(crate) mod unshadowed;
