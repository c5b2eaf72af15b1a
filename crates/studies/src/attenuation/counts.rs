//! What is counted on a surface.

use std::ops::AddAssign;

/// Points that face a direction, and those of them that see it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen {
    pub(super) facing: u64,
    pub(super) free: u64,
}

impl AddAssign for Seen {
    fn add_assign(&mut self, other: Self) {
        self.facing += other.facing;
        self.free += other.free;
    }
}

/// Projected areas of points that face a direction, and of those that see it, over that of the mean plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Area {
    pub(super) facing: f64,
    pub(super) free: f64,
}

/// What was counted on a surface, or on a part of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Counts {
    pub(super) points: u64,
    /// One per light.
    pub(super) lights: Vec<Seen>,
    /// The same lights' projected areas, each point having one of the mean plane.
    pub(super) areas: Vec<Area>,
    /// One per view.
    pub(super) views: Vec<Seen>,
    /// Points that face both directions, and those of them that are lit and visible; views of one light after
    /// the other.
    pub(super) pairs: Vec<Seen>,
    /// Samples of the grid.
    pub(super) samples: u64,
    /// Samples that are lit and visible; views of one light after the other.
    pub(super) paper: Vec<u64>,
    /// Lit points whose mirrored ray escapes, one number per light.
    pub(super) mirrored: Vec<u64>,
    /// Points that face a light and are lit, by their height; the bins of one light after the other.
    pub(super) heights: Vec<Seen>,
    /// Visibility rays lost to numerical failure.
    pub(super) lost: u64,
}

impl Counts {
    pub(super) fn add(mut self, other: Self) -> Self {
        if self.points == 0 {
            return other;
        }
        let sum = |into: &mut Vec<Seen>, from: &[Seen]| {
            into.iter_mut().zip(from).for_each(|(a, b)| *a += *b);
        };
        let sum_plain = |into: &mut Vec<u64>, from: &[u64]| {
            into.iter_mut().zip(from).for_each(|(a, b)| *a += b);
        };
        self.points += other.points;
        self.samples += other.samples;
        sum(&mut self.lights, &other.lights);
        sum(&mut self.views, &other.views);
        sum(&mut self.pairs, &other.pairs);
        sum(&mut self.heights, &other.heights);
        for (a, b) in self.areas.iter_mut().zip(&other.areas) {
            a.facing += b.facing;
            a.free += b.free;
        }
        sum_plain(&mut self.paper, &other.paper);
        sum_plain(&mut self.mirrored, &other.mirrored);
        self.lost += other.lost;
        self
    }
}
