//! Statistical scattering models of rough surfaces and their comparison with explicit results.
//!
//! The models know nothing of ray tracing: they are the independent side of every comparison.
//!
//! # Conventions
//! `wi` points towards the light (`z > 0`), `wo` to where the light goes (`z > 0` reflected,
//! `z < 0` transmitted). `eta` is the index behind the surface relative to that before it.
//! Smoothness `s = tau / sigma` is the 1/e correlation length over the root mean square height of
//! a surface with autocorrelation `sigma^2 exp(-r^2 / tau^2)`; its facet slopes have variance
//! `2 / s^2` per axis. A BSDF is outgoing radiance over incident irradiance, in 1/sr, so that the
//! solid angle `dOmega` about `wo` receives the share `f |cos theta_o| dOmega` of the flux that
//! falls on the mean plane. Fluxes here are such shares.
//!
//! # Example
//! ```
//! use asperity_analysis::{ScatteringModel, bin_fluxes, create_model, hemispherical_energy};
//! use asperity_optics::{Incidence, Material};
//! use asperity_tally::HemisphereGrid;
//!
//! let glass = Material::dielectric(1.4)?;
//! let model = create_model("smith", 3.0, glass)?;
//! let wi = Incidence::from_degrees(30.0, 0.0)?.wi();
//! let energy = hemispherical_energy(model.as_ref(), wi);
//! assert!((energy.transmitted - 0.958_340).abs() < 1e-6);
//! let fluxes = bin_fluxes(model.as_ref(), wi, &HemisphereGrid::default());
//! let total: f64 = fluxes.iter().sum();
//! assert!((total - energy.reflected - energy.transmitted).abs() < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod attenuation;
mod comparison;
mod control;
mod deviation;
mod energy;
mod facet_scattering;
mod family;
mod flux;
mod kinematics;
mod lobe;
mod model;
mod quadrature;
mod registry;
mod sign_flip;
mod slopes;
mod smith;
mod unshadowed;
mod verdict;
mod xu_sun;

pub use attenuation::{
    facing_share, smith_correlated_g2, smith_demarcation, smith_lit, smith_lit_as_printed,
    smith_separable_g2, smith_visibility, v_cavity_lit, v_cavity_mean_g1, v_cavity_mean_g2,
};
pub use comparison::{
    BinComparison, Comparison, ComparisonError, Grouping, TotalVariation, compare,
};
pub use control::{control, unshadowed_control, visible_shares};
pub use deviation::deviation_bound;
pub use energy::{HemisphericalEnergy, hemispherical_energy};
pub use family::{chi_squared_per_degree, chi_squared_survival, sidak_level, sidak_z_threshold};
pub use flux::{bin_fluxes, flux_into};
pub use kinematics::{Facet, reflecting_facet, refracting_facet};
pub use model::{BsdfModel, ExpectedFluxes, ModelError, ScatteringModel, Scope};
pub use registry::{MODEL_NAMES, create_model};
pub use sign_flip::{ScaleTest, SignFlipTest, Untested};
pub use slopes::{SlopeCovariance, SlopeError, smith_lambda};
pub use smith::{Masking, Smith};
pub use unshadowed::unshadowed_fluxes;
pub use verdict::{DEFAULT_LEVEL, Unresolved, Verdict, verdicts};
pub use xu_sun::{XuSun, xu_sun_visibility};
