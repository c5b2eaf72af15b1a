//! Numerical tools that are independent of optics.

pub(crate) mod hash;
pub(crate) mod quadrature;
pub(crate) mod special;
