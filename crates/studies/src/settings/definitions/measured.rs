//! `[measured]`: given surfaces.

use super::choices::{BORDER, FORM, MISSING, UNIT, UP};
use super::commands::{GIVEN, GONIO, HEIGHT_MAPS, INSPECT, MESH, RENDER, SURFACES, TRACE};
use super::erosion::{ETCH, REPOSE, SLIP_STEPS};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, basic, setting, table};

pub(super) const SETTINGS: &[Setting] = &table(
    "measured",
    GIVEN,
    [
        basic("file", Kind::Path)
            .help("Height map")
            .commands(INSPECT)
            .flag(Flag::Named("surface"))
            .value_name("FILE")
            .flag_only(),
        basic("file", Kind::Path)
            .help("Height map, repeated for several meshes")
            .commands(MESH)
            .flag(Flag::Named("surface"))
            .value_name("FILE")
            .arity(Arity::Repeated)
            .flag_only(),
        basic("file", Kind::Path)
            .help("Height map or triangle mesh")
            .commands(RENDER)
            .flag(Flag::Named("surface"))
            .value_name("FILE")
            .flag_only(),
        basic("file", Kind::Path)
            .help("Height map or triangle mesh, repeated for each of an ensemble")
            .commands(TRACE.and(GONIO))
            .flag(Flag::Named("surface"))
            .value_name("FILE")
            .arity(Arity::Repeated),
        basic("flat", Kind::Switch)
            .help("A flat surface")
            .commands(TRACE.and(RENDER).and(GONIO)),
        setting("border", BORDER)
            .help("What lies beyond the border")
            .basic(TRACE.and(HEIGHT_MAPS))
            .otherwise("as the file says; else a height map is mirrored and a mesh open"),
        setting("spacing", Kind::Length)
            .help("Distance between samples")
            .basic(TRACE.and(HEIGHT_MAPS))
            .range(Range::Above(0.0))
            .arity(Arity::PerAxis)
            .otherwise("as the file says"),
        setting("unit", UNIT)
            .help("Convert lengths of the file into this unit")
            .basic(HEIGHT_MAPS)
            .otherwise("as the file says"),
        setting("assume_unit", UNIT)
            .help("Unit of the lengths of a file that states none")
            .basic(HEIGHT_MAPS)
            .otherwise("arbitrary"),
        setting("flip", Kind::Switch)
            .help("Take rows in reverse order, the last at y = 0")
            .basic(HEIGHT_MAPS),
        setting("up", UP)
            .help("Axis of a triangle mesh that points up")
            .commands(SURFACES)
            .otherwise("z"),
        setting("missing", MISSING)
            .help("What is done with missing points")
            .basic(TRACE.and(HEIGHT_MAPS))
            .default("refuse"),
        setting("remove", FORM)
            .help("Form to remove")
            .basic(TRACE.and(HEIGHT_MAPS))
            .default("none"),
        setting("s_filter", Kind::Length)
            .help("Nesting index of the S-filter: removes shorter waves, before form")
            .basic(INSPECT)
            .range(Range::Above(0.0))
            .otherwise("no S-filter"),
        setting("l_filter", Kind::Length)
            .help("Nesting index of the L-filter: removes longer waves, after form")
            .basic(INSPECT)
            .range(Range::Above(0.0))
            .otherwise("no L-filter"),
        REPOSE.basic(INSPECT),
        SLIP_STEPS,
        ETCH.basic(INSPECT),
    ],
);
