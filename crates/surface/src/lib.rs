//! Rough surfaces as height fields.
//!
//! A [`HeightField`] holds samples `h[iy][ix]` at `(ix dx, iy dy)` with shape `[ny, nx]`, a length
//! unit, and what lies beyond its border. [`Synthesis`] draws random ones from a [`Psd`],
//! [`Roughness`] measures any, [`Form`] removes mean, plane or parabola, and [`RawHeightMap`] with
//! its [`MissingPolicy`] fills or refuses points that an instrument did not see. The same surface on
//! a finer grid is [`HeightField::refined`]. A [`SplineSurface`] passes through the samples
//! smoothly; [`SplineSynthesis`] draws random ones. Surfaces that are not Gaussian are drawn by [`FieldSynthesis`] from a
//! [`SurfaceRecipe`].
//!
//! # Conventions
//! Autocorrelation `C(r) = sigma^2 exp(-r^2 / tau^2)`; `tau` is the 1/e length. The other habit,
//! `exp(-r^2 / (2 l^2))`, is `l = tau / sqrt 2`. Smoothness `s = tau / sigma`; slope variance per
//! axis `2 sigma^2 / tau^2 = 2 / s^2`. Power spectral density, two-sided in angular wave vector:
//! `W(k) = sigma^2 tau^2 / (4 pi) exp(-k^2 tau^2 / 4)`, whose integral over `d^2k` is `sigma^2`.
//!
//! # Example
//! ```
//! use asperity_surface::{Psd, Roughness, Synthesis};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Root mean square height 0.5 and correlation length 1, 8 samples to each, 32 of them a side
//! let psd = Psd::gaussian(0.5, 1.0)?;
//! let synthesis = Synthesis::new(psd, [256, 256], [0.125, 0.125], false)?;
//! let seed = 1;
//! let surface = synthesis.draw(seed, 0)?;
//!
//! // A realisation is not rescaled: its roughness scatters about the requested one.
//! let roughness = Roughness::of(&surface);
//! let sigma = roughness.realised.expect("the surface was generated").sigma;
//! let scatter = sigma.expected_deviation.expect("known for a Gaussian");
//! assert_eq!(sigma.requested, 0.5);
//! assert!((roughness.sq - sigma.requested).abs() < 4.0 * scatter);
//! # Ok(())
//! # }
//! ```

mod erosion;
mod field_synthesis;
mod form;
mod gaussian_filter;
mod height_field;
mod histogram;
mod iso25178;
mod missing;
mod numbers;
mod numerics;
mod psd;
mod recipe;
mod region_slopes;
mod resampling;
mod roughness;
mod slope_mixture;
mod slope_moments;
mod slope_samples;
mod spectrum;
mod spline;
mod structure;
mod synthesis;
mod unreached;

pub use erosion::{Erosion, ErosionError, Etch, MAX_ETCH_SPACINGS, MAX_SLIP_STEPS, Slip};
pub use field_synthesis::{FieldSynthesis, Resolution};
pub use form::{Form, FormError};
pub use gaussian_filter::{FilterError, GaussianFilter};
pub use height_field::{Border, HeightField, HeightFieldError, LengthUnit, check_grid};
pub use histogram::Histogram;
pub use iso25178::{FunctionalParameters, Iso25178, SpatialParameters};
pub use missing::{MissingError, MissingPolicy, RawHeightMap};
pub use numbers::short;
pub use psd::{
    EstimateError, GaussianPsd, PlanePsd, Psd, PsdError, PsdTableError, RadialPsd, RadialTable,
    SumPsd,
};
pub use recipe::{
    HeightDistribution, HeightTable, HeightTableError, Johnson, JohnsonError, JohnsonFamily,
    MeasuredStructure, Provenance, StructuredSurface, StudentSlopes, SurfaceRecipe,
    TransformedHeights,
};
pub use region_slopes::RegionSlopes;
pub use resampling::{CoarseningError, RefinementError};
pub use roughness::{
    AxisAutocorrelation, Compared, Expectation, Gradients, Realised, RealisedStructure, Roughness,
    SteeperThan, SteepestFacet, Triangle,
};
pub use slope_mixture::{SlopeComponent, SlopeMixture};
pub use slope_moments::SlopeMoments;
pub use spectrum::{PowerSpectrum, SpectralRing};
pub use spline::{SplineRoughness, SplineSurface};
pub use structure::{
    Allowed, Arrangement, Cracks, GrooveProfile, Grooves, MAX_ADJUSTMENT, MAX_FEATURES,
    MIN_SPACINGS_PER_WIDTH, Pyramids, Scratches, SphericalSegments, Structure, StructureError,
    StructureStatistics, StructureSynthesis,
};
pub use synthesis::splines::{MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH, SplineSynthesis};
pub use synthesis::{
    MAX_SAMPLES, MIN_CORRELATION_LENGTHS_PER_SIDE, MIN_SPACINGS_PER_CORRELATION_LENGTH, Synthesis,
    SynthesisError, UNRESOLVED_SLOPES,
};
pub use unreached::Unreached;
