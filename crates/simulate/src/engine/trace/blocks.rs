//! Blocks: divide the rays of a surface; groups of them are traced together.

use std::iter::successors;
use std::ops::Range;

use asperity_tracer::{BatchedRays, Sampling};

/// A division of rays into blocks of `strata * strata` rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Blocks {
    /// Number of the first.
    pub(crate) first: u64,
    pub(crate) count: u64,
    pub(crate) strata: u32,
}

/// Most strata along a side of a block: so many that its rays fall near to one another, where the
/// surface is in cache, few enough to keep every thread busy.
const MAX_STRATA: u64 = 512;

/// Blocks that a single surface gets at least, since its errors come from them.
pub(crate) const MIN_BLOCKS_OF_ONE: u64 = 64;

/// Most rays of blocks that are traced together: enough for rays that start side by side to read the same cells of a large surface,
/// few enough for a run to stop soon.
const MAX_RAYS_OF_GROUP: u64 = 1 << 20;

/// Most rays of each of the first two groups, so that a run that is to stop early has a result.
const MAX_RAYS_OF_FIRST: u64 = 1 << 18;

/// Most values in the tallies of blocks that are traced together, so that they stay in cache: 1 MiB.
const MAX_VALUES_OF_GROUP: usize = 1 << 16;

/// Fewest rays of a part of a group, which has a tally of each block.
const MIN_RAYS_OF_PART: u64 = 1 << 13;

/// Most parts of a group: enough to keep threads busy, few enough for their tallies to cost little.
const MAX_PARTS: u64 = 8;

impl Blocks {
    /// At least `rays` rays in at least `fewest` blocks, where there are as many rays.
    ///
    /// Quasi-random rays come in smaller blocks, of a size that `sampling` allows.
    pub(crate) fn plan(rays: u64, fewest: u64, sampling: Sampling) -> Self {
        let count = rays.div_ceil(MAX_STRATA.pow(2)).max(fewest.min(rays));
        // The smallest square that holds a block's rays. Counts end at 1e15, so it fits.
        let strata = match sampling {
            Sampling::Random | Sampling::Stratified => (rays.div_ceil(count) - 1).isqrt() + 1,
            Sampling::QuasiRandom => {
                let side = rays.div_ceil(count).isqrt();
                (1 << side.ilog2()).min(Sampling::MAX_QUASI_RANDOM_STRATA.into())
            }
        };
        let count = rays.div_ceil(strata * strata).max(fewest.min(rays));
        Self {
            first: 0,
            count,
            strata: strata as u32,
        }
    }

    /// Blocks of these numbers.
    pub(crate) const fn of(self, numbers: &Range<u64>) -> Self {
        Self {
            first: numbers.start,
            count: numbers.end - numbers.start,
            ..self
        }
    }

    /// Rays of all blocks.
    pub(crate) const fn rays(self) -> u64 {
        self.count * (self.strata as u64).pow(2)
    }

    /// Rays of one block.
    pub(crate) const fn rays_of_one(self) -> u64 {
        (self.strata as u64).pow(2)
    }

    /// The blocks in groups that are traced together, for tallies of `values` values. Groups do not depend on threads, and results
    /// not on groups.
    pub(crate) fn groups(
        self,
        sampling: Sampling,
        values: usize,
    ) -> impl Iterator<Item = BlockGroup> {
        let of_rays = MAX_RAYS_OF_GROUP / self.rays_of_one();
        let of_values = (MAX_VALUES_OF_GROUP / values) as u64;
        let most = match sampling {
            Sampling::Stratified => of_rays.min(of_values),
            Sampling::Random | Sampling::QuasiRandom => 1,
        };
        let most = most.clamp(1, BatchedRays::MAX_BATCHES.into());
        let of_first = (MAX_RAYS_OF_FIRST / self.rays_of_one()).clamp(1, most);
        let last = self.first + self.count;
        let group = move |first: u64, most: u64| BlockGroup {
            first,
            count: most.min(last - first) as u32,
            strata: self.strata,
        };
        let first = (self.count > 0).then(|| group(self.first, of_first));
        successors(first, move |before| {
            let next = before.first + u64::from(before.count);
            let is_second = before.first == self.first;
            let most = if is_second { of_first } else { most };
            (next < last).then(|| group(next, most))
        })
    }
}

/// Blocks that are traced together, in parts of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BlockGroup {
    /// Number of the first block.
    pub(crate) first: u64,
    /// Number of blocks.
    pub(crate) count: u32,
    strata: u32,
}

impl BlockGroup {
    /// Rays of a whole block.
    pub(crate) const fn rays_of_block(self) -> u64 {
        (self.strata as u64).pow(2)
    }

    /// Number of parts; a single block is one part.
    pub(crate) fn parts(self) -> u32 {
        let rays = u64::from(self.count) * self.rays_of_block();
        let most = MAX_PARTS.min(self.count.into());
        (rays / MIN_RAYS_OF_PART).clamp(1, most) as u32
    }

    /// The rays of one of its parts.
    pub(crate) fn part(self, number: u32) -> BatchedRays {
        let strata = self.rays_of_block();
        let begin = |part: u32| (strata * u64::from(part) / u64::from(self.parts())) as u32;
        BatchedRays::new(self.strata, self.count, begin(number)..begin(number + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_the_requested_rays_and_few_more() {
        for rays in [
            1,
            2,
            63,
            64,
            1000,
            4096,
            1_000_000,
            50_000_000,
            10_000_000_000,
        ] {
            for fewest in [1, 64] {
                let blocks = Blocks::plan(rays, fewest, Sampling::Stratified);
                assert!(blocks.rays() >= rays, "{rays} {blocks:?}");
                // A square may be 2 strata + 1 larger than a block's rays.
                let slack = blocks.count * (2 * u64::from(blocks.strata) + 1);
                assert!(blocks.rays() - rays <= slack, "{rays} {blocks:?}");
                // So that a run that is to stop does so soon.
                assert!(u64::from(blocks.strata) <= MAX_STRATA);
                assert!(blocks.count >= fewest.min(rays), "{rays} {blocks:?}");
                assert_eq!(blocks, Blocks::plan(rays, fewest, Sampling::Random));
            }
        }
    }

    /// Blocks, groups and parts: no more rays, blocks and tallies than allowed, and each stratum of each block once.
    #[test]
    fn groups_and_their_parts_cover_all_blocks_once() {
        for (count, strata) in [(1, 512), (64, 40), (64, 256), (70, 256), (5, 512), (100, 3)] {
            for values in [7413, 1 << 16, 1 << 20] {
                for sampling in [
                    Sampling::Stratified,
                    Sampling::Random,
                    Sampling::QuasiRandom,
                ] {
                    let blocks = Blocks {
                        first: 7,
                        count,
                        strata,
                    };
                    let mut next = 7;
                    for group in blocks.groups(sampling, values) {
                        assert_eq!(group.first, next);
                        next += u64::from(group.count);
                        let rays = u64::from(group.count) * blocks.rays_of_one();
                        assert!(group.count == 1 || rays <= MAX_RAYS_OF_GROUP);
                        assert!(
                            group.count == 1
                                || group.count as usize * values <= MAX_VALUES_OF_GROUP
                        );
                        if sampling != Sampling::Stratified {
                            assert_eq!(group.count, 1);
                        }
                        let parts: Vec<BatchedRays> =
                            (0..group.parts()).map(|part| group.part(part)).collect();
                        assert!(parts.len() as u32 <= group.count);
                        assert!(parts.len() == 1 || rays >= parts.len() as u64 * MIN_RAYS_OF_PART);
                        let mut stratum = 0;
                        for part in &parts {
                            assert_eq!((part.strata(), part.batches()), (strata, group.count));
                            assert_eq!(part.part().start, stratum);
                            stratum = part.part().end;
                        }
                        assert_eq!(stratum, strata * strata);
                    }
                    assert_eq!(next, 7 + count);
                }
            }
        }
    }

    #[test]
    fn quasi_random_blocks_have_a_power_of_four_rays_and_few_too_many() {
        for rays in [1, 3, 63, 64, 1000, 1_000_000, 50_000_000, 1_000_000_000_000] {
            for fewest in [1, 64] {
                let blocks = Blocks::plan(rays, fewest, Sampling::QuasiRandom);
                let of_block = u64::from(blocks.strata).pow(2);
                assert!(Sampling::quasi_random_strata(blocks.strata), "{blocks:?}");
                assert!(blocks.rays() >= rays, "{rays} {blocks:?}");
                // One block, or as many rays as blocks, since each has the next whole number.
                let slack = of_block.max(fewest);
                assert!(blocks.rays() < rays + slack, "{rays} {blocks:?}");
                assert!(blocks.count >= fewest.min(rays), "{rays} {blocks:?}");
            }
        }
        // 512 x 512 where there are so many
        let ordinary = Blocks::plan(100 << 18, 64, Sampling::QuasiRandom);
        let [count, strata] = [100, 512];
        assert_eq!([ordinary.count, ordinary.strata.into()], [count, strata]);
    }
}
