//! Editing of surfaces: form removal, filters, missing points and resampling.

mod form;
mod gaussian_filter;
mod missing;
mod resampling;

pub use self::form::Form;
pub use self::gaussian_filter::{FilterError, GaussianFilter};
pub use self::missing::{MissingError, MissingPolicy, RawHeightMap};
pub use self::resampling::{CoarseningError, RefinementError};
