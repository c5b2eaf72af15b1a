//! GGX distribution: facet normals with long tails, with Smith's shadowing and masking.
//!
//! Slopes have Student's distribution of two degrees of freedom. With `E` of [`Beckmann`](crate::Beckmann)'s exponent `exp(-E)`,
//! their density is `peak / (1 + E)^2`: both distributions agree at slope zero if they have the same `alpha`. The variance is infinite.
//!
//! # Source
//! Trowbridge and Reitz 1975; Walter et al. 2007, Eqs. 33 and 34; Heitz 2014, Sec. 5.4, for two axes.

use asperity_numerics::elementary::{hypot, sin_cos};
use glam::DVec3;
use rand::distr::Open01;
use rand::{Rng, RngExt};

use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::slope_frame::SlopeFrame;
use crate::microfacet::slopes::{SlopeCovariance, SlopeError};

/// Least `h.z` of a half vector: facets beyond are vertical to rounding.
const MIN_RISE: f64 = 1e-100;

/// The distribution of facet normals of a surface with GGX slopes.
///
/// # Examples
/// ```
/// use asperity_analysis::Ggx;
/// use asperity_optics::from_spherical;
///
/// let ggx = Ggx::isotropic(0.5)?;
/// // tan 45 deg = 1: Lambda = (sqrt(1 + alpha^2) - 1) / 2
/// let lambda = ggx.lambda(from_spherical(std::f64::consts::FRAC_PI_4, 0.0));
/// assert!((lambda - 0.5 * (1.25_f64.sqrt() - 1.0)).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    beckmann: SlopeCovariance,
}

impl Ggx {
    /// The distribution of the same `alpha`, along any azimuth, as the Beckmann distribution of these slopes: `alpha^2` is twice their
    /// variance.
    #[must_use]
    pub const fn new(beckmann: SlopeCovariance) -> Self {
        Self { beckmann }
    }

    /// The distribution of this `alpha` along all azimuths.
    ///
    /// # Errors
    /// [`SlopeError`] unless `alpha` is above zero and finite.
    pub fn isotropic(alpha: f64) -> Result<Self, SlopeError> {
        let half = 0.5 * alpha * alpha;
        SlopeCovariance::new(half, half, 0.0).map(Self::new)
    }

    /// The slopes of the Beckmann distribution of the same `alpha`.
    #[must_use]
    pub const fn beckmann(&self) -> &SlopeCovariance {
        &self.beckmann
    }

    /// Density of facet normals `D(m)` in 1/sr, with the integral of `D cos(theta_m)` equal to one; zero for `m.z <= 0`.
    ///
    /// # Source
    /// Walter et al. 2007, Eq. 33: `alpha^2 / (pi cos^4(theta_m) (alpha^2 + tan^2(theta_m))^2)`.
    #[must_use]
    #[inline(always)]
    pub fn d(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let rest = m.z * m.z + self.beckmann.exponent(m.truncate());
        self.beckmann.peak() / (rest * rest)
    }

    /// Smith's Lambda of direction `w`, up or down: `(sqrt(1 + alpha^2 tan^2(theta)) - 1) / 2`; infinite along the horizon.
    ///
    /// # Source
    /// Walter et al. 2007, Eq. 34; Heitz 2014, Eq. 72.
    #[must_use]
    #[inline(always)]
    pub fn lambda(&self, w: DVec3) -> f64 {
        let t = (2.0 * self.beckmann.variance_along(w.truncate())).sqrt() / w.z.abs();
        let root = (1.0 + t * t).sqrt();
        // The same without the difference
        let of_gentle = 0.5 * t * t / (1.0 + root);
        if t > 1.0 {
            0.5 * (root - 1.0)
        } else {
            of_gentle
        }
    }

    /// Samples a visible facet normal, with the density `max(0, w . m) D(m)` up to a factor.
    ///
    /// `w` may have any `z`, but must not point straight down: no facet is visible from there.
    ///
    /// # Source
    /// J. Dupuy, A. Benyoub, Computer Graphics Forum 42 (2023) e14867: scaled to `alpha` one, facets are those of a half sphere, which
    /// reflects light from `w` evenly into all directions `o` with `o.z > -w.z`.
    pub fn sample_visible(&self, w: DVec3, rng: &mut impl Rng) -> DVec3 {
        let frame = SlopeFrame::of_direction(&self.beckmann, w);
        let alpha = std::f64::consts::SQRT_2 * frame.deviation;
        // Scale to alpha one
        let along = alpha * hypot(w.x, w.y);
        let length = hypot(along, w.z);
        let (sin, cos) = (along / length, w.z / length);
        let above = match cos < 0.0 {
            true => sin * sin / (1.0 - cos),
            false => 1.0 + cos,
        };
        // Reflect: h = w + o
        let u: f64 = rng.sample(Open01);
        let rise = (u * above).max(MIN_RISE);
        let o_z = rise - cos;
        let o_sin = ((1.0 - u) * above * (1.0 + o_z)).max(0.0).sqrt();
        let (o_y, o_x) = sin_cos(std::f64::consts::TAU * rng.random::<f64>());
        // Slopes of the facet, in units of Beckmann's deviation
        let scale = -std::f64::consts::SQRT_2 / rise;
        frame.normal(scale * (sin + o_sin * o_x), scale * o_sin * o_y)
    }
}

impl FacetNormals for Ggx {
    #[inline(always)]
    fn d(&self, m: DVec3) -> f64 {
        self.d(m)
    }

    #[inline(always)]
    fn lambda(&self, w: DVec3) -> f64 {
        self.lambda(w)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use asperity_optics::from_spherical;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::compare::multiple_tests::{chi_squared_survival, sidak_level};

    /// Trowbridge and Reitz as renderers write it for axes along x and y: pbrt's `TrowbridgeReitzDistribution::D` and `Lambda`.
    fn renderer([ax, ay]: [f64; 2], w: DVec3) -> (f64, f64) {
        let (theta, phi) = ((w.x.hypot(w.y) / w.z).atan(), w.y.atan2(w.x));
        let tan2 = theta.tan().powi(2);
        let cos4 = theta.cos().powi(4);
        let e = tan2 * ((phi.cos() / ax).powi(2) + (phi.sin() / ay).powi(2));
        let d = 1.0 / (PI * ax * ay * cos4 * (1.0 + e).powi(2));
        let alpha2 = (phi.cos() * ax).powi(2) + (phi.sin() * ay).powi(2);
        (d, ((1.0 + alpha2 * tan2).sqrt() - 1.0) / 2.0)
    }

    fn of_axes([ax, ay]: [f64; 2]) -> Ggx {
        Ggx::new(SlopeCovariance::new(0.5 * ax * ax, 0.5 * ay * ay, 0.0).unwrap())
    }

    #[test]
    fn density_and_lambda_are_those_that_renderers_write() {
        for axes in [[0.3, 0.3], [0.05, 0.8], [2.0, 0.7]] {
            let ggx = of_axes(axes);
            for (theta, phi) in [(0.0, 0.0), (0.2, 1.0), (0.9, 2.5), (1.5, 4.0), (1.57, 0.3)] {
                let w = from_spherical(theta, phi);
                let (d, lambda) = renderer(axes, w);
                assert!((ggx.d(w) / d - 1.0).abs() < 1e-11, "{axes:?} {theta}");
                let off = (ggx.lambda(w) - lambda).abs();
                assert!(off <= 1e-13 * (1.0 + lambda), "{axes:?} {theta}: {off:e}");
            }
        }
        let ggx = of_axes([0.3, 0.3]);
        assert_eq!(ggx.lambda(DVec3::X), f64::INFINITY);
        assert_eq!((ggx.lambda(DVec3::Z), ggx.d(DVec3::NEG_Z)), (0.0, 0.0));
    }

    /// The mean of exponentially many Gaussian slopes: variance `alpha^2 / (2 E)` with `E` exponential of mean one.
    #[test]
    fn slopes_are_a_mixture_of_gaussian_ones() {
        use crate::microfacet::beckmann::Beckmann;
        let ggx = Ggx::isotropic(0.4).unwrap();
        for theta in [0.1, 0.5, 1.2] {
            let w = from_spherical(theta, 0.7);
            let (mut d, mut lambda) = (0.0, 0.0);
            // Trapezoids over ln E, which converge exponentially
            let step = 0.05;
            for i in -800..90 {
                let e = (step * f64::from(i)).exp();
                let half = 0.5 * 0.16 / e;
                let beckmann = Beckmann::new(SlopeCovariance::new(half, half, 0.0).unwrap());
                let weight = step * e * (-e).exp();
                d += weight * beckmann.d(w);
                lambda += weight * beckmann.lambda(w);
            }
            assert!((ggx.d(w) / d - 1.0).abs() < 1e-9, "{theta}");
            assert!((ggx.lambda(w) / lambda - 1.0).abs() < 1e-6, "{theta}");
        }
    }

    /// In the plane scaled to alpha one, visible facets lie on a half sphere, of which `o.z` and the azimuth of `o` are uniform; here they
    /// are counted by their own density, over cells of tilt and azimuth about z.
    #[test]
    fn sampled_normals_follow_the_visible_density() {
        let mut p_values = Vec::new();
        let turned = Ggx::new(SlopeCovariance::new(0.08, 0.3, 0.1).unwrap());
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for ggx in [Ggx::isotropic(0.3).unwrap(), turned] {
            for theta in [0.0_f64, 40.0, 85.0, 100.0, 150.0] {
                let w = from_spherical(theta.to_radians(), 0.8);
                let sigma = match w.z > 0.0 {
                    true => w.z * (1.0 + ggx.lambda(w)),
                    false => -w.z * ggx.lambda(w),
                };
                let (rows, columns, per) = (8, 8, 60);
                let tilt = |v: f64| (v * 0.5 * PI).clamp(0.0, 0.5 * PI);
                let mut expected = vec![0.0; rows * columns];
                for i in 0..rows * per {
                    for j in 0..columns * per {
                        let t = tilt((i as f64 + 0.5) / (rows * per) as f64);
                        let m = from_spherical(t, TAU * (j as f64 + 0.5) / (columns * per) as f64);
                        let area = t.sin() * 0.5 * PI * TAU / (rows * columns * per * per) as f64;
                        expected[i / per * columns + j / per] +=
                            w.dot(m).max(0.0) * ggx.d(m) / sigma * area;
                    }
                }
                let total: f64 = expected.iter().sum();
                assert!((total - 1.0).abs() < 2e-3, "{theta}: {total}");
                let n = 40_000;
                let mut counts = vec![0.0; rows * columns];
                for _ in 0..n {
                    let m = ggx.sample_visible(w, &mut rng);
                    let row = (m.z.acos() / (0.5 * PI) * rows as f64) as usize;
                    let column = (m.y.atan2(m.x).rem_euclid(TAU) / TAU * columns as f64) as usize;
                    counts[row.min(rows - 1) * columns + column.min(columns - 1)] += 1.0;
                }
                let cells = expected.iter().zip(&counts);
                let cells: Vec<(f64, f64)> = cells
                    .map(|(e, c)| (e / total * f64::from(n), *c))
                    .filter(|(e, _)| *e > 20.0)
                    .collect();
                let chi = cells.iter().map(|(e, c)| (c - e).powi(2) / e).sum();
                p_values.push(chi_squared_survival(chi, cells.len() - 1));
            }
        }
        println!("{p_values:.3?}");
        let level = sidak_level(1e-3, p_values.len());
        assert!(p_values.iter().all(|&p| p > level), "{level}");
    }

    #[test]
    fn extreme_directions_return_finite_normals() {
        let ggx = Ggx::new(SlopeCovariance::new(1e-8, 4.0, 0.0).unwrap());
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for (horizontal, z) in [
            (0.0, 1.0),
            (1e-300, 1.0),
            (1e-18, 1.0),
            (1.0, 1e-300),
            (1.0, -1e-300),
            (1e-9, -1.0),
        ] {
            for w in [
                DVec3::new(horizontal, 0.0, z),
                DVec3::new(0.0, horizontal, z),
            ] {
                for _ in 0..100 {
                    let m = ggx.sample_visible(w, &mut rng);
                    assert!(m.is_finite() && m.z > 0.0 && w.dot(m) > -1e-15, "{w} {m}");
                }
            }
        }
    }
}
