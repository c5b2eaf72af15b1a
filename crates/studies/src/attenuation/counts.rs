//! Counts: what is counted on a surface.

use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

/// Numbers of points by direction, or by height.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Seen<T> {
    /// Points that face a direction.
    pub(super) facing: Vec<T>,
    /// Points among them that nothing hides.
    pub(super) free: Vec<T>,
}

impl<T: Copy + AddAssign> Seen<T> {
    pub(super) fn push(&mut self, [facing, free]: [T; 2]) {
        self.facing.push(facing);
        self.free.push(free);
    }

    fn add(&mut self, other: Self) {
        add(&mut self.facing, other.facing);
        add(&mut self.free, other.free);
    }
}

/// Counts on a surface, or on a part of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Counts {
    pub(super) points: u64,
    /// One per light.
    pub(super) lights: Seen<u64>,
    /// Projected areas towards the same lights, each point having one of the mean plane.
    pub(super) areas: Seen<f64>,
    /// One per view.
    pub(super) views: Seen<u64>,
    /// Points that face both directions, and those of them that are lit and visible; views of one light after
    /// the other.
    pub(super) pairs: Seen<u64>,
    /// Samples of the grid.
    pub(super) samples: u64,
    /// Samples that are lit and visible; views of one light after the other.
    pub(super) paper: Vec<u64>,
    /// Lit points whose mirrored ray escapes, one number per light; empty if that was not requested.
    pub(super) mirrored: Vec<u64>,
    /// Points that face a light and are lit, by their height; the bins of one light after the other. Empty if that was not requested.
    pub(super) heights: Seen<u64>,
    /// Visibility rays lost to numerical failure, of the whole surface.
    pub(super) lost: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.points += other.points;
        self.lights.add(other.lights);
        self.areas.add(other.areas);
        self.views.add(other.views);
        self.pairs.add(other.pairs);
        self.samples += other.samples;
        add(&mut self.paper, other.paper);
        add(&mut self.mirrored, other.mirrored);
        self.heights.add(other.heights);
    }
}

/// Adds numbers one by one; to nothing, all of them.
fn add<T: Copy + AddAssign>(into: &mut Vec<T>, from: Vec<T>) {
    if into.is_empty() {
        *into = from;
    } else {
        into.iter_mut().zip(from).for_each(|(a, b)| *a += b);
    }
}
