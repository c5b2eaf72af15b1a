//! Where light went: hemispherical histograms, batch statistics and the energy budget.

mod grid;

pub use grid::{Bin, HemisphereGrid, HemisphereGridError, Side};
