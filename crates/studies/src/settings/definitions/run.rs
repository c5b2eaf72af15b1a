//! `[run]`: how much is traced, and how.

use super::choices::{
    ACCELERATOR, BINS, BRANCHING, ESTIMATOR, POLARISATION, QUANTITY, ROULETTE, SAMPLING, SIDE,
};
use super::{ATTENUATION, DEGREES, GENERATE, GONIO, MAP, MODEL, RENDER, TRACE, TRACING, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Flag, Setting, setting};

const SECTION: &str = "run";
const AIMED: Commands = TRACE.and(VERIFY).and(MAP);
/// Commands that draw surfaces and record bins.
const RANDOM: Commands = VERIFY.and(MAP).and(GONIO);

pub(super) const SETTINGS: &[Setting] = &[
    setting(
        SECTION,
        "realisations",
        Kind::Count,
        VERIFY.and(MAP).and(GONIO).and(ATTENUATION),
        "Surfaces drawn per case",
    )
    .default("32")
    .default_in(&[(ATTENUATION, Some("20"))])
    .excludes(&["run.target_error"])
    .clears(&["run.of"]),
    setting(
        SECTION,
        "rays",
        Kind::Count,
        TRACING.and(MODEL),
        "Rays per case, over all its surfaces",
    )
    .default("1e6")
    .default_in(&[(MODEL, None)])
    .otherwise("1e6 for a model that follows rays")
    .excludes(&["run.target_error"])
    .clears(&["run.of"]),
    setting(
        SECTION,
        "target_error",
        Kind::Number,
        AIMED,
        "Error to reach, in place of numbers of surfaces and rays",
    )
    .value_name("ERROR")
    .range(Range::Above(0.0))
    .excludes(&["run.realisations", "run.rays"]),
    setting(
        SECTION,
        "of",
        QUANTITY,
        AIMED,
        "Quantity to which the target error applies",
    )
    .value_name("QUANTITY")
    .otherwise("bins"),
    setting(
        SECTION,
        "max_time",
        Kind::Duration,
        TRACING.and(RENDER),
        "Time after which no further work is started",
    )
    .value_name("TIME"),
    setting(
        SECTION,
        "seed",
        Kind::Seed,
        TRACING
            .and(GENERATE)
            .and(RENDER)
            .and(ATTENUATION)
            .and(MODEL),
        "Seed of the random numbers",
    )
    .default("1")
    .default_in(&[(MODEL, None)])
    .otherwise("1 for a model that follows rays"),
    setting(SECTION, "bins", BINS, TRACING, "Bins of a hemisphere")
        .value_name("THETAxPHI")
        .default("auto")
        .default_in(&[(MAP, Some("18x36"))]),
    setting(SECTION, "bins", Kind::Grid, MODEL, "Bins of a hemisphere")
        .value_name("THETAxPHI")
        .otherwise("18x36 for a model that follows rays")
        .flag_only()
        .excludes(&["model.step", "model.sphere"]),
    setting(
        SECTION,
        "in_plane_half_width",
        Kind::Number,
        TRACING,
        "Half width of the in-plane slice",
    )
    .unit(DEGREES)
    .range(Range::AboveTo(0.0, 90.0))
    .default("5"),
    setting(
        SECTION,
        "side",
        SIDE,
        TRACING,
        "The side whose light is recorded",
    )
    .default("both"),
    setting(
        SECTION,
        "branching",
        BRANCHING,
        TRACING,
        "Branches followed at an interface",
    )
    .default("auto"),
    setting(
        SECTION,
        "polarisation",
        POLARISATION,
        TRACING,
        "Whether paths carry the polarisation of light",
    )
    .default("tracked"),
    setting(
        SECTION,
        "roulette",
        ROULETTE,
        TRACING,
        "Throughput below which Russian roulette ends paths",
    )
    .range(Range::AboveTo(0.0, 1.0))
    .default("auto"),
    setting(
        SECTION,
        "max_order",
        Kind::Order,
        TRACING,
        "Interactions after which a path is truncated",
    )
    .default("1000"),
    setting(
        SECTION,
        "accelerator",
        ACCELERATOR,
        TRACING,
        "How hits are found",
    )
    .default("auto"),
    setting(
        SECTION,
        "estimator",
        ESTIMATOR,
        TRACING,
        "How fluxes are estimated from paths",
    )
    .default("auto"),
    setting(
        SECTION,
        "sampling",
        SAMPLING,
        TRACING,
        "How rays are distributed",
    )
    .default("stratified"),
    setting(
        SECTION,
        "refine",
        Kind::Switch,
        AIMED,
        "Also trace at half the spacing, for the error of the mesh",
    )
    .default("false"),
    setting(
        SECTION,
        "fold",
        Kind::Switch,
        RANDOM,
        "Do not average bins on either side of the plane of incidence",
    )
    .flag(Flag::Off("no-fold"))
    .default("true"),
    setting(
        SECTION,
        "mirror",
        Kind::Switch,
        ATTENUATION,
        "Do not follow mirrored rays (mirror_g2)",
    )
    .flag(Flag::Off("no-mirror"))
    .default("true"),
    setting(
        SECTION,
        "heights",
        Kind::Switch,
        ATTENUATION,
        "Measure the visibility by height",
    )
    .default("false"),
    setting(
        SECTION,
        "demarcation",
        Kind::Switch,
        ATTENUATION,
        "Measure the angles at which shadow begins",
    )
    .default("false"),
];
