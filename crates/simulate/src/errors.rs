//! The errors of results by where they come from: rays, surfaces, mesh.

pub(crate) mod budget;
pub(crate) mod convergence;
pub(crate) mod mesh_error;
pub(crate) mod refinement;
