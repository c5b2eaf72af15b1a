//! Stretch: the part of a ray that lies above a cell, between the lowest and the highest point of the surface.

/// Amount by which the heights are extended, relative to them and to a column: a ray that passes the lowest point is
/// then below it at the end of its stretch.
const PADDING: f64 = 1e-9;

/// Rounding of z along a ray, relative to that of its origin.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A part of a ray, by its parameter; empty unless `enter < leave`.
#[derive(Clone, Copy)]
pub(super) struct Stretch {
    pub(super) enter: f64,
    pub(super) leave: f64,
    /// Rate at which the ray crosses the side by which it enters; infinite if it begins in the cell.
    pub(super) rate: f64,
}

impl Stretch {
    /// The part of the ray from `o` along `d` above the cell with its lower corner at `[column, row]`, where heights are
    /// at most `reach` from zero.
    #[inline(always)]
    pub(super) fn over([column, row]: [f64; 2], reach: f64, o: [f64; 3], d: [f64; 3]) -> Self {
        let slab = reach + PADDING * (1.0 + reach) + ROUNDING * o[2].abs();
        let low = [column, row, -slab];
        let high = [column + 1.0, row + 1.0, slab];
        let (mut enter, mut leave, mut rate) = (0.0, f64::INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (a, b) = (
                (low[axis] - o[axis]) / d[axis],
                (high[axis] - o[axis]) / d[axis],
            );
            let (near, far) = if d[axis] > 0.0 { (a, b) } else { (b, a) };
            let moves = d[axis] != 0.0;
            let enters = moves & (near > enter);
            enter = if enters { near } else { enter };
            rate = if enters { d[axis].abs() } else { rate };
            leave = if moves & (far < leave) { far } else { leave };
            let misses = !moves & ((o[axis] < low[axis]) | (o[axis] > high[axis]));
            leave = if misses { f64::NEG_INFINITY } else { leave };
        }
        Self { enter, leave, rate }
    }
}
