//! `[measured]`: given surfaces.

use super::choices::{BORDER, FORM, MISSING, UNIT};
use super::{GIVEN, GONIO, HEIGHT_MAPS, INSPECT, RENDER, TRACE};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, setting, table};

pub(super) const SETTINGS: &[Setting] = &table(
    "measured",
    GIVEN,
    [
        setting("file", Kind::Path, "Height map")
            .basic(Commands::ALL)
            .commands(HEIGHT_MAPS)
            .flag(Flag::Named("surface"))
            .value_name("FILE")
            .flag_only(),
        setting("file", Kind::Path, "Height map or triangle mesh")
            .basic(Commands::ALL)
            .commands(RENDER)
            .flag(Flag::Named("surface"))
            .value_name("FILE")
            .flag_only(),
        setting(
            "file",
            Kind::Path,
            "Height map or triangle mesh, repeated for each of an ensemble",
        )
        .basic(Commands::ALL)
        .commands(TRACE.and(GONIO))
        .flag(Flag::Named("surface"))
        .value_name("FILE")
        .arity(Arity::Repeated)
        .clears(&["measured.*"]),
        setting("flat", Kind::Switch, "A flat surface")
            .basic(Commands::ALL)
            .commands(TRACE.and(RENDER).and(GONIO)),
        setting("border", BORDER, "What lies beyond the border")
            .basic(TRACE.and(RENDER).and(HEIGHT_MAPS))
            .otherwise("as the file says; else a height map is mirrored and a mesh open"),
        setting("spacing", Kind::Length, "Distance between samples")
            .basic(TRACE.and(RENDER).and(HEIGHT_MAPS))
            .range(Range::Above(0.0))
            .arity(Arity::PerAxis)
            .otherwise("as the file says"),
        setting("unit", UNIT, "Convert lengths of the file into this unit")
            .basic(HEIGHT_MAPS)
            .otherwise("as the file says"),
        setting(
            "assume_unit",
            UNIT,
            "Unit of the lengths of a file that states none",
        )
        .basic(HEIGHT_MAPS)
        .otherwise("arbitrary"),
        setting(
            "flip",
            Kind::Switch,
            "Take rows in reverse order, the last at y = 0",
        )
        .basic(HEIGHT_MAPS),
        setting("missing", MISSING, "What is done with missing points")
            .basic(TRACE.and(RENDER).and(HEIGHT_MAPS))
            .default("refuse"),
        setting("remove", FORM, "Form to remove")
            .basic(TRACE.and(RENDER).and(HEIGHT_MAPS))
            .default("none"),
        setting(
            "s_filter",
            Kind::Length,
            "Nesting index of the S-filter: removes shorter waves, before form",
        )
        .basic(Commands::ALL)
        .commands(INSPECT)
        .range(Range::Above(0.0))
        .otherwise("no S-filter")
        .flag_only(),
        setting(
            "l_filter",
            Kind::Length,
            "Nesting index of the L-filter: removes longer waves, after form",
        )
        .basic(Commands::ALL)
        .commands(INSPECT)
        .range(Range::Above(0.0))
        .otherwise("no L-filter")
        .flag_only(),
    ],
);
