//! Missing points: height maps as instruments deliver them, and how gaps are filled.

mod error;
mod fill;
mod laplace;
mod raw_map;
#[cfg(test)]
mod tests;

pub use self::error::MissingError;
pub use self::raw_map::{MissingPolicy, RawHeightMap};
