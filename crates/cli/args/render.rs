//! What can be asked of render.

use std::path::PathBuf;

use asperity_studies::{parse_count, parse_number, parse_seconds};
use clap::{Args, ValueEnum};

use super::{Interface, MediumArguments, Reading};

/// The cameras.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CameraArgument {
    /// All lines of sight meet in the eye
    Pinhole,
    /// All lines of sight are parallel
    Orthographic,
}

#[derive(Debug, Args)]
pub(crate) struct Render {
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
    pub(crate) medium: MediumArguments,
    #[command(flatten)]
    pub(crate) camera: CameraArguments,
    #[command(flatten)]
    pub(crate) lights: LightsArguments,
    #[command(flatten)]
    pub(crate) image: ImageArguments,
}

/// Where the picture is taken from.
#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub(crate) struct CameraArguments {
    /// How the camera projects
    #[arg(long, value_enum, default_value = "pinhole")]
    pub(crate) camera: CameraArgument,
    /// Polar angle of the direction towards the camera, degrees
    #[arg(long, value_parser = parse_number, default_value = "50", allow_negative_numbers = true)]
    pub(crate) view_theta: f64,
    /// Azimuth of the direction towards the camera, degrees
    #[arg(long, value_parser = parse_number, default_value = "270", allow_negative_numbers = true)]
    pub(crate) view_phi: f64,
    /// Vertical field of view of a pinhole camera, degrees [default: 40]
    #[arg(long, value_parser = parse_number, value_name = "DEGREES", allow_negative_numbers = true)]
    pub(crate) fov: Option<f64>,
    /// Point of the mean plane in the middle of the picture, length units [default: the middle of the tile]
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, value_name = "X,Y", allow_negative_numbers = true)]
    pub(crate) look_at: Vec<f64>,
    /// Length seen across the middle of the picture; a pinhole stands as far away as that takes [default: the tile's]
    #[arg(long, value_parser = parse_number, value_name = "LENGTH", allow_negative_numbers = true)]
    pub(crate) width: Option<f64>,
}

/// What shines.
#[derive(Debug, Args)]
#[command(next_help_heading = "Lights")]
pub(crate) struct LightsArguments {
    /// Radiance of the sky, the same from all sides
    #[arg(long, value_parser = parse_number, default_value = "0.5", value_name = "RADIANCE", allow_negative_numbers = true)]
    pub(crate) sky: f64,
    /// Strength of the sun: the radiance of a white matt plane that faces it; 0 for none
    #[arg(long, value_parser = parse_number, default_value = "1", value_name = "STRENGTH", allow_negative_numbers = true)]
    pub(crate) sun: f64,
    /// Polar angle of the direction towards the sun, degrees
    #[arg(long, value_parser = parse_number, default_value = "60", allow_negative_numbers = true)]
    pub(crate) sun_theta: f64,
    /// Azimuth of the direction towards the sun, degrees
    #[arg(long, value_parser = parse_number, default_value = "150", allow_negative_numbers = true)]
    pub(crate) sun_phi: f64,
    /// Angular radius of the sun, degrees: a smaller one makes sharper shadows and more noise
    #[arg(long, value_parser = parse_number, default_value = "5", value_name = "DEGREES", allow_negative_numbers = true)]
    pub(crate) sun_radius: f64,
    /// Let the sun shine only where its rays meet the mean plane within this rectangle, length units
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, value_name = "X0,Y0,X1,Y1", allow_negative_numbers = true)]
    pub(crate) patch: Vec<f64>,
    /// Radiance of what lies below, as seen from above through a flat interface that reflects nothing
    #[arg(long, value_parser = parse_number, default_value = "0", value_name = "RADIANCE", allow_negative_numbers = true)]
    pub(crate) below: f64,
}

/// The picture itself.
#[derive(Debug, Args)]
#[command(next_help_heading = "Picture")]
pub(crate) struct ImageArguments {
    /// Pixels, COLUMNSxROWS
    #[arg(long, value_parser = parse_size, default_value = "640x480")]
    pub(crate) size: [usize; 2],
    /// Lines of sight a pixel, at least
    #[arg(long, value_parser = parse_count, default_value = "16", allow_negative_numbers = true)]
    pub(crate) samples: u64,
    /// Time after which the passes that are complete make the picture: seconds, or as 10m or 2h
    #[arg(long, value_parser = parse_seconds, allow_negative_numbers = true, value_name = "TIME")]
    pub(crate) max_time: Option<f64>,
    /// Seed of the lines of sight and the paths of light
    #[arg(long, default_value = "1", allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// Factor from radiance to the brightness of PNG, where 1 is white [default: by the brightest hundredth]
    #[arg(long, value_parser = parse_number, value_name = "FACTOR", allow_negative_numbers = true)]
    pub(crate) exposure: Option<f64>,
    /// File to write: .exr for numbers, .png for the eye; may be given for each
    #[arg(long, short, value_name = "FILE", required = true)]
    pub(crate) output: Vec<PathBuf>,
}

fn parse_size(text: &str) -> Result<[usize; 2], String> {
    let (columns, rows) = text
        .split_once('x')
        .ok_or_else(|| format!("`{text}` is no size; write it as 640x480"))?;
    let [Ok(columns), Ok(rows)] = [columns, rows].map(|n| n.trim().parse()) else {
        return Err(format!("`{text}` is no size; write it as 640x480"));
    };
    Ok([columns, rows])
}
