//! Random numbers: drawn for many segments at a time.

use std::ops::Range;

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

/// Random numbers of many scatterings: of roulette, two or three of the direction, and of the free flight that follows.
pub(crate) type Numbers = [Vec<f64>; 6];

/// Draws the random numbers of a use at those of `segments` that are in `rows`.
pub(crate) struct DrawNumbers<'a> {
    pub(crate) stream: PathStream,
    pub(crate) segments: &'a Segments,
    pub(crate) rows: Range<usize>,
    /// Pairs of numbers per segment.
    pub(crate) pairs: usize,
    pub(crate) of: Use,
    pub(crate) into: &'a mut Numbers,
}

impl Stage for DrawNumbers<'_> {
    #[inline(always)]
    fn run(self) {
        let n = self.rows.len();
        let at = self.segments;
        let (order, events) = (&at.order[self.rows.clone()], &at.events[self.rows.clone()]);
        let (scatterings, ray) = (
            &at.scatterings[self.rows.clone()],
            &at.ray[self.rows.clone()],
        );
        for (pair, columns) in self.into.chunks_exact_mut(2).enumerate().take(self.pairs) {
            let [first, second] = columns else { continue };
            first.resize(n, 0.0);
            second.resize(n, 0.0);
            let (first, second) = (&mut first[..n], &mut second[..n]);
            for i in 0..n {
                let step = Step {
                    number: order[i].wrapping_add(scatterings[i]),
                    events: events[i],
                };
                let numbers = self.stream.pair_number(pair as u64, ray[i], step, self.of);
                (first[i], second[i]) = (numbers[0], numbers[1]);
            }
        }
    }
}
