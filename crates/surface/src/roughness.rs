//! Roughness of any surface, generated or measured.

mod correlation;
mod gradients;
mod slopes;
mod structure;

use std::f64::consts::{PI, SQRT_2};

use rayon::prelude::*;
use serde::Serialize;

use self::correlation::one_over_e_lag;
pub(crate) use self::correlation::{Axis, axis_autocorrelation};
use self::slopes::slope_moments;
use crate::{Border, HeightField, LengthUnit, Psd, SurfaceRecipe};

pub use self::correlation::AxisAutocorrelation;
pub use self::gradients::{Gradients, SteeperThan};
pub use self::slopes::{SteepestFacet, Triangle};
pub use self::structure::{Expectation, RealisedStructure};

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
    /// What lies beyond the border.
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
    /// As [`Roughness::tau_x`], along y.
    pub tau_y: Option<f64>,
    /// Geometric mean of [`Roughness::tau_x`] and [`Roughness::tau_y`].
    pub tau: Option<f64>,
    /// Correlation length along x in the other convention, `exp(-r^2 / (2 l^2))`: `tau_x / sqrt 2`.
    pub l_x: Option<f64>,
    /// As [`Roughness::l_x`], along y.
    pub l_y: Option<f64>,
    /// The `tau` along x of a Gaussian surface with these heights and slopes:
    /// `sqrt 2 sq / (root of the slope variance along x)`. `None` if no facet slopes along x, or all
    /// heights are equal. It is what geometric optics sees; if it is far from [`Roughness::tau_x`],
    /// the surface is no Gaussian one, or has fine structure of another scale.
    pub equivalent_tau_x: Option<f64>,
    /// As [`Roughness::equivalent_tau_x`], along y.
    pub equivalent_tau_y: Option<f64>,
    /// The smoothness `s = tau / sigma` of an isotropic Gaussian surface with this root mean square
    /// gradient: `2 / sdq`. `None` if the gradient is zero.
    pub equivalent_smoothness: Option<f64>,
    /// The steepest facet, the first of equals.
    pub steepest: SteepestFacet,
    /// Requested and realised statistics, if the surface carries its provenance.
    pub realised: Option<Realised>,
    /// The same of a structured surface, if it carries its provenance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub realised_structure: Option<RealisedStructure>,
}

/// Requested and realised statistics of a generated surface.
///
/// They differ because a tile holds finitely many correlation areas and a realisation is never
/// rescaled.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Realised {
    /// Root mean square height.
    pub sigma: Compared,
    /// Variance of the heights.
    pub variance: Compared,
    /// Lag along x at which the autocorrelation is 1/e.
    pub tau_x: Compared,
    /// Lag along y at which the autocorrelation is 1/e.
    pub tau_y: Compared,
    /// Variance of the mesh's slopes along x. Requested is what the mesh should have at its spacing,
    /// `2 (C(0) - C(dx)) / dx^2`, which is below that of the continuous surface.
    pub slope_variance_x: Compared,
    /// Variance of the mesh's slopes along y; as [`Realised::slope_variance_x`].
    pub slope_variance_y: Compared,
    /// Skewness of the heights, where that was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skewness: Option<Compared>,
    /// Kurtosis of the heights, where that was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kurtosis: Option<Compared>,
    /// Distribution of the slopes, where that is what was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gradients: Option<Gradients>,
}

/// One number, requested and realised.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// The requested value.
    pub requested: f64,
    /// What this surface has; `None` if it cannot be measured on it.
    pub realised: Option<f64>,
    /// Standard deviation expected of the realised value between realisations, where it is known.
    pub expected_deviation: Option<f64>,
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

        let length = |axis, spacing| {
            let correlation = axis_autocorrelation(field, moments.mean, axis);
            one_over_e_lag(&correlation).map(|lag| lag * spacing)
        };
        let (tau_x, tau_y) = if sq > 0.0 {
            (length(Axis::X, dx), length(Axis::Y, dy))
        } else {
            (None, None)
        };
        let equivalent_tau = |slope_variance: f64| {
            (sq > 0.0 && slope_variance > 0.0).then(|| SQRT_2 * sq / slope_variance.sqrt())
        };

        let mut roughness = Self {
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
            realised: None,
            realised_structure: None,
        };
        roughness.realised = Realised::of(field, &roughness);
        roughness.realised_structure =
            RealisedStructure::of(field, roughness.sz, roughness.sdq.powi(2));
        roughness
    }
}

impl Realised {
    /// Compares `roughness` with the provenance of `field`; `None` without one.
    ///
    /// The mean over an area `A` of the square of a Gaussian field with autocorrelation `C` has
    /// variance `2 / A` times the integral of `C^2`. For heights that is `sigma^4 pi tau_x tau_y / A`.
    /// For slopes along an axis, whose autocorrelation is the second derivative of `C`, it is 3/4 of
    /// that relative to the square of their variance, whatever the azimuth. Of other spectra that of heights is an integral of `W^2`,
    /// and that of slopes is not known.
    fn of(field: &HeightField, roughness: &Roughness) -> Option<Self> {
        let recipe = &field.provenance()?.recipe;
        if recipe.structured().is_some() {
            // It has statistics of its own
            return None;
        }
        let sigma = recipe.sigma();
        let [length_x, length_y] = recipe.axis_correlation_lengths();
        let [extent_x, extent_y] = field.extent();
        let [dx, dy] = field.spacing();
        let deviation = match recipe.gaussian() {
            Some(Psd::Gaussian(_)) => {
                let [tau_x, tau_y] = recipe.correlation_lengths();
                Some((PI * (tau_x / extent_x) * (tau_y / extent_y)).sqrt())
            }
            Some(psd) => {
                let area = psd.correlation_area();
                area.map(|area| (area / (extent_x * extent_y)).sqrt())
            }
            None => None,
        };
        let compared = |requested: f64, realised: Option<f64>, relative: Option<f64>| Compared {
            requested,
            realised,
            expected_deviation: relative.map(|r| r * requested),
        };
        let is_closed = matches!(recipe.gaussian(), Some(Psd::Gaussian(_)));
        let slopes = |axis: usize, lag: f64, length: f64| {
            let requested = match is_closed {
                true => -2.0 * sigma * sigma * (-(lag / length).powi(2)).exp_m1() / (lag * lag),
                false => recipe.mesh_slope_variance(axis, lag),
            };
            let relative = deviation.filter(|_| is_closed);
            compared(
                requested,
                Some(roughness.slope_variance[axis]),
                relative.map(|relative| 0.75_f64.sqrt() * relative),
            )
        };
        Some(Self {
            sigma: compared(sigma, Some(roughness.sq), deviation.map(|d| d / 2.0)),
            variance: compared(sigma * sigma, Some(roughness.sq * roughness.sq), deviation),
            tau_x: compared(length_x, roughness.tau_x, None),
            tau_y: compared(length_y, roughness.tau_y, None),
            slope_variance_x: slopes(0, dx, length_x),
            slope_variance_y: slopes(1, dy, length_y),
            skewness: recipe
                .heights()
                .map(|law| compared(law.skewness(), roughness.ssk, None)),
            kurtosis: recipe
                .heights()
                .map(|law| compared(law.kurtosis(), roughness.sku, None)),
            gradients: match recipe {
                SurfaceRecipe::StudentSlopes(student) => Some(Gradients::of(field, student)),
                _ => None,
            },
        })
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

    // Row sums of |d|, d^2, d^3, d^4, and the extremes; the rows are then added in order.
    let rows: Vec<[f64; 6]> = field
        .heights()
        .par_chunks_exact(field.nx())
        .map(|row| {
            let start = [0.0, 0.0, 0.0, 0.0, f64::NEG_INFINITY, f64::INFINITY];
            row.iter().fold(start, |[s1, s2, s3, s4, max, min], h| {
                let d = h - mean;
                let d2 = d * d;
                [
                    s1 + d.abs(),
                    s2 + d2,
                    s3 + d2 * d,
                    s4 + d2 * d2,
                    max.max(d),
                    min.min(d),
                ]
            })
        })
        .collect();
    let [s1, s2, s3, s4, highest, lowest] = rows.iter().fold(
        [0.0, 0.0, 0.0, 0.0, f64::NEG_INFINITY, f64::INFINITY],
        |[s1, s2, s3, s4, max, min], row| {
            [
                s1 + row[0],
                s2 + row[1],
                s3 + row[2],
                s4 + row[3],
                max.max(row[4]),
                min.min(row[5]),
            ]
        },
    );
    let variance = s2 / n;
    HeightMoments {
        mean,
        variance,
        absolute: s1 / n,
        highest,
        lowest,
        skewness: s3 / n / (variance * variance.sqrt()),
        kurtosis: s4 / n / (variance * variance),
    }
}

/// Mean height, summed relative to the first height so that a common offset rounds but once.
pub(crate) fn mean_height(field: &HeightField) -> f64 {
    let origin = field.heights()[0];
    let rows: Vec<f64> = field
        .heights()
        .par_chunks_exact(field.nx())
        .map(|row| row.iter().map(|h| h - origin).sum())
        .collect();
    origin + rows.iter().sum::<f64>() / field.heights().len() as f64
}
