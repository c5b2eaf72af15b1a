//! Numerics: special functions and interpolation for random surfaces.

mod curve;
mod gauss_rule;
mod hermite;
mod normal_moments;
mod quadrature;
mod special;

pub(crate) use self::curve::Curve;
pub(crate) use self::gauss_rule::gauss_rule;
pub(crate) use self::hermite::HermiteSeries;
pub(crate) use self::normal_moments::{normal_moments, normal_nodes};
pub(crate) use self::quadrature::{gauss_legendre, root};
pub(crate) use self::special::{exponential_integral, ln_normal_cdf};
