//! Camera, lights and picture of `render`.

use super::choices::{CAMERA as CAMERAS, TONE};
use super::commands::{DEGREES, RENDER};
use super::light::{SUN_AZIMUTH, SUN_ELEVATION};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, basic, flags, setting};

const POLAR: Range = Range::FromBelow(0.0, 90.0);
const RADIANCE: Range = Range::FromTo(0.0, 1e30);

pub(super) const CAMERA: &[Setting] = &flags(
    "camera",
    RENDER,
    [
        setting("projection", CAMERAS)
            .help("Projection")
            .flag(Flag::Named("camera"))
            .default("pinhole"),
        basic("fov", Kind::Number)
            .help("Vertical field of view of a pinhole camera")
            .unit(DEGREES)
            .range(Range::Between(0.0, 180.0))
            .default("40"),
        setting("look_at", Kind::Length)
            .help("Point of the mean plane at the centre of the picture")
            .arity(Arity::Tuple(&["X", "Y"]))
            .otherwise("the centre of the tile"),
        basic("width", Kind::Length)
            .help("Length seen across the centre of the picture")
            .value_name("LENGTH")
            .range(Range::Above(0.0))
            .otherwise("that of the tile"),
    ],
);

pub(super) const LIGHTS: &[Setting] = &flags(
    "lights",
    RENDER,
    [
        basic("sky", Kind::Number)
            .help("Radiance of the sky at the zenith")
            .value_name("RADIANCE")
            .range(RADIANCE)
            .default("0.8"),
        setting("horizon", Kind::Number)
            .help("Radiance at the horizon over the zenith; 1: uniform")
            .value_name("FACTOR")
            .range(Range::FromTo(0.0, 1.0))
            .default("0.15"),
        setting("sun", Kind::Number)
            .help("Radiance of a white matt plane that faces the sun; 0 for none")
            .value_name("RADIANCE")
            .range(RADIANCE)
            .default("1"),
        basic("sun_theta", Kind::Number)
            .help("Polar angle of the direction towards the sun")
            .unit(DEGREES)
            .range(POLAR)
            .default("60"),
        basic("sun_phi", Kind::Number)
            .help("Azimuth of the direction towards the sun")
            .unit(DEGREES)
            .default("150"),
        SUN_ELEVATION.help("Elevation of the sun, in place of sun_theta and sun_phi"),
        SUN_AZIMUTH,
        setting("sun_radius", Kind::Number)
            .help("Angular radius of the sun")
            .unit(DEGREES)
            .range(Range::FromTo(0.01, 60.0))
            .default("15"),
        setting("patch", Kind::Length)
            .help("Rectangle of the mean plane that the sun lights")
            .arity(Arity::Tuple(&["X0", "Y0", "X1", "Y1"]))
            .otherwise("the whole plane"),
        setting("below", Kind::Number)
            .flag(Flag::Named("radiance-below"))
            .help("Radiance from below, as seen through a flat ideal interface")
            .value_name("RADIANCE")
            .range(RADIANCE)
            .default("0.01"),
    ],
);

pub(super) const PICTURE: &[Setting] = &flags(
    "picture",
    RENDER,
    [
        basic("size", Kind::Pixels)
            .help("Pixels")
            .value_name("COLUMNSxROWS")
            .default("640x480"),
        basic("samples", Kind::Count)
            .help("Samples per pixel; rounded up to a multiple of four")
            .default("16"),
        basic("exposure", Kind::Number)
            .help("Factor on radiance before the tone curve of a PNG")
            .value_name("FACTOR")
            .range(Range::FromTo(1e-30, 1e30))
            .otherwise(
                "by the brightest percent, and but for log by four times the median at most",
            ),
        basic("tone", TONE)
            .help("Curve from exposed radiance to PNG brightness")
            .default("reinhard"),
        setting("scale_bar", Kind::Switch).help("Scale of radiance below the picture of a PNG"),
        basic("denoise", Kind::Switch)
            .help("Denoise by non-local means, within the errors of pixels"),
        setting("error_image", Kind::Path)
            .help("Figure of the relative error of each pixel: .png or .svg")
            .value_name("FILE")
            .otherwise("none"),
        basic("output", Kind::Path)
            .help("File to write: .exr or .png; may be repeated")
            .short('o')
            .value_name("FILE")
            .arity(Arity::Repeated)
            .required(RENDER),
    ],
);
