//! Settings of every command.

use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Setting, setting};

const SECTION: &str = "program";

pub(super) const SETTINGS: &[Setting] = &[
    setting(
        SECTION,
        "threads",
        Kind::Count,
        Commands::ALL,
        "Number of threads",
    )
    .range(Range::FromTo(1.0, 1024.0))
    .otherwise("all cores")
    .flag_only(),
    setting(
        SECTION,
        "quiet",
        Kind::Switch,
        Commands::ALL,
        "Print nothing but errors and what --json prints",
    )
    .short('q')
    .default("false")
    .excludes(&["program.verbose"])
    .flag_only(),
    setting(
        SECTION,
        "verbose",
        Kind::Switch,
        Commands::ALL,
        "Report on standard error what is done and why, and times",
    )
    .short('v')
    .default("false")
    .flag_only(),
];
