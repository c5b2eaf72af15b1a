//! `[measured]`: given surfaces.

use super::choices::{BORDER, FORM, MISSING, UNIT};
use super::{GIVEN, GONIO, HEIGHT_MAPS, INSPECT, RENDER, TRACE};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, setting};

const SECTION: &str = "measured";

pub(super) const SETTINGS: &[Setting] = &[
    setting(SECTION, "file", Kind::Path, HEIGHT_MAPS, "Height map")
        .flag(Flag::Named("surface"))
        .value_name("FILE")
        .flag_only(),
    setting(
        SECTION,
        "file",
        Kind::Path,
        RENDER,
        "Height map or triangle mesh",
    )
    .flag(Flag::Named("surface"))
    .value_name("FILE")
    .excludes(&["measured.flat"])
    .flag_only(),
    setting(
        SECTION,
        "file",
        Kind::Path,
        TRACE.and(GONIO),
        "Height map or triangle mesh, repeated for each of an ensemble",
    )
    .flag(Flag::Named("surface"))
    .value_name("FILE")
    .arity(Arity::Repeated)
    .excludes(&[
        "measured.flat",
        "surface.tau",
        "surface.tau_y",
        "surface.smoothness",
        "surface.sigma",
        "surface.azimuth",
        "surface.structure",
        "surface.depth",
        "surface.width",
        "surface.scratch_length",
        "surface.density",
        "surface.edge_radius",
        "surface.randomness",
        "surface.arrangement",
        "surface.spread",
        "surface.unit",
        "surface.size",
        "surface.spacing",
        "surface.insist",
        "run.realisations",
    ])
    .clears(&["measured.*"]),
    setting(
        SECTION,
        "flat",
        Kind::Switch,
        TRACE.and(RENDER).and(GONIO),
        "A flat surface",
    )
    .default("false")
    .excludes(&[
        "measured.file",
        "measured.border",
        "measured.spacing",
        "measured.unit",
        "measured.assume_unit",
        "measured.flip",
        "measured.missing",
        "measured.remove",
        "surface.tau",
        "surface.tau_y",
        "surface.smoothness",
        "surface.sigma",
        "surface.azimuth",
        "surface.structure",
        "surface.depth",
        "surface.width",
        "surface.scratch_length",
        "surface.density",
        "surface.edge_radius",
        "surface.randomness",
        "surface.arrangement",
        "surface.spread",
        "surface.unit",
        "surface.size",
        "surface.spacing",
        "surface.insist",
        "run.realisations",
        "run.refine",
    ])
    .clears(&["measured.*"]),
    setting(
        SECTION,
        "border",
        BORDER,
        GIVEN,
        "What lies beyond the border",
    )
    .otherwise("as the file says; else a height map is mirrored and a mesh open"),
    setting(
        SECTION,
        "spacing",
        Kind::Length,
        GIVEN,
        "Distance between samples",
    )
    .range(Range::Above(0.0))
    .arity(Arity::PerAxis)
    .otherwise("as the file says"),
    setting(
        SECTION,
        "unit",
        UNIT,
        GIVEN,
        "Convert lengths of the file into this unit",
    )
    .otherwise("as the file says"),
    setting(
        SECTION,
        "assume_unit",
        UNIT,
        GIVEN,
        "Unit of the lengths of a file that states none",
    )
    .otherwise("arbitrary"),
    setting(
        SECTION,
        "flip",
        Kind::Switch,
        GIVEN,
        "Take rows in reverse order, the last at y = 0",
    )
    .default("false"),
    setting(
        SECTION,
        "missing",
        MISSING,
        GIVEN,
        "What is done with missing points",
    )
    .default("refuse"),
    setting(SECTION, "remove", FORM, GIVEN, "Form to remove").default("none"),
    setting(
        SECTION,
        "s_filter",
        Kind::Length,
        INSPECT,
        "Nesting index of the S-filter: removes shorter waves, before form",
    )
    .range(Range::Above(0.0))
    .otherwise("no S-filter")
    .flag_only(),
    setting(
        SECTION,
        "l_filter",
        Kind::Length,
        INSPECT,
        "Nesting index of the L-filter: removes longer waves, after form",
    )
    .range(Range::Above(0.0))
    .otherwise("no L-filter")
    .flag_only(),
];
