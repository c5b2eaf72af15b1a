//! `[material]` and `[medium]`: what the surface is made of, and what lies below.

use super::choices::{BOTTOM, GIVEN_BOTTOMS, MATERIAL, PHASE, RANDOM_BOTTOMS};
use super::commands::{ALBEDO, CONVERGE, GONIO, MAP, MODEL, RENDER, SWEEPS, TRACE, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, basic, setting, table};

const COMMANDS: Commands = TRACE
    .and(RENDER)
    .and(VERIFY)
    .and(MAP)
    .and(GONIO)
    .and(ALBEDO)
    .and(CONVERGE)
    .and(MODEL);

/// Commands with lists of indices.
const LISTS_OF_INDICES: Commands = SWEEPS.and(TRACE).and(ALBEDO).and(MODEL);

pub(super) const MATERIAL_SETTINGS: &[Setting] = &table(
    "material",
    COMMANDS,
    [
        basic("kind", MATERIAL)
            .help("Kind of material, or a named one: the medium below")
            .flag(Flag::Named("material"))
            .value_name("KIND|NAME|FILE|N")
            .default("dielectric"),
        setting("below", Kind::Material)
            .help("Medium below the surface, in place of material")
            .value_name("NAME|FILE|N")
            .otherwise("air where above is given"),
        setting("above", Kind::Material)
            .help("Medium above the surface, which is clear")
            .value_name("NAME|FILE|N")
            .otherwise("index 1"),
        setting("film", Kind::Film)
            .help("Thin film on every facet, layer by layer from above")
            .value_name("MATERIAL:THICKNESS")
            .arity(Arity::ListIn(COMMANDS))
            .otherwise("none"),
        basic("eta", Kind::Number)
            .help("Relative refractive index n_transmitted / n_incident")
            .range(Range::FromTo(0.01, 1e6))
            .arity(Arity::ListIn(LISTS_OF_INDICES))
            .otherwise("1.5 for a dielectric"),
        basic("kappa", Kind::Number)
            .help("Absorption index of a conductor")
            .range(Range::FromTo(0.0, 1e6))
            .otherwise("that of the record of a named material, if it has one")
            .arity(Arity::ListIn(LISTS_OF_INDICES)),
        setting("reflectance", Kind::Number)
            .help("Fraction of light that a Lambertian facet reflects")
            .range(Range::FromTo(0.0, 1.0))
            .otherwise("none; lambertian facets need it"),
    ],
);

const MEDIUM_IN: Commands = TRACE.and(RENDER).and(VERIFY).and(GONIO).and(MODEL);
const LISTS: Arity = Arity::ListIn(VERIFY.and(GONIO).and(MODEL));

pub(super) const MEDIUM: &[Setting] = &table(
    "medium",
    MEDIUM_IN,
    [
        basic("mean_free_path", Kind::Length)
            .help("Mean distance between interactions with the medium")
            .value_name("LENGTH")
            .range(Range::FromTo(1e-150, 1e150))
            .arity(LISTS),
        basic("albedo", Kind::Number)
            .help("Fraction of interactions that scatters; the rest absorbs")
            .range(Range::FromTo(0.0, 1.0))
            .arity(LISTS),
        setting("absorption", Kind::Number)
            .help("Absorption coefficient, in place of mean free path and albedo")
            .unit("1 / length")
            .value_name("COEFFICIENT")
            .range(Range::AtLeast(0.0))
            .arity(LISTS)
            .otherwise("0"),
        setting("scattering", Kind::Number)
            .help("Scattering coefficient")
            .unit("1 / length")
            .value_name("COEFFICIENT")
            .range(Range::AtLeast(0.0))
            .arity(LISTS)
            .otherwise("0"),
        setting("phase", PHASE)
            .help("Phase function")
            .otherwise("henyey-greenstein with g, isotropic without"),
        setting("g", Kind::Number)
            .help("Mean cosine of scattering by Henyey and Greenstein")
            .range(Range::Between(-1.0, 1.0))
            .arity(LISTS),
        basic("thickness", Kind::Length)
            .help("Depth of the medium below the mean plane")
            .value_name("LENGTH")
            .range(Range::Above(0.0))
            .arity(LISTS)
            .otherwise("infinite"),
        setting("layer", Kind::Layer)
            .help("Further layers below that medium, from above")
            .value_name("MATERIAL:THICKNESS")
            .arity(Arity::ListIn(MEDIUM_IN))
            .otherwise("none"),
        setting("bottom", BOTTOM)
            .help("What bounds the medium, or the lowest layer")
            .otherwise("interface"),
        setting("bottom_eta", Kind::Number)
            .help("Index n_beyond / n_layer of a bottom that is an interface")
            .value_name("ETA")
            .range(Range::FromTo(1e-6, 1e6))
            .otherwise("that of the medium above"),
        setting("bottom_material", Kind::Material)
            .help("Medium beyond a bottom that is an interface")
            .value_name("NAME|FILE|N")
            .otherwise("the medium above"),
        setting("bottom_film", Kind::Film)
            .help("Thin film on such a bottom, layer by layer from above")
            .value_name("MATERIAL:THICKNESS")
            .arity(Arity::ListIn(MEDIUM_IN))
            .otherwise("none"),
        setting("bottom_reflectance", Kind::Number)
            .help("Reflectance of a Lambertian bottom")
            .value_name("FRACTION")
            .range(Range::FromTo(0.0, 1.0))
            .otherwise("1"),
        setting("bottom_surface", Kind::ChoiceOrFile(GIVEN_BOTTOMS))
            .help("Shape of the bottom")
            .commands(TRACE.and(RENDER))
            .value_name("SHAPE|FILE")
            .default("flat"),
        setting("bottom_surface", Kind::Choice(RANDOM_BOTTOMS))
            .help("Shape of the bottom")
            .commands(VERIFY)
            .value_name("SHAPE")
            .default("flat"),
        setting("bottom_surface", Kind::ChoiceOrFile(RANDOM_BOTTOMS))
            .help("Shape of the bottom")
            .commands(GONIO)
            .value_name("SHAPE|FILE")
            .default("flat"),
        setting("max_scatterings", Kind::Order)
            .help("Scatterings in the medium after which a path is truncated")
            .commands(TRACE.and(RENDER).and(VERIFY).and(GONIO))
            .default("100000"),
    ],
);
