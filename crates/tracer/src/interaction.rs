//! Interaction of light with a surface: scattering at one facet, the layers below, and the sum of first interactions over
//! all facets.

pub(crate) mod facet;
pub(crate) mod polarised;
pub(crate) mod rayleigh;
pub(crate) mod stack;
pub(crate) mod unshadowed;
