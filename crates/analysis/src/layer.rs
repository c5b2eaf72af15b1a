//! Flat layer: a medium between flat faces, with light that is unscattered inside and light scattered once.
//!
//! A face of relative index `eta` on top, a homogeneous medium of optical thickness `tau = sigma_t d` (or
//! infinite), and a bottom that is open, an interface, a mirror or absorbing. Reflection at flat faces keeps the
//! angle of light, so the inner reflections of one direction are a geometric series, and single scattering has a
//! closed form. Two models differ in the paths that count: see [`LayerPaths`].
//!
//! # Equations
//! Inside the layer `mu_i` and `mu` are the cosines before and after scattering, `R1` and `R2` the
//! reflectances of top and bottom seen from within, `T1 = 1 - R1(mu_i)`, `a = exp(-tau / mu_i)`, `b =
//! exp(-tau / mu)`. Per incident flux, unscattered light goes down with `D exp(-t / mu_i)` and up with
//! `U exp(-(tau - t) / mu_i)` at the optical depth `t`:
//!
//! ```text
//! D = T1 / (1 - R1 R2 a^2),    U = D R2 a
//! ```
//!
//! The fraction `albedo p(cos) dt / mu_i` of either is scattered, by `cos- = h - mu_i mu` from down to up or back,
//! `cos+ = h + mu_i mu` from down to down and up to up, `h` the product of the horizontal components. Over
//! all depths,
//!
//! ```text
//! A = int exp(-t / mu_i) exp(-t / mu) dt,    B = int exp(-t / mu_i) exp(-(tau - t) / mu) dt
//! f_r = albedo / eta^2 (1 - R1) / (1 - R1 R2 b^2) [p- A (D + U R2 b) + p+ B (U + D R2 b)] / (mu_i mu)
//! f_t = albedo eta_3^2 (1 - R2) / (1 - R1 R2 b^2) [p+ B (D + U R1 b) + p- A (U + D R1 b)] / (mu_i mu)
//! ```
//!
//! with `eta_3 = n_3 / n_2`: solid angles change by `n^2 cos` from within to without, radiance by `n^2`.
//!
//! # Source
//! Hanrahan and Krueger 1993, Reflection from Layered Surfaces due to Subsurface Scattering, Eqs. 18 to 21
//! and the first-order transmitted radiance of the same section: these are the terms without `R2 a`, `R2 b`
//! and `R1 b`. They are written for radiances and in angles within the layer; the `1 / eta^2` of `f_r` is
//! that of the solid angle of the beam, which narrows as it enters. The series are those of any plate.

mod depth;
mod directions;
mod expectation;
mod flat_layers;
mod passage;
mod scattering;

pub use flat_layers::{FlatLayers, FlatLayersError, LayerPaths};
pub use scattering::UnscatteredBeam;
