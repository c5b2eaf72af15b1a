//! Jitter: moves starts from the corners of their strata to random positions in them, many at a time.

use super::start::Start;
use crate::random::{PathStream, Step, Use};
use crate::vector::Stage;

/// Moves starts from the corners of their strata, in units of these, to random positions in them.
pub(super) struct Jitter<'a> {
    pub(super) stream: PathStream,
    /// Size of a stratum along u, v and azimuth.
    pub(super) size: [f64; 3],
    pub(super) any_azimuth: bool,
    pub(super) starts: &'a mut [Start],
}

/// Starts of a block.
const BLOCK: usize = 64;

impl Stage for Jitter<'_> {
    #[inline(always)]
    fn run(self) {
        let pairs = if self.any_azimuth { 2 } else { 1 };
        for starts in self.starts.chunks_mut(BLOCK) {
            let mut rays = [0; BLOCK];
            for (ray, start) in rays.iter_mut().zip(&*starts) {
                *ray = start.ray;
            }
            // Along u and v, and along azimuth
            let mut numbers = [[[0.0; BLOCK]; 2]; 2];
            for (pair, [first, second]) in (0..pairs).zip(&mut numbers) {
                for k in 0..BLOCK {
                    let stream = self.stream;
                    let numbers = stream.pair_number(pair, rays[k], Step::START, Use::Start);
                    (first[k], second[k]) = (numbers[0], numbers[1]);
                }
            }
            let [[along_u, along_v], [along_azimuth, _]] = &numbers;
            for (k, start) in starts.iter_mut().enumerate() {
                let along = [along_u[k], along_v[k], along_azimuth[k]];
                for ((position, along), size) in start.position.iter_mut().zip(along).zip(self.size)
                {
                    *position = (*position + along) * size;
                }
            }
        }
    }
}
