//! Ground: the height of the surface, and a check that a stretch of a ray stays on its side of it, independent of how
//! rays are traced.

use asperity_surface::Border;
use asperity_tracer::{Geometry, HalfSpace, TileRay};

use crate::stressed::Stressed;

/// The surface as a function of place, in tile coordinates continued beyond the tile.
pub(crate) struct Ground<'a, G> {
    surface: &'a G,
    /// z where [`Stressed::plain_height`] is zero.
    datum: f64,
    cells: [i64; 2],
    border: Border,
    height_range: f64,
    /// `true` if rays continue from tile to tile.
    crosses_tiles: bool,
}

/// Point at which a ray is on the wrong side of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Breach {
    /// Ray parameter.
    pub(crate) t: f64,
    /// Vertical depth.
    pub(crate) depth: f64,
    /// Depth that rounding explains.
    pub(crate) tolerance: f64,
}

/// A cell, anywhere: the cell of the tile that it repeats, and whether that runs backwards, being mirrored.
struct Cell {
    flip: [bool; 2],
    own: [usize; 2],
}

impl<'a, G: Stressed> Ground<'a, G> {
    pub(crate) fn new(surface: &'a G) -> Self {
        let [low, high] = surface.z_range();
        let first = surface.over(0.0, 0.0).map_or(0.0, |(_, p)| p.z);
        Self {
            surface,
            datum: first - surface.plain_height([0, 0], [0.0; 2]),
            cells: surface.extent().map(|n| n as i64),
            border: surface.border(),
            height_range: high - low,
            crosses_tiles: false,
        }
    }

    /// Ground for rays that continue from tile to tile.
    pub(crate) fn across_tiles(surface: &'a G) -> Self {
        Self {
            crosses_tiles: true,
            ..Self::new(surface)
        }
    }

    /// The cell in column `ix` and row `iy`, or `None` outside an open patch.
    fn cell(&self, ix: i64, iy: i64) -> Option<Cell> {
        let mut flip = [false; 2];
        let mut own = [0_i64; 2];
        for (axis, i) in [ix, iy].into_iter().enumerate() {
            let n = self.cells[axis];
            let inner = i.rem_euclid(n);
            own[axis] = match self.border {
                Border::Open if i != inner => return None,
                Border::Mirrored if i.div_euclid(n) % 2 != 0 => {
                    flip[axis] = true;
                    n - 1 - inner
                }
                _ => inner,
            };
        }
        let own = own.map(|i| i as usize);
        Some(Cell { flip, own })
    }

    /// Height at `(u, v)` of a cell, unflipped.
    fn height(&self, cell: &Cell, u: f64, v: f64) -> f64 {
        let local = |x: f64, flip: bool| {
            let x = x.clamp(0.0, 1.0);
            if flip { 1.0 - x } else { x }
        };
        let place = [local(u, cell.flip[0]), local(v, cell.flip[1])];
        self.surface.plain_height(cell.own, place) + self.datum
    }

    /// Height at a place of the tile, its borders included.
    pub(crate) fn height_in_tile(&self, x: f64, y: f64) -> f64 {
        let column = |x: f64, n: i64| (x.floor() as i64).clamp(0, n - 1);
        let (ix, iy) = (column(x, self.cells[0]), column(y, self.cells[1]));
        self.cell(ix, iy)
            .map_or(0.0, |cell| self.height(&cell, x - ix as f64, y - iy as f64))
    }

    /// Depth that rounding explains at parameter `t`, in column `ix` and row `iy`.
    ///
    /// A coordinate of the point at `t` is the rounded sum of an origin, itself moved by whole tiles
    /// (2 eps), and a product (1 eps), both here and where the ray was traced: 6 eps of
    /// `|o| + t |d|`. Heights change by at most the largest slope around times that. A plane's height
    /// takes three sums and two products of such numbers, the height above it one more: 6 eps of
    /// `slope (|o| + t |d|)` and of the heights. Twice over, here and there, below 32; doubled.
    fn tolerance(&self, [ix, iy]: [i64; 2], ray: &TileRay, t: f64) -> f64 {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, j) in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (i, j))) {
            if let Some(cell) = self.cell(ix + i, iy + j) {
                let [cell_low, cell_high] = self.surface.heights_of(cell.own);
                (low, high) = (low.min(cell_low), high.max(cell_high));
            }
        }
        let steep = 1.0 + (high - low).max(0.0);
        let size = |p: glam::DVec3| p.abs().element_sum();
        let reach = 1.0 + size(ray.origin) + t.abs() * size(ray.direction);
        let place = 32.0 * f64::EPSILON * reach;
        let late =
            self.lateness(ray, t, place) * (ray.direction.z.abs() + steep * speed_across(ray));
        place * steep + late + 0.5 * f64::EPSILON * G::ROUNDING * self.height_range
    }

    /// By how much of its parameter a ray may be late in the next tile.
    ///
    /// It is moved by whole tiles, so its place there is off by rounding, `place`, and it crosses the border by that over its
    /// rate across the border early or late. This counts where it is that near to a border.
    fn lateness(&self, ray: &TileRay, t: f64, place: f64) -> f64 {
        let late = |axis: usize| {
            let (p, size) = (ray.at(t)[axis], self.cells[axis] as f64);
            let is_near = (p - (p / size).round() * size).abs() <= place;
            let rate = ray.direction[axis].abs();
            if self.crosses_tiles && is_near && rate > 0.0 {
                place / rate
            } else {
                0.0
            }
        };
        late(0).max(late(1))
    }

    /// Depth that rounding explains at a point of the tile.
    pub(crate) fn tolerance_in_tile(&self, ray: &TileRay, t: f64) -> f64 {
        let at = ray.at(t);
        let cell = [at.x.floor() as i64, at.y.floor() as i64];
        // At the border, the cell on either side of it: whichever allows for less.
        let inside = [0, 1].map(|axis| cell[axis].clamp(0, self.cells[axis] - 1));
        let [near, own] = [cell, inside].map(|cell| self.tolerance(cell, ray, t));
        near.min(own)
    }

    /// Vertical distance of the point at `t` from the surface, if rounding does not explain it.
    pub(crate) fn off_surface(&self, ray: &TileRay, t: f64) -> Option<f64> {
        let p = ray.at(t);
        let place = [p.x.floor() as i64, p.y.floor() as i64];
        // Outside an open patch by rounding, the nearest cell counts.
        let place = match self.border {
            Border::Open => [0, 1].map(|axis| place[axis].clamp(0, self.cells[axis] - 1)),
            Border::Periodic | Border::Mirrored => place,
        };
        let cell = self.cell(place[0], place[1])?;
        let height = self.height(&cell, p.x - place[0] as f64, p.y - place[1] as f64);
        let distance = (p.z - height).abs();
        (distance > self.tolerance(place, ray, t)).then_some(distance)
    }

    /// First place in `[from, to]` where a ray in `half_space` is on the wrong side by more than rounding.
    ///
    /// Between the lines where it crosses columns and rows, it is tested at the marks of each cell.
    pub(crate) fn breach(
        &self,
        ray: &TileRay,
        half_space: HalfSpace,
        [from, to]: [f64; 2],
    ) -> Option<Breach> {
        let at = ray.at(from);
        let mut place = [at.x.floor() as i64, at.y.floor() as i64];
        let mut t = from;
        loop {
            let next = [0, 1].map(|axis| {
                let rate = ray.direction[axis];
                let line = place[axis] as f64 + if rate > 0.0 { 1.0 } else { 0.0 };
                if rate == 0.0 {
                    f64::INFINITY
                } else {
                    (line - ray.origin[axis]) / rate
                }
            });
            let axis = usize::from(next[1] < next[0]);
            let leave = next[axis].clamp(t, to.max(t));
            if let Some(cell) = self.cell(place[0], place[1]) {
                let corner = place.map(|i| i as f64);
                for t in G::marks(ray, corner, cell.flip, [t, leave]) {
                    if !t.is_finite() {
                        continue;
                    }
                    let p = ray.at(t);
                    let h = self.height(&cell, p.x - corner[0], p.y - corner[1]);
                    let depth = half_space.sign() * (h - p.z);
                    if depth > 0.0 {
                        let tolerance = self.tolerance(place, ray, t);
                        if depth > tolerance {
                            return Some(Breach {
                                t,
                                depth,
                                tolerance,
                            });
                        }
                    }
                }
            }
            if next[axis] >= to {
                return None;
            }
            t = leave;
            place[axis] += if ray.direction[axis] > 0.0 { 1 } else { -1 };
        }
    }
}

/// Speed of a ray across columns and rows.
fn speed_across(ray: &TileRay) -> f64 {
    ray.direction.x.abs() + ray.direction.y.abs()
}

/// The part of a ray over the tile, up to `slab` above and below z = 0; `None` where it passes that box by.
pub(crate) fn over_box<G: Geometry>(surface: &G, ray: &TileRay, slab: f64) -> Option<[f64; 2]> {
    let [cx, cy] = surface.extent();
    let (mut start, mut end) = (0.0_f64, f64::INFINITY);
    for (axis, [low, high]) in [[0.0, cx], [0.0, cy], [-slab, slab]]
        .into_iter()
        .enumerate()
    {
        let (o, d) = (ray.origin[axis], ray.direction[axis]);
        if d == 0.0 {
            if !(low..=high).contains(&o) {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - o) / d, (high - o) / d);
        (start, end) = (start.max(a.min(b)), end.min(a.max(b)));
    }
    (start <= end).then_some([start, end])
}
