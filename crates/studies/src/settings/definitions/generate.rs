//! The height map that `generate` writes.

use super::GENERATE;
use crate::settings::kind::Kind;
use crate::settings::setting::{Setting, setting};

const SECTION: &str = "generate";

pub(super) const SETTINGS: &[Setting] = &[setting(
    SECTION,
    "realisation",
    Kind::Seed,
    GENERATE,
    "Number of the surface among those of the seed",
)
.value_name("NUMBER")
.default("0")
.flag_only()];
