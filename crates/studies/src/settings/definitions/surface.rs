//! `[surface]`: random surfaces, and the cells of any.

use super::choices::{CELLS, DRAWN_BORDER, DRAWN_UNIT, HEIGHTS, PSD, SLOPES};
use super::structure::{
    DENSITY, DEPTH, EDGE_RADIUS, PLACES, RANDOMNESS, SCRATCH_LENGTH, SPREAD, STRUCTURE_KIND, WIDTH,
};
use super::{ATTENUATION, DEGREES, GENERATE, GIVEN, MODEL, RANDOM, SWEEPS, TRACING};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, Unless, setting};

const SECTION: &str = "surface";

/// Spectra whose correlation length follows from other lengths, or is that of a file.
const OWN_TAU: Unless = Unless {
    setting: (SECTION, "psd"),
    is: |psd| !["gaussian", "exponential", "matern"].contains(&psd),
    but_with: None,
};

/// Structures without roughness on top, which has a correlation length.
const NO_ROUGHNESS: Unless = Unless {
    setting: (SECTION, "structure"),
    is: |_| true,
    but_with: Some((SECTION, "sigma")),
};

/// Spectra of height maps, whose spacing is that of the map.
const OWN_SPACING: Unless = Unless {
    setting: (SECTION, "psd"),
    is: |psd| psd.starts_with("like:"),
    but_with: None,
};

/// Spectra whose root mean square height is that of a file.
const OWN_SIGMA: Unless = Unless {
    setting: (SECTION, "psd"),
    is: |psd| !PSD.choices().iter().any(|choice| choice.name == psd),
    but_with: None,
};

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
    .default_unless(&[OWN_TAU, NO_ROUGHNESS])
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
    .default_unless(&[OWN_SIGMA])
    .excludes(&[
        "surface.sigma",
        "surface.ggx_alpha",
        "surface.structure",
        "measured.*",
    ]),
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
        "slopes_of",
        Kind::Path,
        MODEL,
        "Height map, or table x,y,density in .csv, with the slopes",
    )
    .value_name("FILE")
    .otherwise("Gaussian slopes of the smoothness")
    .excludes(&[
        "surface.smoothness",
        "surface.smoothness_y",
        "surface.azimuth",
    ]),
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
    .excludes(&["surface.smoothness", "surface.ggx_alpha", "measured.*"])
    .clears(&["output.models_at_sigma"]),
    STRUCTURE_KIND,
    DEPTH,
    WIDTH,
    SCRATCH_LENGTH,
    DENSITY,
    EDGE_RADIUS,
    RANDOMNESS,
    PLACES,
    SPREAD,
    setting(
        SECTION,
        "azimuth",
        Kind::Number,
        RANDOM.and(MODEL),
        "Angle from +x to the first principal axis, grooves, scratches",
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
    .otherwise("a tile of 32 correlation lengths, of length, or of 16 widths or more")
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
    .default_unless(&[OWN_SPACING])
    .otherwise(
        "tau / 4 for smooth cells, tau / 16 for flat ones, finer for short waves; of structures width / 16, of scratches and cracks / 8",
    ),
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
    setting(
        SECTION,
        "psd",
        PSD,
        RANDOM,
        "Power spectral density: a name, FILE.csv, or like:FILE",
    )
        .value_name("NAME|FILE")
        .otherwise("gaussian")
        .excludes(&["measured.*"]),
    setting(
        SECTION,
        "nu",
        Kind::Number,
        RANDOM,
        "Parameter of the Matern family: 0.5 is exponential",
    )
    .range(Range::AboveTo(0.0, 100.0))
    .otherwise("none; --psd matern needs it")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "hurst",
        Kind::Number,
        RANDOM,
        "Hurst exponent of a power law",
    )
    .range(Range::AboveTo(0.0, 1.0))
    .otherwise("none; --psd power-law needs it")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "roll_off",
        Kind::Length,
        RANDOM,
        "Wavelength beyond which a power law is level",
    )
    .range(Range::Above(0.0))
    .otherwise("none; --psd power-law needs it")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "cut_off",
        Kind::Length,
        RANDOM,
        "Wavelength of the shortest waves of a spectrum",
    )
    .range(Range::Above(0.0))
    .otherwise("none; required, except for matern with nu above 1")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "second_sigma",
        Kind::Length,
        RANDOM,
        "Root mean square height of a second scale, Gaussian",
    )
    .range(Range::Above(0.0))
    .otherwise("no second scale")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "second_tau",
        Kind::Length,
        RANDOM,
        "1/e correlation length of the second scale",
    )
    .range(Range::Above(0.0))
    .otherwise("no second scale")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "heights",
        HEIGHTS,
        RANDOM,
        "Distribution of heights: FILE.csv, or like:FILE",
    )
    .value_name("NAME|FILE")
    .otherwise("gaussian, or by skewness and kurtosis")
    .excludes(&["surface.skewness", "surface.kurtosis", "measured.*"]),
    setting(
        SECTION,
        "skewness",
        Kind::Number,
        RANDOM,
        "Skewness of the heights",
    )
    .otherwise("0")
    .excludes(&["measured.*"]),
    setting(
        SECTION,
        "kurtosis",
        Kind::Number,
        RANDOM,
        "Kurtosis of the heights, 3 if Gaussian; above skewness^2 + 1",
    )
    .range(Range::Above(1.0))
    .otherwise("that of a lognormal distribution of the skewness")
    .excludes(&["measured.*"]),
    setting(SECTION, "slopes", SLOPES, RANDOM, "Distribution of slopes")
        .otherwise("gaussian")
        .excludes(&["measured.*"]),
    setting(
        SECTION,
        "ggx_alpha",
        Kind::Number,
        RANDOM,
        "Roughness of GGX slopes, in place of smoothness",
    )
    .range(Range::AboveTo(0.0, 10.0))
    .arity(Arity::ListIn(SWEEPS))
    .otherwise("none; --slopes ggx needs it")
    .excludes(&["surface.smoothness", "surface.sigma", "measured.*"]),
    setting(
        SECTION,
        "amplitude_ratio",
        Kind::Number,
        RANDOM,
        "Correlation length of the amplitude of GGX slopes, over tau",
    )
    .range(Range::FromTo(2.0, 100.0))
    .otherwise("8")
    .excludes(&["measured.*"]),
];
