//! Quadtree: one ray through the pyramid in f64, the specification of the searches in f32.

use glam::DVec3;

use super::bounds::Bounds;
use crate::geometry::grid::Grid;
use crate::ray::{HalfSpace, Hit, Query};

/// Amount, relative to the size of the tile and to how far a ray comes, by which footprints are widened:
/// far more than rounding in f64 can move a ray, so that no cell that brute force finds a hit in is
/// left out.
const WIDENING: f64 = 1e-10;

/// First facet that a ray passes through: nodes from the top down, near children first.
///
/// A node is left out if the ray stays on its own side of the node's bound all the way across its
/// footprint, or gets there only behind the closest hit so far.
pub(super) fn closest_hit<S: Grid>(
    bounds: &Bounds,
    surface: &S,
    query: &Query,
) -> Option<Hit<S::Facet>> {
    let Query { ray, half_space } = *query;
    let [cx, cy] = bounds.cells;
    let far = ray.origin.abs().max_element().max(cx.max(cy) as f64);
    let widening = WIDENING * far;
    let across = |level: usize, nx: usize, ny: usize| {
        let size = (1_usize << level) as f64;
        let low = [nx as f64 * size - widening, ny as f64 * size - widening];
        let high = low.map(|edge| edge + size + 2.0 * widening);
        footprint(ray.origin, ray.direction, low, high)
    };
    let ahead = [ray.direction.x > 0.0, ray.direction.y > 0.0].map(usize::from);

    let mut closest: Option<Hit<S::Facet>> = None;
    let [columns, rows] = bounds.cells.map(|n| n.div_ceil(1 << bounds.top));
    let mut nodes: Vec<_> = (0..rows)
        .flat_map(|ny| (0..columns).map(move |nx| (bounds.top, nx, ny)))
        .collect();
    while let Some((level, nx, ny)) = nodes.pop() {
        let Some([enter, leave]) = across(level, nx, ny) else {
            continue;
        };
        if closest.is_some_and(|hit| hit.t < enter) {
            continue;
        }
        // The lowest signed height that the ray has over the footprint.
        let q = half_space.sign();
        let (rise, z) = (q * ray.direction.z, q * ray.origin.z);
        let lowest = z + rise * if rise < 0.0 { leave } else { enter };
        if level >= bounds.lowest_level
            && lowest > f64::from(bounds.bound(level, [nx, ny], half_space == HalfSpace::Below))
        {
            continue;
        }
        if level == 0 {
            let cell = [nx as u32, ny as u32];
            if let Some(hit) = surface.intersect_cell(cell, &ray, half_space)
                && hit.is_before(&closest)
            {
                closest = Some(hit);
            }
            continue;
        }
        // The nearest child last, since the last one is taken first.
        for [i, j] in [[1, 1], [1, 0], [0, 1], [0, 0]] {
            let child = |n: usize, far: usize, ahead: usize| 2 * n + (far ^ ahead ^ 1);
            let (x, y) = (child(nx, i, ahead[0]), child(ny, j, ahead[1]));
            if (x << (level - 1)) < cx && (y << (level - 1)) < cy {
                nodes.push((level - 1, x, y));
            }
        }
    }
    closest
}

/// Interval of `t >= 0` in which a ray is over the rectangle from `low` to `high`.
fn footprint(origin: DVec3, direction: DVec3, low: [f64; 2], high: [f64; 2]) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (0.0_f64, f64::MAX);
    for axis in 0..2 {
        let (o, d) = (origin[axis], direction[axis]);
        if d == 0.0 {
            if o < low[axis] || o > high[axis] {
                return None;
            }
        } else {
            let (a, b) = ((low[axis] - o) / d, (high[axis] - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    (enter <= leave).then_some([enter, leave])
}
