//! What can be asked of a model.

use std::path::PathBuf;

use asperity_studies::{parse_count, parse_number};
use asperity_tally::HemisphereGrid;
use clap::Args;

use super::{Interface, MediumArguments};

#[derive(Debug, Args)]
pub(crate) struct Model {
    /// Name, as --list has it
    #[arg(required_unless_present = "list")]
    pub(crate) name: Option<String>,
    /// Say which models there are, and where each is meant to hold
    #[arg(long, exclusive = true)]
    pub(crate) list: bool,
    /// Smoothness s = tau / sigma of a rough surface, along the first principal axis
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) smoothness: Option<f64>,
    /// The same along the second principal axis: tau_y / sigma
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) smoothness_y: Option<f64>,
    /// Angle from +x to the first principal axis, degrees
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, requires = "smoothness_y")]
    pub(crate) azimuth: Option<f64>,
    #[command(flatten)]
    pub(crate) interface: Interface,
    #[command(flatten)]
    pub(crate) medium: MediumArguments,
    /// Polar angle of the direction towards the light, degrees, from 0 to below 90
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, required_unless_present = "list")]
    pub(crate) theta: Option<f64>,
    /// Azimuth of the direction towards the light, degrees
    #[arg(long, value_parser = parse_number, default_value = "0", allow_negative_numbers = true)]
    pub(crate) phi: f64,
    /// Degrees between directions, at most 45, of a model with a density [default: 1]
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true, conflicts_with = "bins")]
    pub(crate) step: Option<f64>,
    /// The whole sphere of outgoing directions, not only the plane of incidence
    #[arg(long, conflicts_with = "bins")]
    pub(crate) sphere: bool,
    /// Means over the bins of a hemisphere, THETAxPHI, in place of single directions [default of a model that follows rays: 18x36]
    #[arg(long)]
    pub(crate) bins: Option<HemisphereGrid>,
    /// Rays of a model that follows rays, rounded up to whole batches of 64 [default: 1e6]
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) rays: Option<u64>,
    /// Seed of these rays [default: 1]
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// File to write, .csv; standard output unless given
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Print the energies, by order of scattering, as JSON on standard output
    #[arg(long, conflicts_with_all = ["step", "sphere"])]
    pub(crate) json: bool,
}
