//! Gaussian facets: slopes, normals, half vectors and single scattering without shadowing.

pub(crate) mod bsdf;
pub(crate) mod half_vector;
pub(crate) mod normals;
pub(crate) mod slopes;
pub(crate) mod visible_normals;
