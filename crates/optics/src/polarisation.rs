//! Polarised light: Stokes vectors, and Mueller matrices of facets and of light paths.
//!
//! Axes, signs and units are on the page of the crate. Everything that a path needs at a facet is plain arithmetic that
//! selects and does not branch, as [`dielectric`](crate::dielectric) is, so that loops over many rays take vector
//! instructions.

mod facet;
mod frame;
mod mueller;

pub use facet::{FacetMueller, PolarisedFresnel, polarised_conductor, polarised_dielectric};
pub use frame::{Turn, incidence_axis, reference_axes};
pub use mueller::{Mueller, Stokes};
