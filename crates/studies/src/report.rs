//! Report: tables of fluxes, summaries, figures, and the files of a study.

mod aperture_light;
pub(crate) mod appearance;
pub(crate) mod areal_parameters;
pub(crate) mod case_views;
pub(crate) mod colours;
pub(crate) mod config_json;
pub(crate) mod disc_bins;
pub(crate) mod distribution_table;
pub(crate) mod effort;
pub(crate) mod energies;
pub(crate) mod error;
pub(crate) mod figures;
pub(crate) mod flux_basis;
pub(crate) mod flux_tables;
pub(crate) mod fluxes;
pub(crate) mod headline;
pub(crate) mod polarised;
pub(crate) mod polarised_figures;
pub(crate) mod roughness;
pub(crate) mod shown_case;
pub(crate) mod spectrum;
pub(crate) mod spectrum_views;
mod structure;
pub(crate) mod summary;
pub(crate) mod views;
