//! The meshed surface: facets, their normals, and where a ray meets one of them.

use std::sync::OnceLock;

use asperity_surface::{Border, HeightField, Triangle};
use glam::DVec3;

use crate::accelerator::{Accelerator, AcceleratorKind, BuildError, TALLEST};
use crate::accelerators::brute_force::BruteForce;
use crate::accelerators::flat::Flat;
use crate::accelerators::mesh_bvh::MeshBvh;
use crate::accelerators::pyramid::Pyramid;
use crate::accelerators::tile_bvh::TileBvh;
use crate::cell::{Cell, Size};
use crate::geometry::{Escape, Geometry, Nearby, is_beside};
use crate::ray::{Hit, Medium, TileRay};
use crate::relief::{Cells, Relief};
use crate::steepness::Steepness;

/// Columns or rows of cells that are looked at one by one.
const FEW: u32 = 2;

/// Columns or rows under a stretch beyond which a search, of many at once, is quicker than a look nearby.
const FAR: u32 = 8;

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
    scale: Scale,
    size: Size,
    mean: f64,
    /// Cells of the tile, `[columns, rows]`.
    extent: [f64; 2],
    /// `dx / dy`.
    aspect: f64,
    steepness: Steepness,
    /// Made for surfaces with a medium below.
    relief: OnceLock<Relief>,
}

/// From heights to z in tile coordinates.
#[derive(Clone, Copy, Debug)]
struct Scale {
    per_column: f64,
    offset: f64,
}

impl Scale {
    fn z(self, height: f64) -> f64 {
        (height - self.offset) * self.per_column
    }
}

impl Surface {
    /// Takes over a height field.
    #[must_use]
    pub fn new(field: HeightField) -> Self {
        let first = field.heights()[0];
        let (mut low, mut high, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for chunk in field.heights().chunks(1024) {
            let (l, h, s) = extremes(chunk, first);
            low = low.min(l);
            high = high.max(h);
            sum += s;
        }
        let scale = Scale {
            per_column: 1.0 / field.spacing()[0],
            offset: 0.5 * low + 0.5 * high,
        };
        let mean = first + sum / field.heights().len() as f64;
        let half_range = (0.5 * high - 0.5 * low) * scale.per_column;
        // Differences of heights are rounded by a few 2^-53 of their range.
        let margin = 1e-14 * half_range;
        let steepness = Steepness::new(field.cells(), field.border(), margin, |iy, row| {
            row.clear();
            row.extend(grid_row(&field, iy).iter().map(|&h| scale.z(h)));
            row.push(scale.z(field.height(field.cells()[0], iy)));
        });
        let [dx, dy] = field.spacing();
        Self {
            extent: field.cells().map(|n| n as f64),
            aspect: dx / dy,
            field,
            scale,
            size: Size {
                reach: half_range,
                steepest: steepness.steepest(),
            },
            mean: scale.z(mean),
            steepness,
            relief: OnceLock::new(),
        }
    }

    /// The height field.
    #[must_use]
    pub const fn field(&self) -> &HeightField {
        &self.field
    }

    /// The height field back.
    #[must_use]
    pub fn into_field(self) -> HeightField {
        self.field
    }

    /// Cells of the tile, `[columns, rows]`: its extent in tile coordinates.
    #[must_use]
    pub const fn cells(&self) -> [usize; 2] {
        self.field.cells()
    }

    /// z of the grid point `(ix, iy)`, tile coordinates; indices wrap.
    #[must_use]
    pub fn z(&self, ix: usize, iy: usize) -> f64 {
        self.scale.z(self.field.height(ix, iy))
    }

    /// Whether all heights are equal.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.field.is_flat()
    }

    /// The accelerator that `kind` stands for on this surface.
    #[must_use]
    pub fn resolve(&self, kind: AcceleratorKind) -> AcceleratorKind {
        kind.on_height_field(self.cells(), self.is_flat())
    }

    /// An upper bound of the rise of any facet along a column or a row, tile coordinates.
    pub(crate) const fn steepest(&self) -> f64 {
        self.size.steepest
    }

    /// z of a height, tile coordinates; it never falls with the height.
    pub(crate) fn z_of(&self, height: f64) -> f64 {
        self.scale.z(height)
    }

    /// z of the grid points of row `iy`, one a cell, tile coordinates; rows wrap.
    pub fn row(&self, iy: usize) -> impl Iterator<Item = f64> {
        grid_row(&self.field, iy).iter().map(|&h| self.scale.z(h))
    }

    /// The corners of a cell.
    #[inline]
    fn cell(&self, [ix, iy]: [u32; 2]) -> Cell {
        let (ix, iy) = (ix as usize, iy as usize);
        let [ny, nx] = self.field.shape();
        if ix + 1 < nx && iy + 1 < ny {
            let corner = iy * nx + ix;
            let heights = &self.field.heights()[corner..corner + nx + 2];
            let z = |i: usize| self.scale.z(heights[i]);
            return Cell {
                z00: z(0),
                z10: z(1),
                z01: z(nx),
                z11: z(nx + 1),
            };
        }
        Cell {
            z00: self.z(ix, iy),
            z10: self.z(ix + 1, iy),
            z01: self.z(ix, iy + 1),
            z11: self.z(ix + 1, iy + 1),
        }
    }

    /// Ray parameter at which a ray passes through the plane of a facet: what [`Geometry::intersect`]
    /// gives where the ray is known to pass through the facet, and not at its edge.
    #[must_use]
    pub fn crossing(&self, facet: Facet, ray: &TileRay) -> f64 {
        self.cell([facet.ix, facet.iy]).crossing(facet, ray)
    }

    /// First facet of the cell `[column, row]` that a ray in `medium` passes through.
    #[must_use]
    pub fn intersect_cell(
        &self,
        [ix, iy]: [u32; 2],
        ray: &TileRay,
        medium: Medium,
    ) -> Option<Hit<Facet>> {
        let cell = self.cell([ix, iy]);
        let mut closest = None;
        for triangle in [Triangle::Lower, Triangle::Upper] {
            let facet = Facet { iy, ix, triangle };
            if let Some(t) = cell.intersect(facet, ray, medium, &self.size) {
                let hit = Hit { t, facet };
                if hit.is_before(&closest) {
                    closest = Some(hit);
                }
            }
        }
        closest
    }

    /// The cells under a stretch of a ray, and what rounding may add; `None` if it is not over the tile.
    #[inline]
    fn cells_under(&self, ray: &TileRay, stretch: [f64; 2]) -> Option<Cells> {
        let mut cells = [[0_u32; 2]; 2];
        for (axis, cells) in cells.iter_mut().enumerate() {
            let [a, b] = stretch.map(|t| ray.origin[axis] + t * ray.direction[axis]);
            // Far more than what rounding adds.
            let margin = 1e-9 * (1.0 + a.abs() + b.abs());
            let [low, high] = [a.min(b) - margin, a.max(b) + margin];
            if !(low >= 0.0 && high < self.extent[axis]) {
                return None;
            }
            *cells = [low as u32, high as u32];
        }
        Some(cells)
    }

    /// The first facet that a ray passes before `t` exceeds `reach`, on a stretch that is over the tile.
    fn nearby_by_halves(
        &self,
        relief: &Relief,
        ray: &TileRay,
        medium: Medium,
        reach: f64,
    ) -> Nearby<Facet> {
        let mut closest: Option<Hit<Facet>> = None;
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
            let Some(cells) = self.cells_under(ray, stretch) else {
                return Nearby::Unknown;
            };
            let z = nearest(ray, medium, stretch);
            if relief.is_clear(cells, medium, z) {
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
                    let cell = self.cell([ix, iy]);
                    let q = medium.sign();
                    // Beyond all four corners the stretch is beyond both facets.
                    if [cell.z00, cell.z10, cell.z01, cell.z11]
                        .iter()
                        .all(|corner| q * z > q * corner)
                    {
                        continue;
                    }
                    for triangle in [Triangle::Lower, Triangle::Upper] {
                        let facet = Facet { iy, ix, triangle };
                        if let Some(t) = cell.intersect(facet, ray, medium, &self.size) {
                            let hit = Hit { t, facet };
                            if hit.is_before(&closest) {
                                closest = Some(hit);
                            }
                        }
                    }
                }
            }
        }
        match closest {
            Some(hit) if hit.t <= reach => Nearby::Met(hit),
            _ => Nearby::Clear,
        }
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
}

impl Geometry for Surface {
    type Facet = Facet;

    #[inline]
    fn border(&self) -> Border {
        self.field.border()
    }

    #[inline]
    fn extent(&self) -> [f64; 2] {
        self.extent
    }

    /// `dx / dy`.
    #[inline]
    fn aspect(&self) -> f64 {
        self.aspect
    }

    fn unit(&self) -> f64 {
        self.field.spacing()[0]
    }

    #[inline]
    fn z_range(&self) -> [f64; 2] {
        [-self.size.reach, self.size.reach]
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

    #[inline]
    fn normal(&self, facet: Facet) -> DVec3 {
        let cell = self.cell([facet.ix, facet.iy]);
        let [_, per_column, per_row] = cell.plane(facet.triangle);
        DVec3::new(-per_column, -per_row * self.aspect(), 1.0).normalize()
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
    #[inline]
    fn snap(&self, facet: Facet, p: DVec3) -> DVec3 {
        let (ix, iy) = (f64::from(facet.ix), f64::from(facet.iy));
        let cell = self.cell([facet.ix, facet.iy]);
        let [z00, per_column, per_row] = cell.plane(facet.triangle);
        let u = (p.x - ix).clamp(0.0, 1.0);
        let v = (p.y - iy).clamp(0.0, 1.0);
        DVec3::new(ix + u, iy + v, z00 + per_column * u + per_row * v)
    }

    fn intersect(&self, facet: Facet, ray: &TileRay, medium: Medium) -> Option<f64> {
        let cell = self.cell([facet.ix, facet.iy]);
        cell.intersect(facet, ray, medium, &self.size)
    }

    fn over(&self, x: f64, y: f64) -> Option<(Facet, DVec3)> {
        let cell = |p: f64, count: usize| (p as usize).min(count - 1) as u32;
        let [cx, cy] = self.cells();
        let (ix, iy) = (cell(x, cx), cell(y, cy));
        let triangle = if x - f64::from(ix) > y - f64::from(iy) {
            Triangle::Lower
        } else {
            Triangle::Upper
        };
        let facet = Facet { iy, ix, triangle };
        Some((facet, self.snap(facet, DVec3::new(x, y, 0.0))))
    }

    fn prepare_nearby(&self) {
        let relief = || Relief::new(self.cells(), |ix, iy| self.z(ix, iy));
        self.relief.get_or_init(relief);
    }

    /// By the heights of blocks of cells under the stretch, or by slopes; where these do not tell and the
    /// stretch is short, half by half, down to the cells.
    #[inline]
    fn nearby(&self, ray: &TileRay, medium: Medium, reach: f64) -> Nearby<Facet> {
        if is_beside(self.z_range(), ray, medium, reach) {
            return Nearby::Clear;
        }
        let (Some(relief), Some(cells)) = (self.relief.get(), self.cells_under(ray, [0.0, reach]))
        else {
            return Nearby::Unknown;
        };
        if relief.is_clear(cells, medium, nearest(ray, medium, [0.0, reach]))
            || self.escapes(ray, medium).is_some()
        {
            return Nearby::Clear;
        }
        let [[x0, x1], [y0, y1]] = cells;
        if x1 - x0 > FAR || y1 - y0 > FAR {
            return Nearby::Unknown;
        }
        self.nearby_by_halves(relief, ray, medium, reach)
    }

    fn is_beyond(&self, p: DVec3, medium: Medium) -> bool {
        self.over(p.x, p.y)
            .is_some_and(|(_, below)| medium.sign() * (p.z - below.z) < 0.0)
    }

    #[inline(always)]
    fn escapes(&self, ray: &TileRay, medium: Medium) -> Option<Escape> {
        let q = medium.sign();
        let (rise, u) = (q * ray.direction.z, q * ray.direction.truncate());
        if rise <= 0.0 {
            return None;
        }
        if self.steepness.is_below_all(u, rise) {
            return Some(Escape::SteeperThanAll);
        }
        // Until it is above the highest point (below the lowest one).
        let t = (self.size.reach - q * ray.origin.z) / rise;
        let place = ray.origin.truncate();
        let [cx, cy] = self.extent();
        let within = (0.0..=cx).contains(&place.x) && (0.0..=cy).contains(&place.y);
        (within && self.steepness.is_below_near(place, u, rise, t))
            .then_some(Escape::SteeperThanNear)
    }

    fn accelerator(&self, kind: AcceleratorKind) -> Result<Box<dyn Accelerator<Self>>, BuildError> {
        let [low, high] = self.z_range();
        let columns = high - low;
        if columns.is_nan() || columns > TALLEST {
            return Err(BuildError::TooTall { columns });
        }
        Ok(match self.resolve(kind) {
            AcceleratorKind::Mesh => Box::new(MeshBvh::build(self)?),
            AcceleratorKind::Flat => Box::new(Flat::build(self)?),
            AcceleratorKind::Pyramid => Box::new(Pyramid::build(self)?),
            AcceleratorKind::Auto | AcceleratorKind::Tiles => Box::new(TileBvh::build(self)?),
            AcceleratorKind::BruteForce => Box::new(BruteForce),
        })
    }
}

/// z of the point of a stretch of a ray in `medium` that is nearest to the other side.
#[inline]
fn nearest(ray: &TileRay, medium: Medium, stretch: [f64; 2]) -> f64 {
    let [a, b] = stretch.map(|t| ray.origin.z + t * ray.direction.z);
    match medium {
        Medium::Above => a.min(b),
        Medium::Below => a.max(b),
    }
}

/// The heights of row `iy`, one a cell; rows wrap.
fn grid_row(field: &HeightField, iy: usize) -> &[f64] {
    let [ny, nx] = field.shape();
    let start = (iy % ny) * nx;
    &field.heights()[start..start + field.cells()[0]]
}

/// Lowest, highest, and the sum over `first`; in lanes, so that it takes vector instructions.
fn extremes(heights: &[f64], first: f64) -> (f64, f64, f64) {
    let mut lanes = [(f64::INFINITY, f64::NEG_INFINITY, 0.0); 8];
    for chunk in heights.chunks(8) {
        for (lane, &h) in lanes.iter_mut().zip(chunk) {
            let (low, high, sum) = *lane;
            *lane = (
                if h < low { h } else { low },
                if h > high { h } else { high },
                sum + (h - first),
            );
        }
    }
    lanes.into_iter().fold(
        (f64::INFINITY, f64::NEG_INFINITY, 0.0),
        |(low, high, sum), (l, h, s)| (low.min(l), high.max(h), sum + s),
    )
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

    /// How a ray in `Medium::Above` meets each facet.
    fn hits(surface: &Surface, origin: DVec3, direction: DVec3) -> Vec<(Facet, f64)> {
        let ray = TileRay { origin, direction };
        let hit = |f| surface.intersect(f, &ray, Medium::Above).map(|t| (f, t));
        surface.facets().filter_map(hit).collect()
    }

    #[test]
    fn a_ray_that_comes_in_under_the_rim_of_a_patch_meets_no_wall_there() {
        // At x = 0, y = 0.5 the plane is at -0.375 (its middle is 0.25); over the rim, and under it.
        let surface = tilted();
        let direction = DVec3::new(1.0, 0.0, -0.1).normalize();
        let over = hits(&surface, DVec3::new(-3.0, 0.5, 0.0), direction);
        assert_eq!(over.len(), 1);
        let under = hits(&surface, DVec3::new(-3.0, 0.5, -0.2), direction);
        assert_eq!(under, []);
    }

    #[test]
    fn a_ray_that_has_left_the_tile_along_its_border_is_not_met_by_a_corner() {
        // It crosses the border x = 5 by rounding, near t = 133, and passes z = 0 at t = 135.2 in the
        // neighbouring tile. Where it runs past the corner (5, 1) it is 2.5e-4 under the plane.
        let field = HeightField::new(vec![7.0; 20], [4, 5], [1.0; 2]).unwrap();
        let origin = DVec3::new(4.999999999999992, 137.1965056830754, 0.033368251402507744);
        let direction = DVec3::new(
            5.999999817250078e-17,
            -0.9999999695416797,
            -0.00024681296471070006,
        );
        let surface = Surface::new(field);
        assert_eq!(hits(&surface, origin, direction), []);
        let beside = hits(&surface, origin - DVec3::new(5.0, 0.0, 0.0), direction);
        let crossing = origin.z / -direction.z;
        assert_eq!(beside.len(), 1);
        assert!((beside[0].1 - crossing).abs() < 1e-9);
    }

    #[test]
    fn a_ray_on_the_wrong_side_of_an_edge_by_rounding_is_caught_by_the_next_facet() {
        // Over the edge x = 1 the ray is at z - h = -1e-15, and falls further.
        let surface = tilted();
        let edge = DVec3::new(1.0, 0.25, 0.5 - 0.0625 - 0.25 - 1e-15);
        let direction = DVec3::new(1.0, 0.0, -0.1).normalize();
        let caught = hits(&surface, edge, direction);
        assert!(caught.iter().any(|(f, t)| f.ix == 1 && *t == 0.0));
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
