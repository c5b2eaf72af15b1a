//! Points and samples of smooth cells.
//!
//! Each has the normal of the surface at its own place, so a sample needs no facet to belong to. A ray starts where its point
//! lies: of the cell that it lies on, the root there is known and divided out.

use asperity_optics::Incidence;
use asperity_tracer::{Geometry, SmoothCell, SmoothSurface, VisibilityRay};
use glam::DVec3;

use super::ground::{Ground, Point};

impl Ground for SmoothSurface {
    fn cells(&self) -> [usize; 2] {
        self.spline().cells()
    }

    fn point(&self, number: usize, [far, near]: [f64; 2]) -> Point<SmoothCell> {
        let cell = self.facet(number / 2);
        let place = if number.is_multiple_of(2) {
            [far, near]
        } else {
            [far - near, far]
        };
        on_cell(self, cell, place, false)
    }

    fn sample(&self, [ix, iy]: [usize; 2], _along: [f64; 2]) -> Point<SmoothCell> {
        let cell = SmoothCell {
            iy: iy as u32,
            ix: ix as u32,
        };
        on_cell(self, cell, [0.0, 0.0], true)
    }

    fn ray_along(&self, point: &Point<SmoothCell>, direction: &Incidence) -> VisibilityRay {
        VisibilityRay {
            origin: point.ray.origin,
            direction: direction.wi(),
        }
    }
}

/// The point of a cell at `[u, v]`, from 0 to 1.
fn on_cell(
    surface: &SmoothSurface,
    cell: SmoothCell,
    [u, v]: [f64; 2],
    is_sample: bool,
) -> Point<SmoothCell> {
    let place = DVec3::new(f64::from(cell.ix) + u, f64::from(cell.iy) + v, 0.0);
    let origin = surface.snap(cell, place);
    let direction = surface.normal_at(cell, origin);
    Point {
        facet: cell,
        ray: VisibilityRay { origin, direction },
        is_sample,
    }
}
