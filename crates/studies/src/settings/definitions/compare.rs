//! `[compare]` and `[map]`: models and how strictly they are judged.

use super::commands::{DEGREES, MAP as MAP_COMMAND, TRACE, VERIFY};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Flag, Setting, basic, setting, table};

const COMMANDS: Commands = TRACE.and(VERIFY).and(MAP_COMMAND);

pub(super) const COMPARE: &[Setting] = &table(
    "compare",
    COMMANDS,
    [
        basic("models", Kind::Models)
            .help("Models to compare with; the default depends on the surface")
            .commands(VERIFY.and(MAP_COMMAND))
            .value_name("NAMES")
            .default("xu-sun,smith,heitz"),
        basic("models", Kind::Models)
            .help("Models to compare a height map with, which have its slopes")
            .commands(TRACE)
            .value_name("NAMES")
            .default("none"),
        setting("model_rays", Kind::Count)
            .help("Rays of a model that follows rays")
            .otherwise("1e6, or as many as a target error asks for"),
        setting("level", Kind::Number)
            .help("Significance level of the tests of one case together")
            .commands(TRACE.and(VERIFY))
            .range(Range::Between(0.0, 1.0))
            .default("0.01"),
    ],
);

pub(super) const MAP: &[Setting] = &table(
    "map",
    COMMANDS,
    [
        basic("total_variation", Kind::Number)
            .help("Tolerated total variation, of the incident flux")
            .commands(MAP_COMMAND)
            .flag(Flag::Named("tolerance-total-variation"))
            .value_name("FLUX")
            .range(Range::Above(0.0))
            .default("0.01"),
        basic("energy", Kind::Number)
            .help("Tolerated difference in energy of a side, of the incident flux")
            .commands(MAP_COMMAND)
            .flag(Flag::Named("tolerance-energy"))
            .value_name("FLUX")
            .range(Range::Above(0.0))
            .default("0.01"),
        basic("peak", Kind::Number)
            .help("Tolerated difference in direction of a peak")
            .commands(MAP_COMMAND)
            .flag(Flag::Named("tolerance-peak"))
            .unit(DEGREES)
            .range(Range::Above(0.0))
            .default("2.5"),
    ],
);
