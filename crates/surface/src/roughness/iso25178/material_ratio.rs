//! Material ratio curve: the height above which a given fraction of the surface lies.

use rayon::prelude::*;

use crate::HeightField;

/// Width of the central region, as a fraction of the surface.
const CENTRAL: f64 = 0.4;

/// The curve of height over material ratio, from 0 at the highest peak to 1 at the lowest valley.
///
/// Sample `i` of `n` in descending order stands at the ratio `(i + 1/2) / n`. The curve is linear between samples and
/// constant beyond the first and the last.
pub(super) struct MaterialRatioCurve {
    heights: Vec<f64>,
}

/// A straight line of height over material ratio.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Height at ratio 0.
    pub(super) top: f64,
    /// Height at ratio 1.
    pub(super) bottom: f64,
}

impl MaterialRatioCurve {
    pub(super) fn of(field: &HeightField) -> Self {
        let mut heights = field.heights().to_vec();
        heights.par_sort_unstable_by(|a, b| b.total_cmp(a));
        Self { heights }
    }

    fn ratio(&self, sample: f64) -> f64 {
        (sample + 0.5) / self.heights.len() as f64
    }

    fn sample(&self, ratio: f64) -> f64 {
        let n = self.heights.len() as f64;
        (ratio * n - 0.5).clamp(0.0, n - 1.0)
    }

    /// The height at a material ratio.
    pub(super) fn height(&self, ratio: f64) -> f64 {
        let sample = self.sample(ratio);
        let before = (sample as usize).min(self.heights.len() - 2);
        let (a, b) = (self.heights[before], self.heights[before + 1]);
        a + (b - a) * (sample - before as f64)
    }

    /// The smallest ratio at which the curve is down to `height`.
    pub(super) fn first_ratio(&self, height: f64) -> f64 {
        self.crossing(height, self.heights.partition_point(|h| *h > height))
    }

    /// The largest ratio at which the curve is still at `height`.
    pub(super) fn last_ratio(&self, height: f64) -> f64 {
        self.crossing(height, self.heights.partition_point(|h| *h >= height))
    }

    /// Position at which the curve crosses `height` between the samples before and at `after`.
    fn crossing(&self, height: f64, after: usize) -> f64 {
        if after == 0 {
            return 0.0;
        }
        if after == self.heights.len() {
            return 1.0;
        }
        let (above, below) = (self.heights[after - 1], self.heights[after]);
        self.ratio(after as f64 - (height - below) / (above - below))
    }

    /// The integral of `f(ratio, height)` along the curve; exact if `f` is quadratic along each of its pieces (Simpson's rule).
    pub(super) fn integral(&self, [from, to]: [f64; 2], f: impl Fn(f64, f64) -> f64) -> f64 {
        let first = (self.sample(from) as usize + 1).min(self.heights.len());
        let inner = (first..self.heights.len())
            .map(|i| (self.ratio(i as f64), self.heights[i]))
            .take_while(|(ratio, _)| *ratio < to);
        // Below the first sample the curve has one more corner, at that sample.
        let corner = (from < self.ratio(0.0) && self.ratio(0.0) < to)
            .then(|| (self.ratio(0.0), self.heights[0]));
        let mut sum = 0.0;
        let mut last = (from, self.height(from));
        for next in corner
            .into_iter()
            .chain(inner)
            .chain([(to, self.height(to))])
        {
            let middle = f(0.5 * (last.0 + next.0), 0.5 * (last.1 + next.1));
            let ends = f(last.0, last.1) + f(next.0, next.1);
            sum += (next.0 - last.0) / 6.0 * (ends + 4.0 * middle);
            last = next;
        }
        sum
    }

    /// The region of 40 % of the surface over which the curve falls least: the first of such, if there are several. It begins at or
    /// after the first sample and ends at or before the last.
    pub(super) fn central_region(&self) -> [f64; 2] {
        let ends = [0.0, self.heights.len() as f64 - 1.0].map(|sample| self.ratio(sample));
        // The fall is linear between places at which either end of the region is at a sample.
        let places = (0..self.heights.len()).into_par_iter().flat_map_iter(|i| {
            let ratio = self.ratio(i as f64);
            [ratio, ratio - CENTRAL]
        });
        let inside = places.filter(|from| *from >= ends[0] && from + CENTRAL <= ends[1]);
        let falls = inside.map(|from| (self.height(from) - self.height(from + CENTRAL), from));
        let least = |a: (f64, f64), b: (f64, f64)| match b.0 < a.0 || (b.0 == a.0 && b.1 < a.1) {
            true => b,
            false => a,
        };
        let best = falls.reduce(|| (f64::INFINITY, ends[0]), least);
        [best.1, best.1 + CENTRAL]
    }

    /// The equivalent straight line: least squares of heights over the central region.
    pub(super) fn equivalent_line(&self) -> Line {
        let region = self.central_region();
        let middle = 0.5 * (region[0] + region[1]);
        let level = self.height(middle);
        let (area, moment) = rayon::join(
            || self.integral(region, |_, height| height - level),
            || self.integral(region, |ratio, height| (ratio - middle) * (height - level)),
        );
        let mean = area / CENTRAL;
        let slope = moment / (CENTRAL.powi(3) / 12.0);
        Line {
            top: level + mean - slope * middle,
            bottom: level + mean + slope * (1.0 - middle),
        }
    }
}
