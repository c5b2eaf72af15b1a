//! Many rays at a time: loops over arrays that take vector instructions, with the results of the methods for one ray.
//!
//! Numbers in memory are loaded ray by ray; everything else is computed in lanes, block by block.

use super::extremes::patch_of;
use super::first_root::{Bracket, falls_once};
use super::gaps::{gaps, snapped, without_first};
use super::patch::Patch;
use super::stretch::Stretch;
use super::{DIVIDED, SmoothCell, SmoothSurface};
use crate::ray::{Hit, RayColumns};

/// Rays of a block: a few loads of lanes.
const BLOCK: usize = 16;

/// Patches of a block, coefficient by coefficient.
struct Patches([[f64; BLOCK]; 16]);

impl Patches {
    /// Loads the patches of some cells.
    #[inline(always)]
    fn load(surface: &SmoothSurface, cells: impl Iterator<Item = [u32; 2]>) -> Self {
        let mut patches = [[0.0; BLOCK]; 16];
        for (k, cell) in cells.enumerate().take(BLOCK) {
            let Patch(rows) = patch_of(&surface.spline, cell);
            for (i, height) in rows.as_flattened().iter().enumerate() {
                patches[i][k] = *height;
            }
        }
        for height in patches.as_flattened_mut() {
            *height = (*height - surface.offset) * surface.per_column;
        }
        Self(patches)
    }

    /// The patch of ray `k`.
    #[inline(always)]
    fn get(&self, k: usize) -> Patch {
        let c = &self.0;
        Patch([
            [c[0][k], c[1][k], c[2][k], c[3][k]],
            [c[4][k], c[5][k], c[6][k], c[7][k]],
            [c[8][k], c[9][k], c[10][k], c[11][k]],
            [c[12][k], c[13][k], c[14][k], c[15][k]],
        ])
    }
}

impl SmoothSurface {
    /// [`crate::Geometry::arrive`].
    #[inline(always)]
    pub(super) fn arrive_many(
        &self,
        cells: &[SmoothCell],
        ts: &[f64],
        [x, y, z]: [&mut [f64]; 3],
        [dx, dy, _]: [&[f64]; 3],
        [nx, ny, nz]: [&mut [f64]; 3],
    ) {
        let aspect = self.aspect;
        for first in (0..cells.len()).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(cells.len());
            let cells = &cells[block.clone()];
            let patches = Patches::load(self, cells.iter().map(|cell| [cell.ix, cell.iy]));
            let mut corners = [[0.0; BLOCK]; 2];
            for (k, cell) in cells.iter().enumerate().take(BLOCK) {
                (corners[0][k], corners[1][k]) = (f64::from(cell.ix), f64::from(cell.iy));
            }
            let (ts, dx, dy) = (&ts[block.clone()], &dx[block.clone()], &dy[block.clone()]);
            let [x, y, z] = [&mut *x, &mut *y, &mut *z].map(|column| &mut column[block.clone()]);
            let [nx, ny, nz] =
                [&mut *nx, &mut *ny, &mut *nz].map(|column| &mut column[block.clone()]);
            for k in 0..cells.len().min(BLOCK) {
                let (u, v);
                [x[k], u] = snapped(corners[0][k], x[k] + ts[k] * dx[k]);
                [y[k], v] = snapped(corners[1][k], y[k] + ts[k] * (dy[k] * aspect));
                let [height, along_x, along_y] = patches.get(k).at([u, v]);
                z[k] = height;
                let (mx, my) = (-along_x, -along_y * aspect);
                let scale = 1.0 / (mx * mx + my * my + 1.0).sqrt();
                nx[k] = mx * scale;
                ny[k] = my * scale;
                nz[k] = scale;
            }
        }
    }
}

impl SmoothSurface {
    /// [`crate::geometry::grid::Grid::pass_cells`]: for rays that pass a patch once, coming from above or beginning on it.
    #[inline(always)]
    pub(super) fn pass_cells_many(
        &self,
        rays: RayColumns<'_>,
        met: &[(u32, [u32; 2])],
        hits: &mut [Option<Hit<SmoothCell>>],
    ) {
        for (met, hits) in met.chunks(BLOCK).zip(hits.chunks_mut(BLOCK)) {
            let patches = Patches::load(self, met.iter().map(|met| met.1));
            let mut fields = [[0.0; BLOCK]; 9];
            for (k, &(i, [ix, iy])) in met.iter().enumerate().take(BLOCK) {
                let i = i as usize;
                (fields[7][k], fields[8][k]) = (f64::from(ix), f64::from(iy));
                for axis in 0..3 {
                    fields[axis][k] = rays.origin[axis][i];
                    fields[3 + axis][k] = rays.direction[axis][i];
                }
                fields[6][k] = rays.side[i];
            }

            // The polynomial whose root is wanted, and whether it is certain that there is one
            let [x, y, z, dx, dy, dz, side, column, row] = &fields;
            let mut polynomials = [[0.0; BLOCK]; 7];
            let (mut enters, mut lengths, mut certain) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
            for k in 0..BLOCK {
                let o = [x[k], y[k], z[k]];
                let d = [dx[k], dy[k] * rays.aspect, dz[k]];
                let stretch = Stretch::over([column[k], row[k]], self.reach, o, d);
                let Stretch { enter, leave, .. } = stretch;
                let from_corner = [o[0] - column[k], o[1] - row[k], o[2]];
                let gaps = gaps(&patches.get(k), side[k], from_corner, d, [enter, leave]);
                let noise = self.noise(from_corner);
                let comes = gaps[0] > noise;
                let begins = (gaps[0] >= -noise) & (gaps[1] - gaps[0] > noise);
                let divided = without_first(&gaps);
                let least = if comes { noise } else { DIVIDED * noise };
                let mut b = [0.0; 7];
                for m in 0..7 {
                    b[m] = if comes { gaps[m] } else { divided[m] };
                    polynomials[m][k] = b[m];
                }
                let is_certain = (comes | begins) & falls_once(&b, least) & (enter < leave);
                certain[k] = if is_certain { 1.0 } else { 0.0 };
                enters[k] = enter;
                lengths[k] = leave - enter;
            }
            let roots = roots(&polynomials, &mut certain);
            for (k, (hit, &(_, [ix, iy]))) in hits.iter_mut().zip(met).enumerate() {
                let t = enters[k] + roots[k] * lengths[k];
                let facet = SmoothCell { iy, ix };
                *hit = (certain[k] > 0.0).then_some(Hit { t, facet });
            }
        }
    }
}

/// Roots of polynomials that fall once; those that are not found in a few steps are not `certain`.
#[inline(always)]
fn roots(polynomials: &[[f64; BLOCK]; 7], certain: &mut [f64; BLOCK]) -> [f64; BLOCK] {
    let mut roots = [0.0; BLOCK];
    for k in 0..BLOCK {
        let bracket = Bracket::near_root(&polynomial(polynomials, k));
        roots[k] = bracket.s;
        certain[k] = if bracket.is_narrow() { certain[k] } else { 0.0 };
    }
    roots
}

#[inline(always)]
fn polynomial(polynomials: &[[f64; BLOCK]; 7], k: usize) -> [f64; 7] {
    let p = polynomials;
    [
        p[0][k], p[1][k], p[2][k], p[3][k], p[4][k], p[5][k], p[6][k],
    ]
}

#[cfg(test)]
mod tests {
    use asperity_surface::SplineSurface;
    use asperity_synthesis::{Psd, Synthesis};
    use glam::DVec3;

    use super::*;
    use crate::geometry::Geometry;
    use crate::geometry::grid::Grid;
    use crate::ray::{HalfSpace, Query, RayBatch, TileRay};

    /// Rays that pass cells, from above and from places of the surface: nearly all are told at once, with the same bytes.
    #[test]
    fn many_rays_are_told_what_one_is() {
        let psd = Psd::gaussian(4.0, 4.0).unwrap();
        let synthesis = Synthesis::new(psd, [32, 32], [1.0, 1.25], true).unwrap();
        let field = synthesis.draw(1, 0).unwrap();
        let surface = SmoothSurface::new(SplineSurface::through(&field));
        let (mut queries, mut met) = (Vec::new(), Vec::new());
        for i in 0..20_000_u32 {
            let part = |step: f64| (f64::from(i) * step).fract();
            let turn = std::f64::consts::TAU * part(0.618_034);
            let mut direction = DVec3::new(turn.cos(), turn.sin(), 2.0 * part(0.754_878) - 1.5);
            let place = [32.0 * part(0.569_840), 32.0 * part(0.438_579)];
            let (cell, on) = surface.over(place[0], place[1]).unwrap();
            let lifted = on + DVec3::Z * if i % 2 == 0 { 0.0 } else { part(0.2718) };
            if i % 2 == 0 && direction.dot(surface.normal_at(cell, on)) < 0.0 {
                direction = -direction;
            }
            let ray = TileRay {
                origin: lifted,
                direction,
            };
            let query = Query {
                ray,
                half_space: HalfSpace::Above,
            };
            let cell = [cell.ix, cell.iy];
            if surface
                .intersect_cell(cell, &ray, HalfSpace::Above)
                .is_some()
            {
                met.push((queries.len() as u32, cell));
                queries.push(query);
            }
        }
        let rays: RayBatch = queries.iter().collect();
        let mut hits = vec![None; met.len()];
        surface.pass_cells(rays.columns(), &met, &mut hits);
        let mut told = 0;
        for (hit, &(i, cell)) in hits.iter().zip(&met) {
            if hit.is_some() {
                let Query { ray, half_space } = queries[i as usize];
                assert_eq!(*hit, surface.intersect_cell(cell, &ray, half_space));
                told += 1;
            }
        }
        // Starts that fall pass at once, which is left to one ray at a time.
        assert!(
            told * 2 > met.len() && met.len() > 1000,
            "{told} of {}",
            met.len()
        );

        let (cells, ts): (Vec<SmoothCell>, Vec<f64>) =
            hits.iter().flatten().map(|hit| (hit.facet, hit.t)).unzip();
        let queries: Vec<Query> = hits
            .iter()
            .zip(&queries)
            .filter_map(|(hit, query)| hit.map(|_| *query))
            .collect();
        let column = |of: fn(&Query) -> f64| queries.iter().map(of).collect::<Vec<f64>>();
        let mut origin = [
            column(|q| q.ray.origin.x),
            column(|q| q.ray.origin.y),
            column(|q| q.ray.origin.z),
        ];
        let direction = [
            column(|q| q.ray.direction.x),
            column(|q| q.ray.direction.y),
            column(|q| q.ray.direction.z),
        ];
        let mut normal = origin.clone();
        let scaled: Vec<f64> = direction[1].iter().map(|d| d / surface.aspect()).collect();
        surface.arrive(
            &cells,
            &ts,
            origin.each_mut().map(|column| &mut column[..]),
            [&direction[0], &scaled, &direction[2]],
            normal.each_mut().map(|column| &mut column[..]),
        );
        for (i, query) in queries.iter().enumerate() {
            let mut ray = query.ray;
            ray.direction.y = scaled[i] * surface.aspect();
            let p = surface.snap(cells[i], ray.at(ts[i]));
            let found = DVec3::new(origin[0][i], origin[1][i], origin[2][i]);
            let m = DVec3::new(normal[0][i], normal[1][i], normal[2][i]);
            assert_eq!(found, p, "{i}");
            assert_eq!(m, surface.normal_at(cells[i], p), "{i}");
        }
    }
}
