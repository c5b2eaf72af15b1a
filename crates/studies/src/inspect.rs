//! Inspect: the spectrum, autocorrelation and histograms of one surface, as tables and figures.

mod config;
mod figures;
mod files;
mod statistics;
mod tables;
#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use asperity_numerics::elementary::{exp, sin_cos};
use asperity_surface::{
    AxisAutocorrelation, HeightField, Histogram, LengthUnit, PowerSpectrum, SpectralRing,
};
use asperity_synthesis::{Provenance, Psd, SurfaceRecipe};

pub use self::config::{InspectConfig, InspectLight, Inspection};
pub use self::files::{InspectReport, inspection_files, names_folder};
pub use self::statistics::Statistics;
use crate::config::filtering::FilteringError;
use crate::given::FileProblem;

/// Azimuths over a half turn at which a requested spectrum is averaged.
const AZIMUTHS: usize = 90;

/// Distributions of the heights and slopes of one surface over waves, lags and values.
#[derive(Clone, Debug)]
pub(crate) struct Texture {
    unit: LengthUnit,
    spacing: [f64; 2],
    spectrum: Vec<SpectrumRow>,
    /// Area of the plane of wave vectors that one wave stands for.
    wave_area: f64,
    correlation: AxisAutocorrelation,
    /// Spectrum that was requested of a generated surface.
    requested: Option<Psd>,
    heights: Histogram,
    /// Root mean square height.
    sq: f64,
    slopes: [Histogram; 2],
    /// Mean squares of the slopes along x and y about zero.
    mean_square_slopes: [f64; 2],
    /// GGX's `alpha` along x and y that was requested of a generated surface.
    ggx_alpha: Option<[f64; 2]>,
}

/// A ring of wave vectors.
#[derive(Clone, Copy, Debug)]
struct SpectrumRow {
    ring: SpectralRing,
    /// Density that was requested of a generated surface, averaged over azimuths.
    requested: Option<f64>,
}

impl Texture {
    /// Measures a surface, unless all heights are equal, or so large that their sums overflow.
    fn of(field: &HeightField) -> Result<Self, FileProblem> {
        let heights = Histogram::of_heights(field).ok_or(FileProblem::Flat)?;
        let slopes = Histogram::of_slopes(field).ok_or(FileProblem::Flat)?;
        let spectrum = PowerSpectrum::of(field).map_err(FilteringError::from)?;
        let correlation = AxisAutocorrelation::of(field);
        let recipe = Provenance::of(field.provenance()).map(|provenance| &provenance.recipe);
        let requested = recipe.and_then(|recipe| recipe.gaussian());
        let row = |ring: SpectralRing| SpectrumRow {
            ring,
            requested: requested.map(|psd| mean_over_azimuths(psd, ring.k)),
        };
        let [xx, _, yy] = field.slope_moments().second;
        Ok(Self {
            unit: field.unit(),
            spacing: field.spacing(),
            spectrum: spectrum.rings().into_iter().map(row).collect(),
            wave_area: spectrum.wave_area(),
            sq: correlation.along_x[0].sqrt(),
            correlation,
            requested: requested.cloned(),
            heights,
            slopes,
            mean_square_slopes: [xx, yy],
            ggx_alpha: match recipe {
                Some(SurfaceRecipe::StudentSlopes(student)) => Some(student.alpha()),
                _ => None,
            },
        })
    }
}

/// Mean density of `psd` at wave vectors of length `k`.
fn mean_over_azimuths(psd: &Psd, k: f64) -> f64 {
    if psd.is_isotropic() {
        return psd.density(k, 0.0);
    }
    let at = |i: usize| {
        let (sin, cos) = sin_cos(PI * i as f64 / AZIMUTHS as f64);
        psd.density(k * cos, k * sin)
    };
    (0..AZIMUTHS).map(at).sum::<f64>() / AZIMUTHS as f64
}

/// The normal density of mean zero.
fn normal(value: f64, mean_square: f64) -> f64 {
    exp(-value * value / (2.0 * mean_square)) / (2.0 * PI * mean_square).sqrt()
}

/// The density of the slope along one axis of GGX: that of Walter et al. (2007), Eq. 33, integrated over the other axis.
fn ggx(slope: f64, alpha: f64) -> f64 {
    let root = (1.0 + (slope / alpha).powi(2)).sqrt();
    1.0 / (2.0 * alpha * root.powi(3))
}
