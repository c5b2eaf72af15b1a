//! Control variates: by the slopes of random surfaces, and by the facets of a given one.

mod facets;
pub(crate) mod slopes;

pub(crate) use facets::FacetSums;
