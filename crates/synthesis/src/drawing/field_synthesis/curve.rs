//! Curve: a function of a standard normal number, tabulated.

use rayon::prelude::*;

/// A function tabulated at even steps between -[`RANGE`] and [`RANGE`], beyond which it is constant. Between them it is
/// the cubic of the values and slopes at both ends.
///
/// It takes additions and multiplications alone, so that every processor computes the same bits.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    /// Value and slope times the step, per node.
    nodes: Vec<[f64; 2]>,
}

/// Normal numbers beyond are as rare as 1e-15.
const RANGE: f64 = 8.0;

/// Nodes per unit.
const PER_UNIT: f64 = 64.0;

/// Numbers that a thread maps at a time.
const CHUNK: usize = 1 << 14;

impl Curve {
    /// Curve of a function that gives values alone; slopes are differences of neighbouring nodes of fourth order.
    pub(super) fn of(function: impl Fn(f64) -> f64) -> Self {
        let count = (2.0 * RANGE * PER_UNIT) as i64;
        let at = |i: i64| function(i as f64 / PER_UNIT - RANGE);
        let values: Vec<f64> = (-2..=count + 2).map(at).collect();
        let nodes = values.windows(5).map(|v| {
            let slope = (8.0 * (v[3] - v[1]) - (v[4] - v[0])) / 12.0;
            [v[2], slope]
        });
        Self {
            nodes: nodes.collect(),
        }
    }

    /// The value at `z`.
    pub(super) fn at(&self, z: f64) -> f64 {
        let (i, t) = self.cell(z);
        let [[f0, d0], [f1, d1]] = [self.nodes[i], self.nodes[i + 1]];
        let rise = f1 - f0;
        let (square, cube) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
        f0 + t * (d0 + t * (square + t * cube))
    }

    /// The derivative at `z`.
    pub(super) fn derivative_at(&self, z: f64) -> f64 {
        let (i, t) = self.cell(z);
        let [[f0, d0], [f1, d1]] = [self.nodes[i], self.nodes[i + 1]];
        let rise = f1 - f0;
        let (square, cube) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
        PER_UNIT * (d0 + t * (2.0 * square + 3.0 * t * cube))
    }

    /// Number of the cell that holds `z`, and the place in it.
    fn cell(&self, z: f64) -> (usize, f64) {
        let last = self.nodes.len() - 1;
        let x = ((z + RANGE) * PER_UNIT).clamp(0.0, last as f64);
        let i = (x as usize).min(last - 1);
        (i, x - i as f64)
    }

    /// Replaces each of `values` by the curve at `scale` times it.
    pub(super) fn map(&self, values: &mut [f64], scale: f64) {
        values.par_chunks_mut(CHUNK).for_each(|chunk| {
            for value in chunk {
                *value = self.at(scale * *value);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of a cubic is the fourth derivative times `step^4 / 384`, and of its slopes `step^4 / 30` times the fifth times the
    /// step: 2e-10 and less for a sine.
    #[test]
    fn a_smooth_function_is_reproduced() {
        let curve = Curve::of(f64::sin);
        for i in -1000..1000 {
            let z = 0.007_93 * f64::from(i);
            assert!((curve.at(z) - z.sin()).abs() < 3e-10, "{z}");
            assert!((curve.derivative_at(z) - z.cos()).abs() < 1e-7, "{z}");
        }
        assert!((curve.at(1e9) - 8.0_f64.sin()).abs() < 1e-15);
        assert!((curve.at(-1e9) + 8.0_f64.sin()).abs() < 1e-15);
        assert!(curve.at(f64::NAN).is_nan());
    }
}
