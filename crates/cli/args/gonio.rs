//! What can be asked of the virtual gonioreflectometer.

use std::path::PathBuf;

use asperity_studies::{parse_count, parse_number, parse_seconds};
use asperity_surface::{Border, Form, LengthUnit, MissingPolicy};
use asperity_tally::HemisphereGrid;
use clap::Args;

use super::ensembles::{RandomSurfaces, Rays, Substance};
use super::{AzimuthArgument, FromArgument, MediumArguments};

#[derive(Debug, Args)]
pub(crate) struct Gonio {
    /// Configuration; every key has a default, and flags override the file
    pub(crate) config: Option<PathBuf>,
    /// A given surface in place of random ones: height map or triangle mesh
    #[arg(long, value_name = "FILE")]
    pub(crate) surface: Option<PathBuf>,
    /// A flat surface in place of random ones
    #[arg(long, conflicts_with = "surface")]
    pub(crate) flat: bool,
    /// What lies beyond the border of the given surface: periodic, mirrored or open
    #[arg(long, value_name = "BORDER")]
    pub(crate) border: Option<Border>,
    /// Length unit of the given surface: 1 (arbitrary), m, mm, um or nm
    #[arg(long)]
    pub(crate) unit: Option<LengthUnit>,
    /// What to do with missing points of the given surface: refuse or fill
    #[arg(long, value_name = "POLICY")]
    pub(crate) missing: Option<MissingPolicy>,
    /// Form to remove from the given surface: none, mean, plane or parabola
    #[arg(long, value_name = "FORM")]
    pub(crate) remove: Option<Form>,
    #[command(flatten)]
    pub(crate) surfaces: RandomSurfaces,
    #[command(flatten)]
    pub(crate) substance: Substance,
    #[command(flatten)]
    pub(crate) medium: MediumArguments,
    /// Polar angle of the direction towards the light, degrees, one or several: 0,30,60
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) theta: Vec<f64>,
    /// Azimuth of the direction towards the light, degrees, one or several
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) phi: Vec<f64>,
    /// Directions at the centres of the bins of a hemisphere, THETAxPHI, instead of --theta and --phi
    #[arg(long, value_name = "GRID", conflicts_with_all = ["theta", "phi"])]
    pub(crate) directions: Option<HemisphereGrid>,
    /// Whether each ray comes from an azimuth of its own, or all from --phi [default: random where surfaces are drawn and isotropic]
    #[arg(long, value_enum)]
    pub(crate) light_azimuth: Option<AzimuthArgument>,
    /// The side that the light comes from
    #[arg(long, value_enum)]
    pub(crate) from: Option<FromArgument>,
    /// Random surfaces, the same for all directions
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) realisations: Option<u64>,
    /// Rays for each direction, over all its surfaces
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) rays: Option<u64>,
    /// Time after which no direction is begun: seconds, or as 10m or 2h
    #[arg(long, value_parser = parse_seconds, allow_negative_numbers = true, value_name = "TIME")]
    pub(crate) max_time: Option<f64>,
    #[command(flatten)]
    pub(crate) followed: Rays,
    /// Folder for the results; a measurement in it is gone on with
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Draw no plots
    #[arg(long)]
    pub(crate) no_plots: bool,
    /// Print summary.json on standard output, instead of the tables
    #[arg(long)]
    pub(crate) json: bool,
}
