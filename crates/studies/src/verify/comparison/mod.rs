//! Models against explicit results: which component is compared with what, peaks, sides, conclusions.

pub(crate) mod compared;
pub(crate) mod conclusion;
pub(crate) mod json;
pub(crate) mod models;
pub(crate) mod peak;
mod ray_counts;
pub(crate) mod side_difference;
