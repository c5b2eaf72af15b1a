//! Nearby hits: finds the hit of a short stretch of a ray on a surface without a search.

use crate::geometry::{Nearby, is_outside};
use crate::ray::{HalfSpace, Hit, TileRay};

use super::grid::Grid;
use super::height_bounds::{Cells, HeightBounds};

/// Columns or rows of cells that are tested one by one.
const FEW: u32 = 2;

/// Columns or rows under a stretch beyond which a search is faster.
const FAR: u32 = 8;

/// Returns `true` if the heights of blocks of cells under the stretch, or slopes, tell that a ray hits nothing before `t` exceeds `reach`.
#[inline]
pub(super) fn is_clear_nearby<S: Grid>(
    surface: &S,
    ray: &TileRay,
    half_space: HalfSpace,
    reach: f64,
) -> bool {
    if is_outside(surface.z_range(), ray, half_space, reach) {
        return true;
    }
    let cells = cells_under(surface, ray, [0.0, reach]);
    surface
        .height_bounds()
        .zip(cells)
        .is_some_and(|(heights, cells)| {
            let z = nearest(ray, half_space, [0.0, reach]);
            heights.is_clear(cells, half_space, z) || surface.escapes(ray, half_space).is_some()
        })
}

/// By [`is_clear_nearby`]; where that does not tell and the stretch is short, half by half, down to the cells.
#[inline]
pub(super) fn find_nearby<S: Grid>(
    surface: &S,
    ray: &TileRay,
    half_space: HalfSpace,
    reach: f64,
) -> Nearby<S::Facet> {
    if is_clear_nearby(surface, ray, half_space, reach) {
        return Nearby::Clear;
    }
    let cells = cells_under(surface, ray, [0.0, reach]);
    match surface.height_bounds().zip(cells) {
        Some((heights, [[x0, x1], [y0, y1]])) if x1 - x0 <= FAR && y1 - y0 <= FAR => {
            nearby_by_halves(surface, heights, ray, half_space, reach)
        }
        _ => Nearby::Unknown,
    }
}

/// The cells under a stretch of a ray, and what rounding may add; `None` if it is not over the tile.
#[inline]
fn cells_under<S: Grid>(surface: &S, ray: &TileRay, stretch: [f64; 2]) -> Option<Cells> {
    let mut cells = [[0_u32; 2]; 2];
    for (axis, cells) in cells.iter_mut().enumerate() {
        let [a, b] = stretch.map(|t| ray.origin[axis] + t * ray.direction[axis]);
        // Far more than what rounding adds.
        let margin = 1e-9 * (1.0 + a.abs() + b.abs());
        let [low, high] = [a.min(b) - margin, a.max(b) + margin];
        if !(low >= 0.0 && high < surface.extent()[axis]) {
            return None;
        }
        *cells = [low as u32, high as u32];
    }
    Some(cells)
}

/// The first facet that a ray passes before `t` exceeds `reach`, on a stretch that is over the tile.
fn nearby_by_halves<S: Grid>(
    surface: &S,
    height_bounds: &HeightBounds,
    ray: &TileRay,
    half_space: HalfSpace,
    reach: f64,
) -> Nearby<S::Facet> {
    let mut closest: Option<Hit<S::Facet>> = None;
    // The nearest stretch comes last; each is half as long as the one before.
    let mut stretches = [[0.0, reach]; 64];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let stretch = stretches[waiting];
        let [from, to] = stretch;
        // What is met in the cells of a stretch comes before all that lies beyond them.
        if closest.is_some() {
            break;
        }
        let Some(cells) = cells_under(surface, ray, stretch) else {
            return Nearby::Unknown;
        };
        let z = nearest(ray, half_space, stretch);
        if height_bounds.is_clear(cells, half_space, z) {
            continue;
        }
        let [[x0, x1], [y0, y1]] = cells;
        if (x1 - x0 >= FEW || y1 - y0 >= FEW) && waiting + 2 <= stretches.len() {
            let middle = 0.5 * (from + to);
            stretches[waiting] = [middle, to];
            stretches[waiting + 1] = [from, middle];
            waiting += 2;
            continue;
        }
        for iy in y0..=y1 {
            for ix in x0..=x1 {
                let q = half_space.sign();
                // Beyond all heights of the cell the stretch is beyond its facets.
                let range = surface.cell_range([ix, iy]);
                if range.iter().all(|height| q * z > q * height) {
                    continue;
                }
                if let Some(hit) = surface.intersect_cell([ix, iy], ray, half_space)
                    && hit.is_before(&closest)
                {
                    closest = Some(hit);
                }
            }
        }
    }
    match closest {
        Some(hit) if hit.t <= reach => Nearby::Met(hit),
        _ => Nearby::Clear,
    }
}

/// z of the point of a stretch of a ray in `half_space` that is nearest to the other side.
#[inline]
fn nearest(ray: &TileRay, half_space: HalfSpace, stretch: [f64; 2]) -> f64 {
    let [a, b] = stretch.map(|t| ray.origin.z + t * ray.direction.z);
    match half_space {
        HalfSpace::Above => a.min(b),
        HalfSpace::Below => a.max(b),
    }
}
