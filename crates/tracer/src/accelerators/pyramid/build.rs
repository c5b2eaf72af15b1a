//! Build: makes the bounds over a surface, level by level.

use super::bounds::{Bounds, MAX_CELLS, MAX_LEVELS, STEPS, greater};
use super::cells::SearchedGrid;
use super::rays::{ROUNDING, Tile};
use crate::accelerators::accelerator::BuildError;

/// The bounds over a surface.
///
/// # Errors
/// [`BuildError::TooManyFacets`] if there are more cells than 30 bits can number.
pub(super) fn build<S: SearchedGrid>(surface: &S) -> Result<Bounds, BuildError> {
    let [cx, cy] = surface.cells();
    if !Bounds::hold([cx, cy]) {
        return Err(BuildError::TooManyFacets {
            facets: surface.facet_count(),
            most: MAX_CELLS * (surface.facet_count() / (cx * cy)),
        });
    }
    let top = (cx.max(cy).next_power_of_two().ilog2() as usize).clamp(1, MAX_LEVELS);
    let shape = |level: usize| [cx, cy].map(|n| n.div_ceil(1 << level));
    let (mut first, mut width) = ([0; MAX_LEVELS + 1], [0; MAX_LEVELS + 1]);
    let mut count = 0;
    for level in S::LOWEST_LEVEL..=top {
        let [nx, ny] = shape(level);
        first[level] = count as i32;
        width[level] = nx as i32;
        count += nx * ny;
    }
    let [_, reach] = surface.z_range();
    let reach = reach as f32 * (1.0 + f32::EPSILON);
    let steepest = surface.steepest() as f32 * (1.0 + f32::EPSILON);
    let slack = 4.0 * steepest * ROUNDING;
    let table = surface.table();
    // Rays begin above the heights, by more than these where a surface is nearly flat
    let [_, above] = Tile::new(surface, surface.diagonals()).z_range;
    let largest = table
        .values
        .iter()
        .fold(above as f32, |a, b| greater(a, b.abs()));
    let mut bounds = Bounds {
        margin: largest * table.rounding + 2.0 * slack + f32::MIN_POSITIVE,
        table,
        nodes: vec![0; count],
        cells: [cx, cy],
        top,
        lowest_level: S::LOWEST_LEVEL,
        first,
        width,
        reach,
        slack,
        steepest,
        lowest: -reach,
        // Some steps more than the heights span: one for rounding up, one for the margin.
        step: 2.0 * reach / STEPS + f32::MIN_POSITIVE,
    };
    surface.bound_lowest(&mut bounds);
    for level in S::LOWEST_LEVEL + 1..=top {
        bounds.bound_level(level, shape(level - 1));
    }
    Ok(bounds)
}
