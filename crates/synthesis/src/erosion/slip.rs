//! Slipping: material moves down slopes steeper than the angle of repose.
//!
//! Between two neighbours whose slope exceeds that of repose, each step moves a fixed fraction of the excess from the higher to the
//! lower one. The volume stays, and slopes approach that of repose; surfaces less steep do not change.
//!
//! # Source
//! F. Musgrave, C. Kolb, R. Mace, *The synthesis and rendering of eroded fractal terrains*, SIGGRAPH 1989 (thermal weathering).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::{ErosionError, MAX_SLIP_STEPS};
use super::neighbours::beside;
use crate::gives_up::GivesUp;
use asperity_numerics::elementary::hypot;
use asperity_surface::HeightField;

/// Fraction of the excess that moves between two neighbours in a step. With eight neighbours, up to 1/8 no sample falls below all that it
/// gives to.
const FRACTION: f64 = 0.1;

/// The eight neighbours `[column, row]` of a sample.
const NEIGHBOURS: [[i64; 2]; 8] = [
    [1, 0],
    [-1, 0],
    [0, 1],
    [0, -1],
    [1, 1],
    [-1, -1],
    [1, -1],
    [-1, 1],
];

/// Slipping of material on steep slopes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slip {
    /// Slope of repose, the tangent of its angle: 0 or more.
    pub slope: f64,
    /// Number of steps, from 1 to [`MAX_SLIP_STEPS`](crate::MAX_SLIP_STEPS).
    pub steps: u32,
}

impl Slip {
    pub(super) fn check(&self) -> Result<(), ErosionError> {
        if !(self.slope.is_finite() && self.slope >= 0.0) {
            return Err(ErosionError::BadSlope(self.slope));
        }
        if !(1..=MAX_SLIP_STEPS).contains(&self.steps) {
            return Err(ErosionError::BadSteps { steps: self.steps });
        }
        Ok(())
    }

    /// Heights after slipping.
    pub(super) fn heights(&self, field: &HeightField, gives_up: GivesUp<'_>) -> Vec<f64> {
        let ([ny, nx], [dx, dy], border) = (field.shape(), field.spacing(), field.border());
        let allowed = NEIGHBOURS.map(|[i, j]| self.slope * hypot(i as f64 * dx, j as f64 * dy));
        let mut heights = field.heights().to_vec();
        let mut next = heights.clone();
        for _ in 0..self.steps {
            if gives_up() {
                break;
            }
            let before = &heights;
            let slip = |gains: &mut Vec<f64>, (iy, row): (usize, &mut [f64])| {
                let here = &before[iy * nx..(iy + 1) * nx];
                gains.fill(0.0);
                for ([i, j], allowed) in NEIGHBOURS.into_iter().zip(allowed) {
                    let Some(other) = beside(border, iy, j, ny) else {
                        continue;
                    };
                    let other = &before[other * nx..(other + 1) * nx];
                    // What a neighbour gains this sample loses, to the last bit
                    let gain = |here: f64, other: f64| {
                        let rise = other - here;
                        FRACTION * (rise - rise.clamp(-allowed, allowed))
                    };
                    // Columns inside need no rule of the border
                    let inner = &mut gains[1..nx - 1];
                    let beside_inner = &other[(1 + i) as usize..];
                    for ((sum, here), other) in inner.iter_mut().zip(&here[1..]).zip(beside_inner) {
                        *sum += gain(*here, *other);
                    }
                    for ix in [0, nx - 1] {
                        if let Some(column) = beside(border, ix, i, nx) {
                            gains[ix] += gain(here[ix], other[column]);
                        }
                    }
                }
                for ((h, here), gain) in row.iter_mut().zip(here).zip(gains) {
                    *h = here + *gain;
                }
            };
            next.par_chunks_exact_mut(nx)
                .enumerate()
                .for_each_init(|| vec![0.0; nx], slip);
            let moved = heights.iter().zip(&next).any(|(a, b)| a != b);
            std::mem::swap(&mut heights, &mut next);
            if !moved {
                break;
            }
        }
        heights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Erosion, Psd, Synthesis};
    use asperity_surface::Border;

    fn rough() -> HeightField {
        let psd = Psd::gaussian(4.0, 8.0).unwrap();
        let synthesis = Synthesis::new(psd, [64, 64], [1.0, 1.0], false).unwrap();
        synthesis.draw(3, 0).unwrap()
    }

    fn steepest(field: &HeightField) -> f64 {
        let [ny, nx] = field.shape();
        let steps = (0..nx * ny).map(|i| {
            let (ix, iy) = (i % nx, i / nx);
            let h = field.height(ix, iy);
            (field.height(ix + 1, iy) - h)
                .abs()
                .max((field.height(ix, iy + 1) - h).abs())
        });
        steps.fold(0.0, f64::max)
    }

    #[test]
    fn slopes_approach_that_of_repose_and_the_volume_stays() {
        let field = rough();
        assert!(steepest(&field) > 1.5);
        let slip = Slip {
            slope: 0.4,
            steps: 4000,
        };
        let slipped = Erosion::Slip(slip).of(&field).unwrap();
        assert!(steepest(&slipped) < 0.401, "{}", steepest(&slipped));
        let mean = |field: &HeightField| field.heights().iter().sum::<f64>() / 4096.0;
        // Each step rounds each of 4096 heights, of up to 16, by 2e-15
        assert!((mean(&slipped) - mean(&field)).abs() < 1e-12);
        // It stays as rough as slopes of 0.4 allow
        assert!(steepest(&slipped) > 0.35);
    }

    #[test]
    fn surfaces_less_steep_than_that_of_repose_stay() {
        for border in [Border::Periodic, Border::Open] {
            let field = rough().with_border(border);
            let slip = Slip {
                slope: 5.0,
                steps: 3,
            };
            assert_eq!(Erosion::Slip(slip).of(&field).unwrap(), field);
        }
    }
}
