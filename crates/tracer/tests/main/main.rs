//! Integration tests of the crate, in one binary; the stress harness has its own.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and report as tests do"
)]

mod accelerators;
mod common;
mod conductors;
mod control_variates;
mod diffuse;
mod films;
mod layers;
mod layers_against_reference;
mod light_beams;
mod meshes;
mod physics;
mod polarised;
mod polarised_paths;
mod polarised_table;
mod smooth;
mod smooth_paths;
mod structures;
mod visibility;
mod wavefront;
