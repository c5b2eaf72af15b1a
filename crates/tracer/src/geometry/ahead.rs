//! Ahead: what rays have ahead of them, by which they escape without a search: how steep the facets nearby are, and how
//! high the surface is farther on.
//!
//! A ray meets nothing if it is steeper than all facets of its block and of the next ones in its quadrant of directions, and
//! after 1, 2, 4, 8 and 16 sides of a block above all that lies up to twice as far, and after 32 above all heights. Slopes tell
//! more where a ray passes less than a correlation length, heights beyond: the blocks are chosen between.

use asperity_surface::Border;
use glam::DVec2;
use rayon::prelude::*;

use super::blocks::{Block, FINEST, Support};
use super::windows::{Joined, Layout};

/// Stretches on which heights are bounded, each twice as long as the one before.
const STRETCHES: usize = 5;

/// Steps into which rises and heights are divided, some less than a word can tell.
const STEPS: f64 = 65_000.0;

/// Blocks at the most.
const MOST_BLOCKS: usize = 1 << 18;

/// What rays from a block that go into one quadrant have ahead of them, in steps: rises of facets along x, along y and along
/// the diagonal between them, and heights on each stretch. Those of rays below are turned upside down.
pub(crate) type View = [u16; VIEWED];

/// Entries of a [`View`].
pub(crate) const VIEWED: usize = 3 + STRETCHES;

/// The views from all blocks of a tile.
#[derive(Clone, Debug)]
pub(crate) struct Ahead {
    /// How steep all facets are, and their mirror images where there are any.
    all: Support,
    /// A block has two to this power cells along each side.
    level: u32,
    /// Numbers of the last block along x and y.
    last: [u32; 2],
    /// Block by block, row by row: of each quadrant the view above and the view below.
    views: Vec<View>,
    rises: Scale,
    heights: Scale,
}

/// What steps stand for.
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

    /// Steps that stand for a value, or a little more.
    fn steps(&self, value: f64) -> u16 {
        ((value - self.lowest) / self.step + 3.0) as u16
    }

    /// What so many steps stand for.
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

impl Ahead {
    /// Of a tile of `[columns, rows]` cells whose heights lie within `reach` of zero, from its finest blocks. Rises may be off by
    /// `margin`.
    pub(crate) fn new(
        cells: [usize; 2],
        border: Border,
        reach: f64,
        margin: f64,
        finest: Vec<Block>,
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
        // Heights over slopes: some correlation lengths
        let longest = reach / steepest;
        let (mut blocks, mut size) = (finest, cells.map(|n| n.div_ceil(FINEST)));
        let mut level = FINEST.ilog2();
        while (2.0 * f64::from(1 << level) <= longest || blocks.len() > MOST_BLOCKS)
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
        let stretches: Vec<(usize, usize)> = (0..2)
            .flat_map(|side| (0..STRETCHES).map(move |stretch| (side, stretch)))
            .collect();
        let high: Vec<[Vec<u16>; 4]> = stretches
            .into_par_iter()
            .map(|(side, stretch)| {
                let top = |block: &Block| match side {
                    0 => block.range[1],
                    _ => -block.range[0],
                };
                let tops: Vec<u16> = blocks.iter().map(|b| heights.steps(top(b))).collect();
                in_quadrants(&layout, &tops, 2 << stretch)
            })
            .collect();
        let mut views = vec![[0; VIEWED]; 8 * blocks.len()];
        for (block, views) in views.chunks_exact_mut(8).enumerate() {
            for (i, view) in views.iter_mut().enumerate() {
                let (quadrant, side) = (i / 2, i % 2);
                let of = &steep[quadrant][block].0;
                for (rise, direction) in view.iter_mut().zip(DIRECTIONS[quadrant]) {
                    // Facets rise towards a ray below where they fall away from one above.
                    *rise = of[(direction + 4 * side) % 8];
                }
                for stretch in 0..STRETCHES {
                    view[3 + stretch] = high[STRETCHES * side + stretch][quadrant][block];
                }
            }
        }
        Self {
            all,
            level,
            last: size.map(|n| n as u32 - 1),
            views,
            rises,
            heights,
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

    /// The view of a ray from `[x, y]` in the tile in horizontal direction `[dx, dy]`, in the half space of sign `q`.
    #[inline(always)]
    pub(crate) fn view(&self, [x, y]: [f64; 2], [dx, dy]: [f64; 2], q: f64) -> &View {
        let block = |place: f64, last: u32| (place as i32 as u32 >> self.level).min(last);
        let number = block(y, self.last[1]) * (self.last[0] + 1) + block(x, self.last[0]);
        let quadrant = u32::from(dx < 0.0) | u32::from(dy < 0.0) << 1;
        let below = u32::from(q < 0.0);
        &self.views[(8 * number + 2 * quadrant + below) as usize]
    }

    /// Whether a ray that has this view, from the height `z` in direction `[dx, dy, rise]`, meets nothing, all counted
    /// upwards in its half space.
    #[inline(always)]
    pub(crate) fn is_clear(&self, view: &[f64; VIEWED], z: f64, [dx, dy, rise]: [f64; 3]) -> bool {
        let (ux, uy) = (dx.abs(), dy.abs());
        let is_along_x = ux >= uy;
        let (longer, shorter) = if is_along_x { (ux, uy) } else { (uy, ux) };
        let axis = if is_along_x { view[0] } else { view[1] };
        let steepest =
            (longer - shorter) * self.rises.value(axis) + shorter * self.rises.value(view[2]);
        let mut is_clear = rise > steepest;
        // Height won on the way past one block
        let mut won = rise * f64::from(1 << self.level) / longer;
        for steps in &view[3..] {
            is_clear &= z + won > self.heights.value(*steps);
            won *= 2.0;
        }
        is_clear & (z + won > -self.heights.lowest)
    }
}

/// Numbers of the directions of a [`Support`] along x, along y and along the diagonal of each quadrant.
const DIRECTIONS: [[usize; 3]; 4] = [[0, 2, 1], [4, 2, 3], [0, 6, 7], [4, 6, 5]];

/// What blocks have ahead for `count` sides of a block in each quadrant: to greater x and y, to smaller x, to smaller y, to smaller both.
fn in_quadrants<T: Joined>(layout: &Layout, blocks: &[T], count: usize) -> [Vec<T>; 4] {
    let along_x = [false, true].map(|backward| layout.ahead(blocks, 0, backward, count));
    std::array::from_fn(|quadrant| {
        layout.ahead(&along_x[quadrant & 1], 1, quadrant & 2 != 0, count)
    })
}

#[cfg(test)]
mod tests {
    use asperity_surface::HeightField;

    use super::*;
    use crate::geometry::Geometry;
    use crate::geometry::height_field::Surface;

    /// Gentle land with towers and pits of some width here and there, which only heights tell of from afar.
    fn surface([columns, rows]: [usize; 2], border: Border, width: f64) -> Surface {
        let centres: Vec<DVec2> = (0..(columns * rows).div_ceil(900))
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

    /// Rays that begin on the surface, and are as steep as many facets, are followed in small steps.
    #[test]
    fn rays_that_are_clear_meet_nothing_up_to_all_heights() {
        // The last blocks are whole, or not, or one is more than the tile.
        let tiles = [[96, 64], [90, 70], [21, 5], [40, 48]];
        let borders = [Border::Periodic, Border::Mirrored, Border::Open];
        for (number, (cells, border)) in tiles
            .into_iter()
            .flat_map(|cells| borders.map(|border| (cells, border)))
            .enumerate()
        {
            let width = [1.5, 40.0][number % 2];
            let surface = surface(cells, border, width);
            let ahead = surface.ahead();
            let [nx, ny] = surface.extent();
            let [_, reach] = surface.z_range();
            let mut clear = 0;
            for i in 0..30_000 {
                let i = f64::from(i);
                let place = DVec2::new(nx * (i * 0.754_877).fract(), ny * (i * 0.569_840).fract());
                let u = DVec2::from_angle(i * 2.399_963);
                let q = if (i as u32).is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                };
                let z = q * surface.over(place.x, place.y).unwrap().1.z;
                let rise = ahead.steepest_along(q * u) * (i * 0.381_966).fract().powi(3);
                let view = ahead.view([place.x, place.y], [u.x, u.y], q);
                if !ahead.is_clear(&view.map(f64::from), z, [u.x, u.y, rise]) {
                    continue;
                }
                clear += 1;
                let mut t = 0.05;
                while z + t * rise < reach {
                    let height = q * height_at(&surface, place + t * u, q);
                    assert!(
                        height <= z + t * rise + 1e-9,
                        "{cells:?} {border:?} {place} {u} {t}"
                    );
                    t += 0.05;
                }
            }
            // All of the smallest tile is near the spot.
            assert!(clear > 60 || cells[1] < 8, "{cells:?} {border:?}: {clear}");
        }
    }

    #[test]
    fn a_tower_beyond_all_stretches_is_not_overlooked() {
        let [columns, rows] = [2000, 8];
        let heights = (0..columns * rows).map(|i| if i % columns == 1000 { 5.0 } else { 0.0 });
        let field = HeightField::new(heights.collect(), [rows, columns], [1.0; 2]).unwrap();
        let surface = Surface::new(field);
        let is_clear = |rise: f64| {
            let place = [100.0, 4.0];
            let z = surface.over(place[0], place[1]).unwrap().1.z;
            let view = surface.ahead().view(place, [1.0, 0.0], 1.0);
            let view = view.map(f64::from);
            surface.ahead().is_clear(&view, z, [1.0, 0.0, rise])
        };
        assert!(!is_clear(0.005) && is_clear(0.03));
    }
}
