//! `[material]`: what the surface is made of.

use super::choices::MATERIAL;
use super::{CONVERGE, GONIO, MAP, MODEL, RENDER, SWEEPS, TRACE, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, setting};

const SECTION: &str = "material";
const COMMANDS: Commands = TRACE
    .and(RENDER)
    .and(VERIFY)
    .and(MAP)
    .and(GONIO)
    .and(CONVERGE)
    .and(MODEL);

pub(super) const SETTINGS: &[Setting] = &[
    setting(SECTION, "kind", MATERIAL, COMMANDS, "Material")
        .flag(Flag::Named("material"))
        .default("dielectric"),
    setting(
        SECTION,
        "eta",
        Kind::Number,
        COMMANDS,
        "Relative refractive index n_transmitted / n_incident",
    )
    .range(Range::FromTo(1e-6, 1e6))
    .arity(Arity::ListIn(SWEEPS))
    .otherwise("1.5 for a dielectric"),
    setting(
        SECTION,
        "kappa",
        Kind::Number,
        COMMANDS,
        "Absorption index of a conductor",
    )
    .range(Range::FromTo(0.0, 1e6)),
    setting(
        SECTION,
        "reflectance",
        Kind::Number,
        COMMANDS,
        "Fraction of light that a Lambertian facet reflects",
    )
    .range(Range::FromTo(0.0, 1.0))
    .otherwise("none; lambertian facets need it"),
];
