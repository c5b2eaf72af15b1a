//! `[compare]` and `[map]`: models and how strictly they are judged.

use super::{DEGREES, MAP as MAP_COMMAND, TRACE, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Flag, Setting, setting};

const COMMANDS: Commands = TRACE.and(VERIFY).and(MAP_COMMAND);

pub(super) const COMPARE: &[Setting] = &[
    setting(
        "compare",
        "models",
        Kind::Models,
        VERIFY.and(MAP_COMMAND),
        "Models to compare with; the default depends on the surface",
    )
    .value_name("NAMES")
    .default("xu-sun,smith,heitz"),
    setting(
        "compare",
        "models",
        Kind::Models,
        TRACE,
        "Models to compare a height map with, which have its slopes",
    )
    .value_name("NAMES")
    .default("none"),
    setting(
        "compare",
        "model_rays",
        Kind::Count,
        COMMANDS,
        "Rays of a model that follows rays",
    )
    .default("1e6"),
    setting(
        "compare",
        "level",
        Kind::Number,
        TRACE.and(VERIFY),
        "Significance level of the tests of one case together",
    )
    .range(Range::Between(0.0, 1.0))
    .default("0.01"),
];

pub(super) const MAP: &[Setting] = &[
    setting(
        "map",
        "total_variation",
        Kind::Number,
        MAP_COMMAND,
        "Tolerated total variation, of the incident flux",
    )
    .flag(Flag::Named("tolerance-total-variation"))
    .value_name("FLUX")
    .range(Range::Above(0.0))
    .default("0.01"),
    setting(
        "map",
        "energy",
        Kind::Number,
        MAP_COMMAND,
        "Tolerated difference in energy of a side, of the incident flux",
    )
    .flag(Flag::Named("tolerance-energy"))
    .value_name("FLUX")
    .range(Range::Above(0.0))
    .default("0.01"),
    setting(
        "map",
        "peak",
        Kind::Number,
        MAP_COMMAND,
        "Tolerated difference in direction of a peak",
    )
    .flag(Flag::Named("tolerance-peak"))
    .unit(DEGREES)
    .range(Range::Above(0.0))
    .default("2.5"),
];
