//! Erosion of drawn and of given surfaces.

use super::commands::DEGREES;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Setting, setting};

pub(super) const REPOSE: Setting = setting("repose", Kind::Number)
    .help("Let material slip down slopes steeper than this angle")
    .unit(DEGREES)
    .range(Range::FromBelow(0.0, 90.0))
    .otherwise("not done");

pub(super) const SLIP_STEPS: Setting = setting("slip_steps", Kind::Count)
    .help("Steps of slipping")
    .range(Range::FromTo(1.0, 100_000.0))
    .otherwise("1000");

pub(super) const ETCH: Setting = setting("etch", Kind::Length)
    .help("Etch isotropically to this depth, after slipping")
    .range(Range::Above(0.0))
    .otherwise("not done");
