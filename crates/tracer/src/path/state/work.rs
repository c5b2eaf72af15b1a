//! Work: counts of the work that a batch took.

use serde::{Deserialize, Serialize};

use crate::geometry::{CullingClass, Escape};
use crate::periodic::TraversalEnd;

/// Counts of the work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    /// Incident rays.
    pub rays: u64,
    /// Segments searched for a hit.
    pub segments: u64,
    /// Segments that needed no search, free flights inside a medium among them.
    pub segments_skipped: u64,
    /// Segments skipped by bounds on slopes and heights ahead, not by the steepest facets of the whole surface; counted
    /// in `segments_skipped` too.
    pub segments_skipped_nearby: u64,
    /// Branches not followed, since they could end only on a side that is not recorded.
    pub branches_not_recorded: u64,
    /// Scatterings inside the medium below.
    pub scatterings: u64,
    /// Largest number of scatterings of one path.
    pub max_scatterings: u32,
}

impl Work {
    /// A segment that was searched.
    pub(crate) const SEARCHED: Self = Self {
        segments: 1,
        ..Self::NONE
    };

    /// A segment that was not followed.
    pub(crate) const NOT_RECORDED: Self = Self {
        branches_not_recorded: 1,
        ..Self::NONE
    };

    pub(crate) const NONE: Self = Self {
        rays: 0,
        segments: 0,
        segments_skipped: 0,
        segments_skipped_nearby: 0,
        branches_not_recorded: 0,
        scatterings: 0,
        max_scatterings: 0,
    };

    /// This work less that on some segments of it.
    pub(crate) const fn without(self, segments: &Self) -> Self {
        Self {
            segments: self.segments - segments.segments,
            segments_skipped: self.segments_skipped - segments.segments_skipped,
            segments_skipped_nearby: self.segments_skipped_nearby
                - segments.segments_skipped_nearby,
            branches_not_recorded: self.branches_not_recorded - segments.branches_not_recorded,
            ..self
        }
    }

    /// A segment that escapes without a search, by its culling class.
    pub(crate) fn of_skipped(class: CullingClass) -> Self {
        Self {
            segments_skipped: 1,
            segments_skipped_nearby: u64::from(class == CullingClass::AboveHorizon),
            ..Self::NONE
        }
    }

    /// Counts a segment that met nothing, by how its traversal ended.
    pub(crate) fn count(&mut self, end: TraversalEnd) {
        if let TraversalEnd::EscapedUnsearched(escape) = end {
            self.segments_skipped += 1;
            self.segments_skipped_nearby += u64::from(escape == Escape::AboveHorizon);
        } else {
            self.segments += 1;
        }
    }
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.segments += other.segments;
        self.segments_skipped += other.segments_skipped;
        self.segments_skipped_nearby += other.segments_skipped_nearby;
        self.branches_not_recorded += other.branches_not_recorded;
        self.scatterings += other.scatterings;
        self.max_scatterings = self.max_scatterings.max(other.max_scatterings);
    }
}
