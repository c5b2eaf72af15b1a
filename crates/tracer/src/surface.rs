//! The meshed surface: facets, their normals, and where a ray meets one of them.

use asperity_surface::{Border, HeightField, Triangle};
use glam::DVec3;

use crate::accelerator::{Accelerator, AcceleratorKind, BuildError, TALLEST};
use crate::accelerators::brute_force::BruteForce;
use crate::accelerators::mesh_bvh::MeshBvh;
use crate::accelerators::pyramid::Pyramid;
use crate::geometry::{Escape, Geometry};
use crate::ray::{Hit, Medium, TileRay};

/// A triangle of the mesh: `triangle` of cell `(ix, iy)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet {
    /// Row of the cell.
    pub iy: u32,
    /// Column of the cell.
    pub ix: u32,
    /// Which of its triangles.
    pub triangle: Triangle,
}

/// A height field as the triangles that rays meet, in tile coordinates.
///
/// Tile coordinates: x in columns, `[0, cells_x]`; y in rows, `[0, cells_y]`; z in units of the
/// column spacing, measured from the middle between the lowest and the highest point, so that
/// neither the unit of length nor an offset of the heights changes anything.
#[derive(Clone, Debug)]
pub struct Surface {
    field: HeightField,
    inverse_dx: f64,
    z_offset: f64,
    half_range: f64,
    mean: f64,
    steepest: f64,
}

impl Surface {
    /// Takes over a height field.
    #[must_use]
    pub fn new(field: HeightField) -> Self {
        let (mut low, mut high, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        let first = field.heights()[0];
        for &h in field.heights() {
            low = low.min(h);
            high = high.max(h);
            sum += h - first;
        }
        let inverse_dx = 1.0 / field.spacing()[0];
        let z_offset = 0.5 * low + 0.5 * high;
        let mean = first + sum / field.heights().len() as f64;
        let mut surface = Self {
            half_range: (0.5 * high - 0.5 * low) * inverse_dx,
            mean: (mean - z_offset) * inverse_dx,
            field,
            inverse_dx,
            z_offset,
            steepest: 0.0,
        };
        surface.steepest = surface
            .facets()
            .map(|f| {
                let [x, y] = surface.slope(f);
                x.hypot(y)
            })
            .fold(0.0, f64::max);
        surface
    }

    /// The height field.
    #[must_use]
    pub const fn field(&self) -> &HeightField {
        &self.field
    }

    /// Cells of the tile, `[columns, rows]`: its extent in tile coordinates.
    #[must_use]
    pub const fn cells(&self) -> [usize; 2] {
        self.field.cells()
    }

    /// Slope (tangent) of the steepest facet.
    #[must_use]
    pub const fn steepest_slope(&self) -> f64 {
        self.steepest
    }

    /// z of the grid point `(ix, iy)`, tile coordinates; indices wrap.
    #[must_use]
    pub fn z(&self, ix: usize, iy: usize) -> f64 {
        (self.field.height(ix, iy) - self.z_offset) * self.inverse_dx
    }

    /// z of the grid points of row `iy`, tile coordinates; rows wrap.
    pub fn row(&self, iy: usize) -> impl Iterator<Item = f64> {
        let [ny, nx] = self.field.shape();
        let start = (iy % ny) * nx;
        let columns = self.cells()[0];
        self.field.heights()[start..start + columns]
            .iter()
            .map(|h| (h - self.z_offset) * self.inverse_dx)
    }

    /// First facet of the cell `[column, row]` that a ray in `medium` passes through.
    #[must_use]
    pub fn intersect_cell(
        &self,
        [ix, iy]: [u32; 2],
        ray: &TileRay,
        medium: Medium,
    ) -> Option<Hit<Facet>> {
        let mut closest = None;
        for triangle in [Triangle::Lower, Triangle::Upper] {
            let facet = Facet { iy, ix, triangle };
            if let Some(t) = self.intersect(facet, ray, medium) {
                let hit = Hit { t, facet };
                if hit.is_before(&closest) {
                    closest = Some(hit);
                }
            }
        }
        closest
    }

    /// All facets, row by row.
    pub fn facets(&self) -> impl Iterator<Item = Facet> + use<> {
        let [cx, cy] = self.cells();
        (0..cy as u32).flat_map(move |iy| {
            (0..cx as u32).flat_map(move |ix| {
                [Triangle::Lower, Triangle::Upper].map(|triangle| Facet { iy, ix, triangle })
            })
        })
    }

    /// z of the facet's plane at the cell's corner `(ix, iy)`, and its rise a column and a row.
    fn plane(&self, facet: Facet) -> [f64; 3] {
        let (ix, iy) = (facet.ix as usize, facet.iy as usize);
        let z00 = self.z(ix, iy);
        let z11 = self.z(ix + 1, iy + 1);
        match facet.triangle {
            Triangle::Lower => {
                let z10 = self.z(ix + 1, iy);
                [z00, z10 - z00, z11 - z10]
            }
            Triangle::Upper => {
                let z01 = self.z(ix, iy + 1);
                [z00, z11 - z01, z01 - z00]
            }
        }
    }

    /// Gradient `[dz/dx, dz/dy]` of the facet in physical lengths.
    fn slope(&self, facet: Facet) -> [f64; 2] {
        let [lower, upper] = self
            .field
            .facet_slopes(facet.ix as usize, facet.iy as usize);
        match facet.triangle {
            Triangle::Lower => lower,
            Triangle::Upper => upper,
        }
    }
}

impl Geometry for Surface {
    type Facet = Facet;

    fn border(&self) -> Border {
        self.field.border()
    }

    fn extent(&self) -> [f64; 2] {
        self.cells().map(|n| n as f64)
    }

    /// `dx / dy`.
    fn aspect(&self) -> f64 {
        let [dx, dy] = self.field.spacing();
        dx / dy
    }

    fn z_range(&self) -> [f64; 2] {
        [-self.half_range, self.half_range]
    }

    fn mean_plane(&self) -> f64 {
        self.mean
    }

    /// Two a cell.
    fn facet_count(&self) -> usize {
        let [cx, cy] = self.cells();
        2 * cx * cy
    }

    fn facet(&self, index: usize) -> Facet {
        let [cx, _] = self.cells();
        let cell = index / 2;
        Facet {
            iy: (cell / cx) as u32,
            ix: (cell % cx) as u32,
            triangle: if index.is_multiple_of(2) {
                Triangle::Lower
            } else {
                Triangle::Upper
            },
        }
    }

    fn normal(&self, facet: Facet) -> DVec3 {
        let [x, y] = self.slope(facet);
        DVec3::new(-x, -y, 1.0).normalize()
    }

    fn corners(&self, facet: Facet) -> [DVec3; 3] {
        let corner = |i: u32, j: u32| {
            let (ix, iy) = (facet.ix + i, facet.iy + j);
            DVec3::new(
                f64::from(ix),
                f64::from(iy),
                self.z(ix as usize, iy as usize),
            )
        };
        match facet.triangle {
            Triangle::Lower => [corner(0, 0), corner(1, 0), corner(1, 1)],
            Triangle::Upper => [corner(0, 0), corner(1, 1), corner(0, 1)],
        }
    }

    /// The point of a facet's plane above or below `(p.x, p.y)`, moved into the facet's cell.
    ///
    /// Rounding may have put `p` slightly beside the cell or the plane; the result lies on both.
    fn snap(&self, facet: Facet, p: DVec3) -> DVec3 {
        let (ix, iy) = (f64::from(facet.ix), f64::from(facet.iy));
        let [z00, per_column, per_row] = self.plane(facet);
        let u = (p.x - ix).clamp(0.0, 1.0);
        let v = (p.y - iy).clamp(0.0, 1.0);
        DVec3::new(ix + u, iy + v, z00 + per_column * u + per_row * v)
    }

    /// Ray parameter `t >= 0` at which a ray in `medium` passes through `facet` to the other side.
    ///
    /// Along the ray, `g = z - plane` is linear. The ray is over the facet's footprint for `t` in
    /// `[enter, leave]`. It passes through if the signed height `medium.sign() * g` falls and is
    /// negative on leaving. A ray that enters the footprint slightly on the wrong side, by rounding
    /// on a shared edge, and falls further, passes at once; so no ray slips between two facets, and
    /// one that moves away from a facet never meets it.
    fn intersect(&self, facet: Facet, ray: &TileRay, medium: Medium) -> Option<f64> {
        let q = medium.sign();
        let [z00, per_column, per_row] = self.plane(facet);
        let d = ray.direction;
        let g_rate = d.z - per_column * d.x - per_row * d.y;
        if q * g_rate >= 0.0 {
            return None;
        }
        let x = ray.origin.x - f64::from(facet.ix);
        let y = ray.origin.y - f64::from(facet.iy);
        let mut span = Span {
            enter: 0.0,
            leave: f64::INFINITY,
        };
        // The footprint: u in [0, 1], v in [0, 1], and the diagonal u = v.
        match facet.triangle {
            Triangle::Lower => {
                span.keep_positive(1.0 - x, -d.x);
                span.keep_positive(y, d.y);
                span.keep_positive(x - y, d.x - d.y);
            }
            Triangle::Upper => {
                span.keep_positive(x, d.x);
                span.keep_positive(1.0 - y, -d.y);
                span.keep_positive(y - x, d.y - d.x);
            }
        }
        if span.enter > span.leave {
            return None;
        }
        let g = ray.origin.z - z00 - per_column * x - per_row * y;
        let passes = q * (g + g_rate * span.leave) < 0.0;
        passes.then(|| (-g / g_rate).clamp(span.enter, span.leave))
    }

    fn escapes(&self, ray: &TileRay, medium: Medium) -> Option<Escape> {
        let d = ray.direction;
        let horizontal = d.x.hypot(d.y / self.aspect());
        (medium.sign() * d.z > self.steepest * horizontal).then_some(Escape::SteeperThanAll)
    }

    fn accelerator(&self, kind: AcceleratorKind) -> Result<Box<dyn Accelerator<Self>>, BuildError> {
        let [low, high] = self.z_range();
        let columns = high - low;
        if columns.is_nan() || columns > TALLEST {
            return Err(BuildError::TooTall { columns });
        }
        Ok(match kind {
            AcceleratorKind::Auto | AcceleratorKind::Mesh => Box::new(MeshBvh::build(self)?),
            AcceleratorKind::Pyramid => Box::new(Pyramid::build(self)?),
            AcceleratorKind::BruteForce => Box::new(BruteForce),
        })
    }
}

/// An interval of the ray parameter.
struct Span {
    enter: f64,
    leave: f64,
}

impl Span {
    /// Keeps the part in which `value + t * rate >= 0`.
    fn keep_positive(&mut self, value: f64, rate: f64) {
        if rate > 0.0 {
            self.enter = self.enter.max(-value / rate);
        } else if rate < 0.0 {
            self.leave = self.leave.min(-value / rate);
        } else if value < 0.0 {
            self.leave = f64::NEG_INFINITY;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tilted plane `z = 0.5 x - 0.25 y` over 2 x 2 cells, open, with `dy = 2 dx`.
    fn tilted() -> Surface {
        let heights = (0..9)
            .map(|i| 0.5 * f64::from(i % 3) - 0.25 * f64::from(i / 3))
            .collect();
        let field = HeightField::new(heights, [3, 3], [1.0, 2.0]).unwrap();
        Surface::new(field.with_border(Border::Open))
    }

    #[test]
    fn normal_is_that_of_the_physical_plane() {
        let surface = tilted();
        // dh/dx = 0.5; dh/dy = -0.25 a row of two length units.
        let expected = DVec3::new(-0.5, 0.125, 1.0).normalize();
        for facet in surface.facets() {
            assert!((surface.normal(facet) - expected).length() < 1e-15);
        }
        assert!((surface.steepest_slope() - 0.5_f64.hypot(0.125)).abs() < 1e-15);
    }

    #[test]
    fn a_vertical_ray_meets_exactly_one_facet_and_only_from_its_own_side() {
        let surface = tilted();
        let down = TileRay {
            origin: DVec3::new(0.7, 1.2, 5.0),
            direction: DVec3::NEG_Z,
        };
        let hits: Vec<_> = surface
            .facets()
            .filter_map(|f| surface.intersect(f, &down, Medium::Above).map(|t| (f, t)))
            .collect();
        assert_eq!(hits.len(), 1);
        let (facet, t) = hits[0];
        assert_eq!(
            facet,
            Facet {
                iy: 1,
                ix: 0,
                triangle: Triangle::Lower
            }
        );
        let on_plane = surface.snap(facet, down.at(t));
        assert!((on_plane - down.at(t)).length() < 1e-14);
        assert!(
            surface
                .facets()
                .all(|f| surface.intersect(f, &down, Medium::Below).is_none())
        );
    }

    #[test]
    fn corners_lie_on_the_plane_and_turn_counter_clockwise() {
        let surface = tilted();
        for facet in surface.facets() {
            let [a, b, c] = surface.corners(facet);
            assert!((b - a).cross(c - a).z > 0.0);
            for p in [a, b, c] {
                assert!((surface.snap(facet, p) - p).length() < 1e-15);
            }
        }
    }

    #[test]
    fn offsets_and_units_leave_tile_coordinates_alone() {
        let heights: Vec<f64> = vec![0.0, 1.0, 2.0, -1.0];
        let plain = Surface::new(HeightField::new(heights.clone(), [2, 2], [1.0, 1.0]).unwrap());
        let scaled = heights.iter().map(|h| 1024.0 * h + 4096.0).collect();
        let scaled = Surface::new(HeightField::new(scaled, [2, 2], [1024.0, 1024.0]).unwrap());
        assert_eq!(plain.z_range(), scaled.z_range());
        assert_eq!(plain.mean_plane(), scaled.mean_plane());
        for facet in plain.facets() {
            assert_eq!(plain.corners(facet), scaled.corners(facet));
        }
    }
}
