//! `[surface]`: random surfaces, and the cells of any.

use super::choices::{CELLS, DRAWN_BORDER, DRAWN_UNIT};
use super::{ATTENUATION, DEGREES, GENERATE, GIVEN, MODEL, RANDOM, SWEEPS, TRACING};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, setting};

const SECTION: &str = "surface";

pub(super) const SETTINGS: &[Setting] = &[
    setting(
        SECTION,
        "tau",
        Kind::Length,
        RANDOM.and(ATTENUATION),
        "1/e correlation length",
    )
    .range(Range::Above(0.0))
    .default("16")
    .default_in(&[(ATTENUATION, Some("0.5"))])
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "tau_y",
        Kind::Length,
        RANDOM,
        "1/e correlation length along the second principal axis",
    )
    .range(Range::Above(0.0))
    .otherwise("tau")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "smoothness",
        Kind::Number,
        RANDOM.and(MODEL),
        "Smoothness s = tau / sigma, along the first principal axis",
    )
    .range(Range::AboveTo(0.0, 1e6))
    .arity(Arity::ListIn(SWEEPS))
    .default("3")
    .default_in(&[(MODEL, None)])
    .otherwise("none; models of rough surfaces need it")
    .default_yields()
    .excludes(&["surface.sigma", "measured.*"]),
    setting(
        SECTION,
        "smoothness_y",
        Kind::Number,
        MODEL,
        "Smoothness tau_y / sigma along the second principal axis",
    )
    .range(Range::AboveTo(0.0, 1e6))
    .otherwise("smoothness"),
    setting(
        SECTION,
        "sigma",
        Kind::Length,
        RANDOM.and(ATTENUATION),
        "Root mean square height, in place of smoothness",
    )
    .range(Range::Above(0.0))
    .arity(Arity::ListIn(SWEEPS.and(ATTENUATION)))
    .default_in(&[(ATTENUATION, Some("0.5"))])
    .excludes(&["surface.smoothness", "measured.*"])
    .clears(&["output.models_at_sigma"]),
    setting(
        SECTION,
        "azimuth",
        Kind::Number,
        RANDOM.and(MODEL),
        "Angle from +x to the first principal axis",
    )
    .unit(DEGREES)
    .default("0")
    .default_in(&[(MODEL, None)])
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "unit",
        DRAWN_UNIT,
        RANDOM.and(ATTENUATION),
        "Unit of lengths",
    )
    .otherwise("that of the first length with a unit, else 1")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "size",
        Kind::Count,
        RANDOM.and(ATTENUATION),
        "Samples along x and y",
    )
    .arity(Arity::PerAxis)
    .default("512")
    .default_in(&[
        (GENERATE, Some("1024")),
        (ATTENUATION, None),
        (TRACING, None),
    ])
    .otherwise("a tile of 32 correlation lengths, or of length")
    .excludes(&["surface.length", "measured.*"]),
    setting(
        SECTION,
        "length",
        Kind::Length,
        ATTENUATION,
        "Side of the tile, in place of size; a multiple of the spacing",
    )
    .range(Range::Above(0.0))
    .arity(Arity::PerAxis)
    .default("12.8")
    .default_yields()
    .excludes(&["surface.size"]),
    setting(
        SECTION,
        "spacing",
        Kind::Length,
        RANDOM.and(ATTENUATION),
        "Distance between samples",
    )
    .range(Range::Above(0.0))
    .arity(Arity::PerAxis)
    .default("1")
    .default_in(&[(ATTENUATION, Some("0.05")), (TRACING, None)])
    .otherwise("tau / 4 for smooth cells, tau / 16 for flat ones"),
    setting(
        SECTION,
        "cells",
        CELLS,
        TRACING.and(GIVEN).and(ATTENUATION),
        "What lies between the heights of the grid",
    )
    .default("auto")
    .default_in(&[(ATTENUATION, Some("flat"))]),
    setting(
        SECTION,
        "border",
        DRAWN_BORDER,
        ATTENUATION,
        "What lies beyond the border",
    )
    .default("periodic"),
    setting(
        SECTION,
        "insist",
        Kind::Switch,
        RANDOM.and(ATTENUATION),
        "Draw surfaces even if the grid cannot resolve or hold them",
    )
    .default("false")
    .excludes(&["measured.*"]),
];
