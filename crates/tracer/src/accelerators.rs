//! Accelerators: find the hits of rays on the facets of one tile.
//!
//! `accelerator.rs` is the interface, `brute_force.rs` the specification that every other accelerator must agree
//! with, and `chooser.rs` builds one by its name. Single precision and obvhs stay in this folder.

pub(crate) mod accelerator;
pub(crate) mod brute_force;
pub(crate) mod chooser;
pub(crate) mod flat;
pub(crate) mod kind;
pub(crate) mod mesh_bvh;
mod obvhs_ray;
mod overlaps;
pub(crate) mod pyramid;

pub(crate) use accelerator::{Accelerator, SearchedSurface};
