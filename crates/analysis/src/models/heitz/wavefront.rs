//! Wavefront: many rays of the random walk at a time, in loops that are compiled for each instruction set.
//!
//! Hits wait in columns. A step samples the facet of every hit, divides the light there, tallies what escapes, and hands on what is left
//! as hits of the next step. New rays join where fewer than [`MIN_HITS`] hits are left, so that lanes stay busy. Random numbers are functions of
//! the walk and of its step; the branches of the first facet are two walks from there on. The scalar walk in `heitz.rs` is the reference.
//!
//! Light scattered once is not tallied, since the model takes it from its density, unless its side is not recorded.

mod columns;
mod draws;
mod heights;
mod normals;
mod scatter;
#[cfg(test)]
mod tests;

use std::marker::PhantomData;
use std::ops::Range;

use asperity_numerics::vector::{Instructions, Stage};
use asperity_optics::Material;
use asperity_tally::{Event, EventPath, Exit, ExitColumns, Loss, Side, Tally};
use glam::DVec3;
use rand::Rng;

use self::columns::{Branches, Hits, grow};
use self::draws::{MAX_TRIALS, TRANSMITTED_FIRST};
use self::heights::{Next, Start};
use self::normals::{Pending, ProposeNormals};
use self::scatter::Scatter;
use super::light::Light;
use super::limits::{MAX_INTERACTIONS, MIN_WEIGHT, ROULETTE_THRESHOLD};
use crate::microfacet::beckmann::Beckmann;

/// Hits below which new rays join.
const MIN_HITS: usize = 1024;

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
            assert!(trial < MAX_TRIALS, "no visible normal is accepted");
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

const fn side(is_behind: bool) -> Side {
    match is_behind {
        false => Side::Reflected,
        true => Side::Transmitted,
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
