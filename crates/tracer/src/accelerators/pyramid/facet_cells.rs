//! Facet cells: cells of two triangles, tested by their heights above or below a ray.

use super::bounds::{Bounds, Table};
use super::cells::{Exit, SearchedGrid, Test, greatest, least};
#[cfg(target_arch = "x86_64")]
use super::lane_state::{CellsMet, LanesExit, State};
use super::rays::Ray;
use crate::geometry::grid::Grid;
use crate::geometry::height_field::Surface;
#[cfg(target_arch = "x86_64")]
use crate::vector::lanes::{Floats, Integers, Lanes};

impl SearchedGrid for Surface {
    const LOWEST_LEVEL: usize = 1;

    fn diagonals(&self) -> [bool; 2] {
        [true, self.field().turned_cells().is_some()]
    }

    /// Heights of the grid points, with the first column and row repeated behind the last where cells wrap.
    fn table(&self) -> Table {
        let [cx, cy] = Grid::cells(self);
        let mut values = Vec::with_capacity((cx + 1) * (cy + 1));
        for iy in 0..=cy {
            values.extend(self.row(iy).map(|z| z as f32));
            values.push(self.z(cx, iy) as f32);
        }
        let mut turned = Vec::new();
        if self.field().turned_cells().is_some() {
            let is_turned = |i: usize| self.field().is_turned(i % (cx + 1) % cx, i / (cx + 1) % cy);
            turned = (0..values.len()).map(|i| u32::from(is_turned(i))).collect();
        }
        Table {
            values,
            turned,
            stride: cx + 1,
            rows: 2,
            rounding: 2_f32.powi(-20),
        }
    }

    fn bound_lowest(&self, bounds: &mut Bounds) {
        bounds.bound_points();
    }

    fn test(bounds: &Bounds, ray: &Ray, cell: [i32; 2], t: f32, exit: &Exit) -> Test {
        let [mut h00, mut h10, mut h01, mut h11] = corners(bounds, cell).map(|h| h * ray.side);
        // Place within the cell at t = 0, and over which triangle the ray enters and leaves.
        let mut u = ray.x - (cell[0] - ray.cell[0]) as f32;
        let v = ray.y - (cell[1] - ray.cell[1]) as f32;
        let mut dx = ray.dx;
        // The mirror image of a turned cell is split from 00 to 11
        if !bounds.table.turned.is_empty() && is_turned(bounds, cell) {
            (h00, h10, h01, h11) = (h10, h00, h11, h01);
            (u, dx) = (1.0 - u, -dx);
        }
        let (w, dw) = (u - v, dx - ray.dy);
        let (lower_in, lower_out) = (w + t * dw > 0.0, w + exit.t * dw > 0.0);
        let slopes = |lower: bool| {
            if lower {
                [h10 - h00, h11 - h10]
            } else {
                [h11 - h01, h01 - h00]
            }
        };
        let ([a_in, b_in], [a_out, b_out]) = (slopes(lower_in), slopes(lower_out));
        // Where it passes from one to the other, or leaves if it does not.
        let t_diagonal = if lower_in == lower_out {
            exit.t
        } else {
            least(greatest(-w / dw, t), exit.t)
        };
        // Heights above the triangles on entry, on the diagonal, and on leaving.
        let over = ray.z - h00;
        let rate_in = ray.dz - a_in * dx - b_in * ray.dy;
        let rate_out = ray.dz - a_out * dx - b_out * ray.dy;
        let (first_in, first_out) = (over - a_in * u - b_in * v, over - a_out * u - b_out * v);
        let on_entry = first_in + t * rate_in;
        let on_diagonal = first_in + t_diagonal * rate_in;
        let on_leaving = first_out + exit.t * rate_out;
        // Rays come from above, or start on a facet.
        let margin = exit.margin;
        if on_entry + margin <= 0.0 {
            return Test::Unknown;
        }
        let gap = least(on_diagonal, on_leaving) - margin;
        if on_diagonal + margin < 0.0 || (on_diagonal > margin && on_leaving + margin < 0.0) {
            Test::Met
        } else if gap > 0.0 {
            Test::Clear(gap)
        } else {
            Test::Unknown
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn test_lanes<L: Lanes>(
        lanes: L,
        bounds: &Bounds,
        state: &State<L>,
        exit: &LanesExit<L>,
    ) -> CellsMet<L> {
        let (zero, none, margin) = (lanes.splat(0.0), lanes.splat_i(0), exit.margin);
        let stride = bounds.table.stride as i32;
        let cell = state.iy.times(lanes.splat_i(stride)) + state.ix;
        // Lanes that are not at cells touch no memory of their own.
        let at_cell = lanes.equal_i(state.level, none);
        let corner = lanes.select_i(at_cell, cell, none);
        let heights = &bounds.table.values;
        let [h00, h10] = lanes.gather_pair(heights, corner);
        let [h01, h11] = lanes.gather_pair(heights, corner + lanes.splat_i(stride));
        let (mut h00, mut h10) = (h00 * state.side, h10 * state.side);
        let (mut h01, mut h11) = (h01 * state.side, h11 * state.side);
        // Place within the cell at t = 0, and over which triangle the ray enters and leaves.
        let mut u = state.x - lanes.to_float(state.ix - state.first_x);
        let v = state.y - lanes.to_float(state.iy - state.first_y);
        let mut dx = state.dx;
        // The mirror image of a turned cell is split from 00 to 11
        let turned = &bounds.table.turned;
        if !turned.is_empty() {
            let turned = lanes.equal_i(lanes.gather_i(turned, corner), lanes.splat_i(1));
            let swapped = |a, b| (lanes.select(turned, b, a), lanes.select(turned, a, b));
            ((h00, h10), (h01, h11)) = (swapped(h00, h10), swapped(h01, h11));
            u = lanes.select(turned, lanes.splat(1.0) - u, u);
            dx = lanes.select(turned, zero - dx, dx);
        }
        let (w, dw) = (u - v, dx - state.dy);
        let (w_in, w_out) = (state.t.times_plus(dw, w), exit.t.times_plus(dw, w));
        let (lower_in, lower_out) = (lanes.less(zero, w_in), lanes.less(zero, w_out));
        let (lower_a, lower_b, upper_a, upper_b) = (h10 - h00, h11 - h10, h11 - h01, h01 - h00);
        let a_in = lanes.select(lower_in, lower_a, upper_a);
        let b_in = lanes.select(lower_in, lower_b, upper_b);
        let a_out = lanes.select(lower_out, lower_a, upper_a);
        let b_out = lanes.select(lower_out, lower_b, upper_b);
        // Where it passes from one to the other, or leaves if it does not.
        let t_diagonal = (zero - w).over(dw);
        let t_diagonal = lanes.select(lanes.less(t_diagonal, state.t), state.t, t_diagonal);
        let t_diagonal = lanes.select(lower_in ^ lower_out, t_diagonal.min(exit.t), exit.t);
        // Heights above the triangles on entry, on the diagonal, and on leaving.
        let over = state.z - h00;
        let first_in = over.minus_times(a_in, u).minus_times(b_in, v);
        let first_out = over.minus_times(a_out, u).minus_times(b_out, v);
        let rate_in = state.dz.minus_times(a_in, dx).minus_times(b_in, state.dy);
        let rate_out = state.dz.minus_times(a_out, dx).minus_times(b_out, state.dy);
        let on_entry = state.t.times_plus(rate_in, first_in);
        let on_diagonal = t_diagonal.times_plus(rate_in, first_in);
        let on_leaving = exit.t.times_plus(rate_out, first_out);
        // Rays come from above, or start on a facet.
        let comes = lanes.less(zero, on_entry + margin);
        let under_diagonal = lanes.less(on_diagonal + margin, zero);
        let over_diagonal = lanes.less(margin, on_diagonal);
        let under_leaving = lanes.less(on_leaving + margin, zero);
        let gap = on_diagonal.min(on_leaving) - margin;
        CellsMet {
            met: comes & (under_diagonal | (over_diagonal & under_leaving)),
            gap: lanes.select(comes, gap, zero),
        }
    }
}

/// Returns `true` if the cell `[ix, iy]` is turned, where any is.
fn is_turned(bounds: &Bounds, [ix, iy]: [i32; 2]) -> bool {
    bounds.table.turned[iy as usize * bounds.table.stride + ix as usize] != 0
}

/// Heights at the corners 00, 10, 01 and 11 of the cell `[ix, iy]`.
fn corners(bounds: &Bounds, [ix, iy]: [i32; 2]) -> [f32; 4] {
    let Table { values, stride, .. } = &bounds.table;
    let i = iy as usize * stride + ix as usize;
    let (near, far) = (&values[i..i + 2], &values[i + stride..i + stride + 2]);
    [near[0], near[1], far[0], far[1]]
}
