//! Numerical tools that know nothing of light: quadrature and hashing.

pub(crate) mod hash;
pub(crate) mod quadrature;
