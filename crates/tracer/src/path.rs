//! Path engine: follows many light paths together, from interaction to interaction, until all flux has left.
//!
//! A wavefront: each round takes all segments in flight through the same stages, each a loop over arrays in structures of arrays
//! (`state`) that is compiled for the vector (SIMD) instructions of the machine.
//!
//! | stage | folder |
//! |---|---|
//! | start new paths | `start` |
//! | search for the facets that segments hit | `travel` |
//! | reflect and refract at them, with Russian roulette | `scatter` |
//! | fly and scatter inside the layer below | `layer` |
//! | find the segments that escape, and tally them | `leave` |
//!
//! Rare segments are traced one by one (`travel/single.rs`): those beyond their first tile, and those that a control
//! variate needs (`leave/masking.rs`). `given_rays.rs` takes rays of a camera through these stages. `state` holds everything that passes between the stages. Random
//! numbers are functions of path and step ([`crate::random`]), so that no order of work changes them. The same
//! light, one path at a time, is in `reference`.

mod absorbed_cells;
mod beam;
mod given_rays;
mod illumination;
mod layer;
mod leave;
mod scatter;
mod start;
mod state;
mod tracer;
mod travel;

pub use absorbed_cells::AbsorbedCells;
pub use beam::Beam;
pub use given_rays::GivenRays;
pub use illumination::{Illumination, Starts, Window};
pub use state::conductors::MAX_CONDUCTORS;
pub use state::work::Work;
pub use tracer::Tracer;
