//! Random surfaces: spectra, recipes, structures, and how they are drawn and worn.
//!
//! [`Synthesis`] draws height fields from a [`Psd`], and [`SplineSynthesis`] splines. Surfaces that are not Gaussian are drawn
//! by [`FieldSynthesis`] from a [`SurfaceRecipe`]. An [`Erosion`] wears any surface.
//!
//! # Example
//! ```
//! use asperity_synthesis::{DrawnRoughness, Psd, Synthesis};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Root mean square height 0.5 and correlation length 1, 8 samples to each, 32 of them a side
//! let psd = Psd::gaussian(0.5, 1.0)?;
//! let synthesis = Synthesis::new(psd, [256, 256], [0.125, 0.125], false)?;
//! let seed = 1;
//! let surface = synthesis.draw(seed, 0)?;
//!
//! // A realisation is not rescaled: its roughness scatters about the requested one.
//! let drawn = DrawnRoughness::of(&surface);
//! let sigma = drawn.realised.expect("the surface was generated").sigma;
//! let scatter = sigma.expected_deviation.expect("known for a Gaussian");
//! assert_eq!(sigma.requested, 0.5);
//! assert!((drawn.roughness.sq - sigma.requested).abs() < 4.0 * scatter);
//! # Ok(())
//! # }
//! ```

mod drawing;
mod erosion;
mod gives_up;
mod realised;
mod recipe;
mod spectra;
mod structures;

pub use drawing::{
    FieldSynthesis, MAX_SAMPLES, MIN_CORRELATION_LENGTHS_PER_SIDE,
    MIN_SPACINGS_PER_CORRELATION_LENGTH, MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH, Resolution,
    SlopeComponent, SlopeMixture, SpectrumMismatch, SplineSynthesis, Synthesis, SynthesisError,
    UNRESOLVED_SLOPES,
};
pub use erosion::{Erosion, ErosionError, Etch, MAX_ETCH_SPACINGS, MAX_SLIP_STEPS, Slip};
pub use gives_up::{GivesUp, NEVER};
pub use realised::{
    Compared, DrawnRoughness, Expectation, Gradients, Realisation, Realised, RealisedStructure,
    SteeperThan,
};
pub use recipe::{
    ErodedSurface, HeightDistribution, HeightTable, HeightTableError, Johnson, JohnsonError,
    JohnsonFamily, MeasuredStructure, Provenance, StructuredSurface, StudentSlopes, SurfaceRecipe,
    TransformedHeights,
};
pub use spectra::{
    EstimateError, GaussianPsd, PlanePsd, Psd, PsdError, PsdTableError, RadialPsd, RadialTable,
    SumPsd,
};
pub use structures::{
    Allowed, Arrangement, Cracks, GrooveProfile, Grooves, MAX_ADJUSTMENT, MAX_FEATURES,
    MIN_SPACINGS_PER_WIDTH, Pyramids, Scratches, SphericalSegments, Structure, StructureError,
    StructureStatistics, StructureSynthesis,
};
