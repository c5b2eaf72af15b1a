//! Interaction of light with a surface: scattering at one facet, the layer below, and the sum of first interactions over
//! all facets.

pub(crate) mod facet;
pub(crate) mod layer;
pub(crate) mod polarised;
pub(crate) mod rayleigh;
pub(crate) mod unshadowed;
