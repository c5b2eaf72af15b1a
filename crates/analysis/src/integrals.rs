//! Models integrated over bins, hemispheres and slopes.

pub(crate) mod attenuation;
pub(crate) mod control_variate;
pub(crate) mod deviation_bound;
pub(crate) mod energy;
pub(crate) mod expectation;
pub(crate) mod flux;
mod flux_integral;
mod lobe;
mod slope_images;
pub(crate) mod tabulated;
pub(crate) mod unshadowed;
