//! Batch: everything that changes while a batch of paths is traced.

use asperity_tally::Tally;

use super::state::{LayerRay, SegmentQueue};
use super::work::Work;

/// Segments that are searched together: enough to fill wide searches, few enough for them and the surface
/// around them to stay in cache.
pub(super) const MAX_IN_FLIGHT: usize = 1024;

/// The state of one batch.
pub(super) struct Batch<'r, F, R> {
    pub(super) tally: Tally<'r>,
    pub(super) work: Work,
    pub(super) rng: &'r mut R,
    /// Segments to be searched in the next round, by the interface that they may meet.
    pub(super) next: [SegmentQueue<F>; 2],
    /// Rays that begin inside the layer.
    pub(super) inside: Vec<LayerRay>,
    /// How many of the next segments may be followed by another one.
    ///
    /// New paths start while it is small. Segments that are the last of their paths do not count, so that when a
    /// path starts, and which random numbers it draws, does not depend on whether they are traced; see
    /// `Tracer::trace_if_recorded`.
    pub(super) continuing: usize,
}

impl<'r, F, R> Batch<'r, F, R> {
    pub(super) fn new(tally: Tally<'r>, rng: &'r mut R) -> Self {
        Self {
            tally,
            work: Work::default(),
            rng,
            next: [SegmentQueue::new(), SegmentQueue::new()],
            inside: Vec::new(),
            continuing: 0,
        }
    }

    /// Takes the segments of the next round into `now`; false if there are none.
    pub(super) fn begin_round(&mut self, now: &mut [SegmentQueue<F>; 2]) -> bool {
        std::mem::swap(now, &mut self.next);
        self.continuing = 0;
        now.iter().any(|queue| !queue.segments.is_empty())
    }
}
