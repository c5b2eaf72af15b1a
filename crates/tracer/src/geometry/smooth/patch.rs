//! Patch: z over one cell of a smooth surface, by the sixteen B-spline coefficients around it.
//!
//! Everything is a value of the blossom: the symmetric function `f(a, b, c)`, linear in each argument, with
//! `f(u, u, u)` the cubic itself. For places of the cell, `0 <= a, b, c <= 1`, it is a weighted mean of the
//! coefficients with weights of at least zero, so it loses nothing to cancellation. Written out without closures, so that loops
//! over many patches take vector instructions.
//!
//! # Source
//! Ramshaw, Blossoms are polar forms, Computer Aided Geometric Design 6, 323 (1989).

/// Coefficients of the four columns by four rows that a cell depends on; row by row, tile coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patch(pub(crate) [[f64; 4]; 4]);

impl Patch {
    /// z at the place `(u, v)` of the cell, and its rise along x and along y.
    #[inline(always)]
    pub(crate) fn at(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [r0, r1, r2, r3] = &self.0;
        let (e0, e1, e2, e3) = (ends(r0, u), ends(r1, u), ends(r2, u), ends(r3, u));
        // f(u, u, 0) and f(u, u, 1) along x, each with f(v, v, 0) and f(v, v, 1) along y
        let [low_0, high_0] = ends(&[e0[0], e1[0], e2[0], e3[0]], v);
        let [low_1, high_1] = ends(&[e0[1], e1[1], e2[1], e3[1]], v);
        let (low, high) = (mix(low_0, low_1, u), mix(high_0, high_1, u));
        let (left, right) = (mix(low_0, high_0, v), mix(low_1, high_1, v));
        [mix(low, high, v), 3.0 * (right - left), 3.0 * (high - low)]
    }

    /// Bernstein coefficients of z along the line between two places of the cell, of degree six: each a weighted
    /// mean of z, the first and the last its values at the ends.
    #[inline(always)]
    pub(crate) fn along(&self, from: [f64; 2], to: [f64; 2]) -> [f64; 7] {
        let [r0, r1, r2, r3] = &self.0;
        let ([a, c], [b, d]) = (from, to);
        let (r0, r1) = (between(r0, a, b), between(r1, a, b));
        let (r2, r3) = (between(r2, a, b), between(r3, a, b));
        product([
            between(&[r0[0], r1[0], r2[0], r3[0]], c, d),
            between(&[r0[1], r1[1], r2[1], r3[1]], c, d),
            between(&[r0[2], r1[2], r2[2], r3[2]], c, d),
            between(&[r0[3], r1[3], r2[3], r3[3]], c, d),
        ])
    }

    /// The sixteen Bezier points of z: it lies between the lowest and the highest of them. The reference of what is computed for
    /// many patches at a time.
    pub(crate) fn bezier(&self) -> [[f64; 4]; 4] {
        let [r0, r1, r2, r3] = &self.0;
        let (r0, r1) = (between(r0, 0.0, 1.0), between(r1, 0.0, 1.0));
        let (r2, r3) = (between(r2, 0.0, 1.0), between(r3, 0.0, 1.0));
        [
            between(&[r0[0], r1[0], r2[0], r3[0]], 0.0, 1.0),
            between(&[r0[1], r1[1], r2[1], r3[1]], 0.0, 1.0),
            between(&[r0[2], r1[2], r2[2], r3[2]], 0.0, 1.0),
            between(&[r0[3], r1[3], r2[3], r3[3]], 0.0, 1.0),
        ]
    }
}

/// Bernstein coefficients of degree six of what is cubic in x and in y, along the diagonal of both: `at[k]` are those
/// along y of the coefficient number `k` along x.
#[inline(always)]
fn product(at: [[f64; 4]; 4]) -> [f64; 7] {
    [
        at[0][0],
        0.5 * (at[0][1] + at[1][0]),
        0.2 * (at[0][2] + at[2][0]) + 0.6 * at[1][1],
        0.05 * (at[0][3] + at[3][0]) + 0.45 * (at[1][2] + at[2][1]),
        0.2 * (at[1][3] + at[3][1]) + 0.6 * at[2][2],
        0.5 * (at[2][3] + at[3][2]),
        at[3][3],
    ]
}

/// `f(-1, 0, a)`, `f(0, 1, a)` and `f(1, 2, a)`.
#[inline(always)]
fn thirds([c0, c1, c2, c3]: &[f64; 4], a: f64) -> [f64; 3] {
    const THIRD: f64 = 1.0 / 3.0;
    [
        mix(*c0, *c1, (a + 2.0) * THIRD),
        mix(*c1, *c2, (a + 1.0) * THIRD),
        mix(*c2, *c3, a * THIRD),
    ]
}

/// `f(0, a, b)` and `f(1, a, b)`, from the [`thirds`] of `a`.
#[inline(always)]
fn halves([low, middle, high]: [f64; 3], b: f64) -> [f64; 2] {
    [
        mix(low, middle, 0.5 * (b + 1.0)),
        mix(middle, high, 0.5 * b),
    ]
}

/// `f(0, u, u)` and `f(1, u, u)`.
#[inline(always)]
fn ends(coefficients: &[f64; 4], u: f64) -> [f64; 2] {
    halves(thirds(coefficients, u), u)
}

/// Bernstein coefficients from `a` to `b`: `f(a, a, a)`, `f(a, a, b)`, `f(a, b, b)` and `f(b, b, b)`.
#[inline(always)]
fn between(coefficients: &[f64; 4], a: f64, b: f64) -> [f64; 4] {
    let (of_a, of_b) = (thirds(coefficients, a), thirds(coefficients, b));
    let [low, high] = halves(of_a, a);
    let [low_mixed, high_mixed] = halves(of_a, b);
    let [low_b, high_b] = halves(of_b, b);
    [
        mix(low, high, a),
        mix(low_mixed, high_mixed, a),
        mix(low_mixed, high_mixed, b),
        mix(low_b, high_b, b),
    ]
}

/// `a` where `x` is 0, `b` where it is 1.
#[inline(always)]
fn mix(a: f64, b: f64, x: f64) -> f64 {
    a * (1.0 - x) + b * x
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATCH: Patch = Patch([
        [0.3, -1.0, 2.0, 0.7],
        [1.5, 0.2, -0.4, 3.0],
        [-2.0, 0.9, 1.1, -0.6],
        [0.8, 2.5, -1.7, 0.1],
    ]);

    /// Weights of a uniform cubic B-spline, by its definition.
    fn weights(u: f64) -> [f64; 4] {
        [
            (1.0 - u).powi(3) / 6.0,
            (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
            (-3.0 * u * u * u + 3.0 * u * u + 3.0 * u + 1.0) / 6.0,
            u * u * u / 6.0,
        ]
    }

    fn by_definition([u, v]: [f64; 2]) -> f64 {
        let (along_u, along_v) = (weights(u), weights(v));
        let row = |row: [f64; 4]| -> f64 { row.iter().zip(along_u).map(|(c, w)| c * w).sum() };
        PATCH.0.iter().zip(along_v).map(|(c, w)| row(*c) * w).sum()
    }

    const PLACES: [[f64; 2]; 5] = [
        [0.0, 0.0],
        [1.0, 1.0],
        [0.25, 0.8],
        [0.61, 0.0],
        [1.0, 0.33],
    ];

    #[test]
    fn a_patch_is_the_tensor_product_b_spline() {
        for place in PLACES {
            let [z, along_x, along_y] = PATCH.at(place);
            assert!((z - by_definition(place)).abs() < 1e-14, "{place:?}");
            let step = 1e-5;
            let [u, v] = place;
            let x = by_definition([u + step, v]) - by_definition([u - step, v]);
            let y = by_definition([u, v + step]) - by_definition([u, v - step]);
            assert!((along_x - x / (2.0 * step)).abs() < 1e-8, "{place:?}");
            assert!((along_y - y / (2.0 * step)).abs() < 1e-8, "{place:?}");
        }
    }

    #[test]
    fn bernstein_coefficients_along_a_line_give_the_values_on_it() {
        const CHOOSE: [f64; 7] = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0];
        for from in PLACES {
            for to in PLACES {
                let coefficients = PATCH.along(from, to);
                for s in [0.0, 0.1, 0.5, 0.77, 1.0] {
                    let place = [0, 1].map(|axis| from[axis] + s * (to[axis] - from[axis]));
                    let value: f64 = (0..7)
                        .map(|k| {
                            let basis = s.powi(k) * (1.0 - s).powi(6 - k);
                            CHOOSE[k as usize] * basis * coefficients[k as usize]
                        })
                        .sum();
                    assert!(
                        (value - by_definition(place)).abs() < 1e-14,
                        "{from:?} {to:?} {s}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_patch_lies_between_its_bezier_points() {
        let points = PATCH.bezier();
        let all = points.iter().flatten();
        let low = all.clone().fold(f64::INFINITY, |a, b| a.min(*b));
        let high = all.fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        for i in 0..=50 {
            for j in 0..=50 {
                let z = by_definition([f64::from(i) / 50.0, f64::from(j) / 50.0]);
                assert!((low..=high).contains(&z));
            }
        }
        // The corners are points of the surface.
        assert!((points[0][0] - by_definition([0.0, 0.0])).abs() < 1e-14);
        assert!((points[3][3] - by_definition([1.0, 1.0])).abs() < 1e-14);
    }
}
