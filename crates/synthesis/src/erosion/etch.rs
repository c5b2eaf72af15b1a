//! Isotropic etching: all material within a depth of the surface is removed.
//!
//! An etchant that attacks at the same rate in all directions moves each point of the surface along its normal. By Huygens'
//! construction the new surface is the envelope of spheres of the etched depth about the points of the old one:
//! `h'(x) = min over |q| <= depth of h(x + q) - sqrt(depth^2 - q^2)`. Ridges stay sharp, and valleys become round with
//! the etched depth as radius, as on ground glass after hydrofluoric acid.
//!
//! # Source
//! G. Spierings, *Wet chemical etching of silicate glasses in hydrofluoric acid based solutions*, J. Mater. Sci. 28, 6261
//! (1993).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::{ErosionError, MAX_ETCH_SPACINGS};
use super::neighbours::beside;
use crate::gives_up::GivesUp;
use asperity_surface::HeightField;

/// Isotropic etching.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Etch {
    /// Depth that is removed along the normal of the surface, length units, above 0.
    pub depth: f64,
}

impl Etch {
    pub(super) fn check(&self, [dx, dy]: [f64; 2]) -> Result<(), ErosionError> {
        let depth = self.depth;
        if !(depth.is_finite() && depth > 0.0) {
            return Err(ErosionError::BadDepth(depth));
        }
        let most = MAX_ETCH_SPACINGS * dx.min(dy);
        match depth > most {
            true => Err(ErosionError::TooDeep { depth, most }),
            false => Ok(()),
        }
    }

    /// Heights after etching. The sphere is that of the samples: a flank of slope `m` sinks by
    /// `depth sqrt(1 + m^2)`, less up to `d^2 (1 + m^2)^(3/2) / (8 depth)` at the spacing `d`.
    pub(super) fn heights(&self, field: &HeightField, gives_up: GivesUp<'_>) -> Vec<f64> {
        let depth = self.depth;
        let [dx, dy] = field.spacing();
        let ([ny, nx], border) = (field.shape(), field.border());
        let rows_away = (depth / dy).floor() as i64;
        let mut heights = vec![f64::INFINITY; nx * ny];
        heights
            .par_chunks_exact_mut(nx)
            .enumerate()
            .for_each(|(iy, row)| {
                if gives_up() {
                    return;
                }
                for j in -rows_away..=rows_away {
                    let Some(other) = beside(border, iy, j, ny) else {
                        continue;
                    };
                    let other = &field.heights()[other * nx..(other + 1) * nx];
                    let left = (depth * depth - (j as f64 * dy).powi(2)).max(0.0);
                    let columns_away = (left.sqrt() / dx).floor() as i64;
                    for i in -columns_away..=columns_away {
                        let sink = (left - (i as f64 * dx).powi(2)).max(0.0).sqrt();
                        lower(row, other, i, |h| h - sink, |ix| beside(border, ix, i, nx));
                    }
                }
            });
        heights
    }
}

/// Lowers `row` to `height` of `other`, `i` columns beside; near the ends, of the column that `beside` gives.
fn lower(
    row: &mut [f64],
    other: &[f64],
    i: i64,
    height: impl Fn(f64) -> f64,
    beside: impl Fn(usize) -> Option<usize>,
) {
    let nx = row.len();
    let away = (i.unsigned_abs() as usize).min(nx);
    // Columns whose neighbour lies inside of the row need no rule of the border
    let (first, last) = if i < 0 { (away, nx) } else { (0, nx - away) };
    let from = if i < 0 { 0 } else { away };
    let inner = &mut row[first..last];
    for (h, above) in inner.iter_mut().zip(&other[from..]) {
        *h = h.min(height(*above));
    }
    for ix in (0..first).chain(last..nx) {
        if let Some(column) = beside(ix) {
            row[ix] = row[ix].min(height(other[column]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Erosion;
    use asperity_surface::Border;

    fn grooves(n: usize, spacing: f64, slope: f64) -> HeightField {
        let half = n as f64 / 2.0;
        let heights = (0..4 * n)
            .map(|i| slope * spacing * ((i % n) as f64 - half).abs())
            .collect();
        HeightField::new(heights, [4, n], [spacing, spacing]).unwrap()
    }

    /// Flanks sink by `depth sqrt(1 + m^2)`, the ridge stays sharp, and the bottom is an arc about the old one. Rows are few, so that
    /// the sphere spans several tiles.
    #[test]
    fn etched_grooves_have_sharp_ridges_and_round_bottoms() {
        let (n, spacing, slope, depth) = (256, 1.0 / 16.0, 0.8_f64, 2.0_f64);
        let field = grooves(n, spacing, slope);
        let etched = Erosion::Etch(Etch { depth }).of(&field).unwrap();
        let secant = (1.0 + slope * slope).sqrt();
        let allowed = spacing * spacing * secant.powi(3) / (8.0 * depth);
        for ix in 0..n {
            let x = (spacing * (ix as f64 - n as f64 / 2.0)).abs();
            let expected = if x > depth * slope / secant {
                slope * x - depth * secant
            } else {
                -(depth * depth - x * x).sqrt()
            };
            let off = etched.height(ix, 1) - expected;
            assert!(
                off > -1e-12 && off < 1.01 * allowed,
                "{ix}: {off} {allowed}"
            );
        }
    }

    /// The envelope of spheres by its definition, under each border.
    #[test]
    fn rows_are_lowered_as_the_definition_says() {
        let heights: Vec<f64> = (0..9 * 7).map(|i| f64::from(i * i % 23)).collect();
        for border in [Border::Periodic, Border::Mirrored, Border::Open] {
            let field = HeightField::new(heights.clone(), [9, 7], [1.0, 1.3]).unwrap();
            let field = field.with_border(border);
            let depth = 9.5;
            let etched = Erosion::Etch(Etch { depth }).of(&field).unwrap();
            for iy in 0..9 {
                for ix in 0..7 {
                    let mut expected = f64::INFINITY;
                    for j in -10..=10 {
                        for i in -10..=10 {
                            let q2 = f64::from(i).powi(2) + (1.3 * f64::from(j)).powi(2);
                            let at = (
                                beside(border, ix, i64::from(i), 7),
                                beside(border, iy, i64::from(j), 9),
                            );
                            if let (Some(x), Some(y)) = at
                                && q2 <= depth * depth
                            {
                                let sink = (depth * depth - q2).sqrt();
                                expected = expected.min(field.height(x, y) - sink);
                            }
                        }
                    }
                    assert!((etched.height(ix, iy) - expected).abs() < 1e-12);
                }
            }
        }
    }
}
