//! `[output]` and what is written where.

use super::choices::SCALE;
use super::{
    ATTENUATION, CONVERGE, GENERATE, GONIO, INSPECT, MAP, MESH, MODEL, SWEEPS, TRACE, TRACING,
};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, setting};

const FIGURES_IN: Commands = TRACING.and(CONVERGE).and(ATTENUATION);

pub(super) const FIGURES: &[Setting] = &[
    setting(
        "output",
        "plots",
        Kind::Switch,
        FIGURES_IN,
        "Draw no figures",
    )
    .flag(Flag::Off("no-plots"))
    .default("true"),
    setting(
        "output",
        "scale",
        SCALE,
        GONIO,
        "Discs of a figure that share a colour scale",
    )
    .flag(Flag::None)
    .default("rows"),
    setting(
        "output",
        "models_at_sigma",
        Kind::Number,
        ATTENUATION,
        "Values of sigma at which models are drawn over theta",
    )
    .flag(Flag::None)
    .range(Range::Above(0.0))
    .arity(Arity::ListIn(ATTENUATION))
    .otherwise("up to three of them"),
    setting(
        "output",
        "over_sigma_at_theta",
        Kind::Number,
        ATTENUATION,
        "Polar angles at which visibility is drawn over sigma",
    )
    .flag(Flag::None)
    .range(Range::FromBelow(0.0, 90.0))
    .arity(Arity::ListIn(ATTENUATION))
    .otherwise("up to five of them"),
];

const FILE: &str = "FILE";

pub(super) const RESULTS: &[Setting] = &[
    setting(
        "results",
        "output",
        Kind::Path,
        FIGURES_IN,
        "Folder for the results",
    )
    .short('o')
    .value_name("DIR")
    .required(SWEEPS)
    .flag_only(),
    setting(
        "results",
        "output",
        Kind::Path,
        GENERATE,
        "File to write: .exr, .npy, .gsf, .x3p, or .png for viewing",
    )
    .short('o')
    .value_name(FILE)
    .required(GENERATE)
    .flag_only(),
    setting(
        "results",
        "output",
        Kind::Path,
        INSPECT,
        "Result folder, or height map: .exr, .npy, .gsf, .x3p or .png",
    )
    .short('o')
    .value_name("DIR|FILE")
    .flag_only(),
    setting(
        "results",
        "output",
        Kind::Path,
        MESH,
        "File to write: .ply, .obj or .stl",
    )
    .short('o')
    .value_name(FILE)
    .required(MESH)
    .flag_only(),
    setting(
        "results",
        "output",
        Kind::Path,
        MODEL,
        "File to write: .csv",
    )
    .short('o')
    .value_name(FILE)
    .otherwise("standard output")
    .flag_only(),
    setting(
        "results",
        "plot",
        Kind::Path,
        INSPECT,
        "Figure of the height map to write: .svg or .png",
    )
    .value_name(FILE)
    .flag_only(),
    setting(
        "results",
        "json",
        Kind::Switch,
        TRACE
            .and(SWEEPS)
            .and(MAP)
            .and(ATTENUATION)
            .and(GENERATE)
            .and(INSPECT)
            .and(MODEL),
        "Print results as JSON on standard output",
    )
    .default("false")
    .flag_only(),
];
