//! One ray through the pyramid in f32, from node to node: what `wide.rs` does in every lane, but for
//! products and sums, which lanes round together and portable code one after the other.
//!
//! The ray goes down a level where it may come under the bound of its node, on to the next node
//! where it cannot, and up a level where it passes from one parent to the next. In a cell, its height
//! above the two facets decides. Every comparison leaves room for what rounding in f32 may have done;
//! a ray that comes nearer to a decision than that is doubtful, and left to `quadtree.rs`.

use super::bounds::Bounds;
use super::cells::{Exit, SearchedGrid, Test, least};
use super::rays::{DOUBTFUL, NOTHING, Ray, Rays};

/// Searches all rays, one after the other.
pub(super) fn search<S: SearchedGrid>(bounds: &Bounds, rays: &mut Rays) {
    for i in 0..rays.len() {
        let ray = rays.ray(i);
        let answer = closest_cell::<S>(bounds, &ray);
        rays.answers.push(ray.place, answer);
    }
}

/// Follows one ray to its answer: the cell `[column, row]` that it meets, or a negative column.
fn closest_cell<S: SearchedGrid>(bounds: &Bounds, ray: &Ray) -> [i32; 2] {
    let high = ray.z > 0.999 * bounds.reach;
    let mut level = if high {
        Bounds::FIRST_LEVEL.min(bounds.top as i32)
    } else {
        0
    };
    let [cx, cy] = bounds.cells.map(|n| n as i32);
    let mut cell = ray.cell;
    let mut t = 0.0;
    // A ray that begins on the surface is near to it.
    let mut is_near = level == 0;
    loop {
        let exit = leave(bounds, ray, cell, level);
        let is_tested = level == 0 && (is_near || S::LOWEST_LEVEL > 0);
        let test = if is_tested {
            S::test(bounds, ray, cell, t, &exit)
        } else {
            test_node(bounds, ray, cell.map(|i| i >> level), level, t, &exit)
        };
        let gap = match test {
            Test::Met => return cell,
            Test::Clear(gap) if exit.t > t => gap,
            Test::Unknown if !is_tested => {
                is_near = level == 0;
                level = (level - 1).max(0);
                continue;
            }
            Test::Clear(_) | Test::Unknown => return [DOUBTFUL, 0],
        };
        // The coordinate along the edge says which cell comes next.
        let behind = |axis: usize, rate: f32| (exit.ahead[axis] << level) - i32::from(rate < 0.0);
        let (start, rate) = if exit.across_x {
            (ray.y, ray.dy)
        } else {
            (ray.x, ray.dx)
        };
        let whole = floor(start + exit.t * rate);
        if (whole as f32) * rate < 0.0 {
            return [DOUBTFUL, 0];
        }
        if ray.dz > 0.0 && exit.z > bounds.reach + bounds.margin {
            return [NOTHING, 0];
        }
        cell = if exit.across_x {
            [behind(0, ray.dx), ray.cell[1] + whole]
        } else {
            [ray.cell[0] + whole, behind(1, ray.dy)]
        };
        let inside_x = (0..cx).contains(&cell[0]);
        if !(inside_x && (0..cy).contains(&cell[1])) {
            let is_sure = gap > clearance(bounds, ray, !inside_x);
            return [if is_sure { NOTHING } else { DOUBTFUL }, 0];
        }
        // Up a level where the edge is also that of the parent.
        let edge = exit.ahead[usize::from(!exit.across_x)];
        if edge & 1 == 0 && level < bounds.top as i32 {
            level += 1;
        }
        t = exit.t;
        is_near = false;
    }
}

/// Exit of a ray from the node of `level` that `cell` is in.
pub(super) fn leave(bounds: &Bounds, ray: &Ray, cell: [i32; 2], level: i32) -> Exit {
    let ahead = [
        (cell[0] >> level) + i32::from(ray.dx >= 0.0),
        (cell[1] >> level) + i32::from(ray.dy >= 0.0),
    ];
    let t_x = (((ahead[0] << level) - ray.cell[0]) as f32 - ray.x) * ray.inverse_dx;
    let t_y = (((ahead[1] << level) - ray.cell[1]) as f32 - ray.y) * ray.inverse_dy;
    let t = least(t_x, t_y);
    Exit {
        t,
        z: ray.z + t * ray.dz,
        across_x: t_x < t_y,
        ahead,
        margin: bounds.margin + t * (bounds.slack * travel(ray)),
    }
}

/// Columns and rows that a ray comes per unit of `t`.
fn travel(ray: &Ray) -> f32 {
    ray.dx.abs() + ray.dy.abs()
}

/// Distance by which a ray that leaves the tile must be clear of the surface: when it leaves may be off by [`ROUNDING`] times
/// `1 / |dx|`, and so long it may run along the border.
///
/// [`ROUNDING`]: super::rays::ROUNDING
fn clearance(bounds: &Bounds, ray: &Ray, through_x: bool) -> f32 {
    let slow = if through_x {
        ray.inverse_dx
    } else {
        ray.inverse_dy
    };
    let falls = ray.dz.abs() + bounds.steepest * travel(ray);
    bounds.rounding_across() * falls * slow.abs()
}

/// Tests the bound of a node, which the ray enters at `t`.
fn test_node(bounds: &Bounds, ray: &Ray, node: [i32; 2], level: i32, t: f32, exit: &Exit) -> Test {
    let lowest = least(ray.z + t * ray.dz, exit.z);
    let bound = bounds.bound(level as usize, node.map(|i| i as usize), ray.side < 0.0);
    let gap = lowest - exit.margin - bound;
    if gap > 0.0 {
        Test::Clear(gap)
    } else {
        Test::Unknown
    }
}

/// The largest integer that is not larger; for values within the range of i32.
fn floor(value: f32) -> i32 {
    let towards_zero = value as i32;
    towards_zero - i32::from((towards_zero as f32) > value)
}
