//! What can be asked for on the command line.

mod attenuation;
mod ensembles;
mod gonio;
mod medium;
mod model;
mod render;

use std::path::PathBuf;

use asperity_simulate::{Estimator, Quantity};
use asperity_studies::{Azimuth, parse_count, parse_number, parse_order, parse_seconds};
use asperity_surface::{Border, Form, LengthUnit, MissingPolicy};
use asperity_tally::{HemisphereGrid, Sides};
use asperity_tracer::{AcceleratorKind, Branching, Sampling};
use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::output::say;

pub(crate) use attenuation::Attenuation;
pub(crate) use ensembles::{Converge, Ensemble, Map, RandomSurfaces, Rays, Substance, Verify};
pub(crate) use gonio::Gonio;
pub(crate) use medium::MediumArguments;
pub(crate) use model::Model;
pub(crate) use render::{CameraArgument, CameraArguments, LightsArguments, Render};

/// Light on explicit rough surfaces: generate or read a height map, mesh it, trace real reflection
/// and refraction on it, and compare what comes out with the statistical models.
///
/// Angles are in degrees; --theta and --phi give the direction towards the light. Numbers may be
/// quotients (1/1.4), counts may be written as 1e6. Exit codes: 0 done, 1 failed, 2 wrong usage.
#[derive(Debug, Parser)]
#[command(name = "asperity", version, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Options of every command.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct Common {
    /// Threads to use; all cores unless given
    #[arg(long, global = true, value_name = "N", value_parser = parse_threads)]
    pub(crate) threads: Option<usize>,
    /// Print nothing but errors, what --json asks for, and the values of a model without -o
    #[arg(long, short, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say on standard error what is done and how long it takes
    #[arg(long, short, global = true)]
    pub(crate) verbose: bool,
}

impl Common {
    /// Says something on standard error with `--verbose`.
    pub(crate) fn say(&self, what: impl FnOnce() -> String) {
        if self.verbose {
            say(&what());
        }
    }
}

/// Most threads: beyond, starting them takes longer than they save.
const MOST_THREADS: usize = 1024;

fn parse_threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads) if (1..=MOST_THREADS).contains(&threads) => Ok(threads),
        _ => Err(format!(
            "`{text}` threads cannot be used; give 1 to {MOST_THREADS}"
        )),
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw a random rough surface and write it as a height map
    Generate(Generate),
    /// Roughness statistics of a height map
    Inspect(Inspect),
    /// Write a height map as the triangle mesh that is traced
    Mesh(Mesh),
    /// Trace light on one surface
    Trace(Box<Trace>),
    /// Make a picture of one surface and the medium below it
    Render(Box<Render>),
    /// Trace light on fresh random surfaces and compare with the statistical models
    Verify(Box<Verify>),
    /// Map where each model holds, over smoothness, material and angle; goes on where it was left
    Map(Box<Map>),
    /// Measure the whole BRDF and BTDF, direction by direction; goes on where it was left
    Gonio(Box<Gonio>),
    /// Measure run time against error for estimators, samplings, accelerators and spacings
    Converge(Box<Converge>),
    /// Measure shadowing and masking on explicit surfaces, beside Smith and V-cavities
    Attenuation(Box<Attenuation>),
    /// Evaluate a statistical model
    Model(Box<Model>),
}

/// How a height map is read.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// What lies beyond the border: periodic, mirrored or open; as the file says unless given (a mesh is open)
    #[arg(long, value_name = "BORDER")]
    pub(crate) border: Option<Border>,
    /// Length units a sample along x, or X,Y; as the file says unless given
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) spacing: Vec<f64>,
    /// Length unit of heights and spacing: 1 (arbitrary), m, mm, um or nm; as the file says unless given
    #[arg(long)]
    pub(crate) unit: Option<LengthUnit>,
    /// What to do with missing points: refuse or fill
    #[arg(long, value_name = "POLICY", default_value = "refuse")]
    pub(crate) missing: MissingPolicy,
    /// Form to remove by least squares: none, mean, plane or parabola
    #[arg(long, value_name = "FORM", default_value = "none")]
    pub(crate) remove: Form,
}

/// The power spectral densities.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum PsdKind {
    /// Gaussian autocorrelation.
    Gaussian,
}

#[derive(Debug, Args)]
pub(crate) struct Generate {
    /// 1/e correlation length tau, C = sigma^2 exp(-r^2 / tau^2), length units
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) tau: f64,
    /// The same along the second principal axis [default: tau]
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) tau_y: Option<f64>,
    /// Angle from +x to the first principal axis, degrees
    #[arg(long, value_parser = parse_number, default_value = "0", allow_negative_numbers = true)]
    pub(crate) azimuth: f64,
    /// Smoothness s = tau / sigma
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) smoothness: Option<f64>,
    /// Root mean square height sigma, length units; instead of --smoothness
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, conflicts_with = "smoothness", required_unless_present = "smoothness")]
    pub(crate) sigma: Option<f64>,
    /// Samples along x, or X,Y
    #[arg(long, value_parser = parse_count, value_delimiter = ',', num_args = 1, allow_negative_numbers = true, default_value = "1024")]
    pub(crate) size: Vec<u64>,
    /// Length units a sample along x, or X,Y
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, default_value = "1", allow_negative_numbers = true)]
    pub(crate) spacing: Vec<f64>,
    /// Length unit: 1 (arbitrary), m, mm, um or nm
    #[arg(long, default_value = "1")]
    pub(crate) unit: LengthUnit,
    /// Power spectral density
    #[arg(long, value_enum, default_value = "gaussian")]
    pub(crate) psd: PsdKind,
    /// Seed
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// Which realisation of that seed
    #[arg(long, default_value = "0")]
    pub(crate) realisation: u64,
    /// Draw even what the grid cannot resolve or hold
    #[arg(long)]
    pub(crate) insist: bool,
    /// File to write: .exr, .npy, .gsf, .x3p, or .png for the eye
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Print requested and realised statistics as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Inspect {
    /// Height map: .exr, .npy, .gsf, .x3p, .asc, .txt or .csv
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw the height map with a colour bar: .svg or .png
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Write the surface as it was read, filled and freed of form: .exr, .npy, .gsf, .x3p or .png
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Mesh {
    /// Height map: .exr, .npy, .gsf, .x3p, .asc, .txt or .csv
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// File to write: .ply, .obj or .stl
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
}

/// The kinds of material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MaterialArgument {
    /// Reflects and transmits; --eta is n_transmitted / n_incident
    Dielectric,
    /// Reflects and absorbs; its index is --eta + i --kappa
    Conductor,
    /// Reflects everything
    Mirror,
}

/// The side that light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FromArgument {
    /// Above the surface
    Above,
    /// Below the surface
    Below,
}

/// How the azimuth of the light is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AzimuthArgument {
    /// Every ray comes from an azimuth of its own; results are turned back to --phi
    Random,
    /// All light comes from --phi
    Fixed,
}

impl From<AzimuthArgument> for Azimuth {
    fn from(azimuth: AzimuthArgument) -> Self {
        match azimuth {
            AzimuthArgument::Random => Self::Random,
            AzimuthArgument::Fixed => Self::Fixed,
        }
    }
}

/// Both branches or one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BranchingArgument {
    /// Follow the reflected and the transmitted branch
    Split,
    /// Pick one at random
    Pick,
}

impl From<BranchingArgument> for Branching {
    fn from(branching: BranchingArgument) -> Self {
        match branching {
            BranchingArgument::Split => Self::Split,
            BranchingArgument::Pick => Self::Pick,
        }
    }
}

/// What one surface is made of.
#[derive(Debug, Args)]
pub(crate) struct Interface {
    /// Material of the surface
    #[arg(long, value_enum, default_value = "dielectric")]
    pub(crate) material: MaterialArgument,
    /// Relative refractive index n_transmitted / n_incident [default: 1.5 for a dielectric]
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) eta: Option<f64>,
    /// Absorption index of a conductor
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) kappa: Option<f64>,
}

/// Where the light comes from.
#[derive(Debug, Args)]
pub(crate) struct Light {
    /// Polar angle of the direction towards the light, degrees, from 0 to below 90
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) theta: f64,
    /// Azimuth of the direction towards the light, degrees
    #[arg(long, value_parser = parse_number, default_value = "0", allow_negative_numbers = true)]
    pub(crate) phi: f64,
}

#[derive(Debug, Args)]
pub(crate) struct Trace {
    /// Height map: .exr, .npy, .gsf, .x3p, .asc, .txt or .csv; or triangle mesh: .ply, .obj or .stl
    #[arg(required_unless_present = "flat")]
    pub(crate) file: Option<PathBuf>,
    /// A flat surface in place of FILE
    #[arg(long, conflicts_with_all = ["file", "border", "missing", "remove", "spacing", "unit"])]
    pub(crate) flat: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) interface: Interface,
    #[command(flatten)]
    pub(crate) light: Light,
    /// The side that the light comes from
    #[arg(long, value_enum, default_value = "above")]
    pub(crate) from: FromArgument,
    /// Whether each ray comes from an azimuth of its own, and what leaves is turned back
    #[arg(long, value_enum, default_value = "fixed")]
    pub(crate) light_azimuth: AzimuthArgument,
    #[command(flatten)]
    pub(crate) medium: MediumArguments,
    /// Rays in all
    #[arg(long, value_parser = parse_count, default_value = "1e6", allow_negative_numbers = true)]
    pub(crate) rays: u64,
    /// Error to reach, instead of a number of rays
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, value_name = "ERROR", conflicts_with = "rays")]
    pub(crate) target_error: Option<f64>,
    /// Whose error: reflected, transmitted or absorbed, as a flux fraction; bins, rings or in-plane, relative [default: bins]
    #[arg(long, value_name = "QUANTITY")]
    pub(crate) of: Option<Quantity>,
    /// Time after which nothing more is begun: seconds, or as 10m or 2h
    #[arg(long, value_parser = parse_seconds, allow_negative_numbers = true, value_name = "TIME")]
    pub(crate) max_time: Option<f64>,
    /// Seed of the rays
    #[arg(long, default_value = "1", allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// Bins of a hemisphere, THETAxPHI
    #[arg(long, default_value = "18x36")]
    pub(crate) bins: HemisphereGrid,
    /// Half width of the in-plane wedge, degrees
    #[arg(long, value_parser = parse_number, default_value = "5", allow_negative_numbers = true)]
    pub(crate) in_plane_half_width: f64,
    /// The side whose light is recorded: both, reflected or transmitted
    #[arg(long, default_value = "both")]
    pub(crate) side: Sides,
    /// Follow both branches at an interface, or pick one
    #[arg(long, value_enum, default_value = "split")]
    pub(crate) branching: BranchingArgument,
    /// Flux, of an incident ray's, below which roulette decides whether a branch goes on
    #[arg(long, value_parser = parse_number, default_value = "0.01", allow_negative_numbers = true)]
    pub(crate) roulette: f64,
    /// Interactions after which a path is truncated
    #[arg(long, value_parser = parse_order, default_value = "1000", allow_negative_numbers = true)]
    pub(crate) max_order: u32,
    /// How hits are found: auto, mesh, pyramid, flat (flat surfaces only) or brute-force
    #[arg(long, default_value = "auto")]
    pub(crate) accelerator: AcceleratorKind,
    /// How paths become results: auto, plain or controlled
    #[arg(long, default_value = "auto")]
    pub(crate) estimator: Estimator,
    /// How rays are spread: random, stratified or quasi-random
    #[arg(long, default_value = "stratified")]
    pub(crate) sampling: Sampling,
    /// Trace the surface at half the spacing as well and report that; the difference is the error of the mesh
    #[arg(long, conflicts_with = "flat")]
    pub(crate) refine: bool,
    /// Folder for summary.json, histogram.csv, in_plane.csv and plots
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Draw no plots
    #[arg(long)]
    pub(crate) no_plots: bool,
    /// Print summary.json on standard output
    #[arg(long)]
    pub(crate) json: bool,
}
