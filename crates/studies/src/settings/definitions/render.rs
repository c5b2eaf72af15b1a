//! Camera, lights and picture of `render`.

use super::choices::CAMERA as CAMERAS;
use super::{DEGREES, RENDER};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, setting};

const POLAR: Range = Range::FromBelow(0.0, 90.0);
const RADIANCE: Range = Range::FromTo(0.0, 1e30);

pub(super) const CAMERA: &[Setting] = &[
    setting("camera", "projection", CAMERAS, RENDER, "Projection")
        .flag(Flag::Named("camera"))
        .default("pinhole")
        .flag_only(),
    setting(
        "camera",
        "fov",
        Kind::Number,
        RENDER,
        "Vertical field of view of a pinhole camera",
    )
    .unit(DEGREES)
    .range(Range::Between(0.0, 180.0))
    .default("40")
    .flag_only(),
    setting(
        "camera",
        "look_at",
        Kind::Length,
        RENDER,
        "Point of the mean plane at the centre of the picture",
    )
    .arity(Arity::Tuple(&["X", "Y"]))
    .otherwise("the centre of the tile")
    .flag_only(),
    setting(
        "camera",
        "width",
        Kind::Length,
        RENDER,
        "Length seen across the centre of the picture",
    )
    .value_name("LENGTH")
    .range(Range::Above(0.0))
    .otherwise("that of the tile")
    .flag_only(),
];

pub(super) const LIGHTS: &[Setting] = &[
    setting(
        "lights",
        "sky",
        Kind::Number,
        RENDER,
        "Radiance of the sky at the zenith",
    )
    .value_name("RADIANCE")
    .range(RADIANCE)
    .default("0.8")
    .flag_only(),
    setting(
        "lights",
        "horizon",
        Kind::Number,
        RENDER,
        "Radiance at the horizon over the zenith; 1: uniform",
    )
    .value_name("FACTOR")
    .range(Range::FromTo(0.0, 1.0))
    .default("0.15")
    .flag_only(),
    setting(
        "lights",
        "sun",
        Kind::Number,
        RENDER,
        "Radiance of a white matt plane that faces the sun; 0 for none",
    )
    .value_name("RADIANCE")
    .range(RADIANCE)
    .default("1")
    .flag_only(),
    setting(
        "lights",
        "sun_theta",
        Kind::Number,
        RENDER,
        "Polar angle of the direction towards the sun",
    )
    .unit(DEGREES)
    .range(POLAR)
    .default("60")
    .flag_only(),
    setting(
        "lights",
        "sun_phi",
        Kind::Number,
        RENDER,
        "Azimuth of the direction towards the sun",
    )
    .unit(DEGREES)
    .default("150")
    .flag_only(),
    setting(
        "lights",
        "sun_radius",
        Kind::Number,
        RENDER,
        "Angular radius of the sun",
    )
    .unit(DEGREES)
    .range(Range::FromTo(0.01, 60.0))
    .default("15")
    .flag_only(),
    setting(
        "lights",
        "patch",
        Kind::Length,
        RENDER,
        "Rectangle of the mean plane that the sun lights",
    )
    .arity(Arity::Tuple(&["X0", "Y0", "X1", "Y1"]))
    .otherwise("the whole plane")
    .flag_only(),
    setting(
        "lights",
        "below",
        Kind::Number,
        RENDER,
        "Radiance from below, as seen through a flat ideal interface",
    )
    .value_name("RADIANCE")
    .range(RADIANCE)
    .default("0.01")
    .flag_only(),
];

pub(super) const PICTURE: &[Setting] = &[
    setting("picture", "size", Kind::Pixels, RENDER, "Pixels")
        .value_name("COLUMNSxROWS")
        .default("640x480")
        .flag_only(),
    setting(
        "picture",
        "samples",
        Kind::Count,
        RENDER,
        "Samples per pixel, at least",
    )
    .default("16")
    .flag_only(),
    setting(
        "picture",
        "exposure",
        Kind::Number,
        RENDER,
        "Factor from radiance to PNG brightness, where 1 is white",
    )
    .value_name("FACTOR")
    .range(Range::Above(0.0))
    .otherwise("by the brightest percent, and by four times the median at most")
    .flag_only(),
    setting(
        "picture",
        "output",
        Kind::Path,
        RENDER,
        "File to write: .exr or .png; may be repeated",
    )
    .short('o')
    .value_name("FILE")
    .arity(Arity::Repeated)
    .required(RENDER)
    .flag_only(),
];
