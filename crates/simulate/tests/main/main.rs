//! The engine through its door, `simulate`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and speak as tests do"
)]

mod mesh_error;
mod sharing;
