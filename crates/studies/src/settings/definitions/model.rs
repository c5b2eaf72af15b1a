//! What `model` evaluates.

use super::{DEGREES, MODEL};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Flag, Setting, setting};

const SECTION: &str = "model";

pub(super) const SETTINGS: &[Setting] = &[
    setting(SECTION, "name", Kind::Model, MODEL, "Model")
        .flag(Flag::None)
        .flag_only(),
    setting(
        SECTION,
        "list",
        Kind::Switch,
        MODEL,
        "List the models and where each is meant to hold",
    )
    .default("false")
    .flag_only(),
    setting(
        SECTION,
        "step",
        Kind::Number,
        MODEL,
        "Distance between directions, for a model with a density",
    )
    .unit(DEGREES)
    .range(Range::AboveTo(0.0, 45.0))
    .otherwise("1")
    .excludes(&["run.bins", "results.json"])
    .flag_only(),
    setting(
        SECTION,
        "sphere",
        Kind::Switch,
        MODEL,
        "The whole sphere, not only the plane of incidence",
    )
    .default("false")
    .excludes(&["run.bins", "results.json"])
    .flag_only(),
];
