//! Compared: one number, requested and realised.

use serde::Serialize;

/// One number, requested and realised.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// The requested value.
    pub requested: f64,
    /// What this surface has; `None` if it cannot be measured on it.
    pub realised: Option<f64>,
    /// Standard deviation expected of the realised value between realisations, where it is known.
    pub expected_deviation: Option<f64>,
}
