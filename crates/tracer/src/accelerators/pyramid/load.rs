//! Load: brings rays from f64 into the f32 columns of the wide search, block by block.

use super::bounds::Bounds;
use super::cells::SearchedGrid;
use super::rays::{Rays, Tile};
use crate::ray::RayColumns;
use crate::vector::Stage;

/// Rays of a block.
const BLOCK: usize = 64;

/// Loads the `rays` whose numbers are in `which`; the place of a ray is its index there. Rays that are doubtful from the
/// start get their answers at once.
pub(super) struct Load<'a, S> {
    pub(super) surface: &'a S,
    pub(super) bounds: &'a Bounds,
    pub(super) rays: RayColumns<'a>,
    pub(super) which: &'a [u32],
    pub(super) into: &'a mut Rays,
}

impl<S: SearchedGrid> Stage for Load<'_, S> {
    #[inline(always)]
    fn run(self) {
        let tile = Tile::new(self.surface, self.surface.diagonals());
        self.into.begin(self.which.len());
        for (k, which) in self.which.chunks(BLOCK).enumerate() {
            let first = k * BLOCK;
            let from = self.into.len();
            if !load_block(&tile, self.rays, which, first, self.into) {
                load_one_by_one(&tile, self.rays, which, first, self.into);
            }
            for cell in self.into.cells(from) {
                self.bounds.prefetch(cell);
            }
        }
    }
}

/// Loads a block of rays, unless one of them begins outside of the tile or is doubtful.
#[inline(always)]
fn load_block(
    tile: &Tile,
    rays: RayColumns<'_>,
    which: &[u32],
    first: usize,
    into: &mut Rays,
) -> bool {
    let n = which.len().min(BLOCK);
    // Gather
    let mut fields = [[0.0; BLOCK]; 7];
    for (k, &i) in which.iter().enumerate().take(BLOCK) {
        let i = i as usize;
        for axis in 0..3 {
            fields[axis][k] = rays.origin[axis][i];
            fields[3 + axis][k] = rays.direction[axis][i];
        }
        fields[6][k] = rays.side[i];
    }

    // Convert in lanes
    let [x, y, z, dx, dy, dz, side] = &fields;
    let (floats, [columns, rows, places]) = into.next(n);
    let [fx, fy, fz, fdx, fdy, fdz, inverse_dx, inverse_dy, fside] = floats;
    let mut are_sure = true;
    for k in 0..n {
        let origin = [x[k], y[k], z[k]];
        let direction = [dx[k], dy[k] * rays.aspect, dz[k]];
        let (ray, is_sure) = tile.load(origin, direction, side[k]);
        are_sure &= is_sure & tile.contains(origin);
        fx[k] = ray.x;
        fy[k] = ray.y;
        fz[k] = ray.z;
        fdx[k] = ray.dx;
        fdy[k] = ray.dy;
        fdz[k] = ray.dz;
        inverse_dx[k] = ray.inverse_dx;
        inverse_dy[k] = ray.inverse_dy;
        fside[k] = ray.side;
        columns[k] = ray.cell[0];
        rows[k] = ray.cell[1];
        places[k] = (first + k) as i32;
    }
    if !are_sure {
        into.take_back(n);
    }
    are_sure
}

/// Loads rays one by one, from where they enter the tile.
#[inline(never)]
fn load_one_by_one(
    tile: &Tile,
    rays: RayColumns<'_>,
    which: &[u32],
    first: usize,
    into: &mut Rays,
) {
    for (place, &i) in (first as i32..).zip(which) {
        let query = rays.query(i as usize);
        let origin = query.ray.origin.to_array();
        let direction = query.ray.direction.to_array();
        if tile.contains(origin) {
            match tile.load(origin, direction, query.half_space.sign()) {
                (ray, true) => into.add(&ray, place),
                _ => into.add_doubtful(place),
            }
        } else {
            into.add_entering(&query, tile, place);
        }
    }
}
