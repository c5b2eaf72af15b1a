//! The scattering models, one per file, and the registry of their names.

pub(crate) mod heitz;
pub(crate) mod heitz_polarised;
pub(crate) mod kinks;
pub(crate) mod model;
pub(crate) mod neumann;
pub(crate) mod oren_nayar;
pub(crate) mod registry;
pub(crate) mod sampling;
pub(crate) mod smith;
pub(crate) mod smith_slopes;
pub(crate) mod v_cavity;
pub(crate) mod xu_sun;
pub(crate) mod xu_sun_mc;
