//! How a case is estimated: where its paths start, and the control variate that is subtracted.

pub(crate) mod analytic;
pub(crate) mod control_variates;
mod known_slopes;
pub(crate) mod method;
