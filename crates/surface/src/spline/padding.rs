//! Coefficients around the grid points, which continue them as the border does.

use crate::Border;

/// The coefficients of grid points, shape `[ny, nx]`, with one row and column before them and one, or two
/// if the border is periodic, behind them. The memory of `values` is used if it has room.
pub(super) fn padded(mut values: Vec<f64>, [ny, nx]: [usize; 2], border: Border) -> Vec<f64> {
    let [cx, cy] = border.cells([nx, ny]);
    let stride = cx + 3;
    values.resize((cy + 3) * stride, 0.0);

    // From the last row on, since the place of each is behind those that have not yet moved
    let along_x = continuations(nx, border);
    for iy in (0..ny).rev() {
        values.copy_within(iy * nx..(iy + 1) * nx, (iy + 1) * stride + 1);
        let row = &mut values[(iy + 1) * stride..][..stride];
        for &Continuation { to, near, far } in &along_x {
            row[to] = 2.0 * row[near] - row[far];
        }
    }
    for Continuation { to, near, far } in continuations(ny, border) {
        for ix in 0..stride {
            values[to * stride + ix] = 2.0 * values[near * stride + ix] - values[far * stride + ix];
        }
    }
    values
}

/// A place beyond the ends of a line of coefficients, with two places that it continues linearly; it
/// equals them if they are one. Places are counted from that before the first coefficient.
struct Continuation {
    to: usize,
    near: usize,
    far: usize,
}

/// All places beyond the ends of a line of `n` coefficients.
fn continuations(n: usize, border: Border) -> Vec<Continuation> {
    let places: &[[usize; 3]] = match border {
        Border::Periodic => &[[0, n, n], [n + 1, 1, 1], [n + 2, 2, 2]],
        Border::Mirrored => &[[0, 2, 2], [n + 1, n - 1, n - 1]],
        Border::Open => &[[0, 1, 2], [n + 1, n, n - 1]],
    };
    places
        .iter()
        .map(|&[to, near, far]| Continuation { to, near, far })
        .collect()
}
