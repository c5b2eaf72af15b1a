//! Lobe of Gaussian facets: locates it among outgoing directions, so that quadrature does not miss it.
//!
//! Light that comes at `theta_i` and leaves at `theta`, `psi` from the forward azimuth, meets a facet
//! along `h = wi + eta wo` (`eta = 1` for reflection). The density of its slope `h_xy / h_z` falls as
//! `exp(-E)`, `E = h_xy^T C^-1 h_xy / (2 h_z^2)`. At given `theta`, `E` is a trigonometric polynomial of
//! degree two in `psi`; at given `psi` it is one in `theta` over a square, whose derivative has the
//! zeros of another one of degree two. So the minima of `E`, at most two along either line, are found exactly
//! however narrow they are.

use std::f64::consts::FRAC_PI_2;

use asperity_optics::horizontal;
use glam::{DVec2, DVec3};

use crate::microfacet::slopes::SlopeCovariance;
use asperity_numerics::elementary::{acos, atan, cos, hypot, sin, sin_cos, tan};
use asperity_numerics::quadrature::Breaks;

/// `E` above which there is no light: facets with such slopes, all of them together, are `exp(-36) = 2e-16` of the mean plane, however
/// narrow the range of directions that they send light to.
pub(crate) const NEGLIGIBLE: f64 = 36.0;

/// Differences of `E` from its minimum at which the quadrature is subdivided.
const LEVELS: [f64; 2] = [4.0, 36.0];

/// The exponent `E` for one direction of light and one side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lobe {
    sin_i: f64,
    cos_i: f64,
    eta: f64,
    /// 1 or -1: the sign of `h_z` if the facet faces upward.
    upward: f64,
    /// `C^-1` along forward and to the left of it.
    forward: f64,
    across: f64,
    mixed: f64,
}

impl Lobe {
    /// `eta`: the index of refraction, `None` for reflection; `forward`: the azimuth of undeviated light.
    pub(crate) fn new(
        slopes: &SlopeCovariance,
        wi: DVec3,
        forward: f64,
        refracted: Option<f64>,
    ) -> Self {
        let f = horizontal(forward);
        let g = f.perp();
        Self {
            sin_i: hypot(wi.x, wi.y),
            cos_i: wi.z,
            eta: refracted.unwrap_or(1.0),
            upward: if refracted.is_some_and(|eta| eta > 1.0) {
                -1.0
            } else {
                1.0
            },
            forward: slopes.inverse_form(f, f),
            across: slopes.inverse_form(g, g),
            mixed: slopes.inverse_form(f, g),
        }
    }

    /// `E`; infinite where no facet scatters the light.
    pub(crate) fn exponent(&self, theta: f64, psi: f64) -> f64 {
        let h_z = self.upward * (self.cos_i + self.eta * cos(theta));
        if h_z <= 0.0 {
            return f64::INFINITY;
        }
        let (sin_psi, cos_psi) = sin_cos(psi);
        let radius = self.eta * sin(theta);
        let q = DVec2::new(radius * cos_psi - self.sin_i, radius * sin_psi);
        0.5 * self.form(q, q) / (h_z * h_z)
    }

    /// Marks the minima of `E` along `psi` at `theta`. Returns the least `E` there.
    pub(crate) fn mark_azimuths(&self, breaks: &mut Breaks, theta: f64, psi: [f64; 2]) -> f64 {
        let radius = self.eta * sin(theta);
        let slope = TrigonometricPolynomial {
            mean: 0.0,
            cos: -self.mixed * self.sin_i,
            sin: self.forward * self.sin_i,
            cos_2: self.mixed * radius,
            sin_2: 0.5 * (self.across - self.forward) * radius,
        };
        mark_minima(breaks, psi, &slope, |psi| self.exponent(theta, psi))
    }

    /// Marks the minima of `E` along `theta` at `psi`.
    pub(crate) fn mark_polar_angles(&self, breaks: &mut Breaks, theta: [f64; 2], psi: f64) {
        // h_xy = a + eta sin(theta) u. Where E is stationary,
        // (a + eta sin(theta) u) . (u (cos_i cos(theta) + eta) + a sin(theta)) vanishes.
        let u = horizontal(psi);
        let a = DVec2::new(-self.sin_i, 0.0);
        let [aa, au, uu] = [self.form(a, a), self.form(a, u), self.form(u, u)];
        let eta = self.eta;
        let slope = TrigonometricPolynomial {
            mean: 1.5 * eta * au,
            cos: self.cos_i * au,
            sin: aa + eta * eta * uu,
            cos_2: -0.5 * eta * au,
            sin_2: 0.5 * eta * self.cos_i * uu,
        };
        // Facets face upward on one side of the angle where h_z vanishes.
        let horizontal = acos((-self.cos_i / eta).max(-1.0));
        let theta = if self.upward > 0.0 {
            [theta[0], theta[1].min(horizontal)]
        } else {
            [theta[0].max(horizontal), theta[1]]
        };
        mark_minima(breaks, theta, &slope, |theta| self.exponent(theta, psi));
    }

    /// `a^T C^-1 b`, along forward and to the left of it.
    fn form(&self, a: DVec2, b: DVec2) -> f64 {
        self.forward * a.x * b.x + self.across * a.y * b.y + self.mixed * (a.x * b.y + a.y * b.x)
    }
}

/// Marks the minima of `exponent` between `lo` and `hi` and their widths; `slope` vanishes where the exponent is
/// stationary. Returns the least exponent.
fn mark_minima(
    breaks: &mut Breaks,
    [lo, hi]: [f64; 2],
    slope: &TrigonometricPolynomial,
    exponent: impl Fn(f64) -> f64,
) -> f64 {
    if hi <= lo {
        return f64::INFINITY;
    }
    let mut least = f64::INFINITY;
    let mut visit = |from: (f64, f64), to: (f64, f64)| {
        let (minimum, top) = if from.1 <= to.1 {
            (from, to)
        } else {
            (to, from)
        };
        least = least.min(minimum.1);
        if minimum.1 > NEGLIGIBLE {
            return;
        }
        breaks.add_smooth(minimum.0);
        for level in LEVELS {
            if minimum.1 + level < top.1 {
                breaks.add_smooth(crossing(minimum.0, top.0, minimum.1, level, &exponent));
            }
        }
    };
    // Tangents of half angles stay small within quarter turns. Their ends are visited themselves, since rounding
    // might lose a minimum there.
    let quarters = ((hi - lo) / (FRAC_PI_2 + 1e-9)).ceil().max(1.0);
    let end = |i: f64| lo + (hi - lo) * (i / quarters);
    let mut last = (lo, exponent(lo));
    for i in 0..quarters as usize {
        let range = [i, i + 1].map(|i| end(i as f64));
        let mut advance_to = |x: f64| {
            let next = (x, exponent(x));
            visit(last, next);
            last = next;
        };
        slope.zeros_within_quarter(range, &mut advance_to);
        advance_to(range[1]);
    }
    least
}

/// The point where a monotone `exponent` exceeds its value `at_minimum` by `level`, to a tenth of it.
fn crossing(
    mut minimum: f64,
    mut top: f64,
    at_minimum: f64,
    level: f64,
    exponent: impl Fn(f64) -> f64,
) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (minimum + top);
        let excess = exponent(middle) - at_minimum - level;
        if excess.abs() < 0.1 * level {
            return middle;
        }
        if excess > 0.0 {
            top = middle;
        } else {
            minimum = middle;
        }
    }
    minimum
}

/// `mean + cos cos x + sin sin x + cos_2 cos 2x + sin_2 sin 2x`.
#[derive(Clone, Copy, Debug)]
struct TrigonometricPolynomial {
    mean: f64,
    cos: f64,
    sin: f64,
    cos_2: f64,
    sin_2: f64,
}

impl TrigonometricPolynomial {
    /// Calls `found` with the zeros within a range of at most a quarter turn, ascending.
    fn zeros_within_quarter(&self, [lo, hi]: [f64; 2], mut found: impl FnMut(f64)) {
        let centre = 0.5 * (lo + hi);
        let reach = tan(0.25 * (hi - lo));
        let mut zeros = Zeros::default();
        zeros.find(&self.about(centre), -reach, reach);
        for t in zeros.iter() {
            found(centre + 2.0 * atan(t));
        }
    }

    /// Coefficients of `(1 + t^2)^2` times this in powers of `t = tan((x - centre) / 2)`.
    fn about(&self, centre: f64) -> [f64; 5] {
        let (s, c) = sin_cos(centre);
        let (s_2, c_2) = (2.0 * s * c, (c - s) * (c + s));
        let (cos, sin) = (self.cos * c + self.sin * s, self.sin * c - self.cos * s);
        let cos_2 = self.cos_2 * c_2 + self.sin_2 * s_2;
        let sin_2 = self.sin_2 * c_2 - self.cos_2 * s_2;
        [
            self.mean + cos + cos_2,
            2.0 * sin + 4.0 * sin_2,
            2.0 * self.mean - 6.0 * cos_2,
            2.0 * sin - 4.0 * sin_2,
            self.mean - cos + cos_2,
        ]
    }
}

/// Zeros of a polynomial of degree four at most.
#[derive(Clone, Copy, Debug, Default)]
struct Zeros {
    at: [f64; 4],
    len: usize,
}

impl Zeros {
    fn iter(&self) -> impl Iterator<Item = f64> {
        self.at.into_iter().take(self.len)
    }

    /// Finds those of the polynomial with these coefficients, in ascending powers, within
    /// `lo < t < hi`: between neighbouring zeros of its derivative lies one at most.
    fn find(&mut self, coefficients: &[f64], lo: f64, hi: f64) {
        self.len = 0;
        let degree = coefficients.len() - 1;
        if degree == 0 {
            return;
        }
        let mut derivative = [0.0; 4];
        for (i, d) in derivative.iter_mut().enumerate().take(degree) {
            *d = (i + 1) as f64 * coefficients[i + 1];
        }
        let mut turns = Self::default();
        turns.find(&derivative[..degree], lo, hi);
        let value = |t: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
        let mut last = (lo, value(lo));
        for t in turns.iter().chain([hi]) {
            let next = (t, value(t));
            if (last.1 < 0.0) != (next.1 < 0.0) && self.len < 4 {
                self.at[self.len] = bisect(last.0, next.0, last.1 < 0.0, value);
                self.len += 1;
            }
            last = next;
        }
    }
}

/// The point between `a` and `b` where `value` changes sign, to rounding.
fn bisect(mut a: f64, mut b: f64, negative_at_a: bool, value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..52 {
        let middle = 0.5 * (a + b);
        if (value(middle) < 0.0) == negative_at_a {
            a = middle;
        } else {
            b = middle;
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn zeros_of_products_are_found() {
        // Any product of four sines of half differences is a polynomial of degree two.
        let zeros_at = [0.4, 0.400_1, 2.0, 4.9];
        let product = |x: f64| -> f64 { zeros_at.iter().map(|z| (0.5 * (x - z)).sin()).product() };
        // Its coefficients by sums over eight points, exact for degrees below four.
        let sum = |f: fn(f64) -> f64| -> f64 {
            (0..8)
                .map(|i| f64::from(i) * TAU / 8.0)
                .map(|x| product(x) * f(x) / 4.0)
                .sum()
        };
        let polynomial = TrigonometricPolynomial {
            mean: 0.5 * sum(|_| 1.0),
            cos: sum(f64::cos),
            sin: sum(f64::sin),
            cos_2: sum(|x| (2.0 * x).cos()),
            sin_2: sum(|x| (2.0 * x).sin()),
        };
        for (lo, hi) in [(0.3, 1.7), (0.39, 0.41), (1.9, 3.0), (4.7 - TAU, 5.0 - TAU)] {
            let mut found = Vec::new();
            polynomial.zeros_within_quarter([lo, hi], |x| found.push(x));
            let mut expected: Vec<f64> = zeros_at
                .iter()
                .flat_map(|z| [z - TAU, *z])
                .filter(|z| (lo..hi).contains(z))
                .collect();
            expected.sort_by(f64::total_cmp);
            assert_eq!(found.len(), expected.len(), "{lo} {hi} {found:?}");
            for (a, b) in found.iter().zip(&expected) {
                // Rounding, some 1e-16, over the slope of a product with two zeros 1e-4 apart.
                assert!((a - b).abs() < 1e-10, "{a} {b}");
            }
        }
    }

    #[test]
    fn all_minima_of_the_exponent_are_marked() {
        let slopes = SlopeCovariance::new(0.3, 0.05, -0.08).unwrap();
        for (refracted, side) in [(None, 0.0), (Some(1.5), PI), (Some(1.0 / 1.5), PI)] {
            let wi = from_spherical(0.7, 0.4);
            let lobe = Lobe::new(&slopes, wi, 0.4 + PI, refracted);
            for (theta, psi) in [(0.3, 0.2), (0.8, 1.1), (0.5, -2.0)] {
                let theta = f64::abs(side - theta);
                for along_psi in [true, false] {
                    let mut breaks = Breaks::new(-10.0, 10.0);
                    let e = |x: f64| {
                        if along_psi {
                            lobe.exponent(theta, x)
                        } else {
                            lobe.exponent(x, psi)
                        }
                    };
                    let step = 1e-3;
                    let range = if along_psi {
                        lobe.mark_azimuths(&mut breaks, theta, [-3.0, 3.0]);
                        [-3.0, 3.0]
                    } else {
                        let range = if side == 0.0 { [0.0, 1.5] } else { [1.6, 3.1] };
                        lobe.mark_polar_angles(&mut breaks, range, psi);
                        range
                    };
                    // Every minimum found by a search in small steps is marked.
                    let n = ((range[1] - range[0]) / step) as usize;
                    for i in 1..n - 1 {
                        let x = range[0] + step * i as f64;
                        let [before, here, after] = [e(x - step), e(x), e(x + step)];
                        if here < before && here <= after && here < NEGLIGIBLE {
                            let near = breaks.points().any(|b| (b - x).abs() <= 2.0 * step);
                            assert!(near, "{refracted:?} {theta} {psi} {along_psi} {x}");
                        }
                    }
                }
            }
        }
    }
}
