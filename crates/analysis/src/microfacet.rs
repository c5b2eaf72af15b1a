//! Facets, Gaussian, GGX or of a table: their slopes, the distribution of their normals, half vectors and single scattering.

pub(crate) mod beckmann;
pub(crate) mod bsdf;
pub(crate) mod bsdf_columns;
pub(crate) mod facet_normals;
pub(crate) mod ggx;
pub(crate) mod half_vector;
pub(crate) mod lambda;
pub(crate) mod lambda_curve;
pub(crate) mod lambda_map;
pub(crate) mod mueller;
mod normals;
pub(crate) mod slope_distribution;
pub(crate) mod slope_frame;
pub(crate) mod slope_grid;
pub(crate) mod slope_mixture;
pub(crate) mod slope_table;
pub(crate) mod slopes;
pub(crate) mod smith_normals;
pub(crate) mod visible_normals;
