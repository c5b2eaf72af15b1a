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
//! use asperity_analysis::{Masking, SlopeCovariance, Smith, bin_fluxes, hemispherical_energy};
//! use asperity_optics::{Incidence, Material};
//! use asperity_tally::HemisphereGrid;
//!
//! let glass = Material::dielectric(1.4)?;
//! let slopes = SlopeCovariance::isotropic(3.0)?;
//! let model = Smith::new(slopes, glass, Masking::HeightCorrelated)?;
//! let wi = Incidence::from_degrees(30.0, 0.0)?.wi();
//! let energy = hemispherical_energy(&model, wi);
//! assert!((energy.transmitted - 0.958_340).abs() < 1e-6);
//! let fluxes = bin_fluxes(&model, wi, &HemisphereGrid::default());
//! let total: f64 = fluxes.iter().sum();
//! assert!((total - energy.reflected - energy.transmitted).abs() < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod attenuation;
mod comparison;
mod control;
mod deviation;
mod energy;
mod expectation;
mod facet_scattering;
mod family;
mod flat_layer;
mod flux;
mod gaussian_normals;
mod hash;
mod heitz;
mod kinematics;
mod kinks;
mod lobe;
mod model;
mod neumann;
mod quadrature;
mod registry;
mod sign_flip;
mod slopes;
mod smith;
mod unshadowed;
mod v_cavity;
mod verdict;
mod visible_normals;
mod xu_sun;
mod xu_sun_mc;

pub use attenuation::{
    facing_share, smith_correlated_g2, smith_demarcation, smith_lit, smith_lit_as_printed,
    smith_separable_g2, smith_visibility, v_cavity_lit, v_cavity_mean_g1, v_cavity_mean_g2,
};
pub use comparison::{
    BinComparison, Comparison, ComparisonError, Expected, Grouping, TotalVariation, compare,
};
pub use control::{control, unshadowed_control, visible_shares};
pub use deviation::deviation_bound;
pub use energy::{HemisphericalEnergy, hemispherical_energy};
pub use expectation::{Effort, Expectation, expect};
pub use family::{chi_squared_per_degree, chi_squared_survival, sidak_level, sidak_z_threshold};
pub use flat_layer::{FlatLayer, FlatLayerError, LayerPaths, UnscatteredBeam};
pub use flux::{bin_fluxes, flux_into, in_plane_flux};
pub use hash::fnv1a;
pub use heitz::Heitz;
pub use kinematics::{Facet, reflecting_facet, refracting_facet};
pub use kinks::Kinks;
pub use model::{BsdfModel, ModelError, ScatteringModel, Scope, Walk};
pub use neumann::{Attenuation, CookTorranceNeumann};
pub use registry::{CLOSED_FORMS, MODEL_NAMES, closed_form, create_model};
pub use sign_flip::{ScaleTest, SignFlipTest, Untested};
pub use slopes::{SlopeCovariance, SlopeError, smith_lambda};
pub use smith::{Masking, Smith};
pub use unshadowed::unshadowed_fluxes;
pub use v_cavity::{VCavity, v_cavity_g1};
pub use verdict::{DEFAULT_LEVEL, Unresolved, Verdict, verdicts};
pub use xu_sun::{XuSun, xu_sun_visibility};
pub use xu_sun_mc::{RayVisibility, XuSunMonteCarlo};
