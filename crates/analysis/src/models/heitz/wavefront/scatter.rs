//! Scattering: divides the light of each hit into what is reflected and transmitted, escapes and remains.

use std::marker::PhantomData;
use std::ops::Range;

use asperity_numerics::random::{open_unit, unit_of_half};
use asperity_numerics::vector::Stage;
use asperity_optics::{Fresnel, Material, reflect, refract};
use glam::DVec3;

use super::columns::{Branches, Hits, cut, cut_mut, grow};
use super::draws;
use crate::microfacet::beckmann::Beckmann;
use crate::models::heitz::height::Height;
use crate::models::heitz::light::{LIGHT_COLUMNS, Light};

/// Divides the light of each hit at its facet.
pub(super) struct Scatter<'a, L, M> {
    pub(super) beckmann: Beckmann,
    pub(super) material: Material,
    pub(super) at: M,
    pub(super) key: [u64; 2],
    pub(super) hits: &'a Hits,
    pub(super) normals: &'a [Vec<f64>; 3],
    pub(super) reflected: &'a mut Branches,
    pub(super) transmitted: &'a mut Branches,
    pub(super) absorbed: &'a mut Vec<f64>,
    pub(super) draws: &'a mut [Vec<f64>; 3],
    pub(super) light: PhantomData<L>,
}

impl<L: Light, M: Fn(f64) -> Material> Stage for Scatter<'_, L, M> {
    #[inline(always)]
    fn run(self) {
        let n = self.hits.len();
        // Relative index from either side; one for materials that transmit nothing
        let index = self.material.transmitting_index();
        let transmits = index.is_some();
        let indices = [index.unwrap_or(1.0), 1.0 / index.unwrap_or(1.0)];
        self.reflected.resize(n, L::KEPT);
        self.transmitted.resize(n, L::KEPT);
        grow(self.absorbed, n);
        self.draws.iter_mut().for_each(|column| grow(column, n));
        let (heights, is_behind) = (&self.hits.height[..n], &self.hits.is_behind[..n]);
        let (walks, paths) = (&self.hits.walk[..n], &self.hits.path[..n]);
        let [u, v, t] = cut_mut(self.draws, n);

        // Draw the random numbers of the step
        for i in 0..n {
            let order = u64::from(paths[i].order());
            let [first, second] = draws::of_interaction(self.key, walks[i], order);
            t[i] = open_unit(first);
            u[i] = unit_of_half(second);
            v[i] = unit_of_half(second << 32);
        }

        // Divide the light, block by block: arrays of the stack do not overlap, as the compiler knows
        let (reflected, transmitted) = (&mut *self.reflected, &mut *self.transmitted);
        for first in (0..n).step_by(BLOCK) {
            let rows = first..n.min(first + BLOCK);
            let (w, m) = (load(&self.hits.w, &rows), load(self.normals, &rows));
            let light = load_some(&self.hits.light, L::KEPT, &rows);
            let mut eta = [1.0; BLOCK];
            for (eta, &is_behind) in eta.iter_mut().zip(&is_behind[rows.clone()]) {
                *eta = if is_behind { indices[1] } else { indices[0] };
            }
            let mut directions = [[[0.0; BLOCK]; 3]; 2];
            let mut fractions = [[0.0; BLOCK]; 2];
            let mut lights = [[[0.0; BLOCK]; LIGHT_COLUMNS]; 2];
            for i in 0..BLOCK {
                let vector = |of: &[[f64; BLOCK]; 3]| DVec3::new(of[0][i], of[1][i], of[2][i]);
                let (w, m) = (vector(&w), vector(&m));
                let state = L::from_numbers(light.each_ref().map(|column| column[i]));
                let scattered = state.scattered((self.at)(eta[i]), w, m);
                let Fresnel {
                    reflected,
                    transmitted,
                    cos_theta_t,
                } = scattered.fresnel;
                let (up, down) = (reflect(w, m), refract(w, m, eta[i], cos_theta_t));
                for (k, up) in up.to_array().into_iter().enumerate() {
                    directions[0][k][i] = up;
                }
                // A branch without light leads down, so that nothing of it escapes
                let is_dark = transmitted <= 0.0;
                directions[1][0][i] = if is_dark { 0.0 } else { down.x };
                directions[1][1][i] = if is_dark { 0.0 } else { down.y };
                directions[1][2][i] = if is_dark { -1.0 } else { -down.z };
                fractions[0][i] = reflected;
                fractions[1][i] = if is_dark { 0.0 } else { transmitted };
                let states = [scattered.reflected, scattered.transmitted].map(L::to_numbers);
                for k in 0..L::KEPT {
                    lights[0][k][i] = states[0][k];
                    lights[1][k][i] = states[1][k];
                }
            }
            for (branch, number) in [(&mut *reflected, 0), (&mut *transmitted, 1)] {
                let count = rows.len();
                let kept = branch.light[..L::KEPT].iter_mut().zip(&lights[number]);
                let columns = branch.direction.iter_mut().zip(&directions[number]);
                for (column, block) in columns.chain(kept) {
                    column[rows.clone()].copy_from_slice(&block[..count]);
                }
                branch.remaining[rows.clone()].copy_from_slice(&fractions[number][..count]);
            }
        }
        reflected.height[..n].copy_from_slice(heights);
        let below = &mut transmitted.height[..n];
        if transmits {
            for (below, &height) in below.iter_mut().zip(heights) {
                *below = Height::at(height).seen_from_behind().logarithm();
            }
        }
        self.absorbed[..n].fill(0.0);
        self.reflected.divide(&self.beckmann, n);
        if transmits {
            self.transmitted.divide(&self.beckmann, n);
        } else {
            // What is not reflected is absorbed.
            self.transmitted.escaping[..n].fill(0.0);
            std::mem::swap(self.absorbed, &mut self.transmitted.remaining);
        }
    }
}

impl Branches {
    /// Divides the fraction of the light in `remaining` into what escapes and what meets another facet.
    #[inline(always)]
    pub(super) fn divide(&mut self, beckmann: &Beckmann, n: usize) {
        let [dx, dy, dz] = cut(&self.direction, n);
        let (heights, lambdas) = (&self.height[..n], &mut self.lambda[..n]);
        let (escaping, remaining) = (&mut self.escaping[..n], &mut self.remaining[..n]);
        let blocked = &mut self.blocked[..n];
        for i in 0..n {
            let direction = DVec3::new(dx[i], dy[i], dz[i]);
            let lambda = beckmann.lambda(direction);
            let (escape, block) = Height::at(heights[i]).escape(lambda);
            let is_up = direction.z > 0.0;
            let (escape, block) = (
                if is_up { escape } else { 0.0 },
                if is_up { block } else { 1.0 },
            );
            lambdas[i] = lambda;
            blocked[i] = block;
            escaping[i] = remaining[i] * escape;
            remaining[i] *= block;
        }
    }
}

/// Rows of a block.
const BLOCK: usize = 64;

/// A block of each column, the last one filled up with zeros.
#[inline(always)]
fn load<const N: usize>(columns: &[Vec<f64>; N], rows: &Range<usize>) -> [[f64; BLOCK]; N] {
    load_some(columns, N, rows)
}

/// A block of each of the first `kept` columns.
#[inline(always)]
fn load_some<const N: usize>(
    columns: &[Vec<f64>; N],
    kept: usize,
    rows: &Range<usize>,
) -> [[f64; BLOCK]; N] {
    let mut blocks = [[0.0; BLOCK]; N];
    for (block, column) in blocks.iter_mut().zip(&columns[..kept]) {
        block[..rows.len()].copy_from_slice(&column[rows.clone()]);
    }
    blocks
}
