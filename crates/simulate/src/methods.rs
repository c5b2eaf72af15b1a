//! How a case is estimated: where its paths start, and the control variate that is subtracted.

pub(crate) mod analytic;
pub(crate) mod facet_control_variate;
mod known_slopes;
pub(crate) mod method;
pub(crate) mod slope_control;
