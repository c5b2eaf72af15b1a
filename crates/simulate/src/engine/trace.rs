//! Tracing: rays in blocks, blocks on surfaces, surfaces in rounds.

pub(crate) mod block_run;
pub(crate) mod blocks;
pub(crate) mod joint;
pub(crate) mod rounds;
pub(crate) mod stage;
mod surface_run;
pub(crate) mod surfaces;
mod turns;
mod watch;
