//! The engine through its entry point, `simulate`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests panic and print as tests do"
)]

mod after;
mod apertures;
mod budget;
mod conductors;
mod engines;
mod ensembles;
mod fold;
mod lobes;
mod mesh_error;
mod other_slopes;
mod paths;
mod regions;
mod resuming;
mod sharing;
mod smooth;
mod stacks;
mod stopping;
mod streaming;
mod support;
