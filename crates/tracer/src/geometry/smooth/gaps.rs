//! Gaps: the height of a ray above a patch, as a polynomial along the ray.

use super::patch::Patch;

/// The place at parameter `t` of a ray whose origin is counted from the corner of the cell.
#[inline(always)]
pub(super) fn place(o: [f64; 3], d: [f64; 3], t: f64) -> [f64; 2] {
    [
        unit_interval(o[0] + t * d[0]),
        unit_interval(o[1] + t * d[1]),
    ]
}

/// Bernstein coefficients of a ray's height above a patch, on its own side, from parameter `enter` to `leave`.
#[inline(always)]
pub(super) fn gaps(
    patch: &Patch,
    q: f64,
    o: [f64; 3],
    d: [f64; 3],
    [enter, leave]: [f64; 2],
) -> [f64; 7] {
    let mut gaps = patch.along(place(o, d, enter), place(o, d, leave));
    let (from, to) = (o[2] + enter * d[2], o[2] + leave * d[2]);
    for (k, gap) in gaps.iter_mut().enumerate() {
        let s = k as f64 * (1.0 / 6.0);
        *gap = q * (from + s * (to - from) - *gap);
    }
    gaps
}

/// A polynomial, less its value at 0, divided by `s`; as one of the same degree.
#[inline(always)]
pub(super) fn without_first(b: &[f64; 7]) -> [f64; 7] {
    let mut divided = [0.0; 6];
    for k in 0..6 {
        divided[k] = 6.0 / (k + 1) as f64 * (b[k + 1] - b[0]);
    }
    let mut raised = [divided[0]; 7];
    for k in 1..6 {
        let part = k as f64 * (1.0 / 6.0);
        raised[k] = part * divided[k - 1] + (1.0 - part) * divided[k];
    }
    raised[6] = divided[5];
    raised
}

/// The coordinate of a cell from `corner` that is nearest to `p`, and what it is from the corner, to the last bit: a place that
/// has been found once is found again.
#[inline(always)]
pub(super) fn snapped(corner: f64, p: f64) -> [f64; 2] {
    let place = corner + unit_interval(p - corner);
    [place, place - corner]
}

/// The nearest number in `[0, 1]`.
#[inline(always)]
fn unit_interval(x: f64) -> f64 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < 1.0 { x } else { 1.0 }
}
