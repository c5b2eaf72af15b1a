//! Neighbours: which sample lies a number of steps beside another, by the border.

use asperity_surface::Border;

/// The sample `step` beside sample `i` of `n`; `None` beyond an open border.
pub(super) fn beside(border: Border, i: usize, step: i64, n: usize) -> Option<usize> {
    let (at, n) = (i as i64 + step, n as i64);
    let inside = match border {
        Border::Periodic => at.rem_euclid(n),
        Border::Mirrored => {
            let period = 2 * (n - 1);
            let at = at.rem_euclid(period);
            at.min(period - at)
        }
        Border::Open => (0..n).contains(&at).then_some(at)?,
    };
    Some(inside as usize)
}
