//! Coefficients of the spline through given samples.
//!
//! Along each axis, coefficients `c` solve `(c[i-1] + 4 c[i] + c[i+1]) / 6 = h[i]`. With the pole
//! `z = sqrt 3 - 2` of this filter, two recursions with any starts solve all equations but the first
//! and the last:
//! forward `y[i] = -6 z h[i] + z y[i-1]`, backward `c[i] = y[i] + z c[i+1]`. The other solutions differ
//! by `A z^i + B z^(n-1-i)`; `A` and `B` follow from the equations at the two ends, in which the border
//! comes in. No series is truncated, and the lines may be as short as two samples.
//!
//! Source: Unser, Aldroubi and Eden, IEEE Trans. Signal Process. 41 (1993) 821, for the recursions; with
//! starts of their own for each border in place of the sums there.

use rayon::prelude::*;

use crate::{Border, HeightField};

/// The root of `z^2 + 4 z + 1 = 0` within the unit circle, `sqrt 3 - 2`.
const POLE: f64 = -0.267_949_192_431_122_7;

/// Samples from an end beyond which `A z^i` is below `1e-36 A`, and left out.
const REACH: usize = 64;

/// Lines that are turned together: as many numbers as share a cache line.
const TILE: usize = 8;

/// Coefficients at the grid points of `field`, row-major with its shape.
pub(super) fn coefficients(field: &HeightField) -> Vec<f64> {
    let [ny, nx] = field.shape();
    let mut rows = field.heights().to_vec();
    solve_lines(&mut rows, nx, field.border());
    let mut columns = transposed(&rows, nx);
    drop(rows);
    solve_lines(&mut columns, ny, field.border());
    transposed(&columns, ny)
}

/// Replaces each line of `n` samples by its coefficients.
fn solve_lines(lines: &mut [f64], n: usize, border: Border) {
    let ends = Ends::new(n, border);
    lines
        .par_chunks_exact_mut(n)
        .for_each(|line| ends.solve(line));
}

/// The equations at the ends of a line.
struct Ends {
    /// Weights in the first equation, for `h[0]`, of the first, the second and the last coefficient. The
    /// last equation is its mirror image.
    weights: [f64; 3],
    /// The left side of the first equation for `c[i] = z^i`, and for `c[i] = z^(n-1-i)`.
    homogeneous: [f64; 2],
}

impl Ends {
    fn new(n: usize, border: Border) -> Self {
        let weights = match border {
            Border::Periodic => [4.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0],
            // The coefficient before the first equals the second.
            Border::Mirrored => [4.0 / 6.0, 2.0 / 6.0, 0.0],
            // That before the first continues the first two linearly.
            Border::Open => [1.0, 0.0, 0.0],
        };
        let [first, second, last] = weights;
        let before_last = power(n - 2);
        let at_last = POLE * before_last;
        Self {
            weights,
            homogeneous: [
                first + second * POLE + last * at_last,
                first * at_last + second * before_last + last,
            ],
        }
    }

    fn solve(&self, line: &mut [f64]) {
        let [near_end, far_end] = [line[0], line[line.len() - 1]];
        let mut before = 0.0;
        for value in line.iter_mut() {
            before = POLE * (before - 6.0 * *value);
            *value = before;
        }
        let mut after = 0.0;
        for value in line.iter_mut().rev() {
            after = *value + POLE * after;
            *value = after;
        }

        // Solve a A + b B = p, b A + a B = q for what the equations at the ends still lack.
        let n = line.len();
        let [first, second, last] = self.weights;
        let p = near_end - (first * line[0] + second * line[1] + last * line[n - 1]);
        let q = far_end - (first * line[n - 1] + second * line[n - 2] + last * line[0]);
        let [a, b] = self.homogeneous;
        let determinant = (a - b) * (a + b);
        add_decaying((a * p - b * q) / determinant, line.iter_mut());
        add_decaying((a * q - b * p) / determinant, line.iter_mut().rev());
    }
}

/// Adds `amplitude z^i` to the values.
fn add_decaying<'a>(mut amplitude: f64, values: impl Iterator<Item = &'a mut f64>) {
    for value in values.take(REACH) {
        *value += amplitude;
        amplitude *= POLE;
    }
}

/// `z^i`, or zero if that is below what [`REACH`] leaves out.
fn power(i: usize) -> f64 {
    if i < REACH { POLE.powi(i as i32) } else { 0.0 }
}

/// Rows of `width` numbers as columns.
fn transposed(values: &[f64], width: usize) -> Vec<f64> {
    let height = values.len() / width;
    let mut turned = vec![0.0; values.len()];
    turned
        .par_chunks_mut(TILE * height)
        .enumerate()
        .for_each(|(tile, columns)| {
            for (iy, row) in values.chunks_exact(width).enumerate() {
                let row = &row[tile * TILE..];
                for (column, value) in columns.chunks_exact_mut(height).zip(row) {
                    column[iy] = *value;
                }
            }
        });
    turned
}
