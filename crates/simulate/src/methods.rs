//! Methods: estimate a case by its path starts and a control variate.

pub(crate) mod analytic;
pub(crate) mod control_variates;
mod known_slopes;
pub(crate) mod method;
