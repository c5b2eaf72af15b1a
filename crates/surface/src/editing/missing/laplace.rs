//! Laplace's equation over the gaps of a grid, by preconditioned conjugate gradients.
//!
//! The preconditioner is symmetric successive over-relaxation: one relaxation of all points forwards
//! and one backwards. The number of steps grows with the square root of the diameter of a gap: some 30
//! at 30 points, some 110 at 500.
//!
//! # Source
//! Axelsson, BIT 12, 443 (1972); Saad, Iterative Methods for Sparse Linear Systems, Secs. 4.1 and 9.2.

use std::f64::consts::PI;

use super::error::MissingError;

/// Error, relative to the first guess and in the energy norm, at which the solution has settled.
const TOLERANCE: f64 = 1e-11;

/// Most steps of conjugate gradients.
const MAX_STEPS: usize = 10_000;

/// The equations `sum_j w_ij (h_i - h_j) + a_i h_i = b_i` of unknown heights `h`.
///
/// `w`: weights between neighbouring points, symmetric. `a`: weights to neighbours of given height,
/// which with their heights make up `b`.
pub(crate) struct GapEquations {
    /// Sum of all weights at each point.
    diagonal: Vec<f64>,
    right_hand_side: Vec<f64>,
    /// Neighbours of all points, one point after the other, and their weights.
    neighbours: Vec<(u32, f64)>,
    /// End of each point's neighbours in `neighbours`.
    ends: Vec<usize>,
}

impl GapEquations {
    pub(crate) fn with_capacity(points: usize) -> Self {
        Self {
            diagonal: Vec::with_capacity(points),
            right_hand_side: Vec::with_capacity(points),
            neighbours: Vec::with_capacity(4 * points),
            ends: Vec::with_capacity(points),
        }
    }

    /// Adds the next point: its `unknown` neighbours with their weights, and for its `given` ones
    /// their weights and heights.
    pub(crate) fn push(
        &mut self,
        unknown: impl IntoIterator<Item = (u32, f64)>,
        given: impl IntoIterator<Item = (f64, f64)>,
    ) {
        let first = self.neighbours.len();
        self.neighbours.extend(unknown);
        let mut diagonal: f64 = self.neighbours[first..].iter().map(|(_, w)| w).sum();
        let mut right_hand_side = 0.0;
        for (weight, height) in given {
            diagonal += weight;
            right_hand_side += weight * height;
        }
        self.diagonal.push(diagonal);
        self.right_hand_side.push(right_hand_side);
        self.ends.push(self.neighbours.len());
    }

    fn len(&self) -> usize {
        self.diagonal.len()
    }

    fn neighbours_of(&self, i: usize) -> &[(u32, f64)] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.neighbours[start..self.ends[i]]
    }

    /// `out = A h`.
    fn apply(&self, h: &[f64], out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            let neighbours = self.neighbours_of(i).iter();
            let sum: f64 = neighbours.map(|&(j, w)| w * h[j as usize]).sum();
            *out = self.diagonal[i] * h[i] - sum;
        }
    }

    /// `z = M^-1 r` for `M = (D + omega L) D^-1 (D + omega U)`, where `A = L + D + U` is the matrix of
    /// the equations, split into its lower triangle, diagonal and upper triangle.
    fn precondition(&self, omega: f64, r: &[f64], z: &mut [f64]) {
        // Points behind the current one still count as zero.
        z.fill(0.0);
        for i in 0..self.len() {
            let neighbours = self.neighbours_of(i).iter();
            let sum: f64 = neighbours.map(|&(j, w)| w * z[j as usize]).sum();
            z[i] = (r[i] + omega * sum) / self.diagonal[i];
        }
        for i in (0..self.len()).rev() {
            let behind = self
                .neighbours_of(i)
                .iter()
                .filter(|(j, _)| *j as usize > i);
            let sum: f64 = behind.map(|&(j, w)| w * z[j as usize]).sum();
            z[i] += omega * sum / self.diagonal[i];
        }
    }

    /// Solves the equations.
    ///
    /// # Errors
    /// [`MissingError::NotSettled`] if the solution has not settled after ten thousand steps.
    pub(crate) fn solve(&self) -> Result<Vec<f64>, MissingError> {
        let n = self.len();
        // The best factor for a square gap of as many points, held level on its borders.
        let omega = 2.0 / (1.0 + PI / (n as f64).sqrt().max(PI));
        let mut h = vec![0.0; n];
        // r: residual, z: preconditioned residual, p: direction
        let mut r = self.right_hand_side.clone();
        let mut z = vec![0.0; n];
        self.precondition(omega, &r, &mut z);
        let mut p = z.clone();
        let mut ap = vec![0.0; n];
        let mut rz = dot(&r, &z);
        let first = rz;
        let mut steps = 0;
        while rz > first * TOLERANCE * TOLERANCE {
            if steps == MAX_STEPS {
                return Err(MissingError::NotSettled {
                    steps,
                    relative: (rz / first).sqrt(),
                });
            }
            self.apply(&p, &mut ap);
            let step = rz / dot(&p, &ap);
            for i in 0..n {
                h[i] += step * p[i];
                r[i] -= step * ap[i];
            }
            self.precondition(omega, &r, &mut z);
            let next = dot(&r, &z);
            let beta = next / rz;
            rz = next;
            for i in 0..n {
                p[i] = z[i] + beta * p[i];
            }
            steps += 1;
        }
        Ok(h)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
