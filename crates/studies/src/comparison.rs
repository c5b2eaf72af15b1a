//! Models against explicit results: which component is compared with what, peaks, sides, conclusions.

/// Warning on models of layers where light is polarised.
pub(crate) const AVERAGED_LAYERS: &str = "models of layers average s and p at each face; --polarisation averaged compares like with like";

pub(crate) mod compared;
pub(crate) mod conclusion;
pub(crate) mod json;
pub(crate) mod judgement;
pub(crate) mod model_rays;
pub(crate) mod models;
pub(crate) mod other_slopes;
pub(crate) mod peak;
mod ray_counts;
pub(crate) mod region_shifts;
pub(crate) mod side_difference;
pub(crate) mod slope_tables;
