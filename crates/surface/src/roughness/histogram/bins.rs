//! Bins: equal intervals that values are counted in.

/// Equal bins over a range.
pub(super) struct Bins {
    pub(super) lowest: f64,
    pub(super) width: f64,
    pub(super) count: usize,
}

impl Bins {
    /// `None` if the range is empty, or too narrow to be divided.
    pub(super) fn new([lowest, highest]: [f64; 2], count: usize) -> Option<Self> {
        let width = (highest - lowest) / count as f64;
        (width.is_normal() && width > 0.0).then_some(Self {
            lowest,
            width,
            count,
        })
    }

    /// Counts of no value: of each bin, and of what lies outside.
    pub(super) fn none(&self) -> Vec<u64> {
        vec![0; self.count + 1]
    }

    /// Counts of `values`. The last bin holds its upper edge, and rounding there.
    pub(super) fn count(&self, values: impl Iterator<Item = f64>) -> Vec<u64> {
        let mut counts = self.none();
        for value in values {
            let place = (value - self.lowest) / self.width;
            let is_inside = place >= -1e-9 && place <= self.count as f64 + 1e-9;
            let bin = (place.max(0.0) as usize).min(self.count - 1);
            counts[if is_inside { bin } else { self.count }] += 1;
        }
        counts
    }
}
