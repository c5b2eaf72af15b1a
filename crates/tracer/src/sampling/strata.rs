//! Strata: the rays of one batch, or of several that are traced together, stratum by stratum.

use std::ops::Range;

use super::start::Start;
use crate::random::PathStream;
use crate::sampling::morton::MortonSquare;

/// Rays of several batches that are traced together: those of the same strata of each.
///
/// A batch has one ray in each of `strata * strata` strata, which are numbered along a Morton curve. Where several batches lie
/// on the same surface, tracing the rays of one stratum of all of them together keeps neighbours together: they read the same
/// cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BatchedRays {
    strata: u32,
    batches: u32,
    part: Range<u32>,
}

impl BatchedRays {
    /// Most batches that are traced together.
    pub const MAX_BATCHES: u32 = 1 << 10;

    /// All rays of one batch of `strata * strata` rays.
    ///
    /// # Panics
    /// For the reasons of [`BatchedRays::new`].
    #[must_use]
    pub fn of_one(strata: u32) -> Self {
        Self::new(strata, 1, 0..strata * strata)
    }

    /// The rays in those strata of each of `batches` batches whose numbers are in `part`.
    ///
    /// # Panics
    /// Unless there are up to [`BatchedRays::MAX_BATCHES`] batches, of [`PathStream::MAX_PATHS_OF_BATCH`] rays each at the most, and
    /// `part` is a range of their strata.
    #[must_use]
    pub fn new(strata: u32, batches: u32, part: Range<u32>) -> Self {
        let rays = u64::from(strata).pow(2);
        assert!(
            rays <= PathStream::MAX_PATHS_OF_BATCH,
            "{strata} strata along a side of a batch"
        );
        assert!(
            (1..=Self::MAX_BATCHES).contains(&batches),
            "{batches} batches at a time"
        );
        assert!(
            part.start <= part.end && u64::from(part.end) <= rays,
            "strata {part:?} of {rays}"
        );
        Self {
            strata,
            batches,
            part,
        }
    }

    /// Strata along a side of the period.
    #[must_use]
    pub const fn strata(&self) -> u32 {
        self.strata
    }

    /// Number of batches.
    #[must_use]
    pub const fn batches(&self) -> u32 {
        self.batches
    }

    /// Numbers of the strata whose rays are traced.
    #[must_use]
    pub fn part(&self) -> Range<u32> {
        self.part.clone()
    }

    /// Rays of a whole batch.
    #[must_use]
    pub const fn rays_of_batch(&self) -> u64 {
        (self.strata as u64).pow(2)
    }

    /// Returns `true` if these are all rays of a single batch.
    #[must_use]
    pub fn is_one_batch(&self) -> bool {
        self.batches == 1 && (0..self.strata * self.strata) == self.part
    }
}

/// The strata of some rays, each once for every batch.
pub(super) struct Strata {
    along_curve: MortonSquare,
    /// Side of a stratum.
    width: f64,
    batches: u32,
    /// Numbers of the strata that are still to come.
    left: Range<u32>,
    /// The stratum whose turn it is, its number, and the batch that comes next in it.
    stratum: [f64; 2],
    number: u32,
    batch: u32,
}

impl Strata {
    pub(super) fn new(rays: &BatchedRays) -> Self {
        Self {
            along_curve: MortonSquare::new(rays.strata, rays.part.start),
            width: 1.0 / f64::from(rays.strata),
            batches: rays.batches,
            left: rays.part.clone(),
            stratum: [0.0; 2],
            number: 0,
            batch: rays.batches,
        }
    }

    /// Side of a stratum.
    pub(super) const fn width(&self) -> f64 {
        self.width
    }
}

/// Starts at the corners of their strata, in units of these.
impl Iterator for Strata {
    type Item = Start;

    #[inline]
    fn next(&mut self) -> Option<Start> {
        if self.batch == self.batches {
            self.number = self.left.next()?;
            self.stratum = self.along_curve.next()?.map(f64::from);
            self.batch = 0;
        }
        let [column, row] = self.stratum;
        let ray = PathStream::ray(self.batch, self.number);
        self.batch += 1;
        Some(Start {
            position: [column, row, 0.0],
            ray,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Positions, Sampling};

    fn starts(rays: &BatchedRays, stream: PathStream) -> Vec<Start> {
        Positions::new(Sampling::Stratified, rays, false, stream).draw_all()
    }

    /// Each batch has the starts that it has alone, whatever it is traced with and however its strata are divided.
    #[test]
    fn batches_have_the_same_starts_together_as_alone() {
        let stream = PathStream::new(7, 3).from_batch(5);
        for strata in [1, 5, 8] {
            let n = strata * strata;
            for cut in [0, 1, n / 2, n] {
                let [first, second] =
                    [0..cut, cut..n].map(|part| starts(&BatchedRays::new(strata, 3, part), stream));
                let together = [first, second].concat();
                assert_eq!(together.len() as u32, 3 * n);
                for batch in 0..3 {
                    let alone = PathStream::new(7, 3).from_batch(5 + u64::from(batch));
                    let of_batch: Vec<Start> = together
                        .iter()
                        .filter(|start| PathStream::batch_of(start.ray) == batch)
                        .map(|start| Start {
                            ray: start.ray - PathStream::ray(batch, 0),
                            ..*start
                        })
                        .collect();
                    assert_eq!(of_batch, starts(&BatchedRays::of_one(strata), alone));
                }
            }
        }
    }

    #[test]
    #[should_panic(expected = "strata 3..5 of 4")]
    fn strata_that_do_not_exist_are_refused() {
        let _ = BatchedRays::new(2, 1, 3..5);
    }
}
