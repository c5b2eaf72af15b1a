//! Many rays at a time: loops over arrays that take vector instructions, with the results of the methods for one ray.
//!
//! Numbers in memory are loaded ray by ray; everything else is computed in lanes, block by block.

use asperity_surface::Triangle;
use glam::DVec3;

use super::{Facet, Scale, Surface};
use crate::geometry::grid::Grid;
use crate::geometry::{Geometry, Triangles};
use crate::ray::{Hit, RayColumns};

/// Rays of a block: a few loads of lanes.
const BLOCK: usize = 64;

impl Surface {
    /// [`crate::Geometry::arrive`].
    #[inline(always)]
    pub(super) fn arrive_many(
        &self,
        facets: &[Facet],
        ts: &[f64],
        [x, y, z]: [&mut [f64]; 3],
        [dx, dy, dz]: [&[f64]; 3],
        [nx, ny, nz]: [&mut [f64]; 3],
    ) {
        let n = facets.len();
        // Facets of turned cells one by one
        let arrive_alone = |(i, facet): (usize, &Facet)| {
            let d = DVec3::new(dx[i], dy[i] * self.aspect, dz[i]);
            let p = self.snap(*facet, DVec3::new(x[i], y[i], z[i]) + ts[i] * d);
            (i, p, self.normal(*facet))
        };
        let turned: Vec<(usize, DVec3, DVec3)> = match self.field.turned_cells() {
            Some(_) => {
                let facets = facets.iter().enumerate();
                let is_turned = |f: &Facet| self.field.is_turned(f.ix as usize, f.iy as usize);
                facets
                    .filter(|(_, f)| is_turned(f))
                    .map(arrive_alone)
                    .collect()
            }
            None => Vec::new(),
        };
        let (ts, x, y, z) = (&ts[..n], &mut x[..n], &mut y[..n], &mut z[..n]);
        let (dx, dy) = (&dx[..n], &dy[..n]);
        let (nx, ny, nz) = (&mut nx[..n], &mut ny[..n], &mut nz[..n]);
        let aspect = self.aspect;
        let Scale { per_column, offset } = self.scale;
        let scaled = |height: f64| (height - offset) * per_column;
        for first in (0..n).step_by(BLOCK) {
            let last = (first + BLOCK).min(n);
            // Load the heights between which the two slopes of a facet lie: from the corner 00 along a
            // column, along a row
            let mut cells = [[0.0; BLOCK]; 7];
            for (k, i) in (first..last).enumerate() {
                let (z00, column, row) = self.slope_heights(facets[i]);
                cells[0][k] = z00;
                (cells[1][k], cells[2][k]) = (column[0], column[1]);
                (cells[3][k], cells[4][k]) = (row[0], row[1]);
                (cells[5][k], cells[6][k]) = (f64::from(facets[i].ix), f64::from(facets[i].iy));
            }
            // Move to the facet, into its cell and onto its plane; its gradient gives the normal
            for (k, i) in (first..last).enumerate() {
                let (ix, iy) = (cells[5][k], cells[6][k]);
                let u = unit_interval(x[i] + ts[i] * dx[i] - ix);
                let v = unit_interval(y[i] + ts[i] * (dy[i] * aspect) - iy);
                let z00 = scaled(cells[0][k]);
                let along_column = scaled(cells[1][k]) - scaled(cells[2][k]);
                let along_row = scaled(cells[3][k]) - scaled(cells[4][k]);
                x[i] = ix + u;
                y[i] = iy + v;
                z[i] = z00 + along_column * u + along_row * v;
                let (mx, my) = (-along_column, -along_row * aspect);
                let scale = 1.0 / (mx * mx + my * my + 1.0).sqrt();
                nx[i] = mx * scale;
                ny[i] = my * scale;
                nz[i] = scale;
            }
        }
        for (i, p, m) in turned {
            [x[i], y[i], z[i]] = p.to_array();
            [nx[i], ny[i], nz[i]] = m.to_array();
        }
    }
}

/// Least distance from its edges, in columns, at which a facet is certainly passed: far more than rounding in f64 can
/// move a ray.
const EDGE: f64 = 1e-7;

/// Codes of what a ray passes.
const LOWER: u64 = 0;
const UPPER: u64 = 1;
const UNSURE: u64 = 2;

impl Surface {
    /// [`Surface::pass_cells`].
    #[inline(always)]
    pub(super) fn pass_cells_many(
        &self,
        rays: RayColumns<'_>,
        met: &[(u32, [u32; 2])],
        hits: &mut [Option<Hit<Facet>>],
    ) {
        let Scale { per_column, offset } = self.scale;
        let scaled = |height: f64| (height - offset) * per_column;
        for (met, hits) in met.chunks(BLOCK).zip(hits.chunks_mut(BLOCK)) {
            // Load rays, from the corner 00 of their cells, and the heights of these
            let mut fields = [[0.0; BLOCK]; 7];
            let mut heights = [[0.0; BLOCK]; 4];
            for (k, &(i, cell)) in met.iter().enumerate() {
                let i = i as usize;
                fields[0][k] = rays.origin[0][i] - f64::from(cell[0]);
                fields[1][k] = rays.origin[1][i] - f64::from(cell[1]);
                fields[2][k] = rays.origin[2][i];
                for axis in 0..3 {
                    fields[3 + axis][k] = rays.direction[axis][i];
                }
                fields[6][k] = rays.side[i];
                let corners = self.corner_heights(cell);
                for (heights, height) in heights.iter_mut().zip(corners) {
                    heights[k] = height;
                }
            }
            // Pass both facets, as in `Cell::intersect`, and keep what is certain
            let ([x, y, z, dx, dy, dz, q], [h00, h10, h01, h11]) = (&fields, &heights);
            let (mut ts, mut codes) = ([0.0; BLOCK], [UNSURE; BLOCK]);
            for k in 0..met.len().min(BLOCK) {
                let [z00, z10, z01, z11] = [h00[k], h10[k], h01[k], h11[k]].map(scaled);
                let (x, y, dx, dy) = (x[k], y[k], dx[k], dy[k] * rays.aspect);
                let pass = |per_column: f64, per_row: f64, is_lower: bool| {
                    let g = z[k] - z00 - per_column * x - per_row * y;
                    let g_rate = dz[k] - per_column * dx - per_row * dy;
                    let t = -g / g_rate;
                    let (u, v) = (x + t * dx, y + t * dy);
                    // The three sides of the footprint
                    let (low, high) = if is_lower { (v, u) } else { (u, v) };
                    let within = least(least(1.0 - high, low), high - low);
                    let falls = q[k] * g_rate < 0.0;
                    let inside = falls & (within > EDGE) & (t > 0.0);
                    let near = falls & (within > -EDGE) & (t > -EDGE);
                    (t, inside, near)
                };
                let (t_lower, in_lower, near_lower) = pass(z10 - z00, z11 - z10, true);
                let (t_upper, in_upper, near_upper) = pass(z11 - z01, z01 - z00, false);
                let lower = in_lower & (!near_upper | (in_upper & (t_lower <= t_upper)));
                let upper = in_upper & (!near_lower | (in_lower & (t_upper < t_lower)));
                ts[k] = if lower { t_lower } else { t_upper };
                let code = if upper { UPPER } else { UNSURE };
                codes[k] = if lower { LOWER } else { code };
            }
            for (k, (hit, &(i, [ix, iy]))) in hits.iter_mut().zip(met).enumerate() {
                if self.field.is_turned(ix as usize, iy as usize) {
                    let query = rays.query(i as usize);
                    *hit = self.intersect_cell([ix, iy], &query.ray, query.half_space);
                    continue;
                }
                let triangle = if codes[k] == LOWER {
                    Triangle::Lower
                } else {
                    Triangle::Upper
                };
                let facet = Facet { iy, ix, triangle };
                *hit = (codes[k] != UNSURE).then_some(Hit { t: ts[k], facet });
            }
        }
    }
}

/// The smaller one.
#[inline(always)]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The nearest number in `[0, 1]`.
#[inline(always)]
fn unit_interval(x: f64) -> f64 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < 1.0 { x } else { 1.0 }
}
