//! How rays are divided, traced and added until an error is reached.

pub(crate) mod blocks;
pub(crate) mod ensemble;
pub(crate) mod pilot;
pub(crate) mod sharing;
pub(crate) mod trace;
