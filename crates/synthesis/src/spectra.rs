//! Power spectral densities of random surfaces.

mod axes;
mod error;
mod estimate;
mod gaussian;
mod matern;
mod plane;
mod power_law;
mod prepared;
mod profile;
mod projection;
mod psd;
mod radial;
mod radial_table;
#[cfg(test)]
mod spectra_tests;
#[cfg(test)]
mod tests;

pub use self::error::{PsdError, PsdTableError};
pub use self::estimate::EstimateError;
pub use self::gaussian::GaussianPsd;
pub use self::plane::PlanePsd;
pub(crate) use self::prepared::PreparedDensity;
pub use self::psd::{Psd, SumPsd};
pub use self::radial::RadialPsd;
pub use self::radial_table::RadialTable;
