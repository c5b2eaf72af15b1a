//! Drawing of random surfaces.

mod direct;
mod error;
mod expected_moments;
mod field_synthesis;
mod filter;
mod limits;
mod memory;
mod noise;
mod slope_mixture;
mod slopes;
mod spectrum;
mod spectrum_mismatch;
mod splines;
mod synthesis;
mod transform;

pub use self::error::{MAX_SAMPLES, SynthesisError, UNRESOLVED_SLOPES};
pub use self::field_synthesis::{FieldSynthesis, Resolution};
pub use self::limits::{MIN_CORRELATION_LENGTHS_PER_SIDE, MIN_SPACINGS_PER_CORRELATION_LENGTH};
pub use self::slope_mixture::{SlopeComponent, SlopeMixture};
pub use self::spectrum_mismatch::SpectrumMismatch;
pub use self::splines::{MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH, SplineSynthesis};
pub use self::synthesis::Synthesis;
