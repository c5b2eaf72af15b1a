//! Wavefront: many rays of the random walk at a time, in loops that are compiled for each instruction set.
//!
//! Hits wait in columns. A step samples the facet of every hit, divides the light there, tallies what escapes, and hands on what is left
//! as hits of the next step. New rays join where fewer than [`MIN_HITS`] hits are left, so that lanes stay busy. Random numbers are functions of
//! the walk and of its step; the branches of the first facet are two walks from there on. The scalar walk in `heitz.rs` is the reference.
//!
//! Light scattered once is not tallied, since the model takes it from its density, unless its side is not recorded.

#[cfg(test)]
mod tests;

use std::marker::PhantomData;
use std::ops::Range;

use asperity_numerics::random::{open_unit, threefry, unit_of_half};
use asperity_numerics::vector::{Instructions, Stage};
use asperity_optics::{Fresnel, Material, reflect, refract};
use asperity_tally::{Event, EventPath, Exit, ExitColumns, Loss, Side, Tally};
use glam::DVec3;
use rand::Rng;

use super::height::Height;
use super::light::{LIGHT_COLUMNS, Light};
use super::limits::{MAX_INTERACTIONS, MIN_WEIGHT, ROULETTE_THRESHOLD};
use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::slope_frame::SlopeFrame;
use crate::microfacet::visible_normals::propose;

/// Hits below which new rays join.
const MIN_HITS: usize = 1024;

/// Trials of a normal have the counters of a step, with their number in these bits; draws of the step itself have the last one.
const TRIAL_SHIFT: u32 = 48;
const DRAWS_OF_STEP: u64 = 0xffff;

/// Bit of the number of a walk that went on from the first facet by transmission.
const TRANSMITTED_FIRST: u64 = 1 << 47;

/// Light that arrives at facets, field by field.
#[derive(Default)]
struct Hits {
    walk: Vec<u64>,
    path: Vec<EventPath>,
    is_behind: Vec<bool>,
    /// Unit direction towards the origin of the light, in the frame whose +z points into the medium that it comes through.
    w: [Vec<f64>; 3],
    height: Vec<f64>,
    weight: Vec<f64>,
    threshold: Vec<f64>,
    light: [Vec<f64>; LIGHT_COLUMNS],
}

/// One of the two branches of each hit, field by field: see [`super::branch::Branch`].
#[derive(Default)]
struct Branches {
    direction: [Vec<f64>; 3],
    escaping: Vec<f64>,
    remaining: Vec<f64>,
    height: Vec<f64>,
    lambda: Vec<f64>,
    blocked: Vec<f64>,
    light: [Vec<f64>; LIGHT_COLUMNS],
}

/// The random walk on facets of Gaussian slopes, with light of the kind `L` and the material that `at` makes of the relative index.
pub(super) struct Wavefront<L, M> {
    beckmann: Beckmann,
    material: Material,
    at: M,
    key: [u64; 2],
    instructions: Instructions,
    hits: Hits,
    pending: Pending,
    /// Facet normals.
    normals: [Vec<f64>; 3],
    reflected: Branches,
    transmitted: Branches,
    absorbed: Vec<f64>,
    /// Random numbers of the step: those that pick a branch, of Russian roulette, and of the next height.
    draws: [Vec<f64>; 3],
    exits: ExitColumns,
    next: Next,
    /// Light of paths that end in a step.
    truncated: f64,
    light: PhantomData<L>,
}

/// Follows `rays` rays from `wi` with light of the kind `L`, and tallies what is scattered more than once. Returns `false` for
/// materials that are left to the scalar walk.
pub(super) fn follow<L: Light>(
    beckmann: Beckmann,
    material: Material,
    wi: DVec3,
    rays: u64,
    rng: &mut impl Rng,
    tally: &mut Tally<'_>,
) -> bool {
    let mut key = || [rng.next_u64(), rng.next_u64()];
    match material {
        Material::Dielectric { .. } => {
            let at = |eta| Material::Dielectric { eta };
            Wavefront::<L, _>::new(beckmann, material, at, key()).run(wi, rays, tally);
        }
        Material::Conductor { eta, kappa } => {
            let at = move |_| Material::Conductor { eta, kappa };
            Wavefront::<L, _>::new(beckmann, material, at, key()).run(wi, rays, tally);
        }
        Material::Mirror => {
            Wavefront::<L, _>::new(beckmann, material, |_| Material::Mirror, key())
                .run(wi, rays, tally);
        }
        _ => return false,
    }
    true
}

impl<L: Light, M: Fn(f64) -> Material + Copy> Wavefront<L, M> {
    fn new(beckmann: Beckmann, material: Material, at: M, key: [u64; 2]) -> Self {
        Self {
            beckmann,
            material,
            at,
            key,
            instructions: Instructions::best(),
            hits: Hits::default(),
            pending: Pending::default(),
            next: Next::default(),
            normals: Default::default(),
            reflected: Branches::default(),
            transmitted: Branches::default(),
            absorbed: Vec::new(),
            draws: Default::default(),
            exits: ExitColumns::default(),
            truncated: 0.0,
            light: PhantomData,
        }
    }

    fn run(&mut self, wi: DVec3, rays: u64, tally: &mut Tally<'_>) {
        let lambda = self.beckmann.lambda(wi);
        let mut next = 0;
        loop {
            if self.hits.len() < MIN_HITS {
                let end = rays.min(next + MIN_HITS as u64);
                self.start(next..end, wi, lambda);
                next = end;
            }
            if self.hits.len() == 0 {
                break;
            }
            self.sample_normals();
            self.scatter();
            self.tally_exits(tally);
            self.continue_paths(tally);
        }
        self.flush(tally);
    }

    /// Adds hits of new rays from `wi`, whose Lambda is `lambda`.
    fn start(&mut self, walks: Range<u64>, wi: DVec3, lambda: f64) {
        let hits = &mut self.hits;
        let first = hits.len();
        hits.walk.extend(walks);
        let n = hits.len();
        hits.path.resize(n, EventPath::default());
        hits.is_behind.resize(n, false);
        hits.height.resize(n, 0.0);
        hits.weight.resize(n, 1.0);
        hits.threshold.resize(n, 0.0);
        let light = hits.light[..L::KEPT]
            .iter_mut()
            .zip(L::INCIDENT.to_numbers());
        let columns = hits.w.iter_mut().zip(wi.to_array()).chain(light);
        columns.for_each(|(column, x)| column.resize(n, x));
        self.instructions.run(Start {
            key: self.key,
            lambda,
            walks: &hits.walk[first..],
            heights: &mut hits.height[first..],
        });
    }

    /// Samples the facet normal of every hit, by trials of those that have none.
    fn sample_normals(&mut self) {
        let n = self.hits.len();
        let pending = &mut self.pending;
        pending.begin(&self.hits);
        (self.normals.iter_mut()).for_each(|column| grow(column, n));
        let mut trial = 0;
        while !pending.hit.is_empty() {
            self.instructions.run(ProposeNormals {
                beckmann: self.beckmann,
                key: self.key,
                trial,
                pending,
            });
            pending.keep(&mut self.normals);
            trial += 1;
            assert!(trial < DRAWS_OF_STEP, "no visible normal is accepted");
        }
    }

    fn scatter(&mut self) {
        self.instructions.run(Scatter::<L, M> {
            beckmann: self.beckmann,
            material: self.material,
            at: self.at,
            key: self.key,
            hits: &self.hits,
            normals: &self.normals,
            reflected: &mut self.reflected,
            transmitted: &mut self.transmitted,
            absorbed: &mut self.absorbed,
            draws: &mut self.draws,
            light: PhantomData,
        });
    }

    /// Collects the light that escapes and what is absorbed.
    fn tally_exits(&mut self, tally: &mut Tally<'_>) {
        for i in 0..self.hits.len() {
            let (weight, path) = (self.hits.weight[i], self.hits.path[i]);
            if self.absorbed[i] > 0.0 {
                tally.add_loss(Loss::Absorbed, weight * self.absorbed[i]);
            }
            let behind = self.hits.is_behind[i];
            for (branch, event, is_behind) in [
                (&self.reflected, Event::Reflection, behind),
                (&self.transmitted, Event::Transmission, !behind),
            ] {
                let flux = weight * branch.escaping[i];
                let side = side(is_behind);
                if flux > 0.0 && (path.order() > 0 || !tally.records(side)) {
                    let mut wo =
                        DVec3::from_array(branch.direction.each_ref().map(|column| column[i]));
                    if is_behind {
                        wo.z = -wo.z;
                    }
                    let exit = Exit {
                        side,
                        wo,
                        flux,
                        path: path.then(event),
                        scatterings: 0,
                    };
                    self.exits.push(&exit, 0);
                }
            }
        }
        if self.exits.len() >= MIN_HITS {
            self.flush(tally);
        }
    }

    fn flush(&mut self, tally: &mut Tally<'_>) {
        let exits = &mut self.exits;
        self.instructions.run(TallyExits { tally, exits });
    }

    /// Makes the hits of the next step: both branches go on from the first facet, one from later ones.
    fn continue_paths(&mut self, tally: &mut Tally<'_>) {
        self.truncated = 0.0;
        for i in 0..self.hits.len() {
            let remaining = [&self.reflected, &self.transmitted].map(|branch| branch.remaining[i]);
            let sum = remaining[0] + remaining[1];
            if self.hits.path[i].order() == 0 {
                let threshold = ROULETTE_THRESHOLD * sum;
                // The branches take opposite ends of one random number
                let (walk, chance) = (self.hits.walk[i], self.draws[1][i]);
                self.choose(i, false, walk, [remaining[0], threshold, chance]);
                let walk = walk | TRANSMITTED_FIRST;
                self.choose(i, true, walk, [remaining[1], threshold, 1.0 - chance]);
            } else {
                let is_transmitted = self.draws[0][i] * sum < remaining[1];
                let weight = self.hits.weight[i] * sum;
                let roulette = [weight, self.hits.threshold[i], self.draws[1][i]];
                self.choose(i, is_transmitted, self.hits.walk[i], roulette);
            }
        }
        tally.add_loss(Loss::Truncated, self.truncated);
        self.instructions.run(&mut self.next);
        std::mem::swap(&mut self.hits, &mut self.next.hits);
        self.next.clear();
    }

    /// Lets light of a weight go on by a branch, unless it is too weak, or the random number `chance` of Russian roulette ends it.
    #[inline]
    fn choose(&mut self, i: usize, is_transmitted: bool, walk: u64, roulette: [f64; 3]) {
        let [mut weight, threshold, chance] = roulette;
        let path = self.hits.path[i];
        if path.order() + 1 >= MAX_INTERACTIONS || weight < MIN_WEIGHT {
            self.truncated += weight;
            return;
        }
        if weight < threshold {
            let survives = chance * threshold < weight;
            let kept = if survives { threshold } else { 0.0 };
            self.truncated += weight - kept;
            if !survives {
                return;
            }
            weight = kept;
        }
        let (branch, event) = match is_transmitted {
            false => (&self.reflected, Event::Reflection),
            true => (&self.transmitted, Event::Transmission),
        };
        let next = &mut self.next;
        let direction = branch.direction.each_ref().map(|column| column[i]);
        let is_behind = self.hits.is_behind[i] != is_transmitted;
        (next.hits).push(
            walk,
            path.then(event),
            is_behind,
            -DVec3::from_array(direction),
        );
        next.hits.height.push(branch.height[i]);
        next.hits.weight.push(weight);
        next.hits.threshold.push(threshold);
        for (to, from) in next.hits.light.iter_mut().zip(&branch.light[..L::KEPT]) {
            to.push(from[i]);
        }
        next.lambda.push(branch.lambda[i]);
        next.blocked.push(branch.blocked[i]);
        next.u.push(self.draws[2][i]);
    }
}

impl Hits {
    fn len(&self) -> usize {
        self.walk.len()
    }

    fn push(&mut self, walk: u64, path: EventPath, is_behind: bool, w: DVec3) {
        self.walk.push(walk);
        self.path.push(path);
        self.is_behind.push(is_behind);
        for (column, w) in self.w.iter_mut().zip(w.to_array()) {
            column.push(w);
        }
    }
}

impl Branches {
    /// Makes room for `n` branches, whose light has `light` numbers.
    fn resize(&mut self, n: usize, light: usize) {
        let Self {
            direction,
            escaping,
            remaining,
            height,
            lambda,
            blocked,
            light: all,
        } = self;
        let columns = [escaping, remaining, height, lambda, blocked];
        let columns = columns.into_iter().chain(direction);
        columns
            .chain(&mut all[..light])
            .for_each(|column| grow(column, n));
    }
}

/// Makes a column at least `n` rows long.
fn grow(column: &mut Vec<f64>, n: usize) {
    if column.len() < n {
        column.resize(n, 0.0);
    }
}

const fn side(is_behind: bool) -> Side {
    match is_behind {
        false => Side::Reflected,
        true => Side::Transmitted,
    }
}

/// The first `n` numbers of each column.
#[inline(always)]
fn cut<const N: usize>(columns: &[Vec<f64>; N], n: usize) -> [&[f64]; N] {
    columns.each_ref().map(|column| &column[..n])
}

#[inline(always)]
fn cut_mut<const N: usize>(columns: &mut [Vec<f64>; N], n: usize) -> [&mut [f64]; N] {
    columns.each_mut().map(|column| &mut column[..n])
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

/// Finds the heights at which new rays meet their first facets.
struct Start<'a> {
    key: [u64; 2],
    lambda: f64,
    walks: &'a [u64],
    heights: &'a mut [f64],
}

impl Stage for Start<'_> {
    #[inline(always)]
    fn run(self) {
        for (height, walk) in self.heights.iter_mut().zip(self.walks) {
            let [word, _] = threefry(self.key, [walk | DRAWS_OF_STEP << TRIAL_SHIFT, 0]);
            let first = Height::ABOVE_ALL.descended(self.lambda, open_unit(word));
            *height = first.logarithm();
        }
    }
}

/// Hits whose normals are not accepted yet, field by field, and the normals that were tried.
#[derive(Default)]
struct Pending {
    hit: Vec<u32>,
    walk: Vec<u64>,
    step: Vec<u64>,
    w: [Vec<f64>; 3],
    normal: [Vec<f64>; 3],
    is_accepted: Vec<u64>,
}

impl Pending {
    /// Takes all hits.
    fn begin(&mut self, hits: &Hits) {
        let n = hits.len();
        self.hit.clear();
        self.hit.extend(0..n as u32);
        self.walk.clone_from(&hits.walk);
        self.step.clear();
        let steps = hits.path.iter().map(|path| u64::from(path.order()) << 1);
        self.step.extend(steps);
        self.w.clone_from(&hits.w);
        let normals = self.normal.iter_mut();
        normals.for_each(|column| grow(column, n));
        if self.is_accepted.len() < n {
            self.is_accepted.resize(n, 0);
        }
    }

    /// Writes accepted normals into `normals`, and keeps the other hits.
    fn keep(&mut self, normals: &mut [Vec<f64>; 3]) {
        let mut left = 0;
        for j in 0..self.hit.len() {
            let hit = self.hit[j];
            if self.is_accepted[j] == 1 {
                for (normals, tried) in normals.iter_mut().zip(&self.normal) {
                    normals[hit as usize] = tried[j];
                }
                continue;
            }
            self.hit[left] = hit;
            self.walk[left] = self.walk[j];
            self.step[left] = self.step[j];
            let columns = self.w.iter_mut();
            columns.for_each(|column| column[left] = column[j]);
            left += 1;
        }
        self.hit.truncate(left);
    }
}

/// A trial of a visible normal for each pending hit.
struct ProposeNormals<'a> {
    beckmann: Beckmann,
    key: [u64; 2],
    trial: u64,
    pending: &'a mut Pending,
}

impl Stage for ProposeNormals<'_> {
    #[inline(always)]
    fn run(self) {
        let pending = self.pending;
        let n = pending.hit.len();
        let [mx, my, mz] = cut_mut(&mut pending.normal, n);
        let [wx, wy, wz] = cut(&pending.w, n);
        let (walks, steps) = (&pending.walk[..n], &pending.step[..n]);
        let is_accepted = &mut pending.is_accepted[..n];
        let trial = self.trial << TRIAL_SHIFT;
        for i in 0..n {
            let w = DVec3::new(wx[i], wy[i], wz[i]);
            let [first, second] = threefry(self.key, [walks[i] | trial, steps[i]]);
            let [third, fourth] = threefry(self.key, [walks[i] | trial, steps[i] | 1]);
            let frame = SlopeFrame::of_direction(self.beckmann.slopes(), w);
            let (m, accepted) = propose(&frame, w, [first, second, third, fourth]);
            mx[i] = m.x;
            my[i] = m.y;
            mz[i] = m.z;
            is_accepted[i] = u64::from(accepted);
        }
    }
}

/// Divides the light of each hit at its facet.
struct Scatter<'a, L, M> {
    beckmann: Beckmann,
    material: Material,
    at: M,
    key: [u64; 2],
    hits: &'a Hits,
    normals: &'a [Vec<f64>; 3],
    reflected: &'a mut Branches,
    transmitted: &'a mut Branches,
    absorbed: &'a mut Vec<f64>,
    draws: &'a mut [Vec<f64>; 3],
    light: PhantomData<L>,
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
            let step = u64::from(paths[i].order()) << 1 | 1;
            let [first, second] =
                threefry(self.key, [walks[i] | DRAWS_OF_STEP << TRIAL_SHIFT, step]);
            t[i] = open_unit(first);
            u[i] = unit_of_half(second);
            v[i] = unit_of_half(second << 32);
        }

        // Divide the light, block by block: arrays of the stack do not overlap, so that the compiler need not ask
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
    fn divide(&mut self, beckmann: &Beckmann, n: usize) {
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

impl Next {
    fn clear(&mut self) {
        let Hits {
            walk,
            path,
            is_behind,
            w,
            height,
            weight,
            threshold,
            light,
        } = &mut self.hits;
        walk.clear();
        path.clear();
        is_behind.clear();
        let columns = [height, weight, threshold]
            .into_iter()
            .chain(w)
            .chain(light);
        let columns = columns.chain([&mut self.lambda, &mut self.blocked, &mut self.u]);
        columns.for_each(Vec::clear);
    }
}

/// Hits of the next step, of which the heights are still those of the last one.
#[derive(Default)]
struct Next {
    hits: Hits,
    lambda: Vec<f64>,
    blocked: Vec<f64>,
    u: Vec<f64>,
}

impl Stage for &mut Next {
    #[inline(always)]
    fn run(self) {
        let n = self.hits.len();
        let heights = &mut self.hits.height[..n];
        let z = &self.hits.w[2][..n];
        let (lambda, blocked, u) = (&self.lambda[..n], &self.blocked[..n], &self.u[..n]);
        for i in 0..n {
            let height = Height::at(heights[i]);
            let up = height.ascended(lambda[i], blocked[i], u[i]).logarithm();
            let down = height.descended(lambda[i], u[i]).logarithm();
            heights[i] = if z[i] < 0.0 { up } else { down };
        }
    }
}

/// Adds exits to a tally.
struct TallyExits<'a, 't> {
    tally: &'a mut Tally<'t>,
    exits: &'a mut ExitColumns,
}

impl Stage for TallyExits<'_, '_> {
    #[inline(always)]
    fn run(self) {
        self.tally.add_exits(self.exits);
    }
}
