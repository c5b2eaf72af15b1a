//! Facets that a direction sees, drawn by chance.
//!
//! Facets are independent of what hides them in Smith's statistics, so that a ray from `w` meets the
//! normals `m` with the density
//!
//! ```text
//! D_w(m) = max(0, w . m) D(m) / sigma(w),   sigma(w) = cos(theta_w) (1 + Lambda(w))
//! ```
//!
//! where `w` may look up from below the facets, as against a ray that travels upwards and meets a slope
//! from its upper side: there `Lambda(w) = -1 - Lambda(-w)`. With `p` the slope along the azimuth of
//! `w`, `x = p / sqrt(2 var p)` and `a = cot(theta_w) / sqrt(2 var p)`, negative from below, the density
//! of `x` is proportional to `max(0, a - x) exp(-x^2)`; the slope across is Gaussian about a line in `p`.
//!
//! # Source
//! Heitz et al. 2016, Secs. 4 and 5, for the density; the ways to draw from it are derived here.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rand::distr::Open01;
use rand::{Rng, RngExt};

use crate::slopes::SlopeCovariance;

const SQRT_PI: f64 = 1.772_453_850_905_516;

/// Above this `a` all slopes are seen alike to rounding: `a - x = a`.
const FLAT: f64 = 1e17;

/// Below this `a` the slopes seen from below are nearer to a Gamma than to a Rayleigh density: where the
/// two ways accept equally often.
const STEEP: f64 = -std::f64::consts::FRAC_1_SQRT_2;

/// Draws the unit normal (`z > 0`) of a facet that the unit vector `w` sees, with the density `D_w`.
///
/// `w` may have any `z`, but must not look straight down: no facet is seen from vertically below. The
/// density is met exactly, by rejection; at least a third of the trials are accepted.
pub(crate) fn visible_normal<R: Rng>(slopes: &SlopeCovariance, w: DVec3, rng: &mut R) -> DVec3 {
    let sin = w.x.hypot(w.y);
    let along = if sin > 0.0 {
        w.truncate() / sin
    } else {
        DVec2::X
    };
    let across = along.perp();
    let variance = slopes.variance_along(along);
    let unit = (2.0 * variance).sqrt();
    let (x, y) = visible_slope(w.z / (sin * unit), rng);
    let p = unit * x;
    // Given p, the slope across has this mean and the variance 1 / (C^-1)_across.
    let mean = across.dot(slopes.times(along)) / variance * p;
    let q = mean + (2.0 / slopes.inverse_form(across, across)).sqrt() * y;
    (-(p * along + q * across)).extend(1.0).normalize()
}

/// Draws `x` with a density proportional to `max(0, a - x) exp(-x^2)`, and an independent `y` with one
/// proportional to `exp(-y^2)`.
fn visible_slope<R: Rng>(a: f64, rng: &mut R) -> (f64, f64) {
    if a > FLAT {
        return normal_pair(rng);
    }
    if a <= 0.0 {
        return (slope_from_below(a, rng), normal_pair(rng).1);
    }
    // Under (a + |x|) exp(-x^2), of which a sqrt(pi) is Gaussian and one is Rayleigh of either sign.
    let rayleigh = 1.0 / (1.0 + a * SQRT_PI);
    loop {
        let (mut x, y) = normal_pair(rng);
        if rng.random::<f64>() < rayleigh {
            x = log_uniform(rng).sqrt().copysign(x);
        }
        if x <= 0.0 || rng.random::<f64>() * (a + x) < a - x {
            return (x, y);
        }
    }
}

/// [`visible_slope`] for `a <= 0`: `y = a - x > 0` has the density `y exp(-y^2 - 2 |a| y)`, up to a factor.
fn slope_from_below<R: Rng>(a: f64, rng: &mut R) -> f64 {
    loop {
        if a > STEEP {
            let y = log_uniform(rng).sqrt();
            if rng.random::<f64>() < (2.0 * a * y).exp() {
                return a - y;
            }
        } else {
            let y = (log_uniform(rng) + log_uniform(rng)) / (-2.0 * a);
            if rng.random::<f64>() < (-y * y).exp() {
                return a - y;
            }
        }
    }
}

/// Two independent values with the density `exp(-x^2) / sqrt(pi)` (Box and Muller 1958).
fn normal_pair<R: Rng>(rng: &mut R) -> (f64, f64) {
    let radius = log_uniform(rng).sqrt();
    let (sin, cos) = (TAU * rng.random::<f64>()).sin_cos();
    (radius * cos, radius * sin)
}

/// An exponential value of mean one.
fn log_uniform<R: Rng>(rng: &mut R) -> f64 {
    -rng.sample::<f64, _>(Open01).ln()
}
