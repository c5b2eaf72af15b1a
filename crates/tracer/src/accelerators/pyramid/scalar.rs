//! One ray through the pyramid in f32, from node to node: what `wide.rs` does in every lane, but for
//! products and sums, which lanes round together and portable code one after the other.
//!
//! The ray goes down a level where it may come under the bound of its node, on to the next node
//! where it cannot, and up a level where it passes from one parent to the next. In a cell, its height
//! above the two facets decides. Every comparison leaves room for what rounding in f32 may have done;
//! a ray that comes nearer to a decision than that is doubtful, and left to `quadtree.rs`.

use super::bounds::Bounds;
use super::rays::{Code, ROUNDING, Ray, Rays};

/// Searches all rays, one after the other.
pub(super) fn search(bounds: &Bounds, rays: &mut Rays) {
    for i in 0..rays.len() {
        let ray = rays.ray(i);
        let answer = closest_cell(bounds, &ray);
        rays.answers.push(ray.place, answer);
    }
}

/// Where a ray leaves the node that it is in.
struct Exit {
    t: f32,
    /// Whether through the edge across x.
    across_x: bool,
    /// The edges ahead, in cells of the tile.
    edge: [i32; 2],
    /// How far, in columns, rounding may have moved the point.
    rounding: f32,
    /// The same in `t`: more than that where a steep ray leaves through an edge that it runs along.
    late: f32,
    /// Whether the edges across x and y are reached so close together that rounding decides which
    /// comes first: `x`, off by as much as the point, takes `1 / dx` times that to get to an edge.
    tied: bool,
}

/// What a ray meets in a cell.
enum CellTest {
    Met(Code),
    Clear,
    Doubtful,
}

/// Follows one ray to its answer, as a [`Code`].
fn closest_cell(bounds: &Bounds, ray: &Ray) -> [i32; 2] {
    let high = ray.z > 0.999 * bounds.reach;
    let mut level = if high {
        Bounds::FIRST_LEVEL.min(bounds.top as i32)
    } else {
        0
    };
    let mut cell = ray.cell;
    let mut t = 0.0;
    loop {
        let exit = leave(ray, cell, level);
        if level == 0 {
            match test_cell(bounds, ray, cell, t, &exit) {
                CellTest::Met(code) => return Code::met(cell, code),
                CellTest::Doubtful => return Code::DOUBTFUL,
                CellTest::Clear => {}
            }
        } else {
            let node = cell.map(|i| (i >> level) as usize);
            // A rising ray is lowest where it enters, a falling one where it leaves.
            let lowest_at = if ray.dz > 0.0 {
                least(t, exit.t - exit.late)
            } else {
                exit.t + exit.late
            };
            let lowest = ray.z + lowest_at * ray.dz;
            if lowest <= bounds.bound(level as usize, node, ray.side < 0.0) {
                level -= 1;
                continue;
            }
        }
        if ray.dz > 0.0 && ray.z + (exit.t - exit.late) * ray.dz > bounds.reach + bounds.margin {
            return Code::NOTHING;
        }
        // The coordinate along the edge says which cell comes next.
        let along = if exit.across_x {
            ray.y + exit.t * ray.dy
        } else {
            ray.x + exit.t * ray.dx
        };
        let whole = floor(along);
        let within = along - whole as f32;
        if exit.tied || within < exit.rounding || 1.0 - within < exit.rounding {
            return Code::DOUBTFUL;
        }
        let behind = |edge: i32, rate: f32| if rate < 0.0 { edge - 1 } else { edge };
        cell = if exit.across_x {
            [behind(exit.edge[0], ray.dx), ray.cell[1] + whole]
        } else {
            [ray.cell[0] + whole, behind(exit.edge[1], ray.dy)]
        };
        let [cx, cy] = bounds.cells.map(|n| n as i32);
        if !((0..cx).contains(&cell[0]) && (0..cy).contains(&cell[1])) {
            return Code::NOTHING;
        }
        // Up a level where the edge is also that of the parent.
        let edge = if exit.across_x {
            exit.edge[0]
        } else {
            exit.edge[1]
        };
        if (edge >> level) & 1 == 0 && level < bounds.top as i32 {
            level += 1;
        }
        t = exit.t;
    }
}

/// Where a ray leaves the node of `level` that `cell` is in.
fn leave(ray: &Ray, cell: [i32; 2], level: i32) -> Exit {
    let ahead = |rate: f32| i32::from(rate >= 0.0);
    let edge = [
        ((cell[0] >> level) + ahead(ray.dx)) << level,
        ((cell[1] >> level) + ahead(ray.dy)) << level,
    ];
    let t_x = ((edge[0] - ray.cell[0]) as f32 - ray.x) * ray.inverse_dx;
    let t_y = ((edge[1] - ray.cell[1]) as f32 - ray.y) * ray.inverse_dy;
    let across_x = t_x < t_y;
    let (t, slow) = if across_x {
        (t_x, ray.inverse_dx)
    } else {
        (t_y, ray.inverse_dy)
    };
    let rounding = ROUNDING + ROUNDING * (t * (ray.dx.abs() + ray.dy.abs()));
    Exit {
        t,
        across_x,
        edge,
        rounding,
        late: (rounding * slow).abs(),
        tied: (t_x - t_y).abs() < rounding * (ray.inverse_dx.abs() + ray.inverse_dy.abs()),
    }
}

/// Tests the facets of a cell, which the ray enters at `t`.
fn test_cell(bounds: &Bounds, ray: &Ray, cell: [i32; 2], t: f32, exit: &Exit) -> CellTest {
    let [h00, h10, h01, h11] = bounds.corners(cell).map(|h| h * ray.side);
    // Place within the cell at t = 0, and over which triangle the ray enters and leaves.
    let u = ray.x - (cell[0] - ray.cell[0]) as f32;
    let v = ray.y - (cell[1] - ray.cell[1]) as f32;
    let (w, dw) = (u - v, ray.dx - ray.dy);
    let (w_in, w_out) = (w + t * dw, w + exit.t * dw);
    if exit.tied || least(w_in.abs(), w_out.abs()) < 2.0 * exit.rounding {
        return CellTest::Doubtful;
    }
    let (lower_in, lower_out) = (w_in > 0.0, w_out > 0.0);
    let slopes = |lower: bool| {
        if lower {
            [h10 - h00, h11 - h10]
        } else {
            [h11 - h01, h01 - h00]
        }
    };
    let ([a_in, b_in], [a_out, b_out]) = (slopes(lower_in), slopes(lower_out));
    // Heights above the triangles on entry, on the diagonal or where there is none on leaving, and
    // on leaving.
    let over = ray.z - h00;
    let rate_in = ray.dz - a_in * ray.dx - b_in * ray.dy;
    let rate_out = ray.dz - a_out * ray.dx - b_out * ray.dy;
    let (first_in, first_out) = (over - a_in * u - b_in * v, over - a_out * u - b_out * v);
    let across = -1.0 / dw;
    let (t_diagonal, late) = if lower_in == lower_out {
        (exit.t, exit.late)
    } else {
        (w * across, 2.0 * (exit.rounding * across).abs())
    };
    let on_entry = first_in + t * rate_in;
    let on_diagonal = first_in + t_diagonal * rate_in;
    let on_leaving = first_out + exit.t * rate_out;
    // What rounding may do to them: that of z, that of x and y times the slopes of two facets, and, on
    // the diagonal and on leaving, that of t times the rate.
    let margin = bounds.margin + exit.rounding * 4.0 * bounds.steepest;
    let on_diagonal_margin = margin + late * rate_in.abs();
    let on_leaving_margin = margin + exit.late * rate_out.abs();
    if on_entry + margin <= 0.0 {
        return CellTest::Doubtful;
    }
    // The facet is sure if the ray comes to it from clearly above; otherwise it is in the cell.
    let code = |lower: bool| match (on_entry > margin, lower) {
        (true, true) => Code::Lower,
        (true, false) => Code::Upper,
        (false, _) => Code::Either,
    };
    if on_diagonal + on_diagonal_margin < 0.0 {
        CellTest::Met(code(lower_in))
    } else if on_diagonal <= on_diagonal_margin {
        CellTest::Doubtful
    } else if on_leaving + on_leaving_margin < 0.0 {
        CellTest::Met(code(lower_out))
    } else if on_leaving <= on_leaving_margin {
        CellTest::Doubtful
    } else {
        CellTest::Clear
    }
}

/// One comparison, where `f32::min` takes care of a NaN.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The largest integer that is not larger; for values within the range of i32.
fn floor(value: f32) -> i32 {
    let towards_zero = value as i32;
    towards_zero - i32::from((towards_zero as f32) > value)
}
