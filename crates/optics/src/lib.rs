//! Directions, the Fresnel equations, polarised light, interface materials, and participating media.
//!
//! # Conventions
//! The mean plane of the surface is `z = 0` and +z points into the incident medium. `wi` points
//! towards the light, `wo` to where the light goes. Angles are radians. `eta` is the refractive
//! index behind the interface relative to that before it: `sin(theta_i) = eta sin(theta_t)` for the angles to the facet normal. An
//! absorbing conductor has the relative index `n + i k`, `k >= 0`, for the time factor `exp(-i w t)`.
//!
//! # Polarised light
//! A ray that travels along `k` has the axes `s = z x k / |z x k|` and `p = k x s`, so `s x p = k`; a vertical ray has
//! `s = +y`. SCATMECH calls this basis psps. Looking against the ray, s points to the right and p up. With fields of the
//! time factor `exp(-i w t)`
//!
//! ```text
//! I = |Es|^2 + |Ep|^2     Q = |Es|^2 - |Ep|^2
//! U = 2 Re(Es* Ep)        V = 2 Im(Es* Ep)
//! ```
//!
//! so that, looking against the ray, +U is linear light at 45 degrees counter-clockwise from s, and the field of +V
//! turns counter-clockwise. Mueller matrices give *flux* per incident flux: transmission has the factor
//! `eta cos(theta_t) / cos(theta_i)`, and none for radiance.

mod colour;
mod complex_root;
mod direction;
mod dispersion;
mod film;
mod fresnel;
mod interface;
mod layer;
mod material;
mod material_error;
mod participating;
mod phase;
mod polarisation;
mod spread;
mod sunlight;

pub use colour::{Colour, ColourObserver, colour_weights, linear_srgb, srgb_encoded};
pub use direction::{
    Incidence, IncidenceError, around, azimuth, from_spherical, horizontal, polar_angle,
};
pub use dispersion::{ComplexIndex, DispersionCurve, DispersionError, OpticalConstants};
pub use film::{Film, FilmAmplitudes, Films};
pub use fresnel::{Fresnel, FresnelAmplitudes, conductor, conductor_amplitudes, dielectric};
pub use interface::{reflect, refract};
pub use layer::{Bottom, BottomSurface, Layer, LayerError, Slab};
pub use material::Material;
pub use material_error::MaterialError;
pub use participating::{ParticipatingMedium, ParticipatingMediumError};
pub use phase::{PhaseFunction, PhaseFunctionError};
pub use polarisation::{
    FacetMueller, Mueller, PolarisedFresnel, Stokes, Turn, incidence_axis, polarised_conductor,
    polarised_dielectric, reference_axes,
};
pub use spread::{KLEMS, Spread, SpreadError, klems_centres};
pub use sunlight::solar_weights;
