//! Directions, the Fresnel equations, interface materials, and participating media.
//!
//! # Conventions
//! The mean plane of the surface is `z = 0` and +z points into the incident medium. `wi` points
//! towards the light, `wo` to where the light goes. Angles are radians. `eta` is the refractive
//! index behind the interface relative to that before it: `sin(theta_i) = eta sin(theta_t)` for the angles to the facet normal. An
//! absorbing conductor has the relative index `n + i k`, `k >= 0`, for the time factor `exp(-i w t)`.

mod direction;
mod fresnel;
mod interface;
mod layer;
mod material;
mod participating;
mod phase;

pub use direction::{Incidence, IncidenceError, around, azimuth, from_spherical, polar_angle};
pub use fresnel::{Fresnel, FresnelAmplitudes, conductor, conductor_amplitudes, dielectric};
pub use interface::{reflect, refract};
pub use layer::{Bottom, Layer, LayerError, Slab};
pub use material::{Material, MaterialError};
pub use participating::{ParticipatingMedium, ParticipatingMediumError};
pub use phase::{PhaseFunction, PhaseFunctionError};
