//! `[run]`: how much is traced, and how.

use super::choices::{
    ACCELERATOR, AVERAGING, BINS, BRANCHING, ESTIMATOR, POLARISATION, QUANTITY, ROULETTE, SAMPLING,
    SIDE,
};
use super::commands::{
    ALBEDO, ATTENUATION, DEGREES, GENERATE, GONIO, MAP, MODEL, RENDER, TRACE, TRACING, VERIFY,
};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Flag, Setting, basic, setting, table};

const AIMED: Commands = TRACE.and(VERIFY).and(MAP);
/// Commands that draw surfaces and record bins.
const RANDOM: Commands = VERIFY.and(MAP).and(GONIO);

pub(super) const SETTINGS: &[Setting] = &table(
    "run",
    TRACING,
    [
        basic("realisations", Kind::Count)
            .help("Surfaces drawn per case")
            .commands(VERIFY.and(MAP).and(GONIO).and(ALBEDO).and(ATTENUATION))
            .default("32")
            .default_in(&[(ATTENUATION, Some("20"))]),
        basic("realisations", Kind::Count)
            .help("Number of surfaces, numbered files in a folder")
            .commands(GENERATE)
            .range(Range::FromTo(1.0, 1e6))
            .otherwise("one, in a file")
            .flag_only(),
        basic("rays", Kind::Count)
            .help("Rays per case, over all its surfaces")
            .commands(TRACING.and(ALBEDO))
            .default("1e6")
            .default_in(&[(ALBEDO, Some("6e4"))]),
        basic("rays", Kind::Count)
            .help("Rays that a model follows")
            .commands(MODEL)
            .otherwise("1e6 for a model that follows rays")
            .flag_only(),
        basic("target_error", Kind::Number)
            .help("Error to reach, in place of numbers of surfaces and rays")
            .commands(AIMED.and(ALBEDO))
            .value_name("ERROR")
            .range(Range::Above(0.0)),
        setting("of", QUANTITY)
            .help("Quantity to which the target error applies")
            .commands(AIMED)
            .value_name("QUANTITY")
            .otherwise("bins"),
        setting("max_time", Kind::Duration)
            .help("Time after which no further work is started")
            .commands(TRACING.and(ALBEDO).and(RENDER))
            .value_name("TIME"),
        basic("seed", Kind::Seed)
            .help("Seed of the random numbers")
            .commands(
                TRACING
                    .and(ALBEDO)
                    .and(GENERATE)
                    .and(RENDER)
                    .and(ATTENUATION)
                    .and(MODEL),
            )
            .default("1")
            .default_in(&[(MODEL, None)])
            .otherwise("1 for a model that follows rays"),
        setting("bins", BINS)
            .help("Bins of a hemisphere")
            .basic(TRACE.and(VERIFY).and(MODEL))
            .value_name("THETAxPHI")
            .default("auto")
            .default_in(&[(MAP, Some("18x36"))]),
        setting("bins", Kind::Grid)
            .help("Bins of a hemisphere")
            .basic(TRACE.and(VERIFY).and(MODEL))
            .commands(MODEL)
            .value_name("THETAxPHI")
            .otherwise("18x36 for a model that follows rays")
            .flag_only(),
        setting("in_plane_half_width", Kind::Number)
            .help("Half width of the in-plane slice")
            .unit(DEGREES)
            .range(Range::AboveTo(0.0, 90.0))
            .default("5"),
        setting("side", SIDE)
            .help("The side whose light is recorded")
            .default("both"),
        setting("branching", BRANCHING)
            .help("Branches followed at an interface")
            .default("auto"),
        setting("polarisation", POLARISATION)
            .help("Whether paths carry the polarisation of light")
            .default("tracked"),
        setting("polarisation", AVERAGING)
            .help("Whether paths carry the polarisation of light")
            .commands(ALBEDO)
            .default("tracked"),
        setting("roulette", ROULETTE)
            .help("Throughput below which Russian roulette ends paths")
            .range(Range::AboveTo(0.0, 1.0))
            .default("auto"),
        setting("max_order", Kind::Order)
            .help("Interactions after which a path is truncated")
            .default("1000"),
        setting("accelerator", ACCELERATOR)
            .help("How hits are found")
            .default("auto"),
        setting("estimator", ESTIMATOR)
            .help("How fluxes are estimated from paths")
            .default("auto"),
        setting("sampling", SAMPLING)
            .help("How rays are distributed")
            .default("stratified"),
        setting("refine", Kind::Switch)
            .help("Also trace at half the spacing, for the error of the mesh")
            .commands(AIMED),
        setting("fold", Kind::Switch)
            .help("Average bins on either side of the plane of incidence")
            .commands(RANDOM)
            .flag(Flag::Off("no-fold")),
        setting("mirror", Kind::Switch)
            .help("Follow mirrored rays (mirror_g2)")
            .commands(ATTENUATION)
            .flag(Flag::Off("no-mirror")),
        basic("heights", Kind::Switch)
            .help("Measure the visibility by height")
            .commands(ATTENUATION),
        basic("demarcation", Kind::Switch)
            .help("Measure the angles at which shadow begins")
            .commands(ATTENUATION),
    ],
);
