//! The accelerators, each in a file of its own; single precision and obvhs stay in this folder.

pub(crate) mod accelerator;
pub(crate) mod brute_force;
pub(crate) mod flat;
pub(crate) mod mesh_bvh;
mod obvhs_ray;
pub(crate) mod pyramid;
pub(crate) mod tile_bvh;
