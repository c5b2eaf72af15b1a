//! Columns: hits of many walks and their branches, field by field.

use asperity_tally::EventPath;
use glam::DVec3;

use crate::models::heitz::light::LIGHT_COLUMNS;

/// Light that arrives at facets, field by field.
#[derive(Default)]
pub(super) struct Hits {
    pub(super) walk: Vec<u64>,
    pub(super) path: Vec<EventPath>,
    pub(super) is_behind: Vec<bool>,
    /// Unit direction towards the origin of the light, in the frame whose +z points into the medium that it comes through.
    pub(super) w: [Vec<f64>; 3],
    pub(super) height: Vec<f64>,
    pub(super) weight: Vec<f64>,
    pub(super) threshold: Vec<f64>,
    pub(super) light: [Vec<f64>; LIGHT_COLUMNS],
}

/// One of the two branches of each hit, field by field: see [`Branch`](crate::models::heitz::branch::Branch).
#[derive(Default)]
pub(super) struct Branches {
    pub(super) direction: [Vec<f64>; 3],
    pub(super) escaping: Vec<f64>,
    pub(super) remaining: Vec<f64>,
    pub(super) height: Vec<f64>,
    pub(super) lambda: Vec<f64>,
    pub(super) blocked: Vec<f64>,
    pub(super) light: [Vec<f64>; LIGHT_COLUMNS],
}

impl Hits {
    pub(super) fn len(&self) -> usize {
        self.walk.len()
    }

    pub(super) fn push(&mut self, walk: u64, path: EventPath, is_behind: bool, w: DVec3) {
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
    pub(super) fn resize(&mut self, n: usize, light: usize) {
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
pub(super) fn grow(column: &mut Vec<f64>, n: usize) {
    if column.len() < n {
        column.resize(n, 0.0);
    }
}

/// The first `n` numbers of each column.
#[inline(always)]
pub(super) fn cut<const N: usize>(columns: &[Vec<f64>; N], n: usize) -> [&[f64]; N] {
    columns.each_ref().map(|column| &column[..n])
}

/// The first `n` numbers of each column, to be written.
#[inline(always)]
pub(super) fn cut_mut<const N: usize>(columns: &mut [Vec<f64>; N], n: usize) -> [&mut [f64]; N] {
    columns.each_mut().map(|column| &mut column[..n])
}
