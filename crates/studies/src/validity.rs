//! Validity of geometric optics: lengths of a surface against the wavelength.
//!
//! Numbers that must be large. The root mean square phase difference of light from high and low points, per side:
//! `4 pi sigma n_i cos(theta_i) / lambda` of reflected light, the Rayleigh parameter, and
//! `2 pi sigma |n_t cos(theta_t) - n_i cos(theta_i)| / lambda` of transmitted light; a fraction `exp(-phase^2)` of what a Gaussian surface
//! reflects or transmits stays coherent (Beckmann and Spizzichino 1963), and of any other `|mean exp(i phase)|^2` over its heights. `tau / lambda`
//! is the correlation length over the wavelength. The radius of curvature over `lambda / cos^3(theta)` tells whether a facet is level enough to act as a plane.
//!
//! `lambda` is the wavelength in the medium above the surface, to which the indices here are relative: that in vacuum over the index of the medium.

mod coherence;
mod flat_light;
mod judgement;
mod words;

#[cfg(test)]
mod tests;

pub(crate) use flat_light::CoherentLight;
pub use judgement::{DEFAULT_WAVELENGTH_NM, LARGE, Validity};
pub(crate) use words::{first_warning, note_of_several, wavelength_warnings};
