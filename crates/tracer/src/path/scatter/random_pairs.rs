//! Random pairs: the random numbers of many interactions at a time.

use crate::path::state::segments::Segments;
use crate::random::{PathStream, Step, Use};
use crate::vector::Stage;

/// Draws the two numbers of a use at those of `segments` whose numbers are in `which`.
pub(crate) struct DrawPairs<'a> {
    pub(crate) stream: PathStream,
    pub(crate) segments: &'a Segments,
    pub(crate) which: &'a [u32],
    pub(crate) of: Use,
    pub(crate) pairs: &'a mut Vec<[f64; 2]>,
}

/// Interactions of a block.
const BLOCK: usize = 64;

impl Stage for DrawPairs<'_> {
    #[inline(always)]
    fn run(self) {
        let segments = self.segments;
        self.pairs.resize(self.which.len(), [0.0; 2]);
        for (which, pairs) in self.which.chunks(BLOCK).zip(self.pairs.chunks_mut(BLOCK)) {
            let mut places = [(0, 0, 0); BLOCK];
            for (place, &i) in places.iter_mut().zip(which) {
                let i = i as usize;
                let number = segments.order[i].wrapping_add(segments.scatterings[i]);
                *place = (segments.ray[i], number, segments.events[i]);
            }
            for (pair, (ray, number, events)) in pairs.iter_mut().zip(places) {
                let step = Step { number, events };
                *pair = self.stream.pair(ray, step, self.of);
            }
        }
    }
}
