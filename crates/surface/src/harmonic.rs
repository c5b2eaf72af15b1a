//! Laplace's equation on the points of a grid's gaps, by conjugate gradients whose preconditioner
//! is a multigrid cycle. The number of steps hardly grows with the size of a gap.
//!
//! Coarse points are two-by-two blocks of the finer ones, and the coarse equations are the
//! sums of the fine ones over each block (Galerkin with piecewise constant aggregates; Vanek, Mandel
//! and Brezina, Computing 56, 179 (1996), without their smoothing). Each level is relaxed by
//! Gauss-Seidel, forwards before and backwards after the coarse correction, so that the cycle is
//! symmetric as conjugate gradients demand; it visits the next level twice (a W cycle).

use crate::MissingError;

/// Error, relative to the first guess and in the energy norm, at which the solution has settled.
const TOLERANCE: f64 = 1e-11;

/// Most steps of conjugate gradients; a few tens are usual.
const MAX_STEPS: usize = 1000;

/// Points below which a level is not made coarser.
const COARSEST: usize = 16;

/// Relaxations of the coarsest level, forwards and backwards.
const COARSEST_SWEEPS: usize = 8;

/// The equations `sum_j w_ij (h_i - h_j) + a_i h_i = b_i`: springs `w` between points that are
/// sought, and springs `a` from them to given heights.
pub(crate) struct GraphLaplacian {
    /// Where each point lies, in cells of this level.
    places: Vec<[u32; 2]>,
    /// Sum of all springs at each point.
    diagonal: Vec<f64>,
    /// Where the springs of each point end in `springs`; those of point 0 start at 0.
    ends: Vec<usize>,
    springs: Vec<(u32, f64)>,
}

impl GraphLaplacian {
    pub(crate) fn with_capacity(points: usize) -> Self {
        Self {
            places: Vec::with_capacity(points),
            diagonal: Vec::with_capacity(points),
            ends: Vec::with_capacity(points),
            springs: Vec::with_capacity(4 * points),
        }
    }

    /// Adds the next point, to which the springs that follow belong.
    pub(crate) fn begin_point(&mut self, place: [u32; 2]) {
        self.places.push(place);
        self.diagonal.push(0.0);
        self.ends.push(self.springs.len());
    }

    /// Joins the current point to another that is sought; the other must be joined to it in turn.
    pub(crate) fn join(&mut self, other: u32, weight: f64) {
        self.anchor(weight);
        self.springs.push((other, weight));
        if let Some(end) = self.ends.last_mut() {
            *end = self.springs.len();
        }
    }

    /// Joins the current point to a given height.
    pub(crate) fn anchor(&mut self, weight: f64) {
        if let Some(diagonal) = self.diagonal.last_mut() {
            *diagonal += weight;
        }
    }

    fn len(&self) -> usize {
        self.diagonal.len()
    }

    fn springs_of(&self, point: usize) -> &[(u32, f64)] {
        let start = if point == 0 { 0 } else { self.ends[point - 1] };
        &self.springs[start..self.ends[point]]
    }

    /// The block in which a point lies, after so many halvings of the grid.
    fn block(&self, point: u32, halvings: u32) -> [u32; 2] {
        self.places[point as usize].map(|place| place >> halvings)
    }

    /// Pull of the neighbours on a point: `sum_j w_ij h_j`.
    fn pull(&self, point: usize, h: &[f64]) -> f64 {
        self.springs_of(point)
            .iter()
            .map(|&(j, w)| w * h[j as usize])
            .sum()
    }

    /// `out = A h`.
    fn apply(&self, h: &[f64], out: &mut [f64]) {
        for (i, value) in out.iter_mut().enumerate() {
            *value = self.diagonal[i] * h[i] - self.pull(i, h);
        }
    }

    fn relax(&self, point: usize, b: &[f64], h: &mut [f64]) {
        h[point] = (b[point] + self.pull(point, h)) / self.diagonal[point];
    }

    fn relax_forwards(&self, b: &[f64], h: &mut [f64]) {
        for i in 0..self.len() {
            self.relax(i, b, h);
        }
    }

    fn relax_backwards(&self, b: &[f64], h: &mut [f64]) {
        for i in (0..self.len()).rev() {
            self.relax(i, b, h);
        }
    }

    /// The equations of the two-by-two blocks, and the block of each point. Where points lie so far
    /// apart that this would not halve their number, blocks are larger, so that the cost of a cycle
    /// stays in proportion to the points.
    fn coarser(&self) -> (Self, Vec<u32>) {
        let mut halvings = 1;
        let mut order: Vec<u32> = (0..self.len() as u32).collect();
        loop {
            // Points by block, blocks row by row
            order.sort_unstable_by_key(|&i| {
                let [x, y] = self.block(i, halvings);
                (y, x, i)
            });
            let blocks = order
                .chunk_by(|&i, &j| self.block(i, halvings) == self.block(j, halvings))
                .count();
            if 2 * blocks <= self.len() + 1 || halvings == 31 {
                break;
            }
            halvings += 1;
        }
        let same_block = |&i: &u32, &j: &u32| self.block(i, halvings) == self.block(j, halvings);
        let mut block_of = vec![0; self.len()];
        let mut blocks = 0;
        for members in order.chunk_by(same_block) {
            for &i in members {
                block_of[i as usize] = blocks;
            }
            blocks += 1;
        }

        // Springs within a block vanish; those between the same two blocks add.
        let mut coarse = Self::with_capacity(blocks as usize);
        let mut joined: Vec<(u32, f64)> = Vec::new();
        for members in order.chunk_by(same_block) {
            let this = block_of[members[0] as usize];
            coarse.begin_point(self.block(members[0], halvings));
            joined.clear();
            for &i in members {
                let mut anchor = self.diagonal[i as usize];
                for &(j, w) in self.springs_of(i as usize) {
                    anchor -= w;
                    let other = block_of[j as usize];
                    if other == this {
                        continue;
                    }
                    match joined.iter_mut().find(|(known, _)| *known == other) {
                        Some((_, weight)) => *weight += w,
                        None => joined.push((other, w)),
                    }
                }
                coarse.anchor(anchor.max(0.0));
            }
            for &(other, weight) in &joined {
                coarse.join(other, weight);
            }
        }
        (coarse, block_of)
    }
}

/// One level of the cycle with its working space.
struct Level {
    system: GraphLaplacian,
    /// Block of each point on the next level; empty on the coarsest.
    block_of: Vec<u32>,
    b: Vec<f64>,
    h: Vec<f64>,
    residual: Vec<f64>,
}

impl Level {
    fn new(system: GraphLaplacian, block_of: Vec<u32>) -> Self {
        let n = system.len();
        Self {
            system,
            block_of,
            b: vec![0.0; n],
            h: vec![0.0; n],
            residual: vec![0.0; n],
        }
    }
}

/// The solution of `system` with the right-hand side `source`.
pub(crate) fn solve(system: GraphLaplacian, source: &[f64]) -> Result<Vec<f64>, MissingError> {
    let n = source.len();
    let mut levels = Vec::new();
    let mut finest = system;
    // Without springs left, relaxation is exact.
    while finest.len() > COARSEST && !finest.springs.is_empty() {
        let (coarse, block_of) = finest.coarser();
        levels.push(Level::new(finest, block_of));
        finest = coarse;
    }
    levels.push(Level::new(finest, Vec::new()));

    // Conjugate gradients: r residual, z preconditioned residual, p direction
    let mut h = vec![0.0; n];
    let mut r = source.to_vec();
    let mut z = precondition(&mut levels, &r);
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
        levels[0].system.apply(&p, &mut ap);
        let step = rz / dot(&p, &ap);
        for i in 0..n {
            h[i] += step * p[i];
            r[i] -= step * ap[i];
        }
        z = precondition(&mut levels, &r);
        let next = dot(&r, &z);
        let turn = next / rz;
        rz = next;
        for i in 0..n {
            p[i] = z[i] + turn * p[i];
        }
        steps += 1;
    }
    Ok(h)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// An approximate solution for the right-hand side `r`: one cycle from zero.
fn precondition(levels: &mut [Level], r: &[f64]) -> Vec<f64> {
    levels[0].b.copy_from_slice(r);
    levels[0].h.fill(0.0);
    cycle(levels);
    levels[0].h.clone()
}

/// Improves `h` of the first level towards the solution for its `b`.
fn cycle(levels: &mut [Level]) {
    let Some((fine, coarser)) = levels.split_first_mut() else {
        return;
    };
    let Some(coarse) = coarser.first_mut() else {
        for _ in 0..COARSEST_SWEEPS {
            fine.system.relax_forwards(&fine.b, &mut fine.h);
            fine.system.relax_backwards(&fine.b, &mut fine.h);
        }
        return;
    };
    fine.system.relax_forwards(&fine.b, &mut fine.h);
    fine.system.apply(&fine.h, &mut fine.residual);
    coarse.b.fill(0.0);
    coarse.h.fill(0.0);
    for (i, &block) in fine.block_of.iter().enumerate() {
        coarse.b[block as usize] += fine.b[i] - fine.residual[i];
    }
    cycle(coarser);
    if coarser.len() > 1 {
        cycle(coarser);
    }
    for (h, &block) in fine.h.iter_mut().zip(&fine.block_of) {
        *h += coarser[0].h[block as usize];
    }
    fine.system.relax_backwards(&fine.b, &mut fine.h);
}
