//! Horizon bounds: how high the surface can rise before a ray, by which it escapes without a search: how steep the facets nearby
//! are, and how high the surface is farther on. A horizon map, block by block and quadrant by quadrant, that never lies too low.
//!
//! A ray meets nothing if it is steeper than all facets of its block and of the next ones in its quadrant of directions, and
//! after 1, 2, 4, 8 and 16 sides of a block above all that lies up to twice as far, and after 32 above all heights. Bounds on slopes
//! are tighter within about one correlation length, bounds on heights beyond it; the side of the blocks is chosen accordingly.

use asperity_surface::Border;
use glam::DVec2;
use rayon::prelude::*;

use super::blocks::{Block, FINEST, Support, bound};
use super::windows::{Joined, Layout};

/// Stretches on which heights are bounded, each twice as long as the one before.
const STRETCHES: usize = 5;

/// Quantisation steps of rises and heights. With rounding up they stay below `u16::MAX`, which stands for what lies beyond an
/// open border.
const STEPS: f64 = 65_000.0;
const _: () = assert!(STEPS + 4.0 < u16::MAX as f64);

/// Most blocks of a tile: larger tiles have larger blocks.
const MAX_BLOCKS: usize = 1 << 18;

/// Bounds on what rays from a block meet in one quadrant of directions, in quantisation steps: rises of facets along x, along y
/// and along the diagonal between them, and heights on each stretch. Those of rays below are turned upside down.
pub(crate) type QuadrantBounds = [u16; BOUNDS];

/// Number of these.
pub(crate) const BOUNDS: usize = 3 + STRETCHES;

/// The bounds of all blocks of a tile.
#[derive(Clone, Debug)]
pub(crate) struct HorizonBounds {
    /// Slope bounds of all facets, and of their mirror images where there are any.
    all: Support,
    /// A block has two to this power cells along each side.
    level: u32,
    /// Numbers of the last block along x and y.
    last: [u32; 2],
    /// Block by block, row by row: of each quadrant those of rays above and those of rays below.
    quadrants: Vec<QuadrantBounds>,
    /// Scales of the bounds that are rises, and of those that are heights.
    rises: Scale,
    heights: Scale,
}

/// Numbers of the bounds on the horizon, for an engine that computes culling classes elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct HorizonTable<'a> {
    /// Steepest rise of all facets in eight directions, 45 degrees apart from +x.
    pub all: [f64; 8],
    /// A block has two to this power cells along each side.
    pub level: u32,
    /// Numbers of the last block along x and y.
    pub last: [u32; 2],
    /// Bounds in steps, block by block, row by row: of each quadrant of directions those of rays above and those of rays below; three rises,
    /// then heights on stretches of doubling length.
    pub quadrants: &'a [[u16; BOUNDS]],
    /// Lowest value and step of rises.
    pub rises: [f64; 2],
    /// Lowest value and step of heights.
    pub heights: [f64; 2],
}

/// Values that are quantised in equal steps.
#[derive(Clone, Copy, Debug)]
struct Scale {
    lowest: f64,
    step: f64,
}

impl Scale {
    /// For values between `-most` and `most`.
    fn new(most: f64) -> Self {
        Self {
            lowest: -most,
            step: 2.0 * most / STEPS + f64::MIN_POSITIVE,
        }
    }

    /// A value in steps, rounded up.
    fn steps(&self, value: f64) -> u16 {
        ((value - self.lowest) / self.step + 3.0) as u16
    }

    /// The value of a number of steps.
    #[inline(always)]
    fn value(&self, steps: f64) -> f64 {
        self.lowest + self.step * steps
    }
}

/// Rises in the eight directions of a [`Support`], in steps.
#[derive(Clone, Copy)]
struct Rises([u16; 8]);

impl Joined for Rises {
    const BEYOND: Self = Self([u16::MAX; 8]);

    #[inline(always)]
    fn joined(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].max(other.0[k])))
    }

    fn mirrored(self, axis: usize) -> Self {
        Self(Support::MIRRORED[axis].map(|k| self.0[k]))
    }
}

impl HorizonBounds {
    /// Bounds what lies ahead in a tile of `[columns, rows]` cells whose heights lie within `reach` of zero, from its finest
    /// blocks. Rises may be off by `margin`.
    pub(crate) fn new(
        cells: [usize; 2],
        border: Border,
        reach: f64,
        margin: f64,
        finest: Vec<Block>,
    ) -> Self {
        Self::with_blocks(cells, border, reach, margin, finest, MAX_BLOCKS)
    }

    /// [`HorizonBounds::new`] with `max_blocks` blocks at the most.
    fn with_blocks(
        cells: [usize; 2],
        border: Border,
        reach: f64,
        margin: f64,
        finest: Vec<Block>,
        max_blocks: usize,
    ) -> Self {
        let tile = finest
            .iter()
            .fold(Support::NONE, |all, block| all.join(&block.support));
        let all = match border {
            Border::Open | Border::Periodic => tile,
            Border::Mirrored => tile.with_images(),
        }
        .raised(margin);
        let steepest = all.steepest();
        let (rises, heights) = (Scale::new(steepest), Scale::new(reach));
        // The highest height over the steepest slope is about 0.7 correlation lengths of a Gaussian surface.
        let longest = reach / steepest;
        let (mut blocks, mut size) = (finest, cells.map(|n| n.div_ceil(FINEST)));
        let mut level = FINEST.ilog2();
        while (2.0 * f64::from(1 << level) <= longest || blocks.len() > max_blocks)
            && size != [1, 1]
        {
            (blocks, size) = Block::joined_by_four(&blocks, size);
            level += 1;
        }
        let layout = Layout {
            size,
            whole: cells.map(|n| n % (1 << level) == 0),
            border,
        };
        let steep: Vec<Rises> = blocks
            .iter()
            .map(|block| Rises(block.support.raised(margin).0.map(|rise| rises.steps(rise))))
            .collect();
        let steep = in_quadrants(&layout, &steep, 1);
        let above = |block: &Block| heights.steps(block.range[1]);
        let below = |block: &Block| heights.steps(-block.range[0]);
        let tops: [Vec<u16>; 2] = [
            blocks.iter().map(above).collect(),
            blocks.iter().map(below).collect(),
        ];
        let high: Vec<[Vec<u16>; 4]> = (0..2 * STRETCHES)
            .into_par_iter()
            .map(|i| in_quadrants(&layout, &tops[i / STRETCHES], 2 << (i % STRETCHES)))
            .collect();
        let mut quadrants = vec![[0; BOUNDS]; 8 * blocks.len()];
        for (block, of_block) in quadrants.chunks_exact_mut(8).enumerate() {
            for (i, bounds) in of_block.iter_mut().enumerate() {
                let (quadrant, side) = (i / 2, i % 2);
                let of = &steep[quadrant][block].0;
                for (rise, direction) in bounds.iter_mut().zip(DIRECTIONS[quadrant]) {
                    // Facets rise towards a ray below where they fall away from one above.
                    *rise = of[(direction + 4 * side) % 8];
                }
                for stretch in 0..STRETCHES {
                    bounds[3 + stretch] = high[STRETCHES * side + stretch][quadrant][block];
                }
            }
        }
        Self {
            all,
            level,
            last: size.map(|n| n as u32 - 1),
            quadrants,
            rises,
            heights,
        }
    }

    /// All numbers of these bounds.
    pub(crate) fn table(&self) -> HorizonTable<'_> {
        let of = |scale: &Scale| [scale.lowest, scale.step];
        HorizonTable {
            all: self.all.0,
            level: self.level,
            last: self.last,
            quadrants: &self.quadrants,
            rises: of(&self.rises),
            heights: of(&self.heights),
        }
    }

    /// The steepest rise of any facet along an axis or a diagonal.
    pub(crate) fn steepest(&self) -> f64 {
        self.all.steepest()
    }

    /// The steepest rise of any facet in the direction and by the length of `u`.
    #[inline(always)]
    pub(crate) fn steepest_along(&self, u: DVec2) -> f64 {
        self.all.rise(u)
    }

    /// The steepest rises along the axis and along the diagonal between which a direction lies: see [`Support::rise`].
    #[inline(always)]
    pub(crate) fn steepest_about(&self, u: [f64; 2]) -> [f64; 2] {
        self.all.about(u)
    }

    /// The bounds for a ray from `[x, y]` in the tile in horizontal direction `[dx, dy]`, in the half space of sign `q`.
    #[inline(always)]
    pub(crate) fn before(&self, [x, y]: [f64; 2], [dx, dy]: [f64; 2], q: f64) -> &QuadrantBounds {
        let block = |place: f64, last: u32| (place as i32 as u32 >> self.level).min(last);
        let number = block(y, self.last[1]) * (self.last[0] + 1) + block(x, self.last[0]);
        let quadrant = u32::from(dx < 0.0) | u32::from(dy < 0.0) << 1;
        let below = u32::from(q < 0.0);
        &self.quadrants[(8 * number + 2 * quadrant + below) as usize]
    }

    /// Returns `true` if a ray from the height `z` in direction `[dx, dy, rise]`, both counted upwards in its half
    /// space, stays above these bounds, so that it hits nothing.
    #[inline(always)]
    pub(crate) fn is_above(
        &self,
        bounds: &[f64; BOUNDS],
        z: f64,
        [dx, dy, rise]: [f64; 3],
    ) -> bool {
        let is_along_x = dx.abs() >= dy.abs();
        let axis = if is_along_x { bounds[0] } else { bounds[1] };
        let [axis, diagonal] = [axis, bounds[2]].map(|steps| self.rises.value(steps));
        let mut is_above = rise > bound([dx, dy], [axis, diagonal]);
        // Height gained on the way past one block
        let longer = if is_along_x { dx.abs() } else { dy.abs() };
        let mut gain = rise * f64::from(1 << self.level) / longer;
        for steps in &bounds[3..] {
            is_above &= z + gain > self.heights.value(*steps);
            gain *= 2.0;
        }
        is_above & (z + gain > -self.heights.lowest)
    }
}

/// Numbers of the directions of a [`Support`] along x, along y and along the diagonal of each quadrant.
const DIRECTIONS: [[usize; 3]; 4] = [[0, 2, 1], [4, 2, 3], [0, 6, 7], [4, 6, 5]];

/// The join of each block with those within `count` sides of a block after it, by quadrant: to greater x and y, to smaller x, to
/// smaller y, to smaller both.
fn in_quadrants<T: Joined>(layout: &Layout, blocks: &[T], count: usize) -> [Vec<T>; 4] {
    let along_x = [false, true].map(|backward| layout.windows(blocks, 0, backward, count));
    std::array::from_fn(|quadrant| {
        layout.windows(&along_x[quadrant & 1], 1, quadrant & 2 != 0, count)
    })
}

#[cfg(test)]
mod tests {
    use asperity_surface::HeightField;

    use super::*;
    use crate::geometry::Geometry;
    use crate::geometry::height_field::Surface;

    /// Gentle land with towers and pits of some width, one in `area` cells, which only heights tell of from afar.
    fn surface([columns, rows]: [usize; 2], border: Border, width: f64, area: usize) -> Surface {
        let centres: Vec<DVec2> = (0..(columns * rows).div_ceil(area))
            .map(|i| DVec2::new(0.754_877, 0.569_840) * (i as f64 + 0.7))
            .map(|p| p.fract() * DVec2::new(columns as f64, rows as f64))
            .collect();
        let heights = (0..columns * rows).map(|i| {
            let place = DVec2::new((i % columns) as f64, (i / columns) as f64);
            let of_towers = centres.iter().enumerate().map(|(k, centre)| {
                let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
                sign * (-(place - centre).length_squared() / (width * width)).exp()
            });
            let noise = (i as f64 * 0.618_034).fract() - 0.5;
            12.0 * of_towers.sum::<f64>() + 0.05 * noise
        });
        let field = HeightField::new(heights.collect(), [rows, columns], [1.0; 2]).unwrap();
        Surface::new(field.with_border(border))
    }

    /// The height at a place of the tile or beyond its border; the highest one beyond an open border.
    fn height_at(surface: &Surface, place: DVec2, q: f64) -> f64 {
        let inside = |p: f64, n: f64| match surface.border() {
            Border::Periodic => Some(p.rem_euclid(n)),
            Border::Open => (0.0..=n).contains(&p).then_some(p),
            Border::Mirrored => {
                let p = p.rem_euclid(2.0 * n);
                Some(p.min(2.0 * n - p))
            }
        };
        let [nx, ny] = surface.extent();
        match (inside(place.x, nx), inside(place.y, ny)) {
            (Some(x), Some(y)) => surface.over(x, y).unwrap().1.z,
            _ => q * surface.z_range()[1],
        }
    }

    /// Place and direction of ray number `i`: every fifth from the edge or the corner of a block, every third along an axis or a
    /// diagonal.
    fn ray(i: u32, [nx, ny]: [f64; 2]) -> (DVec2, DVec2) {
        let number = f64::from(i);
        let mut place = DVec2::new(
            nx * (number * 0.754_877).fract(),
            ny * (number * 0.569_840).fract(),
        );
        if i.is_multiple_of(5) {
            let to_edge = |p: f64| (p / 8.0).floor() * 8.0;
            place.x = to_edge(place.x);
            place.y = if i.is_multiple_of(10) {
                to_edge(place.y)
            } else {
                place.y
            };
        }
        let mut u = DVec2::from_angle(number * 2.399_963);
        if i.is_multiple_of(3) {
            u = [DVec2::X, DVec2::ONE, DVec2::new(-0.0, -1.0), DVec2::NEG_X][i as usize / 3 % 4];
        }
        (place, u)
    }

    /// Follows rays above the bounds in small steps: those that begin on the surface or above it, and are as steep as many facets.
    fn follow(surface: &Surface, horizon_bounds: &HorizonBounds) -> u32 {
        let [_, reach] = surface.z_range();
        let mut above = 0;
        for i in 0..30_000 {
            let (place, u) = ray(i, surface.extent());
            let q = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            let mut z = q * surface.over(place.x, place.y).unwrap().1.z;
            if i.is_multiple_of(7) {
                z += 0.3 * (reach - z);
            }
            let rise =
                horizon_bounds.steepest_along(q * u) * (f64::from(i) * 0.381_966).fract().powi(3);
            let bounds = horizon_bounds.before([place.x, place.y], [u.x, u.y], q);
            if !horizon_bounds.is_above(&bounds.map(f64::from), z, [u.x, u.y, rise]) {
                continue;
            }
            above += 1;
            let mut t = 0.05;
            while z + t * rise < reach {
                let height = q * height_at(surface, place + t * u, q);
                assert!(height <= z + t * rise + 1e-9, "{place} {u} {rise} {t}");
                t += 0.05;
            }
        }
        above
    }

    #[test]
    fn rays_above_the_bounds_meet_nothing_up_to_all_heights() {
        // The last blocks are whole, or not, or one is more than the tile.
        let tiles = [[96, 64], [90, 70], [21, 5], [40, 48]];
        let borders = [Border::Periodic, Border::Mirrored, Border::Open];
        for (number, (cells, border)) in tiles
            .into_iter()
            .flat_map(|cells| borders.map(|border| (cells, border)))
            .enumerate()
        {
            let width = [1.5, 40.0][number % 2];
            let surface = surface(cells, border, width, 900);
            let above = follow(&surface, surface.horizon_bounds());
            // All of the smallest tile is near a tower.
            assert!(above > 60 || cells[1] < 8, "{cells:?} {border:?}: {above}");
        }
    }

    #[test]
    fn fewer_and_larger_blocks_tell_less_but_nothing_wrong() {
        let surface = surface([400, 300], Border::Periodic, 2.0, 6000);
        let cells = surface.cells();
        let blocks = || {
            Block::of_triangles(cells, |iy, row| {
                row.clear();
                row.extend((0..=cells[0]).map(|ix| surface.z(ix, iy)));
            })
        };
        let [_, reach] = surface.z_range();
        // Blocks of 8, 16, 32 and 256 cells a side
        let above = [2000, 500, 150, 4].map(|max_blocks| {
            let border = surface.border();
            let horizon_bounds =
                HorizonBounds::with_blocks(cells, border, reach, 0.0, blocks(), max_blocks);
            assert!(horizon_bounds.quadrants.len() <= 8 * max_blocks);
            follow(&surface, &horizon_bounds)
        });
        assert!(above.is_sorted_by(|a, b| a > b), "{above:?}");
    }

    #[test]
    fn quantised_values_are_rounded_up_by_a_few_steps() {
        let scale = Scale::new(0.7);
        for i in 0..=1000 {
            let value = 0.0014 * f64::from(i) - 0.7;
            let over = scale.value(f64::from(scale.steps(value))) - value;
            assert!(
                (scale.step..4.0 * scale.step).contains(&over),
                "{value}: {over}"
            );
        }
    }

    /// The steepest facet of one side of a mirrored tile is that of its other side in the mirror image.
    #[test]
    fn the_steepest_facets_of_mirrored_tiles_are_those_of_their_images_too() {
        let heights = |[along_x, along_y]: [f64; 2]| {
            let height = |i: u32| along_x * f64::from(i % 20) + along_y * f64::from(i / 20);
            (0..400).map(height).collect()
        };
        for slope in [[0.5, 0.0], [0.0, 0.5], [0.3, -0.2]] {
            let field = HeightField::new(heights(slope), [20, 20], [1.0; 2]).unwrap();
            let surface = Surface::new(field.with_border(Border::Mirrored));
            let steepest = |x: f64, y: f64| {
                let bounds = surface.horizon_bounds();
                bounds.steepest_along(DVec2::new(x, y))
            };
            let expected = slope[0].abs() + slope[1].abs();
            for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                assert!(
                    (steepest(x, y) - expected).abs() < 1e-12,
                    "{slope:?} {x} {y}"
                );
            }
        }
    }

    #[test]
    fn rays_over_flat_surfaces_and_vertical_rays_are_above_the_bounds_and_level_rays_are_not() {
        let field = HeightField::new(vec![1.0; 400], [20, 20], [1.0; 2]).unwrap();
        let flat = Surface::new(field);
        let rough = surface([40, 48], Border::Periodic, 3.0, 900);
        for (surface, directions) in [
            (
                &flat,
                vec![[0.6, 0.0, 0.8], [0.6, 0.8, 1e-6], [0.0, 0.0, 1.0]],
            ),
            (&rough, vec![[0.0, 0.0, 1.0]]),
        ] {
            let horizon_bounds = surface.horizon_bounds();
            let is_above = |direction: [f64; 3]| {
                let bounds = horizon_bounds.before([3.0, 4.0], [direction[0], direction[1]], 1.0);
                let z = surface.over(3.0, 4.0).unwrap().1.z;
                horizon_bounds.is_above(&bounds.map(f64::from), z, direction)
            };
            assert!(directions.into_iter().all(is_above));
            assert!(!is_above([0.6, 0.8, 0.0]) && !is_above([0.0; 3]));
        }
    }

    #[test]
    fn a_tower_beyond_all_stretches_is_not_overlooked() {
        let [columns, rows] = [2000, 8];
        let heights = (0..columns * rows).map(|i| if i % columns == 1000 { 5.0 } else { 0.0 });
        let field = HeightField::new(heights.collect(), [rows, columns], [1.0; 2]).unwrap();
        let surface = Surface::new(field);
        let is_above = |rise: f64| {
            let place = [100.0, 4.0];
            let z = surface.over(place[0], place[1]).unwrap().1.z;
            let bounds = surface.horizon_bounds().before(place, [1.0, 0.0], 1.0);
            let bounds = bounds.map(f64::from);
            surface
                .horizon_bounds()
                .is_above(&bounds, z, [1.0, 0.0, rise])
        };
        assert!(!is_above(0.005) && is_above(0.03));
    }
}
