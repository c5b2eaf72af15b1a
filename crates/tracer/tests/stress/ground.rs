//! Where the surface is, and whether a stretch of a ray stays on its side of it: independent of how
//! rays are traced.

use asperity_surface::Border;
use asperity_tracer::{Geometry, HalfSpace, Surface, TileRay};

/// The surface as a function of place, in tile coordinates continued beyond the tile.
pub(crate) struct Ground<'a> {
    surface: &'a Surface,
    cells: [i64; 2],
    border: Border,
    height_range: f64,
}

/// Where a ray is on the wrong side of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Breach {
    /// Ray parameter.
    pub(crate) t: f64,
    /// How deep, vertically.
    pub(crate) depth: f64,
    /// What rounding explains.
    pub(crate) tolerance: f64,
}

/// A cell, anywhere, and the heights of its corners `[00, 10, 01, 11]` along its own axes; those of a
/// mirrored cell run backwards.
struct Cell {
    flip: [bool; 2],
    corners: [f64; 4],
}

impl Cell {
    /// Height at `(u, v)` of the cell, unflipped: linear on either side of the diagonal.
    fn height(&self, u: f64, v: f64) -> f64 {
        let local = |x: f64, flip: bool| {
            let x = x.clamp(0.0, 1.0);
            if flip { 1.0 - x } else { x }
        };
        let (u, v) = (local(u, self.flip[0]), local(v, self.flip[1]));
        let [z00, z10, z01, z11] = self.corners;
        if u >= v {
            z00 + (z10 - z00) * u + (z11 - z10) * v
        } else {
            z00 + (z11 - z01) * u + (z01 - z00) * v
        }
    }
}

impl<'a> Ground<'a> {
    pub(crate) fn new(surface: &'a Surface) -> Self {
        let [low, high] = surface.z_range();
        Self {
            surface,
            cells: surface.cells().map(|n| n as i64),
            border: surface.border(),
            height_range: high - low,
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
        let z = |i: i64, j: i64| self.surface.z((own[0] + i) as usize, (own[1] + j) as usize);
        let corners = [z(0, 0), z(1, 0), z(0, 1), z(1, 1)];
        Some(Cell { flip, corners })
    }

    /// Height at a place of the tile, its borders included.
    pub(crate) fn height_in_tile(&self, x: f64, y: f64) -> f64 {
        let column = |x: f64, n: i64| (x.floor() as i64).clamp(0, n - 1);
        let (ix, iy) = (column(x, self.cells[0]), column(y, self.cells[1]));
        self.cell(ix, iy)
            .map_or(0.0, |cell| cell.height(x - ix as f64, y - iy as f64))
    }

    /// What rounding explains of a depth at parameter `t`, in column `ix` and row `iy`.
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
                for z in cell.corners {
                    (low, high) = (low.min(z), high.max(z));
                }
            }
        }
        let steep = 1.0 + (high - low).max(0.0);
        let size = |p: glam::DVec3| p.abs().element_sum();
        let reach = 1.0 + size(ray.origin) + t.abs() * size(ray.direction);
        64.0 * 0.5 * f64::EPSILON * (steep * reach + self.height_range)
    }

    /// The same at a place of the tile.
    pub(crate) fn tolerance_in_tile(&self, ray: &TileRay, t: f64) -> f64 {
        let at = ray.at(t);
        self.tolerance([at.x.floor() as i64, at.y.floor() as i64], ray, t)
    }

    /// How far the point at `t` is from the surface, vertically, if rounding does not explain it.
    pub(crate) fn off_surface(&self, ray: &TileRay, t: f64) -> Option<f64> {
        let p = ray.at(t);
        let place = [p.x.floor() as i64, p.y.floor() as i64];
        // Outside an open patch by rounding, the nearest cell counts.
        let place = match self.border {
            Border::Open => [0, 1].map(|axis| place[axis].clamp(0, self.cells[axis] - 1)),
            Border::Periodic | Border::Mirrored => place,
        };
        let cell = self.cell(place[0], place[1])?;
        let height = cell.height(p.x - place[0] as f64, p.y - place[1] as f64);
        let distance = (p.z - height).abs();
        (distance > self.tolerance(place, ray, t)).then_some(distance)
    }

    /// First place in `[from, to]` where a ray in `half_space` is on the wrong side by more than rounding.
    ///
    /// Between the lines where it crosses columns, rows and diagonals, the height of the ray above
    /// the surface is linear; so it is enough to test all of these.
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
                let diagonal = diagonal_crossing(ray, corner, cell.flip).clamp(t, leave);
                for t in [t, diagonal, leave] {
                    if !t.is_finite() {
                        continue;
                    }
                    let p = ray.at(t);
                    let h = cell.height(p.x - corner[0], p.y - corner[1]);
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

/// Parameter at which a ray crosses the diagonal of the cell at `corner`; anything if it never does.
fn diagonal_crossing(ray: &TileRay, [x, y]: [f64; 2], flip: [bool; 2]) -> f64 {
    let (u, v) = (ray.origin.x - x, ray.origin.y - y);
    let (du, dv) = (ray.direction.x, ray.direction.y);
    let t = if flip[0] == flip[1] {
        (v - u) / (du - dv)
    } else {
        (1.0 - u - v) / (du + dv)
    };
    if t.is_nan() { 0.0 } else { t }
}
