//! Surface recipe: description of random surfaces, without grid, seed and number.

use serde::{Deserialize, Serialize};

use super::drawn_moments::{DrawnMoments, with_density};
use super::height_distribution::HeightDistribution;
use super::heights::TransformedHeights;
use super::structured::StructuredSurface;
use super::student::StudentSlopes;
use crate::{Erosion, Psd};

/// Description by which random surfaces are drawn, without grid, seed and number.
///
/// [`FieldSynthesis`](crate::FieldSynthesis) draws any; [`Synthesis`](crate::Synthesis) and
/// [`SplineSynthesis`](crate::SplineSynthesis) draw Gaussian ones.
///
/// # Examples
/// ```
/// use asperity_synthesis::{Psd, SurfaceRecipe};
///
/// let recipe = SurfaceRecipe::from(Psd::gaussian(0.5, 2.0)?);
/// assert_eq!(recipe.sigma(), 0.5);
/// assert!(recipe.gaussian().is_some());
/// # Ok::<(), asperity_synthesis::PsdError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum SurfaceRecipe {
    /// Gaussian heights, and so Gaussian slopes, of a power spectral density.
    Gaussian(Psd),
    /// Heights of another distribution than the Gaussian.
    Transformed(TransformedHeights),
    /// Slopes of Student's distribution of two degrees of freedom: GGX.
    StudentSlopes(StudentSlopes),
    /// A structure, with Gaussian roughness on top or without.
    Structured(Box<StructuredSurface>),
    /// Any of these after erosion.
    Eroded(Box<ErodedSurface>),
}

/// Random surfaces after processes of erosion.
///
/// Height and slopes, which models and bins need, are measured on two surfaces of the grid that it is made for. Correlation lengths and
/// symmetries are those before the erosion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErodedSurface {
    /// The surfaces before the erosion.
    before: SurfaceRecipe,
    /// The processes, in the order in which they act.
    erosion: Vec<Erosion>,
    /// Root mean square height about the mean, length units.
    sigma: f64,
    /// Covariance `[xx, xy, yy]` of slopes.
    slope_covariance: [f64; 3],
}

impl ErodedSurface {
    /// Surfaces with the `moments` after these processes.
    pub(crate) fn new(before: SurfaceRecipe, erosion: Vec<Erosion>, moments: DrawnMoments) -> Self {
        let DrawnMoments {
            mean,
            square,
            slopes,
        } = moments;
        Self {
            sigma: (square - mean * mean).max(0.0).sqrt(),
            slope_covariance: with_density(slopes, before.is_isotropic()),
            before,
            erosion,
        }
    }

    /// The surfaces before the erosion.
    #[must_use]
    pub const fn before(&self) -> &SurfaceRecipe {
        &self.before
    }

    /// The processes, in the order in which they act.
    #[must_use]
    pub fn erosion(&self) -> &[Erosion] {
        &self.erosion
    }

    const fn sigma(&self) -> f64 {
        self.sigma
    }

    /// Covariance `[xx, xy, yy]` of the slopes, dimensionless.
    #[must_use]
    pub const fn slope_covariance(&self) -> [f64; 3] {
        self.slope_covariance
    }

    fn is_valid(&self) -> bool {
        self.before.is_valid()
            && self.erosion.iter().all(|process| process.is_valid())
            && self.sigma.is_finite()
            && self.slope_covariance.iter().all(|term| term.is_finite())
    }

    fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        let erosion = self.erosion.iter();
        Self {
            before: self.before.converted(convert),
            erosion: erosion.map(|process| process.converted(convert)).collect(),
            sigma: convert(self.sigma),
            slope_covariance: self.slope_covariance,
        }
    }
}

impl From<Psd> for SurfaceRecipe {
    fn from(psd: Psd) -> Self {
        Self::Gaussian(psd)
    }
}

impl From<TransformedHeights> for SurfaceRecipe {
    fn from(transformed: TransformedHeights) -> Self {
        Self::Transformed(transformed)
    }
}

impl From<StudentSlopes> for SurfaceRecipe {
    fn from(student: StudentSlopes) -> Self {
        Self::StudentSlopes(student)
    }
}

impl From<StructuredSurface> for SurfaceRecipe {
    fn from(surface: StructuredSurface) -> Self {
        Self::Structured(Box::new(surface))
    }
}

impl From<ErodedSurface> for SurfaceRecipe {
    fn from(surface: ErodedSurface) -> Self {
        Self::Eroded(Box::new(surface))
    }
}

impl SurfaceRecipe {
    /// The power spectral density, if heights and slopes are Gaussian; `None` of all other surfaces.
    ///
    /// Models, control variates and analytic results that hold for Gaussian slopes alone take this.
    #[must_use]
    pub const fn gaussian(&self) -> Option<&Psd> {
        match self {
            Self::Gaussian(psd) => Some(psd),
            _ => None,
        }
    }

    /// The distribution of the heights, if it was requested.
    #[must_use]
    pub const fn heights(&self) -> Option<&HeightDistribution> {
        match self {
            Self::Transformed(transformed) => Some(transformed.heights()),
            _ => None,
        }
    }

    /// The structured surface; `None` of all other surfaces, eroded ones included.
    #[must_use]
    pub fn structured(&self) -> Option<&StructuredSurface> {
        match self {
            Self::Structured(surface) => Some(surface),
            _ => None,
        }
    }

    /// Returns `true` if height and slopes are measured on drawn surfaces, since no formula has them: slopes then have no known distribution,
    /// and finer grids are drawn anew.
    #[must_use]
    pub const fn is_measured(&self) -> bool {
        match self {
            Self::Structured(_) | Self::Eroded(_) => true,
            Self::Gaussian(_) | Self::Transformed(_) | Self::StudentSlopes(_) => false,
        }
    }

    /// Returns the part that decides correlation lengths, axes and symmetries.
    fn underlying(&self) -> Underlying<'_> {
        match self {
            Self::Gaussian(psd) => Underlying::Spectrum(psd),
            Self::Transformed(transformed) => Underlying::Spectrum(transformed.psd()),
            Self::StudentSlopes(student) => Underlying::Spectrum(student.base()),
            Self::Structured(surface) => Underlying::Structure(surface),
            Self::Eroded(surface) => surface.before().underlying(),
        }
    }

    /// Root mean square height, length units.
    #[must_use]
    pub fn sigma(&self) -> f64 {
        match self {
            Self::Gaussian(psd) => psd.sigma(),
            Self::Transformed(transformed) => transformed.psd().sigma(),
            Self::StudentSlopes(student) => student.sigma(),
            Self::Structured(surface) => surface.sigma(),
            Self::Eroded(surface) => surface.sigma(),
        }
    }

    /// 1/e correlation lengths along the two principal axes; of structured surfaces half the width of a feature, of eroded ones those before.
    #[must_use]
    pub fn correlation_lengths(&self) -> [f64; 2] {
        match self.underlying() {
            Underlying::Spectrum(psd) => psd.correlation_lengths(),
            Underlying::Structure(surface) => surface.correlation_lengths(),
        }
    }

    /// Lags along x and along y at which the autocorrelation is 1/e of its peak, length units.
    #[must_use]
    pub fn axis_correlation_lengths(&self) -> [f64; 2] {
        match self.underlying() {
            Underlying::Spectrum(psd) => psd.axis_correlation_lengths(),
            Underlying::Structure(surface) => surface.correlation_lengths(),
        }
    }

    /// Anisotropy of [`Psd::anisotropy`]; `None` of structured surfaces, whose directions no ratio describes.
    #[must_use]
    pub fn anisotropy(&self) -> Option<[f64; 2]> {
        match self.underlying() {
            Underlying::Spectrum(psd) => psd.anisotropy(),
            Underlying::Structure(_) => None,
        }
    }

    /// GGX's `alpha` along the principal axes, of surfaces of such slopes and before any erosion; `None` of all others.
    #[must_use]
    pub fn ggx_alpha(&self) -> Option<[f64; 2]> {
        match self {
            Self::StudentSlopes(student) => Some(student.alpha()),
            Self::Eroded(surface) => surface.before().ggx_alpha(),
            Self::Gaussian(_) | Self::Transformed(_) | Self::Structured(_) => None,
        }
    }

    /// Returns `true` if the statistics do not depend on azimuth.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match self.underlying() {
            Underlying::Spectrum(psd) => psd.is_isotropic(),
            Underlying::Structure(surface) => surface.is_isotropic(),
        }
    }

    /// Returns `true` if the statistics are the same on either side of the x axis, and so of the y axis.
    #[must_use]
    pub fn is_mirror_symmetric(&self) -> bool {
        match self.underlying() {
            Underlying::Spectrum(psd) => psd.is_mirror_symmetric(),
            Underlying::Structure(surface) => surface.is_mirror_symmetric(),
        }
    }

    /// Covariance `[xx, xy, yy]` of the slopes of the continuous surface, dimensionless.
    #[must_use]
    pub fn slope_covariance(&self) -> [f64; 3] {
        match self {
            Self::Gaussian(psd) => psd.slope_covariance(),
            Self::Transformed(transformed) => transformed.psd().slope_covariance(),
            Self::StudentSlopes(student) => student.slope_covariance(),
            Self::Structured(surface) => surface.slope_covariance(),
            Self::Eroded(surface) => surface.slope_covariance(),
        }
    }

    /// Variance of slopes along x (`axis` 0) or y (1) that are differences of heights `lag` apart: `2 (C(0) - C(lag)) / lag^2`.
    pub(crate) fn mesh_slope_variance(&self, axis: usize, lag: f64) -> f64 {
        let psd = match self.underlying() {
            Underlying::Spectrum(psd) => psd,
            // Measured on a mesh
            Underlying::Structure(surface) => return surface.slope_covariance()[2 * axis.min(1)],
        };
        let [x, y] = match axis {
            0 => [lag, 0.0],
            _ => [0.0, lag],
        };
        let drop = 1.0 - psd.autocorrelation(x, y) / psd.autocorrelation(0.0, 0.0);
        // Of a surface that is not Gaussian, the same fraction of its slope variance
        let [xx, _, yy] = self.slope_covariance();
        let [base_x, _, base_y] = psd.slope_covariance();
        let ratio = [xx / base_x, yy / base_y][axis.min(1)];
        2.0 * psd.sigma() * psd.sigma() * drop / (lag * lag) * ratio
    }

    /// Largest root mean square second derivative along a line, per length unit; `None` where it is not known or not finite.
    #[must_use]
    pub fn curvature(&self) -> Option<f64> {
        let curvature = match self {
            Self::Gaussian(psd) => psd.curvature(),
            Self::Transformed(transformed) => transformed.psd().curvature(),
            Self::StudentSlopes(student) => student.curvature(),
            Self::Structured(_) | Self::Eroded(_) => return None,
        };
        curvature.is_finite().then_some(curvature)
    }

    /// Returns `true` if all numbers are in range, for what was read from a file.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        match self {
            Self::Gaussian(psd) => psd.is_valid(),
            Self::Transformed(transformed) => transformed.is_valid(),
            Self::StudentSlopes(student) => student.is_valid(),
            Self::Structured(surface) => surface.is_valid(),
            Self::Eroded(surface) => surface.is_valid(),
        }
    }

    /// Returns the recipe with all lengths converted.
    #[must_use]
    pub(crate) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        match self {
            Self::Gaussian(psd) => Self::Gaussian(psd.converted(convert)),
            Self::Transformed(transformed) => Self::Transformed(transformed.converted(convert)),
            Self::StudentSlopes(student) => Self::StudentSlopes(student.converted(convert)),
            Self::Structured(surface) => surface.converted(convert).into(),
            Self::Eroded(surface) => surface.converted(convert).into(),
        }
    }
}

/// Part of a recipe that decides correlation lengths, axes and symmetries.
enum Underlying<'a> {
    Spectrum(&'a Psd),
    Structure(&'a StructuredSurface),
}
