//! `[output]`, where results are written, and the settings of every command.

use super::choices::SCALE;
use super::{
    ATTENUATION, CONVERGE, GENERATE, GONIO, INSPECT, MAP, MESH, MODEL, SWEEPS, TRACE, TRACING,
};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, flags, setting, table};

const FIGURES_IN: Commands = TRACING.and(CONVERGE).and(ATTENUATION);

pub(super) const FIGURES: &[Setting] = &table(
    "output",
    FIGURES_IN,
    [
        setting("plots", Kind::Switch, "Draw no figures").flag(Flag::Off("no-plots")),
        setting(
            "scale",
            SCALE,
            "Discs of a figure that share a colour scale",
        )
        .commands(GONIO)
        .flag(Flag::None)
        .default("rows"),
        setting(
            "models_at_sigma",
            Kind::Number,
            "Values of sigma at which models are drawn over theta",
        )
        .commands(ATTENUATION)
        .flag(Flag::None)
        .range(Range::Above(0.0))
        .arity(Arity::ListIn(ATTENUATION))
        .otherwise("up to three of them"),
        setting(
            "over_sigma_at_theta",
            Kind::Number,
            "Polar angles at which visibility is drawn over sigma",
        )
        .commands(ATTENUATION)
        .flag(Flag::None)
        .range(Range::FromBelow(0.0, 90.0))
        .arity(Arity::ListIn(ATTENUATION))
        .otherwise("up to five of them"),
    ],
);

const FILE: &str = "FILE";

pub(super) const RESULTS: &[Setting] = &flags(
    "results",
    FIGURES_IN,
    [
        setting("output", Kind::Path, "Folder for the results")
            .basic(Commands::ALL)
            .short('o')
            .value_name("DIR")
            .required(SWEEPS),
        setting(
            "output",
            Kind::Path,
            "File to write: .exr, .npy, .gsf, .x3p, or .png for viewing",
        )
        .basic(Commands::ALL)
        .commands(GENERATE)
        .short('o')
        .value_name(FILE)
        .required(GENERATE),
        setting(
            "output",
            Kind::Path,
            "Result folder, or height map: .exr, .npy, .gsf, .x3p or .png",
        )
        .basic(Commands::ALL)
        .commands(INSPECT)
        .short('o')
        .value_name("DIR|FILE"),
        setting("output", Kind::Path, "File to write: .ply, .obj or .stl")
            .basic(Commands::ALL)
            .commands(MESH)
            .short('o')
            .value_name(FILE)
            .required(MESH),
        setting("output", Kind::Path, "File to write: .csv")
            .basic(Commands::ALL)
            .commands(MODEL)
            .short('o')
            .value_name(FILE)
            .otherwise("standard output"),
        setting(
            "plot",
            Kind::Path,
            "Figure of the height map to write: .svg or .png",
        )
        .basic(Commands::ALL)
        .commands(INSPECT)
        .value_name(FILE),
        setting(
            "json",
            Kind::Switch,
            "Print results as JSON on standard output",
        )
        .basic(Commands::ALL)
        .commands(
            TRACE
                .and(SWEEPS)
                .and(MAP)
                .and(ATTENUATION)
                .and(GENERATE)
                .and(INSPECT)
                .and(MODEL),
        ),
    ],
);

pub(super) const PROGRAM: &[Setting] = &flags(
    "program",
    Commands::ALL,
    [
        setting("threads", Kind::Count, "Number of threads")
            .basic(Commands::ALL)
            .range(Range::FromTo(1.0, 1024.0))
            .otherwise("all cores"),
        setting(
            "quiet",
            Kind::Switch,
            "Print nothing but errors and what --json prints",
        )
        .basic(Commands::ALL)
        .short('q'),
        setting(
            "verbose",
            Kind::Switch,
            "Report on standard error what is done and why, and times",
        )
        .basic(Commands::ALL)
        .short('v'),
    ],
);
