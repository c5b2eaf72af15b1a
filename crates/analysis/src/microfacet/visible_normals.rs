//! Sampling of visible facet normals.
//!
//! In Smith's statistics a facet is independent of what masks it, so a ray from `w` meets normals `m` with the
//! density
//!
//! ```text
//! D_w(m) = max(0, w . m) D(m) / sigma(w),   sigma(w) = cos(theta_w) (1 + Lambda(w))
//! ```
//!
//! where `w` may point down, as for a ray that travels upwards and meets a slope from its upper side:
//! there `Lambda(w) = -1 - Lambda(-w)`. With `p` the slope along the azimuth of
//! `w`, `x = p / sqrt(2 var p)` and `a = cot(theta_w) / sqrt(2 var p)`, negative from below, the density
//! of `x` is proportional to `max(0, a - x) exp(-x^2)`; the slope across is Gaussian about a line in `p`.
//!
//! # Source
//! Heitz et al. 2016, Secs. 4 and 5, for the density; the sampling methods are derived here.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use asperity_numerics::elementary::{exp, hypot, ln, sin_cos_of_turn};
use asperity_numerics::random::{open_unit, unit, unit_of_half};
use glam::DVec3;
use rand::distr::Open01;
use rand::{Rng, RngExt};

use crate::microfacet::normals::normal_pair;
use crate::microfacet::slope_frame::SlopeFrame;
use crate::microfacet::slopes::SlopeCovariance;

const SQRT_PI: f64 = 1.772_453_850_905_516;

/// Above this `a` all slopes are equally visible to rounding: `a - x = a`.
const MAX_A: f64 = 1e17;

/// Below this `a` a Gamma proposal is accepted more often than a Rayleigh proposal.
const GAMMA_BELOW: f64 = -FRAC_1_SQRT_2;

/// See [`crate::Beckmann::sample_visible`].
pub(crate) fn sample_visible<R: Rng>(slopes: &SlopeCovariance, w: DVec3, rng: &mut R) -> DVec3 {
    let frame = SlopeFrame::of_direction(slopes, w);
    let (x, y) = visible_slope(w.z / (hypot(w.x, w.y) * SQRT_2 * frame.deviation), rng);
    frame.normal(SQRT_2 * x, SQRT_2 * y)
}

/// Samples `x` with a density proportional to `max(0, a - x) exp(-x^2)`, and an independent `y` with one
/// proportional to `exp(-y^2)`.
fn visible_slope<R: Rng>(a: f64, rng: &mut R) -> (f64, f64) {
    if a > MAX_A {
        return half_normals(rng);
    }
    if a <= 0.0 {
        return (slope_from_below(a, rng), half_normals(rng).1);
    }
    // Propose from (a + |x|) exp(-x^2): a Gaussian of mass a sqrt(pi) plus a two-sided Rayleigh of mass one.
    let rayleigh = 1.0 / (1.0 + a * SQRT_PI);
    loop {
        let (mut x, y) = half_normals(rng);
        if rng.random::<f64>() < rayleigh {
            x = log_uniform(rng).sqrt().copysign(x);
        }
        if x <= 0.0 || rng.random::<f64>() * (a + x) < a - x {
            return (x, y);
        }
    }
}

/// A trial of [`sample_visible`] in the frame of `w` by four random words, and whether it is accepted: all proposals in one form without
/// branches, for loops over many directions.
#[inline(always)]
pub(crate) fn propose(frame: &SlopeFrame, w: DVec3, words: [u64; 4]) -> (DVec3, bool) {
    let horizontal = (w.x * w.x + w.y * w.y).sqrt();
    let a = w.z / (horizontal * SQRT_2 * frame.deviation);
    let a = if a < MAX_A { a } else { MAX_A };
    let acceptance = unit_of_half(words[1] << 32);
    let choice = unit(words[3]);
    // Gaussian slopes along and across
    let radius = (-ln(open_unit(words[0]))).sqrt();
    let [sin, cos] = sin_cos_of_turn(unit_of_half(words[1]));
    let (along, across) = (radius * cos, radius * sin);
    // From above: a Gaussian or a two-sided Rayleigh slope
    let is_gamma = a <= GAMMA_BELOW;
    let product = open_unit(words[2]) * if is_gamma { open_unit(words[3]) } else { 1.0 };
    let exponential = -ln(product);
    let rayleigh = exponential.sqrt();
    let is_rayleigh = choice * (1.0 + a * SQRT_PI) < 1.0;
    let x = if is_rayleigh {
        rayleigh.copysign(along)
    } else {
        along
    };
    let is_visible = (x <= 0.0) | (acceptance * (a + x) < a - x);
    // From below: the distance from the steepest visible slope
    let y = if is_gamma {
        exponential / (-2.0 * a)
    } else {
        rayleigh
    };
    let exponent = if is_gamma { -y * y } else { 2.0 * a * y };
    let is_kept = acceptance < exp(exponent);
    // Select
    let is_above = a > 0.0;
    let x = if is_above { x } else { a - y };
    let accepted = if is_above { is_visible } else { is_kept };
    (frame.normal(SQRT_2 * x, SQRT_2 * across), accepted)
}

/// [`visible_slope`] for `a <= 0`: `y = a - x > 0` has the density `y exp(-y^2 - 2 |a| y)`, up to a factor.
fn slope_from_below<R: Rng>(a: f64, rng: &mut R) -> f64 {
    loop {
        if a > GAMMA_BELOW {
            let y = log_uniform(rng).sqrt();
            if rng.random::<f64>() < exp(2.0 * a * y) {
                return a - y;
            }
        } else {
            let y = (log_uniform(rng) + log_uniform(rng)) / (-2.0 * a);
            if rng.random::<f64>() < exp(-y * y) {
                return a - y;
            }
        }
    }
}

/// Two independent values with the density `exp(-x^2) / sqrt(pi)`.
fn half_normals<R: Rng>(rng: &mut R) -> (f64, f64) {
    let (x, y) = normal_pair(rng);
    (FRAC_1_SQRT_2 * x, FRAC_1_SQRT_2 * y)
}

/// An exponential value of mean one.
fn log_uniform<R: Rng>(rng: &mut R) -> f64 {
    -ln(rng.sample::<f64, _>(Open01))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::multiple_tests::{chi_squared_survival, sidak_level};
    use crate::microfacet::beckmann::Beckmann;
    use asperity_optics::from_spherical;
    use glam::DVec2;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// Density of the slopes visible from `w`, per slope along x and y: `max(0, w . m) D(m) / sigma(w)`
    /// with `dOmega_m = cos^3(theta_m)`, `sigma` by the sign rule of Lambda.
    fn density(slopes: &SlopeCovariance, w: DVec3, v: DVec2) -> f64 {
        let m = (-v).extend(1.0).normalize();
        let beckmann = Beckmann::new(*slopes);
        // From below, 1 + Lambda(w) = -Lambda(-w), without the difference.
        let sigma = if w.z > 0.0 {
            w.z * (1.0 + beckmann.lambda(w))
        } else {
            -w.z * beckmann.lambda(w)
        };
        w.dot(m).max(0.0) * beckmann.d(m) * m.z.powi(3) / sigma
    }

    /// Cells of the plane of slopes: by the slope along `w`, up to where facets turn away, and by that
    /// across, counted from its mean at that slope.
    struct Cells {
        along: DVec2,
        incline: f64,
        edges: [(f64, f64); 2],
        n: usize,
    }

    impl Cells {
        fn new(slopes: &SlopeCovariance, w: DVec3) -> Self {
            let along = w.truncate().normalize_or(DVec2::X);
            let deviation = |v: DVec2| slopes.variance_along(v).sqrt();
            let unit = 2_f64.sqrt() * deviation(along);
            let a = w.z / (w.truncate().length() * unit);
            let high = a.min(3.0);
            let low = if a < 0.0 { a - 3.0 / (1.0 - a) } else { -3.0 };
            let across = 3.0 * deviation(along.perp());
            Self {
                along,
                incline: along.perp().dot(slopes.times(along)) / slopes.variance_along(along),
                edges: [(low * unit, high * unit), (-across, across)],
                n: 14,
            }
        }

        fn index(&self, v: DVec2) -> Option<usize> {
            let part = |x: f64, (low, high): (f64, f64)| {
                let t = (x - low) / (high - low);
                (0.0..1.0)
                    .contains(&t)
                    .then_some((t * self.n as f64) as usize)
            };
            let (p, q) = (v.dot(self.along), v.dot(self.along.perp()));
            let i = part(p, self.edges[0])?;
            let j = part(q - self.incline * p, self.edges[1])?;
            Some(i * self.n + j)
        }

        /// Simpson's rule in 8 by 8 steps.
        fn integral(&self, cell: usize, f: impl Fn(DVec2) -> f64) -> f64 {
            let step = self
                .edges
                .map(|(low, high)| (high - low) / self.n as f64 / 8.0);
            let start = [cell / self.n, cell % self.n];
            let at = |axis: usize, k: usize| {
                self.edges[axis].0 + step[axis] * (8 * start[axis] + k) as f64
            };
            let weight = |k: usize| match k {
                0 | 8 => 1.0,
                _ if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let mut sum = 0.0;
            for k in 0..=8 {
                for l in 0..=8 {
                    let (p, q) = (at(0, k), at(1, l) + self.incline * at(0, k));
                    let v = p * self.along + q * self.along.perp();
                    sum += weight(k) * weight(l) * f(v);
                }
            }
            sum * step[0] * step[1] / 9.0
        }
    }

    /// The p value of chi-squared over all cells that expect ten or more, and the rest as one.
    fn p_value(slopes: &SlopeCovariance, w: DVec3, seed: u64) -> f64 {
        let draws = 40_000;
        let cells = Cells::new(slopes, w);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut counts = vec![0_u32; cells.n * cells.n];
        for _ in 0..draws {
            let m = sample_visible(slopes, w, &mut rng);
            assert!((m.length() - 1.0).abs() < 1e-15 && m.z > 0.0);
            assert!(w.dot(m) > -1e-15, "{w} {m}");
            if let Some(cell) = cells.index(-m.truncate() / m.z) {
                counts[cell] += 1;
            }
        }
        let (mut chi_squared, mut used) = (0.0, 0);
        let (mut expected_rest, mut rest) = (f64::from(draws), draws);
        for (cell, &count) in counts.iter().enumerate() {
            let expected = f64::from(draws) * cells.integral(cell, |v| density(slopes, w, v));
            if expected >= 10.0 {
                chi_squared += (f64::from(count) - expected).powi(2) / expected;
                used += 1;
                expected_rest -= expected;
                rest -= count;
            }
        }
        assert!(used > 25 && expected_rest > 10.0, "{used} {expected_rest}");
        chi_squared += (f64::from(rest) - expected_rest).powi(2) / expected_rest;
        chi_squared_survival(chi_squared, used)
    }

    #[test]
    fn sampled_normals_follow_the_visible_density() {
        let slopes = [
            SlopeCovariance::isotropic(1.0).unwrap(),
            SlopeCovariance::isotropic(6.0).unwrap(),
            SlopeCovariance::new(0.8, 0.1, -0.2).unwrap(),
        ];
        // From above, at grazing, and from below, where both proposals are used; degrees.
        let directions = [0.0, 30.0, 75.0, 89.9, 90.1, 97.0, 120.0, 150.0, 170.0];
        let mut p_values = Vec::new();
        for (i, slopes) in slopes.iter().enumerate() {
            for (k, theta) in directions.iter().enumerate() {
                let w = from_spherical(f64::to_radians(*theta), 0.9 + k as f64);
                p_values.push(p_value(slopes, w, 100 + 10 * i as u64 + k as u64));
            }
        }
        println!("{p_values:.3?}");
        let level = sidak_level(1e-3, p_values.len());
        assert!(p_values.iter().all(|&p| p > level), "{level}");
    }

    #[test]
    fn both_proposals_from_below_agree_at_their_limit() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let n = 40_000;
        let mean = |a: f64, rng: &mut ChaCha8Rng| {
            let values: Vec<f64> = (0..n).map(|_| a - slope_from_below(a, rng)).collect();
            let mean = values.iter().sum::<f64>() / f64::from(n);
            let square = values.iter().map(|y| y * y).sum::<f64>() / f64::from(n);
            (mean, ((square - mean * mean) / f64::from(n)).sqrt())
        };
        let (rayleigh, e) = mean(GAMMA_BELOW + 1e-12, &mut rng);
        let (gamma, f) = mean(GAMMA_BELOW - 1e-12, &mut rng);
        let z = (rayleigh - gamma) / e.hypot(f);
        println!("z {z:.2}");
        assert!(z.abs() < 3.5);
    }

    #[test]
    fn extreme_directions_return_finite_normals() {
        let slopes = SlopeCovariance::new(1e-8, 4.0, 0.0).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for (horizontal, z) in [(0.0, 1.0), (1e-300, 1.0), (1e-18, 1.0), (1.0, 1e-300)] {
            for sign in [1.0, -1.0] {
                if sign * z < -0.5 {
                    continue;
                }
                for w in [
                    DVec3::new(horizontal, 0.0, sign * z),
                    DVec3::new(0.0, horizontal, sign * z),
                ] {
                    for _ in 0..100 {
                        let m = sample_visible(&slopes, w, &mut rng);
                        assert!(m.is_finite() && m.z > 0.0 && w.dot(m) > -1e-15, "{w} {m}");
                    }
                }
            }
        }
    }

    /// The mean of `x` is `-(sqrt(pi) / 4) (1 + erf a)` over `(a sqrt(pi) (1 + erf a) + exp(-a^2)) / 2`, by parts:
    /// sharper than counts in cells where the masses of the two proposals meet.
    #[test]
    fn visible_slopes_have_their_exact_mean() {
        let mut rng = ChaCha8Rng::seed_from_u64(17);
        for a in [-2.0_f64, -0.3, 0.2, 0.5, 1.0, 3.0] {
            let below = 1.0 + asperity_numerics::elementary::erf(a);
            let norm = 0.5 * (a * SQRT_PI * below + (-a * a).exp());
            let expected = -0.25 * SQRT_PI * below / norm;
            let n = 200_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                let (x, _) = visible_slope(a, &mut rng);
                sum += x;
                squares += x * x;
            }
            let mean = sum / f64::from(n);
            let se = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
            let z = (mean - expected) / se;
            println!("a = {a}: {mean} of {expected}, z = {z:.2}");
            // One of six: 4.5 is exceeded with probability 4e-5.
            assert!(z.abs() < 4.5, "{a}");
        }
    }
}
