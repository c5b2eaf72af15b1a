//! `[run]`: how much is traced, and how.

use super::choices::{
    ACCELERATOR, BINS, BRANCHING, ESTIMATOR, POLARISATION, QUANTITY, ROULETTE, SAMPLING, SIDE,
    VISIBILITY,
};
use super::{ATTENUATION, DEGREES, GENERATE, GONIO, MAP, MODEL, RENDER, TRACE, TRACING, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Flag, Setting, setting, table};

const AIMED: Commands = TRACE.and(VERIFY).and(MAP);
/// Commands that draw surfaces and record bins.
const RANDOM: Commands = VERIFY.and(MAP).and(GONIO);

pub(super) const SETTINGS: &[Setting] = &table(
    "run",
    TRACING,
    [
        setting("realisations", Kind::Count, "Surfaces drawn per case")
            .basic(Commands::ALL)
            .commands(VERIFY.and(MAP).and(GONIO).and(ATTENUATION))
            .default("32")
            .default_in(&[(ATTENUATION, Some("20"))]),
        setting("rays", Kind::Count, "Rays per case, over all its surfaces")
            .basic(Commands::ALL)
            .commands(TRACING.and(MODEL))
            .default("1e6")
            .default_in(&[(MODEL, None)])
            .otherwise("1e6 for a model that follows rays"),
        setting(
            "target_error",
            Kind::Number,
            "Error to reach, in place of numbers of surfaces and rays",
        )
        .basic(Commands::ALL)
        .commands(AIMED)
        .value_name("ERROR")
        .range(Range::Above(0.0)),
        setting("of", QUANTITY, "Quantity to which the target error applies")
            .commands(AIMED)
            .value_name("QUANTITY")
            .otherwise("bins"),
        setting(
            "max_time",
            Kind::Duration,
            "Time after which no further work is started",
        )
        .commands(TRACING.and(RENDER))
        .value_name("TIME"),
        setting("seed", Kind::Seed, "Seed of the random numbers")
            .basic(Commands::ALL)
            .commands(
                TRACING
                    .and(GENERATE)
                    .and(RENDER)
                    .and(ATTENUATION)
                    .and(MODEL),
            )
            .default("1")
            .default_in(&[(MODEL, None)])
            .otherwise("1 for a model that follows rays"),
        setting("bins", BINS, "Bins of a hemisphere")
            .basic(TRACE.and(VERIFY).and(MODEL))
            .value_name("THETAxPHI")
            .default("auto")
            .default_in(&[(MAP, Some("18x36"))]),
        setting("bins", Kind::Grid, "Bins of a hemisphere")
            .basic(TRACE.and(VERIFY).and(MODEL))
            .commands(MODEL)
            .value_name("THETAxPHI")
            .otherwise("18x36 for a model that follows rays")
            .flag_only(),
        setting(
            "in_plane_half_width",
            Kind::Number,
            "Half width of the in-plane slice",
        )
        .unit(DEGREES)
        .range(Range::AboveTo(0.0, 90.0))
        .default("5"),
        setting("side", SIDE, "The side whose light is recorded").default("both"),
        setting("branching", BRANCHING, "Branches followed at an interface").default("auto"),
        setting(
            "polarisation",
            POLARISATION,
            "Whether paths carry the polarisation of light",
        )
        .default("tracked"),
        setting(
            "roulette",
            ROULETTE,
            "Throughput below which Russian roulette ends paths",
        )
        .range(Range::AboveTo(0.0, 1.0))
        .default("auto"),
        setting(
            "max_order",
            Kind::Order,
            "Interactions after which a path is truncated",
        )
        .default("1000"),
        setting("accelerator", ACCELERATOR, "How hits are found").default("auto"),
        setting(
            "estimator",
            ESTIMATOR,
            "How fluxes are estimated from paths",
        )
        .default("auto"),
        setting("sampling", SAMPLING, "How rays are distributed").default("stratified"),
        setting(
            "refine",
            Kind::Switch,
            "Also trace at half the spacing, for the error of the mesh",
        )
        .commands(AIMED),
        setting(
            "fold",
            Kind::Switch,
            "Do not average bins on either side of the plane of incidence",
        )
        .commands(RANDOM)
        .flag(Flag::Off("no-fold")),
        setting("method", VISIBILITY, "How visibility is computed")
            .commands(ATTENUATION)
            .aliases(&["way"])
            .default("auto"),
        setting(
            "mirror",
            Kind::Switch,
            "Do not follow mirrored rays (mirror_g2)",
        )
        .commands(ATTENUATION)
        .flag(Flag::Off("no-mirror")),
        setting("heights", Kind::Switch, "Measure the visibility by height")
            .basic(Commands::ALL)
            .commands(ATTENUATION),
        setting(
            "demarcation",
            Kind::Switch,
            "Measure the angles at which shadow begins",
        )
        .basic(Commands::ALL)
        .commands(ATTENUATION),
    ],
);
