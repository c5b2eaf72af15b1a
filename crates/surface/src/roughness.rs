//! Roughness of any surface, generated or measured.

mod correlation;
mod height_blocks;
mod histogram;
mod iso25178;
mod slopes;
mod spectrum;
mod window;

use std::f64::consts::SQRT_2;

use rayon::prelude::*;
use serde::Serialize;

pub(crate) use self::correlation::{
    Axis, all_lines, axis_autocorrelation, one_over_e_lag, spread_lines,
};
use self::slopes::slope_moments;
use crate::height_field::mean_height;
use crate::{Border, HeightField, LengthUnit};

pub use self::correlation::AxisAutocorrelation;
pub use self::height_blocks::HeightBlocks;
pub use self::histogram::Histogram;
pub use self::iso25178::{FunctionalParameters, Iso25178, SpatialParameters};
pub use self::slopes::{SteepestFacet, Triangle};
pub use self::spectrum::{PowerSpectrum, SpectralRing};

/// Parameters of a surface's roughness.
///
/// Lengths are in the unit of the surface, slopes are tangents. Height parameters are taken over the
/// samples of one tile, about their mean; slope parameters over the triangles of its mesh, each of
/// which covers the same area of the mean plane. No form is removed: see [`crate::Form`].
///
/// # Source
/// Names and definitions of `sq` to `sku` and `sdq`: ISO 25178-2:2021. `sdq` here is that of the
/// mesh, not of a smooth interpolation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Roughness {
    /// Number of samples `[ny, nx]`.
    pub shape: [usize; 2],
    /// `[dx, dy]`, length units per sample.
    pub spacing: [f64; 2],
    /// Extent `[x, y]` of one tile, length units.
    pub extent: [f64; 2],
    /// Unit of all lengths.
    pub unit: LengthUnit,
    /// Border of the surface.
    pub border: Border,
    /// Mean height, which all other height parameters leave out.
    pub mean: f64,
    /// Root mean square height: sigma.
    pub sq: f64,
    /// Mean absolute height.
    pub sa: f64,
    /// Highest peak above the mean.
    pub sp: f64,
    /// Depth of the lowest valley below the mean, positive.
    pub sv: f64,
    /// Highest peak to lowest valley: `sp + sv`.
    pub sz: f64,
    /// Skewness of the heights; `None` if they are all equal. Zero for a Gaussian surface.
    pub ssk: Option<f64>,
    /// Kurtosis of the heights; `None` if they are all equal. Three for a Gaussian surface.
    pub sku: Option<f64>,
    /// Root mean square gradient of the mesh, a tilt of the whole included.
    pub sdq: f64,
    /// Mean slopes of the mesh along x and y: the tilt. Zero to rounding if periodic.
    pub slope_mean: [f64; 2],
    /// Mean squares of the mesh's slopes along x and y about [`Roughness::slope_mean`].
    pub slope_variance: [f64; 2],
    /// Correlation length along x in the convention of this crate: the lag at which the normalised
    /// autocorrelation falls to 1/e, `exp(-r^2 / tau^2)`. `None` if it does not within half the
    /// tile, or all heights are equal.
    ///
    /// A periodic surface wraps around; otherwise each lag is averaged over the pairs it has.
    pub tau_x: Option<f64>,
    /// Correlation length along y, in the convention of [`Roughness::tau_x`].
    pub tau_y: Option<f64>,
    /// Geometric mean of [`Roughness::tau_x`] and [`Roughness::tau_y`].
    pub tau: Option<f64>,
    /// Correlation length along x in the other convention, `exp(-r^2 / (2 l^2))`: `tau_x / sqrt 2`.
    pub l_x: Option<f64>,
    /// Correlation length along y, in the convention of [`Roughness::l_x`].
    pub l_y: Option<f64>,
    /// The `tau` along x of a Gaussian surface with these heights and slopes:
    /// `sqrt 2 sq / (root of the slope variance along x)`. `None` if no facet slopes along x, or all
    /// heights are equal. It is what geometric optics sees; if it is far from [`Roughness::tau_x`],
    /// the surface is no Gaussian one, or has fine structure of another scale.
    pub equivalent_tau_x: Option<f64>,
    /// Equivalent `tau` along y; see [`Roughness::equivalent_tau_x`].
    pub equivalent_tau_y: Option<f64>,
    /// The smoothness `s = tau / sigma` of an isotropic Gaussian surface with this root mean square
    /// gradient: `2 / sdq`. `None` if the gradient is zero.
    pub equivalent_smoothness: Option<f64>,
    /// The steepest facet, the first of equals.
    pub steepest: SteepestFacet,
}

impl Roughness {
    /// Measures a surface.
    ///
    /// Numbers do not depend on the number of threads. A large mean height costs no accuracy beyond
    /// that with which the heights themselves hold it.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let moments = height_moments(field);
        let slopes = slope_moments(field);
        let [dx, dy] = field.spacing();
        let sq = moments.variance.sqrt();
        let gradient_squared = slopes.variance[0]
            + slopes.variance[1]
            + slopes.mean[0].powi(2)
            + slopes.mean[1].powi(2);
        let sdq = gradient_squared.sqrt();

        let length = |axis, lines, spacing| {
            let lines = all_lines(lines);
            let correlation = axis_autocorrelation(field, moments.mean, axis, &lines);
            one_over_e_lag(&correlation).map(|lag| lag * spacing)
        };
        let (tau_x, tau_y) = if sq > 0.0 {
            (
                length(Axis::X, field.ny(), dx),
                length(Axis::Y, field.nx(), dy),
            )
        } else {
            (None, None)
        };
        let equivalent_tau = |slope_variance: f64| {
            (sq > 0.0 && slope_variance > 0.0).then(|| SQRT_2 * sq / slope_variance.sqrt())
        };

        Self {
            shape: field.shape(),
            spacing: field.spacing(),
            extent: field.extent(),
            unit: field.unit(),
            border: field.border(),
            mean: moments.mean,
            sq,
            sa: moments.absolute,
            sp: moments.highest,
            sv: -moments.lowest,
            sz: moments.highest - moments.lowest,
            ssk: (sq > 0.0).then_some(moments.skewness),
            sku: (sq > 0.0).then_some(moments.kurtosis),
            sdq,
            slope_mean: slopes.mean,
            slope_variance: slopes.variance,
            tau_x,
            tau_y,
            tau: tau_x.zip(tau_y).map(|(x, y)| x.sqrt() * y.sqrt()),
            l_x: tau_x.map(|tau| tau / SQRT_2),
            l_y: tau_y.map(|tau| tau / SQRT_2),
            equivalent_tau_x: equivalent_tau(slopes.variance[0]),
            equivalent_tau_y: equivalent_tau(slopes.variance[1]),
            equivalent_smoothness: (sdq > 0.0).then(|| 2.0 / sdq),
            steepest: slopes.steepest,
        }
    }
}

struct HeightMoments {
    mean: f64,
    variance: f64,
    absolute: f64,
    highest: f64,
    lowest: f64,
    skewness: f64,
    kurtosis: f64,
}

/// Moments of the heights about their mean, which is found first, relative to one of the heights.
fn height_moments(field: &HeightField) -> HeightMoments {
    let n = field.heights().len() as f64;
    let mean = mean_height(field);

    // Sums of |d|, d^2, d^3 and d^4 of each row; the rows are then added in order
    let rows: Vec<Vec<[f64; 4]>> = field
        .heights()
        .par_chunks(ROWS * field.nx())
        .map(|block| {
            let rows: Vec<&[f64]> = block.chunks_exact(field.nx()).collect();
            match <[&[f64]; ROWS]>::try_from(rows.as_slice()) {
                Ok(rows) => deviation_sums(rows, mean).to_vec(),
                Err(_) => rows
                    .iter()
                    .flat_map(|row| deviation_sums([*row], mean))
                    .collect(),
            }
        })
        .collect();
    let [s1, s2, s3, s4] = rows
        .iter()
        .flatten()
        .fold([0.0; 4], |sums, row| [0, 1, 2, 3].map(|i| sums[i] + row[i]));
    let [lowest, highest] = field.range();
    let variance = s2 / n;
    HeightMoments {
        mean,
        variance,
        absolute: s1 / n,
        highest: highest - mean,
        lowest: lowest - mean,
        skewness: s3 / n / (variance * variance.sqrt()),
        kurtosis: s4 / n / (variance * variance),
    }
}

/// Rows that are summed side by side, since each addition to a sum of a row waits for the last one.
const ROWS: usize = 4;

/// Sums of |d|, d^2, d^3 and d^4 over each of some rows of equal length, d being the difference of a height from `mean`.
fn deviation_sums<const N: usize>(rows: [&[f64]; N], mean: f64) -> [[f64; 4]; N] {
    let mut sums = [[0.0; 4]; N];
    let length = rows[0].len();
    let rows = rows.map(|row| &row[..length]);
    for i in 0..length {
        for (sums, row) in sums.iter_mut().zip(rows) {
            let d = row[i] - mean;
            let d2 = d * d;
            let [s1, s2, s3, s4] = *sums;
            *sums = [s1 + d.abs(), s2 + d2, s3 + d2 * d, s4 + d2 * d2];
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_side_by_side_have_the_sums_of_each() {
        let heights: Vec<f64> = (0..4 * 37).map(|i| f64::from(i * i % 61) * 0.37).collect();
        let rows: [&[f64]; 4] = std::array::from_fn(|k| &heights[37 * k..37 * (k + 1)]);
        let alone = rows.map(|row| deviation_sums([row], 7.3)[0]);
        assert_eq!(deviation_sums(rows, 7.3), alone);
        let d = rows[2].iter().map(|h| h - 7.3);
        assert_eq!(alone[2][3], d.fold(0.0, |sum, d| sum + d * d * (d * d)));
    }
}
