//! Realised statistics: compares a drawn surface with what was requested.

mod gradients;
mod structure;

use std::f64::consts::PI;

use asperity_numerics::elementary::exp_m1;
use asperity_surface::{HeightField, QuickRoughness, Roughness};
use serde::Serialize;

pub use self::gradients::{Gradients, SteeperThan};
pub use self::structure::{Expectation, RealisedStructure};
use crate::{Provenance, Psd, SurfaceRecipe};

/// Roughness of a surface, with requested and realised statistics if it was drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnRoughness {
    /// Roughness of the surface.
    #[serde(flatten)]
    pub roughness: Roughness,
    /// Requested and realised statistics, if the surface carries its provenance.
    pub realised: Option<Realised>,
    /// Expected and realised statistics of a structured surface, if it carries its provenance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub realised_structure: Option<RealisedStructure>,
}

impl DrawnRoughness {
    /// Measures a surface.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let roughness = Roughness::of(field);
        Self {
            realised: Realised::of(field, &QuickRoughness::from(&roughness)),
            realised_structure: RealisedStructure::of(field, roughness.sz, roughness.sdq.powi(2)),
            roughness,
        }
    }

    /// Requested and realised statistics alone.
    #[must_use]
    pub fn realisation(&self) -> Option<Realisation> {
        let structured = self.realised_structure.clone().map(Realisation::Structured);
        structured.or_else(|| self.realised.clone().map(Realisation::Random))
    }
}

/// Requested and realised statistics of a generated surface, without the roughness of which nothing was requested.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one value per generated surface")]
pub enum Realisation {
    /// Of a surface drawn from a spectrum.
    Random(Realised),
    /// Of a structured surface.
    Structured(RealisedStructure),
}

impl Realisation {
    /// Measures a surface, as [`QuickRoughness`] if it is drawn from a spectrum; `None` without its provenance, or if nothing was requested.
    #[must_use]
    pub fn of(field: &HeightField) -> Option<Self> {
        let recipe = &Provenance::of(field.provenance())?.recipe;
        match recipe.structured() {
            None => Realised::of(field, &QuickRoughness::of(field)).map(Self::Random),
            Some(_) => DrawnRoughness::of(field).realisation(),
        }
    }
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
    /// Value of this surface; `None` if it cannot be measured on it.
    pub realised: Option<f64>,
    /// Standard deviation expected of the realised value between realisations, where it is known.
    pub expected_deviation: Option<f64>,
}

impl Realised {
    /// Compares `roughness` with the provenance of `field`; `None` without one.
    ///
    /// The mean over an area `A` of the square of a Gaussian field with autocorrelation `C` has
    /// variance `2 / A` times the integral of `C^2`. For heights that is `sigma^4 pi tau_x tau_y / A`.
    /// For slopes along an axis, whose autocorrelation is the second derivative of `C`, it is 3/4 of
    /// that relative to the square of their variance, whatever the azimuth. Of other spectra that of heights is an integral of `W^2`,
    /// and that of slopes is not known.
    fn of(field: &HeightField, roughness: &QuickRoughness) -> Option<Self> {
        let recipe = &Provenance::of(field.provenance())?.recipe;
        if recipe.is_measured() {
            // Nothing was requested but what was measured
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
                true => -2.0 * sigma * sigma * exp_m1(-(lag / length).powi(2)) / (lag * lag),
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
