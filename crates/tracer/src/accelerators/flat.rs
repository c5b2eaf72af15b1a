//! Flat: a surface whose heights are all equal; the plane names the cell.

use super::brute_force::BruteForce;
use crate::accelerators::accelerator::{Accelerator, BuildError};
use crate::accelerators::kind::AcceleratorKind;
use crate::geometry::grid::Grid;
use crate::geometry::height_field::{Facet, Surface};
use crate::ray::{Hit, Query};

/// Amount by which rounding may move a point, relative to the size of the tile, and far more.
const WIDENING: f64 = 1e-9;

/// Fall of a ray, relative to its length, below which rounding may move its crossing of the plane by
/// cells: those rays are left to brute force.
const LEVEL: f64 = 1e-6;

/// Needs no structure: a ray passes a plane once.
#[derive(Clone, Copy, Debug)]
pub struct Flat;

impl Flat {
    /// An accelerator for a surface that is flat.
    ///
    /// # Errors
    /// [`BuildError::NotFlat`] if it is not.
    pub fn build(surface: &Surface) -> Result<Self, BuildError> {
        if surface.is_flat() {
            Ok(Self)
        } else {
            Err(BuildError::NotFlat)
        }
    }
}

impl Accelerator<Surface> for Flat {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::Flat
    }

    fn bytes(&self) -> usize {
        0
    }

    /// Tests up to four cells, within rounding, around the point where the ray passes the plane, or where it comes over
    /// the tile if it has passed the plane by then.
    fn closest_hit(&self, surface: &Surface, query: &Query) -> Option<Hit<Facet>> {
        let Query { ray, half_space } = *query;
        if half_space.sign() * ray.direction.z >= 0.0 {
            return None;
        }
        if ray.direction.z.abs() < LEVEL * ray.direction.length() {
            return BruteForce.closest_hit(surface, query);
        }
        let cells = surface.cells();
        let far = ray.origin.abs().max_element();
        let widening = WIDENING * far.max(cells[0].max(cells[1]) as f64);
        let mut t = ((surface.z(0, 0) - ray.origin.z) / ray.direction.z).max(0.0);
        for (axis, &count) in cells.iter().enumerate() {
            let (place, rate) = (ray.origin[axis], ray.direction[axis]);
            if rate != 0.0 {
                let edge = if rate > 0.0 { 0.0 } else { count as f64 };
                t = t.max((edge - place) / rate);
            }
        }
        let point = ray.at(t);
        let outside =
            |axis: usize| point[axis] < -widening || point[axis] > cells[axis] as f64 + widening;
        if outside(0) || outside(1) {
            return None;
        }
        // Conversion saturates, and what is below zero becomes zero.
        let near = |axis: usize| {
            let [low, high] = [-widening, widening].map(|w| (point[axis] + w) as usize);
            low..(high + 1).min(cells[axis])
        };
        let mut closest = None;
        for iy in near(1) {
            for ix in near(0) {
                let cell = [ix as u32, iy as u32];
                if let Some(hit) = surface.intersect_cell(cell, &ray, half_space)
                    && hit.is_before(&closest)
                {
                    closest = Some(hit);
                }
            }
        }
        // A ray along the rim of the tile may touch no cell here and one further on.
        closest.or_else(|| BruteForce.closest_hit(surface, query))
    }
}
