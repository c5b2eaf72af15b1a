//! Sorted keys: finds the edges of bins that lie below a direction, by a table and a few steps of binary search.

/// Distance from an edge, as a key or as a sine, above which keys decide. Snapping reaches 1e-9 of a bin, which is 3.2e-9 rad at most where
/// there are edges, and rounding far less.
pub(crate) const MARGIN: f64 = 1e-8;

/// Horizontal components below which products would lose digits.
pub(crate) const TINY: f64 = 1e-290;

/// Buckets of a table.
const BUCKETS: usize = 1024;

/// Ascending keys of edges, in buckets of equal width.
#[derive(Clone, Debug)]
pub(crate) struct SortedKeys {
    /// Negative infinity, all keys, and infinity as often as searches may look beyond them.
    keys: Vec<f64>,
    /// Number of keys before each bucket.
    before: Box<[u32; BUCKETS]>,
    buckets_per_unit: f64,
    /// First step of a search within a bucket: 1 if no bucket holds two keys.
    first_step: u32,
}

impl SortedKeys {
    /// `keys`: ascending, from zero to `end`.
    pub(crate) fn new(mut keys: Vec<f64>, end: f64) -> Self {
        let buckets_per_unit = BUCKETS as f64 / end;
        let mut in_bucket = [0_u32; BUCKETS];
        for key in &keys {
            in_bucket[bucket(*key, buckets_per_unit)] += 1;
        }
        let mut before = Box::new([0; BUCKETS]);
        for i in 1..BUCKETS {
            before[i] = before[i - 1] + in_bucket[i - 1];
        }
        let most = in_bucket.into_iter().max().unwrap_or(0);
        let first_step = (most + 1).next_power_of_two() / 2;
        keys.insert(0, f64::NEG_INFINITY);
        keys.resize(keys.len() + 2 * first_step as usize + 1, f64::INFINITY);
        Self {
            keys,
            before,
            buckets_per_unit,
            first_step,
        }
    }

    /// For each of `keys` the number of edges that do not exceed it, and `true` if none is within [`MARGIN`] of it. All take the same steps.
    #[inline(always)]
    pub(crate) fn find<const N: usize>(&self, keys: &[f64; N]) -> ([u32; N], [bool; N]) {
        let mut found = [0; N];
        for k in 0..N {
            found[k] = self.before[bucket(keys[k], self.buckets_per_unit)];
        }
        let mut step = self.first_step;
        while step > 0 {
            for k in 0..N {
                let at = self.keys[(found[k] + step) as usize];
                found[k] += step * u32::from(at <= keys[k]);
            }
            step /= 2;
        }
        let mut edges = [[0.0; 2]; N];
        for k in 0..N {
            let next = found[k] as usize;
            edges[k] = [self.keys[next], self.keys[next + 1]];
        }
        let mut is_sure = [true; N];
        for k in 0..N {
            let [last, next] = edges[k];
            is_sure[k] = (keys[k] > last + MARGIN) & (keys[k] < next - MARGIN);
        }
        (found, is_sure)
    }
}

/// Bucket of a key; the first of no number.
#[inline(always)]
fn bucket(key: f64, buckets_per_unit: f64) -> usize {
    ((key * buckets_per_unit) as i32).clamp(0, BUCKETS as i32 - 1) as usize
}
