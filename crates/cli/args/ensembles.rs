//! What can be asked of commands that draw many surfaces: verify, map and converge.

use std::path::PathBuf;

use asperity_simulate::{Estimator, Quantity};
use asperity_studies::{parse_count, parse_number, parse_order, parse_seconds};
use asperity_tally::{HemisphereGrid, Sides};
use asperity_tracer::{AcceleratorKind, Sampling};
use clap::Args;

use super::{AzimuthArgument, BranchingArgument, FromArgument, MaterialArgument, MediumArguments};

/// Random surfaces; flags override the file.
#[derive(Debug, Args)]
pub(crate) struct RandomSurfaces {
    /// 1/e correlation length, length units
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) tau: Option<f64>,
    /// The same along the second principal axis
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) tau_y: Option<f64>,
    /// Angle from +x to the first principal axis, degrees
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) azimuth: Option<f64>,
    /// Smoothness tau / sigma, one or several: 6,3,1
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true, conflicts_with = "sigma")]
    pub(crate) smoothness: Vec<f64>,
    /// Root mean square height, one or several; instead of --smoothness
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) sigma: Vec<f64>,
    /// Samples along x, or X,Y
    #[arg(long, value_parser = parse_count, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) size: Vec<u64>,
    /// Length units a sample along x, or X,Y
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) spacing: Vec<f64>,
    /// Draw surfaces even if the grid cannot resolve or hold them
    #[arg(long)]
    pub(crate) insist: bool,
}

impl RandomSurfaces {
    /// Whether anything is said of them that a given surface has not: all but the spacing.
    pub(crate) fn shape_is_given(&self) -> bool {
        self.tau.is_some()
            || self.tau_y.is_some()
            || self.azimuth.is_some()
            || !self.smoothness.is_empty()
            || !self.sigma.is_empty()
            || !self.size.is_empty()
            || self.insist
    }
}

/// What surfaces are made of; flags override the file.
#[derive(Debug, Args)]
pub(crate) struct Substance {
    /// Material of the surface
    #[arg(long, value_enum)]
    pub(crate) material: Option<MaterialArgument>,
    /// Relative refractive index, one or several: 1.4,1/1.4
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) eta: Vec<f64>,
    /// Absorption index of a conductor
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) kappa: Option<f64>,
}

/// How rays are followed, and what is recorded of them; flags override the file.
#[derive(Debug, Args)]
pub(crate) struct Rays {
    /// Seed of surfaces and rays
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// Bins of a hemisphere, THETAxPHI
    #[arg(long)]
    pub(crate) bins: Option<HemisphereGrid>,
    /// Half width of the in-plane wedge, degrees
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) in_plane_half_width: Option<f64>,
    /// The side whose light is recorded: both, reflected or transmitted
    #[arg(long)]
    pub(crate) side: Option<Sides>,
    /// Follow both branches at an interface, or pick one
    #[arg(long, value_enum)]
    pub(crate) branching: Option<BranchingArgument>,
    /// Flux, of an incident ray's, below which roulette decides whether a branch goes on
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) roulette: Option<f64>,
    /// Interactions after which a path is truncated
    #[arg(long, value_parser = parse_order, allow_negative_numbers = true)]
    pub(crate) max_order: Option<u32>,
    /// How hits are found: auto, mesh, pyramid, flat (flat surfaces only) or brute-force
    #[arg(long)]
    pub(crate) accelerator: Option<AcceleratorKind>,
    /// How rays are spread: random, stratified or quasi-random
    #[arg(long)]
    pub(crate) sampling: Option<Sampling>,
}

/// The surfaces, the material and the light of an ensemble; flags override the file.
#[derive(Debug, Args)]
pub(crate) struct Ensemble {
    #[command(flatten)]
    pub(crate) surfaces: RandomSurfaces,
    #[command(flatten)]
    pub(crate) substance: Substance,
    /// Polar angle of the direction towards the light, degrees, one or several: 0,30,60
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) theta: Vec<f64>,
    /// Azimuth of the direction towards the light, degrees
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) phi: Option<f64>,
    /// The side that the light comes from
    #[arg(long, value_enum)]
    pub(crate) from: Option<FromArgument>,
    /// Whether every ray comes from an azimuth of its own, and what leaves is turned back [default: random where surfaces are isotropic]
    #[arg(long, value_enum)]
    pub(crate) light_azimuth: Option<AzimuthArgument>,
}

#[derive(Debug, Args)]
pub(crate) struct Verify {
    /// Configuration; every key has a default, and flags override the file
    pub(crate) config: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) ensemble: Ensemble,
    #[command(flatten)]
    pub(crate) medium: MediumArguments,
    /// Surfaces drawn for each case
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) realisations: Option<u64>,
    /// Rays for each case, over all its surfaces
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) rays: Option<u64>,
    /// Error to reach, instead of a number of surfaces and rays
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, value_name = "ERROR", conflicts_with_all = ["realisations", "rays"])]
    pub(crate) target_error: Option<f64>,
    /// Whose error: reflected, transmitted or absorbed, as a flux fraction; bins, rings or in-plane, relative [default: bins]
    #[arg(long, value_name = "QUANTITY")]
    pub(crate) of: Option<Quantity>,
    /// Time after which nothing more is begun: seconds, or as 10m or 2h
    #[arg(long, value_parser = parse_seconds, allow_negative_numbers = true, value_name = "TIME")]
    pub(crate) max_time: Option<f64>,
    #[command(flatten)]
    pub(crate) followed: Rays,
    /// How paths become results: auto, plain or controlled
    #[arg(long)]
    pub(crate) estimator: Option<Estimator>,
    /// Trace every surface at half the spacing as well and report that; the difference is the error of the mesh
    #[arg(long)]
    pub(crate) refine: bool,
    /// Level of the tests of a case
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) alpha: Option<f64>,
    /// Models to compare with, by name, as `model --list` has them: xu-sun,smith; or none [default beside a medium: flat-layer]
    #[arg(long, value_delimiter = ',', num_args = 1)]
    pub(crate) models: Option<Vec<String>>,
    /// Rays that a model follows which is evaluated so
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) model_rays: Option<u64>,
    /// Folder for the results
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Draw no plots
    #[arg(long)]
    pub(crate) no_plots: bool,
    /// Print the comparison as JSON on standard output, instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(mut_arg("alpha", |alpha| alpha.hide(true)))]
pub(crate) struct Map {
    #[command(flatten)]
    pub(crate) verify: Verify,
    /// Total variation that is tolerated, of the incident flux [default: 0.01]
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, value_name = "FLUX")]
    pub(crate) tolerance_total_variation: Option<f64>,
    /// Difference in energy of a side that is tolerated, of the incident flux [default: 0.01]
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, value_name = "FLUX")]
    pub(crate) tolerance_energy: Option<f64>,
    /// Difference in direction of a peak that is tolerated, degrees [default: 2.5]
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, value_name = "DEGREES")]
    pub(crate) tolerance_peak: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct Converge {
    /// Configuration; every key has a default, and flags override the file
    pub(crate) config: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) ensemble: Ensemble,
    /// Estimators, one or several: plain,controlled
    #[arg(long, value_delimiter = ',', num_args = 1)]
    pub(crate) estimators: Vec<Estimator>,
    /// How rays are spread, one or several: random,stratified,quasi-random
    #[arg(long, value_delimiter = ',', num_args = 1)]
    pub(crate) samplings: Vec<Sampling>,
    /// How hits are found, one or several: auto,mesh,pyramid,brute-force
    #[arg(long, value_delimiter = ',', num_args = 1)]
    pub(crate) accelerators: Vec<AcceleratorKind>,
    /// Length units a sample, one or several, over the same extent: size times spacing
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) spacings: Vec<f64>,
    /// Rays a surface, one for all or as many as surfaces: 1e3,1e4
    #[arg(long, value_parser = parse_count, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) rays: Vec<u64>,
    /// Surfaces of a run, one for all or as many as rays: 4,16,64
    #[arg(long, value_parser = parse_count, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) surfaces: Vec<u64>,
    /// Runs of each method and effort
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) repeats: Option<u64>,
    /// Rays a surface of the reference
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) reference_rays: Option<u64>,
    /// Surfaces of the reference
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) reference_surfaces: Option<u64>,
    /// Seed of which those of all runs derive
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// Bins of a hemisphere, THETAxPHI
    #[arg(long)]
    pub(crate) bins: Option<HemisphereGrid>,
    /// The side over whose bins errors are taken: both, reflected or transmitted
    #[arg(long)]
    pub(crate) side: Option<Sides>,
    /// Errors to which the seconds are asked: 1e-2,1e-3
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) errors: Vec<f64>,
    /// Folder for the results
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Draw no plot
    #[arg(long)]
    pub(crate) no_plots: bool,
    /// Print summary.json on standard output, instead of the tables
    #[arg(long)]
    pub(crate) json: bool,
}
