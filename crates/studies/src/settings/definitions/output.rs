//! `[output]`, where results are written, and the settings of every command.

use super::choices::{COHERENT, ENGINE, FOR_FORMAT, SCALE};
use super::commands::{
    ALBEDO, ATTENUATION, CONVERGE, EXPORT, GENERATE, GONIO, INSPECT, MAP, MATERIALS, MERGE, MESH,
    MODEL, REPORT, STUDIES, SWEEPS, TRACE, TRACING, VERIFY,
};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, basic, flags, setting, table};

pub(super) const FIGURES: &[Setting] = &table(
    "output",
    STUDIES,
    [
        setting("plots", Kind::Switch)
            .help("Draw figures")
            .flag(Flag::Off("no-plots")),
        setting("paths", Kind::Count)
            .help("Rays whose paths are listed, and drawn over a section")
            .commands(TRACE)
            .range(Range::FromTo(1.0, 1000.0))
            .otherwise("none"),
        setting("absorbed_map", Kind::Switch)
            .help("Map of the light that each cell absorbs")
            .commands(TRACE),
        setting("coherent", COHERENT)
            .help("Coherent light in gloss, haze and scatter")
            .commands(TRACE.and(VERIFY).and(GONIO))
            .otherwise("kirchhoff where a wavelength and the unit of lengths are known"),
        setting("scale", SCALE)
            .help("Discs of a figure that share a colour scale")
            .commands(GONIO)
            .flag(Flag::None)
            .default("rows"),
        setting("models_at_sigma", Kind::Number)
            .help("Values of sigma at which models are drawn over theta")
            .commands(ATTENUATION)
            .flag(Flag::None)
            .range(Range::Above(0.0))
            .arity(Arity::ListIn(ATTENUATION))
            .otherwise("up to three of them"),
        setting("over_sigma_at_theta", Kind::Number)
            .help("Polar angles at which visibility is drawn over sigma")
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
    STUDIES,
    [
        basic("output", Kind::Path)
            .help("Folder for the results")
            .short('o')
            .value_name("DIR"),
        basic("output", Kind::Path)
            .help("File: .exr, .npy, .gsf, .x3p or .png; folder with --realisations")
            .commands(GENERATE)
            .short('o')
            .value_name("FILE|DIR")
            .required(GENERATE),
        basic("output", Kind::Path)
            .help("Result folder, or height map: .exr, .npy, .gsf, .x3p or .png")
            .commands(INSPECT)
            .short('o')
            .value_name("DIR|FILE"),
        basic("output", Kind::Path)
            .help("File to write: .ply, .obj or .stl; folder for several meshes")
            .commands(MESH)
            .short('o')
            .value_name("FILE|DIR")
            .required(MESH),
        basic("output", Kind::Path)
            .help("File to write: .csv")
            .commands(MODEL)
            .short('o')
            .value_name(FILE)
            .otherwise("standard output"),
        basic("output", Kind::Path)
            .help("Table of n and k to write: .csv")
            .commands(MATERIALS)
            .short('o')
            .value_name(FILE),
        basic("output", Kind::Path)
            .help("File: .nc, .xml, .bsdf, .pbsdf, .json or .ssdd, by the format")
            .commands(EXPORT)
            .short('o')
            .value_name(FILE)
            .required(EXPORT),
        basic("output", Kind::Path)
            .help("File to write: .html")
            .commands(REPORT)
            .short('o')
            .value_name(FILE)
            .required(REPORT),
        basic("output", Kind::Path)
            .help("Folder for the results of all shards")
            .commands(MERGE)
            .short('o')
            .value_name("DIR")
            .required(MERGE),
        setting("report", Kind::Path)
            .help("Page of the results to write: .html")
            .commands(STUDIES.and(MERGE))
            .value_name(FILE)
            .otherwise("none"),
        setting("shard", Kind::Share)
            .help("Part of the run to trace, for merge, such as 2/7")
            .value_name("K/N")
            .otherwise("all of it"),
        setting("engine", ENGINE)
            .help("Where light is traced, which changes no results")
            .commands(TRACING.and(ALBEDO).and(CONVERGE))
            .default("cpu"),
        setting("extendable", Kind::Switch)
            .help("Keep what a run with more surfaces or rays needs"),
        setting("plan_only", Kind::Switch)
            .help("Plan surfaces, rays and time of cases and shards, and end"),
        setting("plan", Kind::Path)
            .help("Folder of --plan-only by whose times shards are balanced")
            .value_name("DIR")
            .otherwise("expected ones"),
        setting("for", FOR_FORMAT)
            .help("Directions, bins and light that a format of export needs")
            .commands(GONIO)
            .otherwise("those of the other flags"),
        basic("plot", Kind::Path)
            .help("Figure of n and k over all wavelengths to write: .svg or .png")
            .commands(MATERIALS)
            .value_name(FILE),
        basic("plot", Kind::Path)
            .help("Figure of the height map to write: .svg or .png")
            .commands(INSPECT)
            .value_name(FILE),
        basic("json", Kind::Switch)
            .help("Print results as JSON on standard output")
            .commands(
                TRACE
                    .and(SWEEPS)
                    .and(MAP)
                    .and(ALBEDO)
                    .and(ATTENUATION)
                    .and(GENERATE)
                    .and(INSPECT)
                    .and(MODEL)
                    .and(MATERIALS)
                    .and(EXPORT)
                    .and(MERGE),
            ),
    ],
);

pub(super) const PROGRAM: &[Setting] = &flags(
    "program",
    Commands::ALL,
    [
        basic("threads", Kind::Count)
            .help("Number of threads")
            .range(Range::FromTo(1.0, 1024.0))
            .otherwise("all cores"),
        basic("quiet", Kind::Switch)
            .help("Print nothing but errors and what --json prints")
            .short('q'),
        basic("verbose", Kind::Switch)
            .help("Report what is done and why, with times; print all tables")
            .short('v'),
    ],
);
