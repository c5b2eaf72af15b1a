//! What can be asked of attenuation.

use std::path::PathBuf;

use asperity_studies::{Way, parse_count, parse_number};
use asperity_surface::Border;
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Attenuation {
    /// Configuration; every key has a default, and flags override the file
    pub(crate) config: Option<PathBuf>,
    /// Root mean square height, one or several: 0.1,0.5,1
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) sigma: Vec<f64>,
    /// 1/e correlation length, length units
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) tau: Option<f64>,
    /// Side of the tile along x, or X,Y, length units; a multiple of the spacing
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true, conflicts_with = "size")]
    pub(crate) length: Vec<f64>,
    /// Samples along x, or X,Y, instead of --length
    #[arg(long, value_parser = parse_count, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) size: Vec<u64>,
    /// Length units a sample along x, or X,Y
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) spacing: Vec<f64>,
    /// What lies beyond the border: periodic or open
    #[arg(long, value_name = "BORDER")]
    pub(crate) border: Option<Border>,
    /// Draw surfaces even if the grid cannot resolve or hold them
    #[arg(long)]
    pub(crate) insist: bool,
    /// Polar angle of the direction towards the light, degrees, one or several: 0,30,60
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) theta: Vec<f64>,
    /// Azimuth of the direction towards the light, degrees
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) phi: Option<f64>,
    /// Polar angle of the direction towards the eye, degrees, one or several; straight above unless given
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) view_theta: Vec<f64>,
    /// Azimuth of the direction towards the eye, degrees
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) view_phi: Option<f64>,
    /// Surfaces drawn
    #[arg(long, value_parser = parse_count, allow_negative_numbers = true)]
    pub(crate) realisations: Option<u64>,
    /// Seed of the surfaces and of the points on them
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// How points look: auto, rays or horizons
    #[arg(long)]
    pub(crate) way: Option<Way>,
    /// Follow no mirrored rays: no mirror_g2
    #[arg(long)]
    pub(crate) no_mirror: bool,
    /// Measure the visibility by height as well
    #[arg(long)]
    pub(crate) heights: bool,
    /// Measure the angles at which shadow begins as well
    #[arg(long)]
    pub(crate) demarcation: bool,
    /// Folder for the results
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Draw no plots
    #[arg(long)]
    pub(crate) no_plots: bool,
    /// Print summary.json on standard output, instead of the tables
    #[arg(long)]
    pub(crate) json: bool,
}
