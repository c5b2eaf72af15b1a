//! Triangle: its projection along a ray, exact in the sign of its edges, and its point nearest to a given one.

use glam::DVec3;

use crate::ray::TileRay;

/// A corner projected along a ray: where it is relative to the ray, and at which ray parameter.
#[derive(Clone, Copy)]
pub(super) struct ProjectedCorner {
    pub(super) x: f64,
    pub(super) y: f64,
    /// Ray parameter.
    pub(super) depth: f64,
}

/// A triangle projected along a ray that is above.
pub(super) struct ProjectedTriangle {
    pub(super) corners: [ProjectedCorner; 3],
    /// Edge functions, each of the edge opposite to a corner: all positive if the ray passes.
    pub(super) turns: [f64; 3],
}

impl ProjectedTriangle {
    /// The corners projected along the ray, and how the edges turn around the ray.
    #[inline]
    pub(super) fn new(corners: [DVec3; 3], ray: &TileRay) -> Self {
        let d = ray.direction;
        let kz = d.abs().max_position();
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        // A shear along the ray, times d[kz] so that nothing is divided.
        let [a, b, c] = corners.map(|p| {
            let p = p - ray.origin;
            ProjectedCorner {
                x: p[kx] * d[kz] - d[kx] * p[kz],
                y: p[ky] * d[kz] - d[ky] * p[kz],
                depth: p[kz] / d[kz],
            }
        });
        // The area is d[kz] times d . n; a ray above meets a facet where d . n is negative.
        let sign = -d[kz].signum();
        Self {
            corners: [a, b, c],
            turns: [turn(b, c), turn(c, a), turn(a, b)].map(|e| sign * e),
        }
    }
}

/// Twice the signed area of the triangle of the ray, `p` and `q`; exact in its sign, and exactly the
/// negative of `turn(q, p)`.
#[inline]
fn turn(p: ProjectedCorner, q: ProjectedCorner) -> f64 {
    let (left, right) = (p.x * q.y, p.y * q.x);
    if left == right {
        // What rounding took from the two products, which a fused multiplication gives exactly.
        // Rounding is monotone, so where the products differ their order is the true one.
        p.x.mul_add(q.y, -left) - p.y.mul_add(q.x, -right)
    } else {
        left - right
    }
}

/// The point of a triangle that is closest to `p` (Ericson, Real-Time Collision Detection, 5.1.5).
#[inline]
pub(super) fn closest_point([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + d1 / (d1 - d3) * ab;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + d2 / (d2 - d6) * ac;
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
    }
    let sum = va + vb + vc;
    a + vb / sum * ab + vc / sum * ac
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_exact_in_sign_and_antisymmetric() {
        // Whole numbers of 53 bits, of which i128 holds the products.
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as i64
        };
        let seen = |x: i64, y: i64| ProjectedCorner {
            x: x as f64,
            y: y as f64,
            depth: 0.0,
        };
        let mut close = 0;
        for i in 0..10_000 {
            let (a, b) = (next(), next());
            // Nearly or exactly along the first.
            let (c, d) = match i % 3 {
                0 => (next(), next()),
                1 => (a - 1, b - (i % 2)),
                _ => (a / 3, b / 3),
            };
            let exact = i128::from(a) * i128::from(d) - i128::from(b) * i128::from(c);
            let (p, q) = (seen(a, b), seen(c, d));
            close += usize::from(p.x * q.y == p.y * q.x && exact != 0);
            assert_eq!(turn(p, q).partial_cmp(&0.0).unwrap(), exact.cmp(&0));
            assert_eq!(turn(p, q), -turn(q, p));
        }
        assert!(close > 10, "{close} products rounded to the same double");
    }

    #[test]
    fn the_closest_point_is_on_the_triangle() {
        let t = [
            DVec3::ZERO,
            DVec3::new(4.0, 0.0, 0.0),
            DVec3::new(0.0, 4.0, 0.0),
        ];
        for (p, expected) in [
            ([1.0, 1.0, 5.0], [1.0, 1.0, 0.0]),
            ([-1.0, -2.0, 3.0], [0.0, 0.0, 0.0]),
            ([2.0, -2.0, 3.0], [2.0, 0.0, 0.0]),
            ([-2.0, 1.0, 3.0], [0.0, 1.0, 0.0]),
            ([3.0, 3.0, 1.0], [2.0, 2.0, 0.0]),
            ([9.0, 1.0, 1.0], [4.0, 0.0, 0.0]),
            ([1.0, 9.0, 1.0], [0.0, 4.0, 0.0]),
        ] {
            assert_eq!(closest_point(t, p.into()), expected.into());
        }
    }
}
