//! `[medium]`: a medium below the surface.

use super::choices::{BOTTOM, BOTTOM_SHAPES, PHASE};
use super::{GONIO, MODEL, RENDER, TRACE, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, setting};

const SECTION: &str = "medium";
const COMMANDS: Commands = TRACE.and(RENDER).and(VERIFY).and(GONIO).and(MODEL);
const LISTS: Arity = Arity::ListIn(VERIFY.and(GONIO));

pub(super) const SETTINGS: &[Setting] = &[
    setting(
        SECTION,
        "mean_free_path",
        Kind::Length,
        COMMANDS,
        "Mean distance between interactions with the medium",
    )
    .value_name("LENGTH")
    .range(Range::FromTo(1e-150, 1e150))
    .arity(LISTS)
    .excludes(&["medium.absorption", "medium.scattering"]),
    setting(
        SECTION,
        "albedo",
        Kind::Number,
        COMMANDS,
        "Fraction of interactions that scatters; the rest absorbs",
    )
    .range(Range::FromTo(0.0, 1.0))
    .arity(LISTS)
    .excludes(&["medium.absorption", "medium.scattering"]),
    setting(
        SECTION,
        "absorption",
        Kind::Number,
        COMMANDS,
        "Absorption coefficient, in place of mean free path and albedo",
    )
    .unit("1 / length")
    .value_name("COEFFICIENT")
    .range(Range::AtLeast(0.0))
    .arity(LISTS)
    .otherwise("0 if scattering is given")
    .excludes(&["medium.mean_free_path", "medium.albedo"]),
    setting(
        SECTION,
        "scattering",
        Kind::Number,
        COMMANDS,
        "Scattering coefficient",
    )
    .unit("1 / length")
    .value_name("COEFFICIENT")
    .range(Range::AtLeast(0.0))
    .arity(LISTS)
    .otherwise("0 if absorption is given")
    .excludes(&["medium.mean_free_path", "medium.albedo"]),
    setting(SECTION, "phase", PHASE, COMMANDS, "Phase function")
        .otherwise("henyey-greenstein with g, isotropic without"),
    setting(
        SECTION,
        "g",
        Kind::Number,
        COMMANDS,
        "Mean cosine of scattering by Henyey and Greenstein",
    )
    .range(Range::Between(-1.0, 1.0))
    .arity(LISTS),
    setting(
        SECTION,
        "thickness",
        Kind::Length,
        COMMANDS,
        "Depth of the medium below the mean plane",
    )
    .value_name("LENGTH")
    .range(Range::Above(0.0))
    .arity(LISTS)
    .otherwise("infinite"),
    setting(
        SECTION,
        "bottom",
        BOTTOM,
        COMMANDS,
        "What bounds a medium of that thickness",
    )
    .otherwise("interface"),
    setting(
        SECTION,
        "bottom_eta",
        Kind::Number,
        COMMANDS,
        "Index n_beyond / n_layer of a bottom that is an interface",
    )
    .value_name("ETA")
    .range(Range::FromTo(1e-6, 1e6))
    .otherwise("1 / eta"),
    setting(
        SECTION,
        "bottom_reflectance",
        Kind::Number,
        COMMANDS,
        "Reflectance of a Lambertian bottom",
    )
    .value_name("FRACTION")
    .range(Range::FromTo(0.0, 1.0))
    .otherwise("1"),
    setting(
        SECTION,
        "bottom_surface",
        Kind::ChoiceOrFile(BOTTOM_SHAPES),
        TRACE.and(RENDER),
        "Shape of the bottom",
    )
    .value_name("SHAPE|FILE")
    .default("flat"),
    setting(
        SECTION,
        "bottom_surface",
        Kind::Choice(BOTTOM_SHAPES),
        VERIFY.and(GONIO).and(MODEL),
        "Shape of the bottom",
    )
    .value_name("SHAPE")
    .default("flat"),
    setting(
        SECTION,
        "max_scatterings",
        Kind::Order,
        COMMANDS,
        "Scatterings in the medium after which a path is truncated",
    )
    .default("100000"),
];
