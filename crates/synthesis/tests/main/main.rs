//! All integration tests of the crate, in one binary.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests fail as their helpers do, and say what they measured"
)]

mod slope_mixture;
mod structures;
mod student_slopes;
mod synthesis;
mod transformed_heights;
