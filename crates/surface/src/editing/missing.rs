//! Height maps as instruments deliver them: with points missing.

mod error;
mod fill;
mod laplace;
mod raw_map;
#[cfg(test)]
mod tests;

pub use self::error::MissingError;
pub use self::raw_map::{MissingPolicy, RawHeightMap};
