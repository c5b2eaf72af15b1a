//! The program as its users run it, and the libraries behind it on whole runs.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests fail as their helpers do, and say what they skip"
)]

mod absorbed_map;
mod albedo;
mod appearance;
mod areal;
mod attenuation;
mod attenuation_files;
mod cells;
mod commands;
mod converge;
mod coverage;
mod engines;
mod estimators;
mod exactness;
mod examples;
mod export;
mod export_fit;
mod export_pbsdf;
mod export_rgl;
mod export_tables;
mod export_window;
mod figures;
mod flags;
mod given;
mod given_ensembles;
mod given_models;
mod gonio;
mod gonio_given;
mod headlines;
mod instructions;
mod instrument_files;
mod interrupts;
mod lambertian;
mod layer_models;
mod lobes;
mod map;
mod materials;
mod media;
mod meshes;
mod models;
mod polarised;
mod polarised_figures;
mod random_surfaces;
mod recipes;
mod reference;
mod refusals;
mod render;
mod report;
mod resources;
mod results;
mod settings;
mod shards;
mod slabs;
mod smooth_meshes;
mod spectra;
mod stopping;
mod structures;
mod support;
mod surface_files;
mod tensor_file;
mod tools;
mod verbose;
mod verify;
mod wavelengths;
mod width;
