//! Height field: the facets of a meshed surface, their normals, and their intersection with a ray.

mod cell;
mod many;
#[cfg(test)]
mod tests;

use std::sync::OnceLock;

use asperity_numerics::elementary::hypot;
use asperity_surface::{Border, HeightField, Triangle};
use glam::DVec3;

use self::cell::{Cell, Size};

use crate::geometry::blocks::{Block, FINEST};
use crate::geometry::culling::{escapes_by, find_culling_classes};
use crate::geometry::grid::Grid;
use crate::geometry::height_bounds::HeightBounds;
use crate::geometry::horizon_bounds::{HorizonBounds, HorizonTable};
use crate::geometry::nearby::{find_nearby, is_clear_nearby};
use crate::geometry::{CullingClass, Escape, Geometry, Nearby, Triangles, bounds_of};
use crate::ray::{HalfSpace, Hit, RayColumns, TileRay};
use crate::vector::prefetch;

pub use self::cell::Facet;

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
    horizon_bounds: HorizonBounds,
    /// Made for surfaces with a medium below.
    height_bounds: OnceLock<HeightBounds>,
}

/// Conversion of heights to z in tile coordinates.
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
        let blocks = Block::of_triangles(field.cells(), |iy, row| {
            row.clear();
            row.extend(grid_row(&field, iy).iter().map(|&h| scale.z(h)));
            row.push(scale.z(field.height(field.cells()[0], iy)));
        });
        let blocks = with_turned_cells(blocks, &field, scale);
        let horizon_bounds =
            HorizonBounds::new(field.cells(), field.border(), half_range, margin, blocks);
        let [dx, dy] = field.spacing();
        Self {
            extent: field.cells().map(|n| n as f64),
            aspect: dx / dy,
            field,
            scale,
            size: Size {
                reach: half_range,
                steepest: horizon_bounds.steepest(),
            },
            mean: scale.z(mean),
            horizon_bounds,
            height_bounds: OnceLock::new(),
        }
    }

    /// The surface whose heights are those of this one times `factor`, -1 to turn it over or 0 for a plane.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let field = &self.field;
        let heights = field.heights().iter().map(|h| h * factor).collect();
        let scaled = HeightField::of_checked(heights, field.shape(), field.spacing())
            .with_unit(field.unit())
            .with_border(field.border())
            .with_turned_cells(field.turned_cells().cloned());
        Self::new(scaled)
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

    /// Bounds on how high it rises before rays.
    #[cfg(test)]
    pub(in crate::geometry) const fn horizon_bounds(&self) -> &HorizonBounds {
        &self.horizon_bounds
    }

    /// Bounds on the horizon, by which rays escape without a search.
    #[must_use]
    pub fn horizon_table(&self) -> HorizonTable<'_> {
        self.horizon_bounds.table()
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

    /// Returns `true` if all heights are equal.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.field.is_flat()
    }

    /// z of the grid points of row `iy`, one per cell, tile coordinates; rows wrap.
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
                is_turned: self.field.is_turned(ix, iy),
            };
        }
        Cell {
            z00: self.z(ix, iy),
            z10: self.z(ix + 1, iy),
            z01: self.z(ix, iy + 1),
            z11: self.z(ix + 1, iy + 1),
            is_turned: self.field.is_turned(ix, iy),
        }
    }

    /// Indices of the heights at the corners 00, 10, 01 and 11 of a cell.
    #[inline(always)]
    fn corner_indices(&self, [ix, iy]: [u32; 2]) -> [usize; 4] {
        let [rows, columns] = self.field.shape();
        let (ix, iy) = (ix as usize, iy as usize);
        let right = if ix + 1 < columns { ix + 1 } else { 0 };
        let far = columns * if iy + 1 < rows { iy + 1 } else { 0 };
        let near = columns * iy;
        [near + ix, near + right, far + ix, far + right]
    }

    /// Heights at the corners 00, 10, 01 and 11 of a cell, in the unit of the field.
    #[inline(always)]
    fn corner_heights(&self, cell: [u32; 2]) -> [f64; 4] {
        let heights = self.field.heights();
        self.corner_indices(cell).map(|i| heights[i])
    }

    /// Heights between which the slopes of a facet lie, in the unit of the field: that of its cell's corner 00, and
    /// the ends of its rise along a column and along a row, `[to, from]`. Of no use for facets of turned cells.
    #[inline(always)]
    fn slope_heights(&self, Facet { ix, iy, triangle }: Facet) -> (f64, [f64; 2], [f64; 2]) {
        let [i00, i10, i01, i11] = self.corner_indices([ix, iy]);
        let heights = self.field.heights();
        let (h00, h11) = (heights[i00], heights[i11]);
        match triangle {
            Triangle::Lower => {
                let h10 = heights[i10];
                (h00, [h10, h00], [h11, h10])
            }
            Triangle::Upper => {
                let h01 = heights[i01];
                (h00, [h11, h01], [h01, h00])
            }
        }
    }

    /// Corners of a facet in its cell, `[column, row]`, counter-clockwise seen from above.
    pub(crate) fn corners_of(&self, Facet { ix, iy, triangle }: Facet) -> [[u32; 2]; 3] {
        match (triangle, self.field.is_turned(ix as usize, iy as usize)) {
            (Triangle::Lower, false) => [[0, 0], [1, 0], [1, 1]],
            (Triangle::Upper, false) => [[0, 0], [1, 1], [0, 1]],
            (Triangle::Lower, true) => [[0, 0], [1, 0], [0, 1]],
            (Triangle::Upper, true) => [[1, 0], [1, 1], [0, 1]],
        }
    }

    /// First facet of a cell at hand, `[column, row]`, that a ray in `half_space` passes through.
    #[inline]
    fn closest_in(
        &self,
        cell: &Cell,
        [ix, iy]: [u32; 2],
        ray: &TileRay,
        half_space: HalfSpace,
    ) -> Option<Hit<Facet>> {
        let mut closest = None;
        for triangle in [Triangle::Lower, Triangle::Upper] {
            let facet = Facet { iy, ix, triangle };
            if let Some(t) = cell.intersect(facet, ray, half_space, &self.size) {
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

    /// Two per cell.
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

    fn cell_number(&self, facet: Facet) -> Option<usize> {
        let [columns, _] = self.cells();
        Some(facet.iy as usize * columns + facet.ix as usize)
    }

    #[inline]
    fn bounds(&self, facet: Facet) -> [DVec3; 2] {
        bounds_of(self.corners(facet))
    }

    #[inline]
    fn normal_at(&self, facet: Facet, _p: DVec3) -> DVec3 {
        self.normal(facet)
    }

    /// The point of a facet's plane above or below `(p.x, p.y)`, moved into the facet's cell.
    ///
    /// Rounding may have put `p` slightly outside the cell or off the plane; the result lies on both.
    #[inline]
    fn snap(&self, facet: Facet, p: DVec3) -> DVec3 {
        let (ix, iy) = (f64::from(facet.ix), f64::from(facet.iy));
        let cell = self.cell([facet.ix, facet.iy]);
        let [z00, per_column, per_row] = cell.plane(facet.triangle);
        let u = (p.x - ix).clamp(0.0, 1.0);
        let v = (p.y - iy).clamp(0.0, 1.0);
        DVec3::new(ix + u, iy + v, z00 + per_column * u + per_row * v)
    }

    fn intersect(&self, facet: Facet, ray: &TileRay, half_space: HalfSpace) -> Option<f64> {
        let cell = self.cell([facet.ix, facet.iy]);
        cell.intersect(facet, ray, half_space, &self.size)
    }

    fn steepest_slope(&self) -> f64 {
        Grid::steepest(self) * hypot(self.aspect(), 1.0)
    }

    #[inline(always)]
    fn facet_over(&self, x: f64, y: f64) -> Option<Facet> {
        let cell = |p: f64, count: usize| (p as u32).min(count as u32 - 1);
        let [cx, cy] = self.cells();
        let (ix, iy) = (cell(x, cx), cell(y, cy));
        let (u, v) = (x - f64::from(ix), y - f64::from(iy));
        let is_turned = self.field.is_turned(ix as usize, iy as usize);
        let is_lower = if is_turned { u < 1.0 - v } else { u > v };
        let triangle = if is_lower {
            Triangle::Lower
        } else {
            Triangle::Upper
        };
        Some(Facet { iy, ix, triangle })
    }

    fn prepare_nearby(&self) {
        let ranges = |iy, ranges: &mut Vec<_>| self.row_ranges(iy, ranges);
        let height_bounds = || HeightBounds::new(self.cells(), ranges);
        self.height_bounds.get_or_init(height_bounds);
    }

    #[inline]
    fn is_clear_nearby(&self, ray: &TileRay, half_space: HalfSpace, reach: f64) -> bool {
        is_clear_nearby(self, ray, half_space, reach)
    }

    #[inline]
    fn nearby(&self, ray: &TileRay, half_space: HalfSpace, reach: f64) -> Nearby<Facet> {
        find_nearby(self, ray, half_space, reach)
    }

    fn is_beyond(&self, p: DVec3, half_space: HalfSpace) -> bool {
        self.over(p.x, p.y)
            .is_some_and(|(_, below)| half_space.sign() * (p.z - below.z) < 0.0)
    }

    #[inline(always)]
    fn escapes(&self, ray: &TileRay, half_space: HalfSpace) -> Option<Escape> {
        escapes_by(&self.horizon_bounds, self, ray, half_space)
    }

    #[inline(always)]
    fn culling_classes(&self, rays: RayColumns<'_>, classes: &mut [CullingClass]) {
        find_culling_classes(
            &self.horizon_bounds,
            self.extent,
            self.size.reach,
            rays,
            classes,
        );
    }

    #[inline(always)]
    fn arrive(
        &self,
        facets: &[Facet],
        ts: &[f64],
        origin: [&mut [f64]; 3],
        direction: [&[f64]; 3],
        normal: [&mut [f64]; 3],
    ) {
        self.arrive_many(facets, ts, origin, direction, normal);
    }
}

impl Grid for Surface {
    fn cells(&self) -> [usize; 2] {
        self.field.cells()
    }

    #[inline]
    fn cell_range(&self, cell: [u32; 2]) -> [f64; 2] {
        let Cell {
            z00, z10, z01, z11, ..
        } = self.cell(cell);
        [
            z00.min(z10).min(z01.min(z11)),
            z00.max(z10).max(z01.max(z11)),
        ]
    }

    fn steepest(&self) -> f64 {
        self.size.steepest
    }

    fn height_bounds(&self) -> Option<&HeightBounds> {
        self.height_bounds.get()
    }

    #[inline]
    fn intersect_cell(
        &self,
        cell: [u32; 2],
        ray: &TileRay,
        half_space: HalfSpace,
    ) -> Option<Hit<Facet>> {
        self.closest_in(&self.cell(cell), cell, ray, half_space)
    }

    #[inline(always)]
    fn prefetch(&self, [ix, iy]: [u32; 2]) {
        let (heights, [_, columns]) = (self.field.heights(), self.field.shape());
        let near = iy as usize * columns + ix as usize;
        prefetch(heights, near);
        prefetch(heights, near + columns);
    }

    /// `None` for rays that come near an edge.
    #[inline(always)]
    fn pass_cells(
        &self,
        rays: RayColumns<'_>,
        met: &[(u32, [u32; 2])],
        hits: &mut [Option<Hit<Facet>>],
    ) {
        self.pass_cells_many(rays, met, hits);
    }
}

impl Triangles for Surface {
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
        self.corners_of(facet).map(|[i, j]| corner(i, j))
    }
}

/// The blocks with the slopes of turned cells too; those of the same cells split along the other diagonal stay.
fn with_turned_cells(mut blocks: Vec<Block>, field: &HeightField, scale: Scale) -> Vec<Block> {
    if field.turned_cells().is_none() {
        return blocks;
    }
    let [columns, rows] = field.cells();
    for iy in 0..rows {
        for ix in (0..columns).filter(|&ix| field.is_turned(ix, iy)) {
            let z = |i: usize, j: usize| scale.z(field.height(ix + i, iy + j));
            let block = &mut blocks[iy / FINEST * columns.div_ceil(FINEST) + ix / FINEST];
            block.add_turned_cell([z(0, 0), z(1, 0), z(0, 1), z(1, 1)]);
        }
    }
    blocks
}

/// The heights of row `iy`, one per cell; rows wrap.
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
