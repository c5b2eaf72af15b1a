//! Rough surfaces as height fields.
//!
//! A [`HeightField`] holds samples `h[iy][ix]` at `(ix dx, iy dy)` with shape `[ny, nx]`, a length
//! unit, and what lies beyond its border. [`synthesis`] draws random ones from a [`Psd`],
//! [`statistics`] measures any, [`form`] removes mean, plane or parabola, and [`missing`] fills or
//! refuses points that an instrument did not see.
//!
//! # Conventions
//! Autocorrelation `C(r) = sigma^2 exp(-r^2 / tau^2)`; `tau` is the 1/e length. The other habit,
//! `exp(-r^2 / (2 l^2))`, is `l = tau / sqrt 2`. Smoothness `s = tau / sigma`; slope variance per
//! axis `2 sigma^2 / tau^2 = 2 / s^2`. Power spectral density, two-sided in angular wave vector:
//! `W(k) = sigma^2 tau^2 / (4 pi) exp(-k^2 tau^2 / 4)`, whose integral over `d^2k` is `sigma^2`.

mod height_field;
mod missing;
mod psd;

pub use height_field::{Border, HeightField, HeightFieldError, LengthUnit, check_grid};
pub use missing::{MissingError, MissingPolicy, RawHeightMap};
pub use psd::{Provenance, Psd, PsdError};
