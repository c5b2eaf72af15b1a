//! Slope bounds: the steepest facets that a ray has ahead, by which it escapes without a search.
//!
//! The gradients of the facets of a block are bounded by their support function: for a horizontal
//! direction u, the steepest rise `max(g . u)`. It is kept in eight directions, axes and diagonals;
//! any other u is `a e + b f` of two neighbouring ones, and `max(g . u) <= a max(g . e) + b max(g . f)`.
//! A ray in direction `(u, d_z)` that rises faster than that comes closer to no facet of the block.

use glam::DVec2;
use rayon::prelude::*;

use asperity_surface::Border;

/// Cells along the side of the smallest blocks.
pub(crate) const SMALLEST: usize = 16;

/// The directions of the support function, `45 deg` apart from +x: axes and diagonals.
const DIRECTIONS: usize = 8;

/// Steepest rise of a set of facets in eight directions, tile coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Support([f64; DIRECTIONS]);

impl Support {
    /// That of no facet.
    const NONE: Self = Self([f64::NEG_INFINITY; DIRECTIONS]);

    /// An upper bound of the steepest rise in the direction and by the length of `u`.
    #[inline]
    pub(crate) fn rise(&self, u: DVec2) -> f64 {
        let (x, y) = (u.x.abs(), u.y.abs());
        let sector = sector([u.x, u.y]);
        let (axis, diagonal) = ((sector & 7) as usize, (sector >> 4) as usize);
        (x - y).abs() * self.0[axis] + x.min(y) * self.0[diagonal]
    }

    /// That of the facets of both.
    fn join(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].max(other.0[k])))
    }

    /// That of the mirror image across x, across y, or both.
    fn mirrored(&self, [x, y]: [bool; 2]) -> Self {
        let mut of = *self;
        if x {
            of = Self([4, 3, 2, 1, 0, 7, 6, 5].map(|k| of.0[k]));
        }
        if y {
            of = Self([0, 7, 6, 5, 4, 3, 2, 1].map(|k| of.0[k]));
        }
        of
    }

    /// Raised by `margin` in every direction.
    fn raised(&self, margin: f64) -> Self {
        Self(self.0.map(|rise| rise + margin))
    }

    /// Least and greatest rise along x, along y, along the diagonal and along the other diagonal.
    pub(crate) fn from_extremes([x, y, diagonal, other]: [[f64; 2]; 4]) -> Self {
        // The other diagonal is (1, -1).
        Self([
            x[1],
            diagonal[1],
            y[1],
            -other[0],
            -x[0],
            -diagonal[0],
            -y[0],
            other[1],
        ])
    }
}

/// Bounds for the whole tile, and for the neighbourhood of every block of it.
#[derive(Clone, Debug)]
pub(crate) struct SlopeBounds {
    all: Support,
    /// For each block that of itself and of the eight around it, beyond the border too; level by level, from the
    /// smallest blocks to the largest, twice as long each time. The first entry is a bound that nothing exceeds.
    around: Vec<Support>,
    /// Where each level is found; of levels that do not exist, the first entry.
    spans: [Span; MAX_LEVELS],
}

/// Levels of blocks, at the most.
const MAX_LEVELS: usize = 32;

/// Blocks of one level: the place of the first, and the numbers of the last along x and y.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    first: u32,
    last: [u32; 2],
}

impl SlopeBounds {
    /// Bounds for a tile of `[columns, rows]` cells of two triangles; `row(i)` are the heights of the grid points of
    /// row i, one more than there are columns.
    pub(crate) fn of_triangles(
        cells: [usize; 2],
        border: Border,
        margin: f64,
        row: impl Fn(usize, &mut Vec<f64>) + Sync,
    ) -> Self {
        let columns = cells[0].div_ceil(SMALLEST);
        Self::new(cells, border, margin, |rows| {
            row_of_blocks(columns, rows, &row)
        })
    }

    /// Bounds for a tile of `[columns, rows]` cells; `supports(rows)` are those of the blocks of [`SMALLEST`] columns in
    /// these rows.
    pub(crate) fn new(
        [cx, cy]: [usize; 2],
        border: Border,
        margin: f64,
        supports: impl Fn(std::ops::Range<usize>) -> Vec<Support> + Sync,
    ) -> Self {
        let columns = cx.div_ceil(SMALLEST);
        let mut blocks: Vec<Support> = (0..cy.div_ceil(SMALLEST))
            .into_par_iter()
            .flat_map_iter(|block_row| {
                supports(block_row * SMALLEST..((block_row + 1) * SMALLEST).min(cy))
            })
            .map(|support| support.raised(margin))
            .collect();
        let mut size = [columns, cy.div_ceil(SMALLEST)];
        let mut side = SMALLEST;
        let mut around = vec![Support([f64::INFINITY; DIRECTIONS])];
        let mut spans = [Span::default(); MAX_LEVELS];
        for span in &mut spans {
            *span = Span {
                first: around.len() as u32,
                last: size.map(|n| n as u32 - 1),
            };
            let whole = [cx, cy].map(|n| n % side == 0);
            around.extend(with_neighbours(&blocks, size, whole, border));
            if size == [1, 1] {
                break;
            }
            (blocks, size) = joined_by_four(&blocks, size);
            side *= 2;
        }
        // Mirror images rise where the tile falls.
        let tile = blocks[0];
        let all = match border {
            Border::Open | Border::Periodic => tile,
            Border::Mirrored => [[true, false], [false, true], [true, true]]
                .into_iter()
                .fold(tile, |all, axes| all.join(&tile.mirrored(axes))),
        };
        Self { all, around, spans }
    }

    /// Where to find the bounds for a ray from `[x, y]` in the tile, of horizontal direction `u`, that goes on by `t`:
    /// the number of its block, and of its sector of directions.
    #[inline(always)]
    pub(crate) fn place_near(&self, [x, y]: [f64; 2], [ux, uy]: [f64; 2], t: f64) -> (u32, u8) {
        // Level: bits of the whole number of smallest blocks that the ray passes, from the exponent
        let longer = if ux.abs() > uy.abs() {
            ux.abs()
        } else {
            uy.abs()
        };
        let blocks = t * longer * (1.0 / SMALLEST as f64);
        let exponent = (blocks.to_bits() >> 52) as i32 - 1022;
        let level = exponent.clamp(0, MAX_LEVELS as i32 - 1) as usize;
        let Span { first, last } = self.spans[level];
        let block = |p: f64, last: u32| ((p as i32 as u32 / SMALLEST as u32) >> level).min(last);
        let number = first + block(y, last[1]) * (last[0] + 1) + block(x, last[0]);
        (if first == 0 { 0 } else { number }, sector([ux, uy]))
    }

    /// Rises that bound those near a block, and those of the whole tile: along the axis and along the diagonal of a
    /// sector. An upper bound for a direction is a sum of these, as in [`Support::rise`].
    #[inline(always)]
    pub(crate) fn rises(&self, block: u32, sector: u8) -> [f64; 4] {
        let near = &self.around[block as usize].0;
        let (axis, diagonal) = ((sector & 7) as usize, (sector >> 4 & 7) as usize);
        [
            near[axis],
            near[diagonal],
            self.all.0[axis],
            self.all.0[diagonal],
        ]
    }

    /// The steepest rise in any of the eight directions.
    pub(crate) fn steepest(&self) -> f64 {
        self.all.0.into_iter().fold(0.0, f64::max)
    }

    /// Whether a ray of horizontal direction `u` that rises by `rise` per unit of `t` is steeper than
    /// every facet.
    #[inline]
    pub(crate) fn is_below_all(&self, u: DVec2, rise: f64) -> bool {
        rise > self.all.rise(u)
    }

    /// Whether such a ray, from `(x, y)` in the tile, is steeper than every facet that it passes
    /// before it has gone on by `t`.
    #[inline]
    pub(crate) fn is_below_near(&self, place: DVec2, u: DVec2, rise: f64, t: f64) -> bool {
        let (block, _) = self.place_near([place.x, place.y], [u.x, u.y], t);
        rise > self.around[block as usize].rise(u)
    }
}

/// Numbers of the axis and of the diagonal between which a horizontal direction lies, in four bits each.
#[inline(always)]
fn sector([x, y]: [f64; 2]) -> u8 {
    // Without branches, since directions come as they like.
    let (left, down) = (u8::from(x < 0.0), u8::from(y < 0.0));
    let axis = if x.abs() >= y.abs() {
        4 * left
    } else {
        2 + 4 * down
    };
    axis | (1 + 2 * (left ^ down) + 4 * down) << 4
}

/// Supports of one row of the smallest blocks, `rows` being its rows of cells.
fn row_of_blocks(
    columns: usize,
    rows: std::ops::Range<usize>,
    row: impl Fn(usize, &mut Vec<f64>),
) -> Vec<Support> {
    let empty = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
    let mut extremes = vec![empty; columns];
    let (mut near, mut far) = (Vec::new(), Vec::new());
    row(rows.start, &mut near);
    for iy in rows {
        row(iy + 1, &mut far);
        for (block, extremes) in extremes.iter_mut().enumerate() {
            let cells = block * SMALLEST..((block + 1) * SMALLEST).min(near.len() - 1);
            let points = cells.start..cells.end + 1;
            widen(extremes, &near[points.clone()], &far[points]);
        }
        std::mem::swap(&mut near, &mut far);
    }
    extremes.into_iter().map(Support::from_extremes).collect()
}

/// Takes a row of cells into the extremes; `near` and `far` are the grid points at its edges.
fn widen(extremes: &mut [[f64; 2]; 4], near: &[f64], far: &[f64]) {
    // Two lanes, so that each extreme is one vector.
    let mut lanes = [extremes.map(|[least, greatest]| ([least; 2], [greatest; 2]))];
    let [lanes] = &mut lanes;
    let cells = near.windows(3).zip(far.windows(3));
    for (a, b) in cells.step_by(2) {
        for lane in 0..2 {
            let rises = rises([a[lane], a[lane + 1], b[lane], b[lane + 1]]);
            for ((least_one, greatest_one), [x, y]) in lanes.iter_mut().zip(rises) {
                least_one[lane] = least(least_one[lane], least(x, y));
                greatest_one[lane] = greatest(greatest_one[lane], greatest(x, y));
            }
        }
    }
    let last = near.len() - 2;
    let rest = rises([near[last], near[last + 1], far[last], far[last + 1]]);
    for ((extreme, (low, high)), [x, y]) in extremes.iter_mut().zip(lanes).zip(rest) {
        extreme[0] = least(least(low[0], low[1]), least(x, y));
        extreme[1] = greatest(greatest(high[0], high[1]), greatest(x, y));
    }
}

/// Rises of both triangles of a cell along x, y, the diagonal and the other diagonal: of the lower
/// one, whose gradient is `(h10 - h00, h11 - h10)`, and of the upper one.
#[inline(always)]
fn rises([h00, h10, h01, h11]: [f64; 4]) -> [[f64; 2]; 4] {
    let (lower_x, lower_y) = (h10 - h00, h11 - h10);
    let (upper_x, upper_y) = (h11 - h01, h01 - h00);
    [
        [lower_x, upper_x],
        [upper_y, lower_y],
        [h11 - h00, h11 - h00],
        [lower_x - lower_y, upper_x - upper_y],
    ]
}

/// One comparison, where `f64::min` takes care of a NaN.
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// As [`least`].
fn greatest(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Blocks of twice the side.
fn joined_by_four(blocks: &[Support], [nx, ny]: [usize; 2]) -> (Vec<Support>, [usize; 2]) {
    let size = [nx.div_ceil(2), ny.div_ceil(2)];
    let joined = (0..size[1])
        .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
        .map(|(x, y)| {
            let mut of = Support::NONE;
            for j in 2 * y..(2 * y + 2).min(ny) {
                for i in 2 * x..(2 * x + 2).min(nx) {
                    of = of.join(&blocks[j * nx + i]);
                }
            }
            of
        })
        .collect();
    (joined, size)
}

/// Each block joined with the eight around it, beyond the border as the border says.
///
/// Where the last block of an axis is not `whole`, what lies a block's side away may be in the next
/// but one, and in the one after that if the last block is followed by its own image.
fn with_neighbours(
    blocks: &[Support],
    [nx, ny]: [usize; 2],
    whole: [bool; 2],
    border: Border,
) -> Vec<Support> {
    // Along x, then along y.
    let along = |i: isize, n: usize| -> Option<(usize, bool)> {
        let n = n as isize;
        match border {
            Border::Open => (0..n).contains(&i).then_some((i as usize, false)),
            Border::Periodic => Some((i.rem_euclid(n) as usize, false)),
            Border::Mirrored => {
                let i = i.rem_euclid(2 * n);
                Some(if i < n {
                    (i as usize, false)
                } else {
                    ((2 * n - 1 - i) as usize, true)
                })
            }
        }
    };
    let far = whole.map(|whole| match border {
        _ if whole => 1,
        Border::Open | Border::Periodic => 2,
        Border::Mirrored => 3,
    });
    let gather = |from: &[Support], axis: usize| -> Vec<Support> {
        (0..nx * ny)
            .map(|index| {
                let at = [index % nx, index / nx];
                let n = [nx, ny][axis];
                let mut of = Support::NONE;
                for step in -far[axis]..=far[axis] {
                    let Some((i, mirrored)) = along(at[axis] as isize + step, n) else {
                        continue;
                    };
                    let mut place = at;
                    place[axis] = i;
                    let flip = [mirrored && axis == 0, mirrored && axis == 1];
                    of = of.join(&from[place[1] * nx + place[0]].mirrored(flip));
                }
                of
            })
            .collect()
    };
    gather(&gather(blocks, 0), 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights that look random, of a tile of `[columns, rows]` cells that repeats.
    fn row(cells: [usize; 2]) -> impl Fn(usize, &mut Vec<f64>) + Sync {
        move |iy, out| {
            out.clear();
            out.extend((0..=cells[0]).map(|ix| {
                let i = (ix % cells[0]) + (iy % cells[1]) * cells[0];
                // Gentle but for a steep spot near the corner of the tile, so that blocks differ.
                let steep = ix % cells[0] < 4 && iy % cells[1] < 4;
                ((i as f64 * 0.618_034).fract() - 0.5) * if steep { 3.0 } else { 0.1 }
            }));
        }
    }

    fn gradients([cx, cy]: [usize; 2]) -> Vec<([usize; 2], [f64; 2])> {
        let heights = row([cx, cy]);
        let mut all = Vec::new();
        let (mut near, mut far) = (Vec::new(), Vec::new());
        for iy in 0..cy {
            heights(iy, &mut near);
            heights(iy + 1, &mut far);
            for ix in 0..cx {
                let (h00, h10, h01, h11) = (near[ix], near[ix + 1], far[ix], far[ix + 1]);
                all.push(([ix, iy], [h10 - h00, h11 - h10]));
                all.push(([ix, iy], [h11 - h01, h01 - h00]));
            }
        }
        all
    }

    #[test]
    fn the_bound_holds_for_every_facet_and_is_met_in_the_eight_directions() {
        let cells = [37, 50];
        let slope_bounds = SlopeBounds::of_triangles(cells, Border::Periodic, 0.0, row(cells));
        for k in 0..64 {
            let u = DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 64.0);
            let steepest = gradients(cells)
                .iter()
                .map(|(_, [x, y])| x * u.x + y * u.y)
                .fold(f64::NEG_INFINITY, f64::max);
            let bound = slope_bounds.all.rise(u);
            assert!(bound >= steepest - 1e-12, "{k}: {bound} {steepest}");
            if k % 8 == 0 {
                assert!((bound - steepest).abs() < 1e-12, "{k}: {bound} {steepest}");
            }
        }
    }

    #[test]
    fn the_bound_nearby_holds_for_every_facet_within_reach() {
        // Of 90 x 70 cells the last blocks are not whole, of 96 x 64 all are.
        let tiles = [[90, 70], [96, 64]];
        let borders = [Border::Periodic, Border::Mirrored, Border::Open];
        for (cells, border) in tiles.iter().flat_map(|&c| borders.map(|b| (c, b))) {
            let [nx, ny] = cells.map(|n| n as f64);
            let slope_bounds = SlopeBounds::of_triangles(cells, border, 0.0, row(cells));
            let all = gradients(cells);
            for i in 0..300 {
                let i = f64::from(i);
                let place = DVec2::new(nx * (i * 0.754_877).fract(), ny * (i * 0.569_840).fract());
                let u = DVec2::from_angle(i * 2.399_963);
                let t = 60.0 * (i * 0.381_966).fract();
                // The steepest facet that the ray passes, found by walking along it.
                let mut steepest = f64::NEG_INFINITY;
                let steps = (t * 50.0) as usize;
                for step in 0..=steps {
                    let p = place + u * (t * step as f64 / steps.max(1) as f64);
                    let fold = |p: f64, n: f64| match border {
                        Border::Periodic => Some((p.rem_euclid(n), 1.0)),
                        Border::Open => (0.0..n).contains(&p).then_some((p, 1.0)),
                        Border::Mirrored => {
                            let p = p.rem_euclid(2.0 * n);
                            Some(if p < n { (p, 1.0) } else { (2.0 * n - p, -1.0) })
                        }
                    };
                    let (Some((x, sx)), Some((y, sy))) = (fold(p.x, nx), fold(p.y, ny)) else {
                        continue;
                    };
                    let cell = [x.min(nx - 1.0) as usize, y.min(ny - 1.0) as usize];
                    let first = 2 * (cell[1] * cells[0] + cell[0]);
                    for (_, g) in &all[first..first + 2] {
                        steepest = steepest.max(g[0] * sx * u.x + g[1] * sy * u.y);
                    }
                }
                if steepest.is_finite() {
                    let rise = steepest - 1e-9;
                    assert!(
                        !slope_bounds.is_below_near(place, u, rise, t),
                        "{border:?} {place} {u} {t} {steepest}"
                    );
                }
            }
            // And it excludes something: a ray steeper than all facets escapes.
            assert!(slope_bounds.is_below_near(DVec2::ONE, DVec2::X, 10.0, 5.0));
        }
    }
}
