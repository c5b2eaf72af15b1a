//! Numbered blocks: statistics over the blocks of rays of a surface, which may come in any order and from several machines.
//!
//! Floating-point sums depend on their order. Here it is fixed by the numbers of the blocks: a span of `2^k` blocks that begins at a multiple
//! of its length is the sum of its halves, and only neighbouring halves are added. Statistics over equal blocks have equal bytes, whatever
//! the order and the parts in which they came. Of `n` blocks in a row at most `2 log2 n` spans are held.

use std::collections::BTreeMap;
use std::ops::Range;

use asperity_tally::{TallySpec, TallyStatistics, TallyValues};
use serde::{Deserialize, Serialize};

use crate::errors::refinement::MeshShifts;

/// Statistics over blocks of rays.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct BlockStatistics {
    /// Flux fractions.
    pub(crate) tally: TallyStatistics,
    /// Differences between the meshes of the surface, where it has several.
    pub(crate) shifts: Option<MeshShifts>,
}

impl BlockStatistics {
    /// Statistics without a block.
    pub(crate) fn empty(spec: TallySpec) -> Self {
        Self {
            tally: TallyStatistics::new(spec),
            shifts: None,
        }
    }

    /// Statistics of one block, which has a tally of each mesh.
    fn of_block(tallies: Vec<TallyValues>) -> Option<Self> {
        let shifts = (tallies.len() > 1).then(|| MeshShifts::of_block(&tallies));
        let tally = tallies.into_iter().next()?;
        Some(Self {
            tally: TallyStatistics::of_one(tally),
            shifts,
        })
    }

    fn append(&mut self, other: &Self) {
        self.tally.append(&other.tally);
        if let (Some(shifts), Some(others)) = (&mut self.shifts, &other.shifts) {
            shifts.append(others);
        }
    }

    fn is_by(&self, spec: &TallySpec) -> bool {
        let of_shifts = self.shifts.as_ref().map_or(spec, MeshShifts::spec);
        [self.tally.spec(), of_shifts] == [spec; 2]
    }
}

/// Statistics over numbered blocks of rays.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(
    try_from = "BTreeMap<u64, BlockStatistics>",
    into = "BTreeMap<u64, BlockStatistics>"
)]
pub(crate) struct NumberedBlocks {
    /// Spans by the number of their first block, as large as the blocks that are there allow.
    spans: BTreeMap<u64, BlockStatistics>,
}

impl NumberedBlocks {
    /// Adds a block, which has a tally of each mesh.
    pub(crate) fn push(&mut self, number: u64, tallies: Vec<TallyValues>) {
        if let Some(block) = BlockStatistics::of_block(tallies) {
            self.spans.insert(number, block);
            self.join(number);
        }
    }

    /// Adds the blocks of `other`; `false` if both have one of the same number.
    pub(crate) fn merge(&mut self, other: Self) -> bool {
        for (first, span) in other.spans {
            let numbers = first..first + span.tally.batches();
            if self.missing(numbers.clone()) != [numbers] {
                return false;
            }
            self.spans.insert(first, span);
            self.join(first);
        }
        true
    }

    /// Joins the span that begins with this block to its neighbour, and what comes of it to its own, while both are there.
    fn join(&mut self, mut first: u64) {
        let count = |spans: &BTreeMap<u64, BlockStatistics>, first| {
            spans.get(&first).map(|span| span.tally.batches())
        };
        while let Some(length) = count(&self.spans, first) {
            let left = first - first % (2 * length);
            let right = left + length;
            if [left, right].map(|half| count(&self.spans, half)) != [Some(length); 2] {
                return;
            }
            if let Some(right) = self.spans.remove(&right)
                && let Some(left) = self.spans.get_mut(&left)
            {
                left.append(&right);
            }
            first = left;
        }
    }

    /// Number of blocks.
    pub(crate) fn count(&self) -> u64 {
        self.spans.values().map(|span| span.tally.batches()).sum()
    }

    /// Number after that of the last block.
    pub(crate) fn end(&self) -> u64 {
        let last = self.spans.last_key_value();
        last.map_or(0, |(first, span)| first + span.tally.batches())
    }

    /// Ranges of the numbers of missing blocks.
    pub(crate) fn missing(&self, numbers: Range<u64>) -> Vec<Range<u64>> {
        let mut missing = Vec::new();
        let mut next = numbers.start;
        for (&first, span) in &self.spans {
            if next < first.min(numbers.end) {
                missing.push(next..first.min(numbers.end));
            }
            next = next.max(first + span.tally.batches());
        }
        if next < numbers.end {
            missing.push(next..numbers.end);
        }
        missing
    }

    /// Statistics over all blocks; `None` without any.
    pub(crate) fn total(&self) -> Option<BlockStatistics> {
        let mut spans = self.spans.values();
        let mut total = spans.next()?.clone();
        spans.for_each(|span| total.append(span));
        Some(total)
    }

    /// Returns `true` if all statistics are by this spec.
    pub(crate) fn are_by(&self, spec: &TallySpec) -> bool {
        self.spans.values().all(|span| span.is_by(spec))
    }
}

impl TryFrom<BTreeMap<u64, BlockStatistics>> for NumberedBlocks {
    type Error = &'static str;

    fn try_from(spans: BTreeMap<u64, BlockStatistics>) -> Result<Self, Self::Error> {
        let mut end = 0;
        for (&first, span) in &spans {
            let count = span.tally.batches();
            let is_whole = count.is_power_of_two() && first % count == 0 && first >= end;
            end = first
                .checked_add(count)
                .filter(|_| is_whole)
                .ok_or("spans of blocks that overlap")?;
        }
        Ok(Self { spans })
    }
}

impl From<NumberedBlocks> for BTreeMap<u64, BlockStatistics> {
    fn from(blocks: NumberedBlocks) -> Self {
        blocks.spans
    }
}

#[cfg(test)]
mod tests {
    use asperity_tally::TallyResult;
    use rand::seq::SliceRandom;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn block(number: u64) -> Vec<TallyValues> {
        let spec = TallySpec::default();
        let mut tally = TallyValues::zeros(spec);
        tally[TallySpec::BUDGET.lost] = (number as f64 + 0.1).sin();
        vec![tally.clone(), tally.map(|x| x * x), tally]
    }

    fn of(numbers: impl IntoIterator<Item = u64>) -> NumberedBlocks {
        let mut blocks = NumberedBlocks::default();
        for number in numbers {
            blocks.push(number, block(number));
        }
        blocks
    }

    #[test]
    fn bytes_do_not_depend_on_the_order_of_blocks_and_parts() {
        let whole = format!("{:?}", of(0..53));
        for seed in 0..20 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut numbers: Vec<u64> = (0..53).collect();
            numbers.shuffle(&mut random);
            let mut parts: Vec<NumberedBlocks> = vec![NumberedBlocks::default(); 4];
            for number in numbers {
                parts[random.random_range(0..4)].push(number, block(number));
            }
            let mut merged = NumberedBlocks::default();
            for part in parts {
                assert!(merged.merge(part));
            }
            assert_eq!(format!("{merged:?}"), whole, "seed {seed}");
        }
    }

    #[test]
    fn totals_are_those_of_all_blocks() {
        let blocks = of(0..53);
        let total = blocks.total().unwrap();
        assert_eq!(
            (blocks.count(), blocks.end(), total.tally.batches()),
            (53, 53, 53)
        );
        let mut plain = TallyStatistics::new(TallySpec::default());
        (0..53).for_each(|number| plain.push(&block(number)[0]));
        let [a, b] = [&total.tally, &plain].map(|one| one.budget().lost);
        assert!((a.mean - b.mean).abs() < 1e-15);
        assert!((a.se.unwrap() - b.se.unwrap()).abs() < 1e-15);
    }

    #[test]
    fn gaps_are_told_and_overlaps_refused() {
        let mut blocks = of([0, 1, 2, 5, 9]);
        assert_eq!(blocks.missing(1..12), [3..5, 6..9, 10..12]);
        assert_eq!(blocks.missing(0..3), []);
        assert!(!blocks.clone().merge(of([1])));
        assert!(!blocks.clone().merge(of(4..8)));
        assert!(blocks.merge(of([3, 4])));
        assert_eq!(blocks.missing(0..12), [6..9, 10..12]);
    }

    #[test]
    fn saved_blocks_are_read_and_spans_that_overlap_are_not() {
        let blocks = of(3..20);
        let saved = serde_json::to_value(&blocks).unwrap();
        let read: NumberedBlocks = serde_json::from_value(saved.clone()).unwrap();
        assert_eq!(format!("{read:?}"), format!("{blocks:?}"));
        let mut shifted = serde_json::Map::new();
        shifted.insert("5".to_owned(), saved["8"].clone());
        assert!(serde_json::from_value::<NumberedBlocks>(shifted.into()).is_err());
    }
}
