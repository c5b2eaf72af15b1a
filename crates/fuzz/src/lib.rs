//! Fuzzing: damaged files for every reader of the workspace.
//!
//! A [`Target`] is a reader with the file that it is given. [`Run`] damages its seeds by a seeded generator, and an input that a reader
//! refuses in new words joins the seeds, so that later inputs get further. A refusal must be one line; a panic is caught and counted. What
//! ends a process (a hang, no memory, too deep a recursion) is seen by the program, which gives each target a process of its own.

mod containers;
mod mutate;
mod run;
mod seeds;
mod targets;

pub use run::{Limit, Run, Tally};
pub use seeds::write_seeds;
pub use targets::{Target, broken, targets};
