//! Erosion of a height map by `inspect`.

use super::{DEGREES, INSPECT};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Setting, setting};

const SECTION: &str = "erosion";

pub(super) const SETTINGS: &[Setting] = &[
    setting(
        SECTION,
        "repose",
        Kind::Number,
        INSPECT,
        "Let material slip down slopes steeper than this angle",
    )
    .unit(DEGREES)
    .range(Range::FromBelow(0.0, 90.0))
    .otherwise("not done")
    .flag_only(),
    setting(
        SECTION,
        "slip_steps",
        Kind::Count,
        INSPECT,
        "Steps of slipping",
    )
    .range(Range::FromTo(1.0, 100_000.0))
    .default("1000")
    .flag_only(),
    setting(
        SECTION,
        "etch",
        Kind::Length,
        INSPECT,
        "Etch isotropically to this depth, after slipping",
    )
    .range(Range::Above(0.0))
    .otherwise("not done")
    .flag_only(),
];
