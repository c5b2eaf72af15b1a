//! The engine through its door, `simulate`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and speak as tests do"
)]

mod after;
mod budget;
mod mesh_error;
mod resuming;
mod sharing;
mod stopping;
mod support;
