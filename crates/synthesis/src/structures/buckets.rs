//! Buckets: a periodic grid that lists the features which may reach each of its squares.
//!
//! A sample then looks at the features of one bucket alone, so that heights cost as much as samples and features
//! together, not their product. A feature wider than the tile meets a bucket with several of its images.

/// The extent of a feature, length units; the feature may lie anywhere, also beyond the tile.
pub(super) trait Footprint {
    /// Lowest and highest y.
    fn y_range(&self) -> [f64; 2];

    /// Lowest and highest x of the part between `y[0]` and `y[1]`; a larger range is allowed.
    fn x_range(&self, y: [f64; 2]) -> [f64; 2];
}

/// A feature in a bucket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    /// Number of the feature.
    pub(super) feature: usize,
    /// Offset that is added to a point of the tile to reach the feature at its own position, length units.
    pub(super) shift: [f64; 2],
}

/// Features by position on a periodic tile.
pub(super) struct Buckets {
    lengths: [f64; 2],
    counts: [usize; 2],
    /// Start of the entries of each bucket, in rows; one more at the end.
    starts: Vec<usize>,
    entries: Vec<Entry>,
}

impl Buckets {
    /// Sorts `features` on a tile with sides `lengths` into buckets of about `size` a side.
    pub(super) fn new(lengths: [f64; 2], size: f64, features: &[impl Footprint]) -> Self {
        let counts = lengths.map(|length| (length / size).floor().max(1.0) as usize);
        let mut buckets = Self {
            lengths,
            counts,
            starts: vec![0; counts[0] * counts[1] + 1],
            entries: Vec::new(),
        };
        // Count the entries of each bucket, then place them
        let mut numbers = vec![0; counts[0] * counts[1]];
        for feature in features {
            buckets.visit(feature, |bucket, _| numbers[bucket] += 1);
        }
        for (i, number) in numbers.iter().enumerate() {
            buckets.starts[i + 1] = buckets.starts[i] + number;
        }
        let none = Entry {
            feature: 0,
            shift: [0.0; 2],
        };
        let mut entries = vec![none; *buckets.starts.last().unwrap_or(&0)];
        let mut next = buckets.starts.clone();
        for (feature, footprint) in features.iter().enumerate() {
            buckets.visit(footprint, |bucket, shift| {
                entries[next[bucket]] = Entry { feature, shift };
                next[bucket] += 1;
            });
        }
        buckets.entries = entries;
        buckets
    }

    /// Sides of a bucket, length units.
    pub(super) fn sides(&self) -> [f64; 2] {
        [0, 1].map(|i| self.lengths[i] / self.counts[i] as f64)
    }

    /// The features that may reach the point `p` of the tile.
    pub(super) fn at(&self, p: [f64; 2]) -> &[Entry] {
        let [i, j] = self.index(p);
        self.entries_of(self.number([i, j].map(|k| k as usize)))
    }

    /// The bucket of a point of the tile.
    pub(super) fn index(&self, p: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|i| {
            let k = (p[i] / self.lengths[i] * self.counts[i] as f64) as usize;
            k.min(self.counts[i] - 1) as i64
        })
    }

    /// The features of any bucket of the plane, and how far its tile lies from the first, length units.
    pub(super) fn image(&self, index: [i64; 2]) -> (&[Entry], [f64; 2]) {
        let (within, shift) = self.wrapped(index);
        (self.entries_of(self.number(within)), shift)
    }

    fn entries_of(&self, bucket: usize) -> &[Entry] {
        &self.entries[self.starts[bucket]..self.starts[bucket + 1]]
    }

    fn number(&self, [i, j]: [usize; 2]) -> usize {
        j * self.counts[0] + i
    }

    /// The bucket on the tile, and the position of the tile on which `index` lies.
    fn wrapped(&self, index: [i64; 2]) -> ([usize; 2], [f64; 2]) {
        let count = |i: usize| self.counts[i] as i64;
        (
            [0, 1].map(|i| index[i].rem_euclid(count(i)) as usize),
            [0, 1].map(|i| index[i].div_euclid(count(i)) as f64 * self.lengths[i]),
        )
    }

    /// Hands every bucket that a feature may reach to `take`, with the shift of the image.
    fn visit(&self, feature: &impl Footprint, mut take: impl FnMut(usize, [f64; 2])) {
        let [width, height] = self.sides();
        let range = |[low, high]: [f64; 2], side: f64| {
            (low / side).floor() as i64..=(high / side).floor() as i64
        };
        for j in range(feature.y_range(), height) {
            let y = [j as f64 * height, (j + 1) as f64 * height];
            for i in range(feature.x_range(y), width) {
                let (within, shift) = self.wrapped([i, j]);
                take(self.number(within), shift);
            }
        }
    }
}
