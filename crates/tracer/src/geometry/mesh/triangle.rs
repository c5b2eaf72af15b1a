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
        // The rounding errors of the two products, which a fused multiplication gives exactly.
        // Rounding is monotone, so where the products differ their order is the true one.
        p.x.mul_add(q.y, -left) - p.y.mul_add(q.x, -right)
    } else {
        left - right
    }
}

/// The point of a triangle with this unit `normal` that is closest to `p`.
///
/// Barycentric coordinates would lose digits with the square of the aspect ratio of the triangle. Here the error
/// is a few roundings of a coordinate, however elongated the triangle is: a point inside is projected along the
/// normal, any other onto the nearest edge.
#[inline]
pub(super) fn closest_point(corners: [DVec3; 3], normal: DVec3, p: DVec3) -> DVec3 {
    let [a, b, c] = corners;
    let edges = [(a, b), (b, c), (c, a)];
    let inside = edges.map(|(from, to)| normal.cross(to - from).dot(p - from) >= 0.0);
    if inside == [true; 3] {
        return p - (p - a).dot(normal) * normal;
    }
    let [q, r, s] = edges.map(|(from, to)| closest_point_of_edge(from, to, p));
    let nearer = |u: DVec3, v: DVec3| {
        if v.distance_squared(p) < u.distance_squared(p) {
            v
        } else {
            u
        }
    };
    nearer(nearer(q, r), s)
}

/// The point between two corners that is closest to `p`, measured from the nearer corner.
#[inline]
fn closest_point_of_edge(from: DVec3, to: DVec3, p: DVec3) -> DVec3 {
    let along = to - from;
    let place = (p - from).dot(along) / along.length_squared();
    if place <= 0.5 {
        from + place.max(0.0) * along
    } else {
        let back = (to - p).dot(along) / along.length_squared();
        to - back.max(0.0) * along
    }
}

/// Unit normal of a triangle, each component to a few roundings of itself.
///
/// The plain cross product of two long edges at a small angle loses digits with the aspect ratio.
pub(super) fn unit_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (u, v) = (b - a, c - a);
    DVec3::new(
        difference_of_products(u.y, v.z, u.z, v.y),
        difference_of_products(u.z, v.x, u.x, v.z),
        difference_of_products(u.x, v.y, u.y, v.x),
    )
    .normalize()
}

/// `a b - c d`, to one and a half units in the last place (Kahan's method).
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let error = c.mul_add(-d, cd);
    a.mul_add(b, -cd) + error
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
            assert_eq!(closest_point(t, DVec3::Z, p.into()), expected.into());
        }
    }

    #[test]
    fn elongated_triangles_lose_no_digits() {
        // Needles and obtuse slivers, turned in space, of aspect ratios up to 1e7
        let turn = glam::DQuat::from_rotation_y(0.7) * glam::DQuat::from_rotation_z(1.1);
        for aspect in [1e1, 1e2, 1e4, 1e7] {
            let width = 1024.0 / aspect;
            for third in [[0.0, width], [512.0, width], [300.0, -width]] {
                let flat = [[0.0, 0.0], [1024.0, 0.0], third];
                let corners = flat.map(|[x, y]| turn * DVec3::new(x, y, 0.0));
                let normal = unit_normal(corners);
                for [u, v] in [[0.2, 0.3], [0.5, 0.5], [0.9, 1e-3], [1e-9, 0.6]] {
                    let [a, b, c] = corners;
                    let p = a + u * (b - a) + v * (1.0 - u) * (c - a);
                    let moved = closest_point(corners, normal, p).distance(p);
                    assert!(moved < 2e-12, "aspect {aspect}: {moved:e}");
                }
            }
        }
    }
}
