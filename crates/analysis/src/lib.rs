//! Statistical scattering models of rough surfaces and their comparison with explicit results.
//!
//! The models do not depend on the ray tracer, so every comparison is between independent results.
//!
//! # Modules, from the bottom up
//! - `microfacet`: Gaussian slopes and tables of slopes, the distribution of facet normals, half vectors, sampling.
//! - `models`: one scattering model per file, and the registry of their names.
//! - `integrals`: models integrated over bins, hemispheres and all slopes.
//! - `layer`: participating media between flat faces.
//! - `compare`: tests of models against explicit results; independent of the models.
//!
//! # Conventions
//! `wi` points towards the light (`z > 0`), `wo` to where the light goes (`z > 0` reflected,
//! `z < 0` transmitted). `eta` is the index behind the surface relative to that before it.
//! Smoothness `s = tau / sigma` is the 1/e correlation length over the root mean square height of
//! a surface with autocorrelation `sigma^2 exp(-r^2 / tau^2)`; its facet slopes have variance
//! `2 / s^2` per axis. A BSDF is outgoing radiance over incident irradiance, in 1/sr, so the solid
//! angle `dOmega` about `wo` receives the fraction `f |cos theta_o| dOmega` of the flux incident on the mean
//! plane. Fluxes here are such fractions. `theta_i` and `theta_t` are angles to the facet normal `m` in the names
//! of variables (`cos_theta_i = wi . m`), and `wi.z` is the cosine of the polar angle of incidence.
//!
//! # Adding a model
//! Write one file in `models/` that implements [`ScatteringModel`], with [`BsdfModel`] for a closed form,
//! [`RandomWalk`] for a random walk, or both. Then add one line to the registry, `models/registry.rs`.
//!
//! # Examples
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

mod compare;
mod integrals;
mod layer;
mod microfacet;
mod models;

pub use compare::comparison::{
    BinComparison, Comparison, Grouping, TotalVariation, compare, compare_untested,
};
pub use compare::input::{ComparisonError, Expected, RayCount};
pub use compare::multiple_tests::{
    chi_squared_per_degree, chi_squared_survival, sidak_level, sidak_z_threshold,
};
pub use compare::sign_flip::{ScaleTest, SignFlipTest, Untested};
pub use compare::verdict::{DEFAULT_LEVEL, Unresolved, Verdict, verdicts};
pub use integrals::attenuation::{
    smith_correlated_g2, smith_demarcation, smith_lit, smith_lit_as_printed, smith_separable_g2,
    smith_visibility, v_cavity_lit, v_cavity_mean_g1, v_cavity_mean_g2,
};
pub use integrals::control_variate::{
    control_variate, unshadowed_control_variate, visible_fractions,
};
pub use integrals::deviation_bound::deviation_bound;
pub use integrals::energy::{HemisphericalEnergy, hemispherical_energy};
pub use integrals::expectation::{Expectation, SamplingEffort, expect, expect_unless};
pub use integrals::flux::{bin_fluxes, flux_into, in_plane_flux};
pub use integrals::tabulated::region_influence;
pub use integrals::unshadowed::unshadowed_fluxes;
pub use layer::{FlatLayers, FlatLayersError, LayerPaths, UnscatteredBeam};
pub use microfacet::beckmann::{Beckmann, Masking};
pub use microfacet::ggx::Ggx;
pub use microfacet::half_vector::{Facet, reflecting_facet, refracting_facet};
pub use microfacet::slope_distribution::SlopeDistribution;
pub use microfacet::slope_grid::{SlopeGrid, SlopeTableError};
pub use microfacet::slope_mixture::SlopeMixture;
pub use microfacet::slope_table::SlopeTable;
pub use microfacet::slopes::{SlopeCovariance, SlopeError};
pub use models::heitz::Heitz;
pub use models::heitz_polarised::HeitzPolarised;
pub use models::kinks::Kinks;
pub use models::model::{BsdfModel, ModelError, ModelInfo, RandomWalk, ScatteringModel, Scope};
pub use models::neumann::{Attenuation, CookTorranceNeumann};
pub use models::oren_nayar::OrenNayar;
pub use models::registry::{CLOSED_FORMS, MODEL_NAMES, closed_form, create_model};
pub use models::sampling::{sample_direction, sampling_density};
pub use models::smith::Smith;
pub use models::smith_slopes::SmithSlopes;
pub use models::v_cavity::{VCavity, v_cavity_g1};
pub use models::xu_sun::{XuSun, xu_sun_visibility};
pub use models::xu_sun_mc::{RayVisibility, XuSunMonteCarlo};
