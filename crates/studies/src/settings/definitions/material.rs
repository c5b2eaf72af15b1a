//! `[material]` and `[medium]`: what the surface is made of, and what lies below.

use super::choices::{BOTTOM, BOTTOM_SHAPES, MATERIAL, PHASE};
use super::{CONVERGE, GONIO, MAP, MODEL, RENDER, SWEEPS, TRACE, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, setting, table};

const COMMANDS: Commands = TRACE
    .and(RENDER)
    .and(VERIFY)
    .and(MAP)
    .and(GONIO)
    .and(CONVERGE)
    .and(MODEL);

pub(super) const MATERIAL_SETTINGS: &[Setting] = &table(
    "material",
    COMMANDS,
    [
        setting("kind", MATERIAL, "Material")
            .basic(Commands::ALL)
            .flag(Flag::Named("material"))
            .default("dielectric"),
        setting(
            "eta",
            Kind::Number,
            "Relative refractive index n_transmitted / n_incident",
        )
        .basic(Commands::ALL)
        .range(Range::FromTo(1e-6, 1e6))
        .arity(Arity::ListIn(SWEEPS))
        .otherwise("1.5 for a dielectric"),
        setting("kappa", Kind::Number, "Absorption index of a conductor")
            .basic(Commands::ALL)
            .range(Range::FromTo(0.0, 1e6)),
        setting(
            "reflectance",
            Kind::Number,
            "Fraction of light that a Lambertian facet reflects",
        )
        .basic(Commands::ALL)
        .range(Range::FromTo(0.0, 1.0))
        .otherwise("none; lambertian facets need it"),
    ],
);

const MEDIUM_IN: Commands = TRACE.and(RENDER).and(VERIFY).and(GONIO).and(MODEL);
const LISTS: Arity = Arity::ListIn(VERIFY.and(GONIO));

pub(super) const MEDIUM: &[Setting] = &table(
    "medium",
    MEDIUM_IN,
    [
        setting(
            "mean_free_path",
            Kind::Length,
            "Mean distance between interactions with the medium",
        )
        .basic(Commands::ALL)
        .value_name("LENGTH")
        .range(Range::FromTo(1e-150, 1e150))
        .arity(LISTS),
        setting(
            "albedo",
            Kind::Number,
            "Fraction of interactions that scatters; the rest absorbs",
        )
        .basic(Commands::ALL)
        .range(Range::FromTo(0.0, 1.0))
        .arity(LISTS),
        setting(
            "absorption",
            Kind::Number,
            "Absorption coefficient, in place of mean free path and albedo",
        )
        .unit("1 / length")
        .value_name("COEFFICIENT")
        .range(Range::AtLeast(0.0))
        .arity(LISTS)
        .otherwise("0 if scattering is given"),
        setting("scattering", Kind::Number, "Scattering coefficient")
            .unit("1 / length")
            .value_name("COEFFICIENT")
            .range(Range::AtLeast(0.0))
            .arity(LISTS)
            .otherwise("0 if absorption is given"),
        setting("phase", PHASE, "Phase function")
            .otherwise("henyey-greenstein with g, isotropic without"),
        setting(
            "g",
            Kind::Number,
            "Mean cosine of scattering by Henyey and Greenstein",
        )
        .range(Range::Between(-1.0, 1.0))
        .arity(LISTS),
        setting(
            "thickness",
            Kind::Length,
            "Depth of the medium below the mean plane",
        )
        .basic(Commands::ALL)
        .value_name("LENGTH")
        .range(Range::Above(0.0))
        .arity(LISTS)
        .otherwise("infinite"),
        setting("bottom", BOTTOM, "What bounds a medium of that thickness").otherwise("interface"),
        setting(
            "bottom_eta",
            Kind::Number,
            "Index n_beyond / n_layer of a bottom that is an interface",
        )
        .value_name("ETA")
        .range(Range::FromTo(1e-6, 1e6))
        .otherwise("1 / eta"),
        setting(
            "bottom_reflectance",
            Kind::Number,
            "Reflectance of a Lambertian bottom",
        )
        .value_name("FRACTION")
        .range(Range::FromTo(0.0, 1.0))
        .otherwise("1"),
        setting(
            "bottom_surface",
            Kind::ChoiceOrFile(BOTTOM_SHAPES),
            "Shape of the bottom",
        )
        .commands(TRACE.and(RENDER))
        .value_name("SHAPE|FILE")
        .default("flat"),
        setting(
            "bottom_surface",
            Kind::Choice(BOTTOM_SHAPES),
            "Shape of the bottom",
        )
        .commands(VERIFY.and(GONIO).and(MODEL))
        .value_name("SHAPE")
        .default("flat"),
        setting(
            "max_scatterings",
            Kind::Order,
            "Scatterings in the medium after which a path is truncated",
        )
        .default("100000"),
    ],
);
