//! Points, samples and horizons of flat cells.
//!
//! A sample has six facets around it. It belongs to the one into which the direction to the light or the eye points.

use asperity_optics::Incidence;
use asperity_surface::Triangle;
use asperity_tracer::{Facet, Geometry, Surface, Triangles, VisibilityRay};

use super::ground::{Ground, Point};

impl Ground for Surface {
    fn cells(&self) -> [usize; 2] {
        Self::cells(self)
    }

    fn point(&self, number: usize, [far, near]: [f64; 2]) -> Point<Facet> {
        let facet = self.facet(number);
        let [a, b, c] = self.corners(facet);
        let place = a + far * (b - a) + near * (c - b);
        let (origin, direction) = (self.snap(facet, place), self.normal(facet));
        Point {
            facet,
            ray: VisibilityRay { origin, direction },
            is_sample: false,
        }
    }

    /// On that facet around it into which the direction points. Along an edge either facet will do: they have the same
    /// slope along it.
    fn sample(&self, [ix, iy]: [usize; 2], [x, y]: [f64; 2]) -> Point<Facet> {
        let [cx, cy] = self.cells();
        let (left, below) = (x < 0.0, y < 0.0);
        let before = |place: usize, back: bool, cells: usize| {
            (if back { place + cells - 1 } else { place }) % cells
        };
        let (ix, iy) = (before(ix, left, cx), before(iy, below, cy));
        let is_turned = self.field().is_turned(ix, iy);
        let is_steep = y.abs() > x.abs();
        // The triangle, and which of its corners the sample is, in the order of `Triangles::corners`.
        let (triangle, corner) = match (left, below) {
            (false, false) if is_turned || !is_steep => (Triangle::Lower, 0),
            (false, false) => (Triangle::Upper, 0),
            (true, false) if !is_turned || !is_steep => (Triangle::Lower, 1),
            (true, false) => (Triangle::Upper, 0),
            (true, true) if !is_turned && x.abs() <= y.abs() => (Triangle::Lower, 2),
            (true, true) => (Triangle::Upper, 1),
            (false, true) if is_turned && is_steep => (Triangle::Lower, 2),
            (false, true) => (Triangle::Upper, 2),
        };
        let facet = Facet {
            iy: iy as u32,
            ix: ix as u32,
            triangle,
        };
        let (origin, direction) = (self.corners(facet)[corner], self.normal(facet));
        Point {
            facet,
            ray: VisibilityRay { origin, direction },
            is_sample: true,
        }
    }

    fn ray_along(&self, point: &Point<Facet>, direction: &Incidence) -> VisibilityRay {
        let w = direction.wi();
        let mut origin = point.ray.origin;
        if point.is_sample {
            // At the sample itself the ray touches six facets, so that rounding of z would decide whether it
            // is blocked. It starts half-way across its own facet instead, which cannot block it: facets
            // extend from a corner to |x| + |y| = 1 at least.
            let [x, y] = [w.x, w.y * self.aspect()];
            let half = 0.5 / (x.abs() + y.abs());
            origin.x += half * x;
            origin.y += half * y;
            origin.z += half * w.z;
        }
        VisibilityRay {
            origin,
            direction: w,
        }
    }
}
