//! Smooth surface: cells of a bicubic B-spline, their intersection with a ray, and the normals there.
//!
//! Along a ray, the height over a patch is a polynomial of degree six. In Bernstein form, over the stretch of the
//! ray above the cell, its coefficients are weighted means, so rounding is that of the heights. The first place where
//! it becomes negative is found by changes of sign (`first_root.rs`), with no epsilon but the rounding of heights; a ray that
//! begins on the surface has a known root there, which is divided out.

mod extremes;
mod first_root;
mod gaps;
mod many;
mod patch;
mod stretch;

use std::sync::OnceLock;

use asperity_numerics::elementary::hypot;
use asperity_surface::{Border, SplineSurface};
use glam::DVec3;

use self::extremes::{blocks, patch_of, row_ranges};
use self::first_root::first_root;
use self::gaps::{gaps, place, snapped, without_first};
use self::patch::Patch;
use self::stretch::Stretch;
use crate::geometry::blocks::{greatest, least};
use crate::geometry::culling::{escapes_by, find_culling_classes};
use crate::geometry::grid::Grid;
use crate::geometry::height_bounds::HeightBounds;
use crate::geometry::horizon_bounds::{HorizonBounds, HorizonTable};
use crate::geometry::nearby::{find_nearby, is_clear_nearby};
use crate::geometry::{CullingClass, Escape, Geometry, Nearby};
use crate::ray::{HalfSpace, Hit, RayColumns, TileRay};
use crate::vector::prefetch;

/// A cell of a smooth surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SmoothCell {
    /// Row of the cell.
    pub iy: u32,
    /// Column of the cell.
    pub ix: u32,
}

/// A bicubic B-spline as the curved cells that rays meet, in tile coordinates.
///
/// Tile coordinates: x in columns, `[0, cells_x]`; y in rows, `[0, cells_y]`; z in units of the column spacing, measured
/// from the middle between the lowest and the highest Bezier point.
#[derive(Clone, Debug)]
pub struct SmoothSurface {
    spline: SplineSurface,
    /// Conversion of heights to z: what is taken off, and the factor.
    offset: f64,
    per_column: f64,
    /// Largest magnitude of z.
    reach: f64,
    mean: f64,
    extent: [f64; 2],
    /// `dx / dy`.
    aspect: f64,
    horizon_bounds: HorizonBounds,
    /// Steepest rise of any cell.
    steepest: f64,
    /// Made for surfaces with a medium below.
    height_bounds: OnceLock<HeightBounds>,
}

/// Factor by which the division by a known root may multiply rounding: 6 times the difference of two heights.
const DIVIDED: f64 = 12.0;

/// Rounding of a height above a patch, in units of the largest height. Coefficients may be nine times as large, and a
/// height is a weighted mean of them; 6 roundings of 2^-52 were the most seen on the worst of patches.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Rounding of a coordinate along a ray, in units of that of its origin, which may be far: over a cell the product of rate
/// and parameter is about as large, and it, the sum and the origin from the corner of the cell round by half an eps each.
/// Twice that, because two gaps of a stretch are compared.
const RAY_ROUNDING: f64 = 4.0 * f64::EPSILON;

impl SmoothSurface {
    /// Takes over a spline.
    #[must_use]
    pub fn new(spline: SplineSurface) -> Self {
        // Heights above one of them, so that an offset common to all loses no digits
        let first = spline.coefficients()[0];
        let [dx, dy] = spline.spacing();
        let per_column = 1.0 / dx;
        let mut blocks = blocks(&spline, first, per_column);
        let low = blocks
            .iter()
            .fold(f64::INFINITY, |low, b| low.min(b.range[0]));
        let high = blocks
            .iter()
            .fold(f64::NEG_INFINITY, |high, b| high.max(b.range[1]));
        let offset = first + 0.5 * (low + high);
        let middle = offset - first;
        let reach = (high - middle).max(middle - low) * per_column * (1.0 + ROUNDING);
        for block in &mut blocks {
            let [low, high] = block.range.map(|height| (height - middle) * per_column);
            block.range = [low - ROUNDING * reach, high + ROUNDING * reach];
        }
        let border = spline.border();
        let horizon_bounds =
            HorizonBounds::new(spline.cells(), border, reach, ROUNDING * reach, blocks);
        Self {
            extent: spline.cells().map(|n| n as f64),
            aspect: dx / dy,
            mean: (spline.mean() - offset) * per_column,
            spline,
            offset,
            per_column,
            reach,
            steepest: horizon_bounds.steepest(),
            horizon_bounds,
            height_bounds: OnceLock::new(),
        }
    }

    /// The surface whose heights are those of this one times `factor`, -1 to turn it over or 0 for a plane.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self::new(self.spline.scaled(factor))
    }

    /// The spline.
    #[must_use]
    pub const fn spline(&self) -> &SplineSurface {
        &self.spline
    }

    /// Gives the spline back.
    #[must_use]
    pub fn into_spline(self) -> SplineSurface {
        self.spline
    }

    /// Bounds on the horizon, by which rays escape without a search.
    #[must_use]
    pub fn horizon_table(&self) -> HorizonTable<'_> {
        self.horizon_bounds.table()
    }

    /// All coefficients, in their order in the spline; tile coordinates.
    pub fn coefficients(&self) -> impl Iterator<Item = f64> {
        let heights = self.spline.coefficients().iter();
        heights.map(|height| (height - self.offset) * self.per_column)
    }

    /// The patch of a cell, tile coordinates.
    #[inline(always)]
    fn patch(&self, cell: [u32; 2]) -> Patch {
        let Patch(mut rows) = patch_of(&self.spline, cell);
        for height in rows.as_flattened_mut() {
            *height = (*height - self.offset) * self.per_column;
        }
        Patch(rows)
    }

    /// The place of a cell nearest to `p`, z there, and its rise along x and along y.
    #[inline]
    fn at(&self, cell: SmoothCell, p: DVec3) -> ([f64; 2], [f64; 3]) {
        let ([x, u], [y, v]) = (snapped(cell.ix.into(), p.x), snapped(cell.iy.into(), p.y));
        ([x, y], self.patch([cell.ix, cell.iy]).at([u, v]))
    }

    /// Rounding of the height above a patch of a ray from `o`, counted from the corner of the cell.
    #[inline(always)]
    fn noise(&self, o: [f64; 3]) -> f64 {
        let along = self.steepest * (o[0].abs() + o[1].abs());
        ROUNDING * self.reach + RAY_ROUNDING * (along + o[2].abs())
    }

    /// Bernstein coefficients of a ray's height above the patch of a cell, between two of its parameters.
    #[cfg(test)]
    pub(crate) fn gaps_over(
        &self,
        [ix, iy]: [u32; 2],
        ray: &TileRay,
        half_space: HalfSpace,
        stretch: [f64; 2],
    ) -> [f64; 7] {
        let origin = ray.origin - DVec3::new(f64::from(ix), f64::from(iy), 0.0);
        let (o, d) = (origin.to_array(), ray.direction.to_array());
        gaps(&self.patch([ix, iy]), half_space.sign(), o, d, stretch)
    }

    /// Distance by which rounding may have put a ray that enters a cell onto the wrong side: its place, by a few 2^-53
    /// of how far it has come, times how fast it comes nearer to the surface, and that again over its rate across the
    /// side by which it enters.
    fn tolerance(&self, ray: &TileRay, stretch: &Stretch) -> f64 {
        let size = |p: DVec3| p.abs().element_sum();
        let reach = 1.0 + self.reach + size(ray.origin) + stretch.enter * size(ray.direction);
        let place = ROUNDING * reach;
        let travel = ray.direction.x.abs() + ray.direction.y.abs();
        let falls = ray.direction.z.abs() + self.steepest * travel;
        place * (1.0 + self.steepest + falls / stretch.rate)
    }
}

impl Geometry for SmoothSurface {
    type Facet = SmoothCell;

    #[inline]
    fn border(&self) -> Border {
        self.spline.border()
    }

    #[inline]
    fn extent(&self) -> [f64; 2] {
        self.extent
    }

    #[inline]
    fn aspect(&self) -> f64 {
        self.aspect
    }

    fn unit(&self) -> f64 {
        self.spline.spacing()[0]
    }

    #[inline]
    fn z_range(&self) -> [f64; 2] {
        [-self.reach, self.reach]
    }

    fn mean_plane(&self) -> f64 {
        self.mean
    }

    /// One per cell.
    fn facet_count(&self) -> usize {
        let [cx, cy] = self.spline.cells();
        cx * cy
    }

    fn facet(&self, index: usize) -> SmoothCell {
        let [cx, _] = self.spline.cells();
        SmoothCell {
            iy: (index / cx) as u32,
            ix: (index % cx) as u32,
        }
    }

    fn cell_number(&self, cell: SmoothCell) -> Option<usize> {
        let [columns, _] = self.spline.cells();
        Some(cell.iy as usize * columns + cell.ix as usize)
    }

    fn bounds(&self, cell: SmoothCell) -> [DVec3; 2] {
        let (x, y) = (f64::from(cell.ix), f64::from(cell.iy));
        let [low, high] = self.cell_range([cell.ix, cell.iy]);
        [DVec3::new(x, y, low), DVec3::new(x + 1.0, y + 1.0, high)]
    }

    #[inline]
    fn normal_at(&self, cell: SmoothCell, p: DVec3) -> DVec3 {
        let (_, [_, along_x, along_y]) = self.at(cell, p);
        DVec3::new(-along_x, -along_y * self.aspect, 1.0).normalize()
    }

    #[inline]
    fn snap(&self, cell: SmoothCell, p: DVec3) -> DVec3 {
        let ([x, y], [z, ..]) = self.at(cell, p);
        DVec3::new(x, y, z)
    }

    fn steepest_slope(&self) -> f64 {
        Grid::steepest(self) * hypot(self.aspect(), 1.0)
    }

    #[inline(always)]
    fn facet_over(&self, x: f64, y: f64) -> Option<SmoothCell> {
        let index = |p: f64, count: usize| (p as u32).min(count as u32 - 1);
        let [cx, cy] = self.spline.cells();
        Some(SmoothCell {
            ix: index(x, cx),
            iy: index(y, cy),
        })
    }

    /// A ray passes where its signed height above the patch becomes negative. One that enters the cell on the
    /// surface, but for rounding, passes at once if it falls; if it rises, it leaves what it has begun on or
    /// touched, and that root is divided out.
    fn intersect(&self, cell: SmoothCell, ray: &TileRay, half_space: HalfSpace) -> Option<f64> {
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        let stretch = Stretch::over([f64::from(cell.ix), f64::from(cell.iy)], self.reach, o, d);
        let Stretch { enter, leave, .. } = stretch;
        if enter >= leave {
            return None;
        }
        let q = half_space.sign();
        let o = [o[0] - f64::from(cell.ix), o[1] - f64::from(cell.iy), o[2]];
        let patch = self.patch([cell.ix, cell.iy]);
        let gaps = gaps(&patch, q, o, d, [enter, leave]);
        let noise = self.noise(o);
        let s = if gaps[0] > noise {
            first_root(&gaps, noise)?
        } else if gaps[0] < -self.tolerance(ray, &stretch) {
            return None;
        } else {
            let [_, along_x, along_y] = patch.at(place(o, d, enter));
            if q * (d[2] - along_x * d[0] - along_y * d[1]) < 0.0 {
                return Some(enter);
            }
            first_root(&without_first(&gaps), DIVIDED * noise)?
        };
        Some(enter + s * (leave - enter))
    }

    fn prepare_nearby(&self) {
        let ranges = |iy, ranges: &mut Vec<_>| self.row_ranges(iy, ranges);
        let height_bounds = || HeightBounds::new(self.spline.cells(), ranges);
        self.height_bounds.get_or_init(height_bounds);
    }

    #[inline]
    fn is_clear_nearby(&self, ray: &TileRay, half_space: HalfSpace, reach: f64) -> bool {
        is_clear_nearby(self, ray, half_space, reach)
    }

    #[inline]
    fn nearby(&self, ray: &TileRay, half_space: HalfSpace, reach: f64) -> Nearby<SmoothCell> {
        find_nearby(self, ray, half_space, reach)
    }

    fn is_beyond(&self, p: DVec3, half_space: HalfSpace) -> bool {
        self.over(p.x, p.y)
            .is_some_and(|(_, below)| half_space.sign() * (p.z - below.z) < 0.0)
    }

    #[inline]
    fn lift(&self, p: &mut DVec3, margin: f64) {
        let [cx, cy] = self.extent;
        let is_over = (0.0 <= p.x) & (p.x < cx) & (0.0 <= p.y) & (p.y < cy);
        if margin > ROUNDING * self.reach
            && is_over
            && p.z.abs() <= self.reach + margin
            && let Some((_, on)) = self.over(p.x, p.y)
            && p.z < on.z
            && on.z <= p.z + margin
        {
            p.z = on.z;
        }
    }

    #[inline(always)]
    fn escapes(&self, ray: &TileRay, half_space: HalfSpace) -> Option<Escape> {
        escapes_by(&self.horizon_bounds, self, ray, half_space)
    }

    #[inline(always)]
    fn culling_classes(&self, rays: RayColumns<'_>, classes: &mut [CullingClass]) {
        find_culling_classes(&self.horizon_bounds, self.extent, self.reach, rays, classes);
    }

    #[inline(always)]
    fn arrive(
        &self,
        cells: &[SmoothCell],
        ts: &[f64],
        origin: [&mut [f64]; 3],
        direction: [&[f64]; 3],
        normal: [&mut [f64]; 3],
    ) {
        self.arrive_many(cells, ts, origin, direction, normal);
    }
}

impl Grid for SmoothSurface {
    fn cells(&self) -> [usize; 2] {
        self.spline.cells()
    }

    #[inline]
    fn cell_range(&self, cell: [u32; 2]) -> [f64; 2] {
        let points = self.patch(cell).bezier();
        let points = points.as_flattened();
        let margin = ROUNDING * self.reach;
        [
            points.iter().copied().fold(f64::INFINITY, least) - margin,
            points.iter().copied().fold(f64::NEG_INFINITY, greatest) + margin,
        ]
    }

    /// Many at a time.
    fn row_ranges(&self, iy: usize, ranges: &mut Vec<[f64; 2]>) {
        row_ranges(&self.spline, iy, self.offset, ranges);
        for range in ranges {
            let [low, high] = range.map(|height| height * self.per_column);
            *range = [low - ROUNDING * self.reach, high + ROUNDING * self.reach];
        }
    }

    fn steepest(&self) -> f64 {
        self.steepest
    }

    fn height_bounds(&self) -> Option<&HeightBounds> {
        self.height_bounds.get()
    }

    #[inline]
    fn intersect_cell(
        &self,
        [ix, iy]: [u32; 2],
        ray: &TileRay,
        half_space: HalfSpace,
    ) -> Option<Hit<SmoothCell>> {
        let facet = SmoothCell { iy, ix };
        let t = self.intersect(facet, ray, half_space)?;
        Some(Hit { t, facet })
    }
    #[inline(always)]
    fn prefetch(&self, [ix, iy]: [u32; 2]) {
        let (coefficients, stride) = (self.spline.coefficients(), self.spline.stride());
        for row in 0..4 {
            prefetch(coefficients, (iy as usize + row) * stride + ix as usize);
        }
    }

    /// `None` where a ray does not pass the patch once, as most do.
    #[inline(always)]
    fn pass_cells(
        &self,
        rays: RayColumns<'_>,
        met: &[(u32, [u32; 2])],
        hits: &mut [Option<Hit<SmoothCell>>],
    ) {
        self.pass_cells_many(rays, met, hits);
    }
}
