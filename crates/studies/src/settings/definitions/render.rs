//! Camera, lights and picture of `render`.

use super::choices::CAMERA as CAMERAS;
use super::{DEGREES, RENDER};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, flags, setting};

const POLAR: Range = Range::FromBelow(0.0, 90.0);
const RADIANCE: Range = Range::FromTo(0.0, 1e30);

pub(super) const CAMERA: &[Setting] = &flags(
    "camera",
    RENDER,
    [
        setting("projection", CAMERAS, "Projection")
            .flag(Flag::Named("camera"))
            .default("pinhole"),
        setting(
            "fov",
            Kind::Number,
            "Vertical field of view of a pinhole camera",
        )
        .basic(Commands::ALL)
        .unit(DEGREES)
        .range(Range::Between(0.0, 180.0))
        .default("40"),
        setting(
            "look_at",
            Kind::Length,
            "Point of the mean plane at the centre of the picture",
        )
        .arity(Arity::Tuple(&["X", "Y"]))
        .otherwise("the centre of the tile"),
        setting(
            "width",
            Kind::Length,
            "Length seen across the centre of the picture",
        )
        .basic(Commands::ALL)
        .value_name("LENGTH")
        .range(Range::Above(0.0))
        .otherwise("that of the tile"),
    ],
);

pub(super) const LIGHTS: &[Setting] = &flags(
    "lights",
    RENDER,
    [
        setting("sky", Kind::Number, "Radiance of the sky at the zenith")
            .basic(Commands::ALL)
            .value_name("RADIANCE")
            .range(RADIANCE)
            .default("0.8"),
        setting(
            "horizon",
            Kind::Number,
            "Radiance at the horizon over the zenith; 1: uniform",
        )
        .value_name("FACTOR")
        .range(Range::FromTo(0.0, 1.0))
        .default("0.15"),
        setting(
            "sun",
            Kind::Number,
            "Radiance of a white matt plane that faces the sun; 0 for none",
        )
        .value_name("RADIANCE")
        .range(RADIANCE)
        .default("1"),
        setting(
            "sun_theta",
            Kind::Number,
            "Polar angle of the direction towards the sun",
        )
        .basic(Commands::ALL)
        .unit(DEGREES)
        .range(POLAR)
        .default("60"),
        setting(
            "sun_phi",
            Kind::Number,
            "Azimuth of the direction towards the sun",
        )
        .basic(Commands::ALL)
        .unit(DEGREES)
        .default("150"),
        setting("sun_radius", Kind::Number, "Angular radius of the sun")
            .unit(DEGREES)
            .range(Range::FromTo(0.01, 60.0))
            .default("15"),
        setting(
            "patch",
            Kind::Length,
            "Rectangle of the mean plane that the sun lights",
        )
        .arity(Arity::Tuple(&["X0", "Y0", "X1", "Y1"]))
        .otherwise("the whole plane"),
        setting(
            "below",
            Kind::Number,
            "Radiance from below, as seen through a flat ideal interface",
        )
        .value_name("RADIANCE")
        .range(RADIANCE)
        .default("0.01"),
    ],
);

pub(super) const PICTURE: &[Setting] = &flags(
    "picture",
    RENDER,
    [
        setting("size", Kind::Pixels, "Pixels")
            .basic(Commands::ALL)
            .value_name("COLUMNSxROWS")
            .default("640x480"),
        setting("samples", Kind::Count, "Samples per pixel, at least")
            .basic(Commands::ALL)
            .default("16"),
        setting(
            "exposure",
            Kind::Number,
            "Factor from radiance to PNG brightness, where 1 is white",
        )
        .basic(Commands::ALL)
        .value_name("FACTOR")
        .range(Range::Above(0.0))
        .otherwise("by the brightest percent, and by four times the median at most"),
        setting(
            "output",
            Kind::Path,
            "File to write: .exr or .png; may be repeated",
        )
        .basic(Commands::ALL)
        .short('o')
        .value_name("FILE")
        .arity(Arity::Repeated)
        .required(RENDER),
    ],
);
