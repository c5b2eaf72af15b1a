//! Flat layers: media between flat faces, with light that is unscattered inside and light scattered once.
//!
//! A flat face on top, homogeneous layers of optical thickness `tau = sigma_t d` (the lowest may be infinite) with flat faces
//! between them, and a bottom that is open, an interface, a metal, a mirror or absorbing; faces may be coated. Reflection at flat
//! faces keeps the angle of light, so the inner reflections of one direction are geometric series, and single scattering has
//! a closed form. Two models differ in the paths that count: see [`LayerPaths`].
//!
//! # Equations
//! In layer `j`, of index `n_j` relative to the medium above, `mu_i` and `mu` are the cosines before and after scattering. Per
//! incident flux, unscattered light goes down with `D exp(-t / mu_i)` and up with `U exp(-(tau - t) / mu_i)` at the optical depth `t`.
//! Both follow from the faces, each with all that lies beyond it: see `passage.rs`. `D'` and `U'` are the same of the reversed path
//! of light that leaves: light that falls in from outside, on the side where it leaves, along that direction. So `D'` is
//! of light that goes up after scattering, and `U'` of light that goes down.
//!
//! The fraction `albedo p(cos) dt / mu_i` of either is scattered, by `cos- = h - mu_i mu` from down to up or back,
//! `cos+ = h + mu_i mu` from down to down and up to up, `h` the product of the horizontal components. Over
//! all depths,
//!
//! ```text
//! A = int exp(-t / mu_i) exp(-t / mu) dt,    B = int exp(-t / mu_i) exp(-(tau - t) / mu) dt
//! f = sum_j albedo (n_o / n_j)^2 [p- A (D D' + U U') + p+ B (D U' + U D')] / (mu_i mu)
//! ```
//!
//! with `n_o` the index of the medium that the light leaves into: solid angles change by `n^2 cos` from within to without,
//! radiance by `n^2`. Light reversed has the same `f / n_o^2`.
//!
//! # Source
//! Hanrahan and Krueger 1993, Reflection from Layered Surfaces due to Subsurface Scattering, Eqs. 18 to 21
//! and the first-order transmitted radiance of the same section: these are the terms of one layer without light that inner
//! faces reflect, `U = U' = 0`. Further layers add theirs, attenuated and refracted by the layers around them. The equations are written for
//! radiances and in angles within the layer; the `1 / n_j^2` of reflected light is that of the solid angle of the beam, which
//! narrows as it enters. The series are those of any pile of plates, without coherence, s and p averaged at every face.

mod depth;
mod directions;
mod event_paths;
mod expectation;
mod flat_layers;
mod passage;
mod scattering;

pub use flat_layers::{FlatLayers, FlatLayersError, LayerPaths};
pub use scattering::UnscatteredBeam;
