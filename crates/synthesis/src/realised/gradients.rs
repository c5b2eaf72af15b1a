//! Distribution of the gradients of facets, beside that of GGX.

use rayon::prelude::*;
use serde::Serialize;

use crate::StudentSlopes;
use asperity_surface::HeightField;

/// Gradients of the facets of a surface of [`StudentSlopes`], in units of `alpha` along each axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gradients {
    /// GGX's `alpha` along the two principal axes.
    pub alpha: [f64; 2],
    /// Fractions of facets that are steeper.
    pub steeper: Vec<SteeperThan>,
    /// Largest difference between requested and realised fractions, over 800 gradients.
    pub largest_difference: f64,
}

/// The fraction of facets whose gradient exceeds a multiple of `alpha`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SteeperThan {
    /// The gradient, over `alpha`.
    pub gradient: f64,
    /// The fraction requested.
    pub requested: f64,
    /// The fraction of facets.
    pub realised: f64,
}

/// Gradients in a table.
const SHOWN: [usize; 6] = [25, 50, 100, 200, 400, 800];

/// Gradients counted per `alpha`.
const PER_ALPHA: f64 = 50.0;

/// The largest gradient counted, in these steps.
const LAST: usize = 800;

impl Gradients {
    pub(super) fn of(field: &HeightField, student: &StudentSlopes) -> Self {
        let square = student.square_in_alpha();
        let [cx, cy] = field.cells();
        let of_row = |iy: usize| {
            let mut counts = vec![0_u32; LAST + 1];
            for ix in 0..cx {
                for slope in field.facet_slopes(ix, iy) {
                    let gradient = square(slope).sqrt();
                    counts[((PER_ALPHA * gradient) as usize).min(LAST)] += 1;
                }
            }
            counts
        };
        let counts = (0..cy).into_par_iter().map(of_row).reduce(
            || vec![0; LAST + 1],
            |a, b| a.iter().zip(b).map(|(a, b)| a + b).collect(),
        );
        let all = (2 * cx * cy) as f64;
        let mut beyond: f64 = all;
        let mut steeper = Vec::new();
        let mut largest_difference = 0.0_f64;
        for (i, count) in counts.iter().enumerate() {
            let gradient = i as f64 / PER_ALPHA;
            let (requested, realised) = (StudentSlopes::exceedance(gradient), beyond / all);
            largest_difference = largest_difference.max((requested - realised).abs());
            if SHOWN.contains(&i) {
                steeper.push(SteeperThan {
                    gradient,
                    requested,
                    realised,
                });
            }
            beyond -= f64::from(*count);
        }
        Self {
            alpha: student.alpha(),
            steeper,
            largest_difference,
        }
    }
}
