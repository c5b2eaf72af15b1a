//! Sampling of facet normals from the slope distribution: all facets, or those that face a direction.

use std::f64::consts::TAU;

use asperity_numerics::elementary::{exp, hypot, ln_1p, sin_cos};
use glam::DVec3;
use rand::{Rng, RngExt};

use crate::microfacet::slope_frame::SlopeFrame;
use crate::microfacet::slopes::SlopeCovariance;

/// Largest threshold of a slope, in standard deviations. Facets beyond it are vertical to rounding.
const MAX_THRESHOLD: f64 = 1e8;

/// See [`crate::Beckmann::sample`].
pub(crate) fn sample(slopes: &SlopeCovariance, rng: &mut impl Rng) -> DVec3 {
    let (along, across) = normal_pair(rng);
    SlopeFrame::of_direction(slopes, DVec3::X).normal(along, across)
}

/// See [`crate::Beckmann::sample_facing`].
pub(crate) fn sample_facing(slopes: &SlopeCovariance, v: DVec3, rng: &mut impl Rng) -> DVec3 {
    let frame = SlopeFrame::of_direction(slopes, v);
    // The facet of slopes (p, q) in the frame faces v where v.z > sin(theta_v) p.
    let along = -normal_above(-v.z / (hypot(v.x, v.y) * frame.deviation), rng);
    let (across, _) = normal_pair(rng);
    frame.normal(along, across)
}

/// Two independent standard normal numbers from two uniform ones.
///
/// # Source
/// Box and Muller 1958.
pub(crate) fn normal_pair(rng: &mut impl Rng) -> (f64, f64) {
    let radius = (-2.0 * ln_1p(-rng.random::<f64>())).sqrt();
    let (sin, cos) = sin_cos(TAU * rng.random::<f64>());
    (radius * cos, radius * sin)
}

/// A standard normal number given that it is above `least`.
///
/// # Source
/// Robert 1995, "Simulation of truncated normal variables", for the tail: at least three of four draws are
/// accepted for any `least`.
fn normal_above(least: f64, rng: &mut impl Rng) -> f64 {
    if least < 0.5 {
        loop {
            let (x, y) = normal_pair(rng);
            if x > least {
                return x;
            }
            if y > least {
                return y;
            }
        }
    }
    let least = least.min(MAX_THRESHOLD);
    let rate = 0.5 * (least + (least * least + 4.0).sqrt());
    loop {
        let x = least - ln_1p(-rng.random::<f64>()) / rate;
        if rng.random::<f64>() < exp(-0.5 * (x - rate) * (x - rate)) {
            return x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_squared_survival;
    use asperity_optics::from_spherical;
    use glam::DVec2;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn slopes_of(m: DVec3) -> DVec2 {
        -m.truncate() / m.z
    }

    /// The standard normal distribution below `x`.
    fn phi(x: f64) -> f64 {
        0.5 * asperity_numerics::elementary::erfc(-x / std::f64::consts::SQRT_2)
    }

    /// Chi-squared of counts in `n x n` cells that are equally likely for (`u`, `v`) uniform in the square.
    fn chi_squared_of(draws: impl Iterator<Item = [f64; 2]>, n: usize) -> f64 {
        let mut counts = vec![0.0; n * n];
        let mut total = 0.0;
        for [u, v] in draws {
            let cell = |u: f64| ((u * n as f64) as usize).min(n - 1);
            counts[cell(u) * n + cell(v)] += 1.0;
            total += 1.0;
        }
        let expected = total / (n * n) as f64;
        let chi: f64 = counts
            .iter()
            .map(|c| (c - expected) * (c - expected) / expected)
            .sum();
        chi_squared_survival(chi, n * n - 1)
    }

    #[test]
    fn sampled_slopes_follow_their_density() {
        // Whitened in the order opposite to that of the sampling: q first, then p at given q.
        let (xx, yy, xy) = (0.5, 0.2, -0.15);
        let slopes = SlopeCovariance::new(xx, yy, xy).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let p = chi_squared_of(
            (0..40_000).map(|_| {
                let s = slopes_of(sample(&slopes, &mut rng));
                let rest = (s.x - xy / yy * s.y) / (xx - xy * xy / yy).sqrt();
                [phi(s.y / yy.sqrt()), phi(rest)]
            }),
            10,
        );
        println!("p {p}");
        assert!(p > 1e-3 && p < 1.0 - 1e-3);
    }

    #[test]
    fn sampled_facing_slopes_follow_the_truncated_density() {
        // In front, behind by little (rejection), and behind by three and by eight deviations.
        let (xx, yy, xy) = (0.5, 0.2, -0.15);
        let slopes = SlopeCovariance::new(xx, yy, xy).unwrap();
        for (i, theta) in [0.4, 1.3, 1.7, 2.7, 3.0].into_iter().enumerate() {
            let v = from_spherical(theta, 2.2);
            let along = v.truncate().normalize();
            let variance = slopes.variance_along(along);
            let regression = along.perp().dot(slopes.times(along)) / variance;
            let limit = v.z / v.x.hypot(v.y) / variance.sqrt();
            let determinant = xx * yy - xy * xy;
            let mut rng = ChaCha8Rng::seed_from_u64(i as u64);
            let p = chi_squared_of(
                (0..20_000).map(|_| {
                    let m = sample_facing(&slopes, v, &mut rng);
                    assert!(v.dot(m) > 0.0 && m.z > 0.0 && (m.length() - 1.0).abs() < 1e-14);
                    let s = slopes_of(m);
                    let p = along.dot(s);
                    let rest =
                        (along.perp().dot(s) - regression * p) / (determinant / variance).sqrt();
                    [phi(p / variance.sqrt()) / phi(limit), phi(rest)]
                }),
                10,
            );
            println!("theta {theta} limit {limit} p {p}");
            // One of five: Sidak's level for 1e-3 together.
            assert!(p > 2e-4 && p < 1.0 - 2e-4, "{theta} {p}");
        }
    }

    #[test]
    fn directions_that_no_facet_faces_return_a_vertical_facet() {
        let slopes = SlopeCovariance::isotropic(3.0).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for v in [
            DVec3::NEG_Z,
            from_spherical(std::f64::consts::PI - 1e-7, 0.0),
        ] {
            let m = sample_facing(&slopes, v, &mut rng);
            assert!(m.is_finite() && m.z > 0.0 && m.z < 1e-7);
        }
    }
}
