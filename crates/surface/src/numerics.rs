//! Numerics: special functions and interpolation for random surfaces.

mod columns;
mod curve;
mod gauss_rule;
mod half_plane;
mod hermite;
mod normal_moments;
mod quadrature;
mod special;
mod window;

pub(crate) use self::columns::columns;
pub(crate) use self::curve::Curve;
pub(crate) use self::gauss_rule::gauss_rule;
pub(crate) use self::half_plane::{HalfPlane, power_plane, transform_plane};
pub(crate) use self::hermite::HermiteSeries;
pub(crate) use self::normal_moments::{normal_moments, normal_nodes};
pub(crate) use self::quadrature::{gauss_legendre, root};
pub(crate) use self::special::{exponential_integral, ln_normal_cdf};
pub(crate) use self::window::multiply_by_hann;
