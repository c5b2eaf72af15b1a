//! Scatter: reflects and transmits the light that has arrived, and decides which branches continue.

pub(crate) mod branch;
pub(crate) mod facets;
pub(crate) mod interaction;
pub(crate) mod joint;
pub(crate) mod roulette;
