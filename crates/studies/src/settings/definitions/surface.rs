//! `[surface]`: random surfaces, and the cells of any.

use super::choices::{
    ARRANGEMENT, CELLS, DRAWN_BORDER, DRAWN_UNIT, HEIGHTS, PSD, SLOPES, STRUCTURE,
};
use super::commands::{
    ATTENUATION, DEGREES, GENERATE, GIVEN, HEIGHT_MAPS, MODEL, RANDOM, SWEEPS, TRACING,
};
use super::erosion::{ETCH, REPOSE, SLIP_STEPS};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, basic, setting, table};

pub(super) const SETTINGS: &[Setting] = &table(
    "surface",
    RANDOM,
    [
        basic("tau", Kind::Length)
            .help("1/e correlation length")
            .commands(RANDOM.and(ATTENUATION))
            .range(Range::Above(0.0))
            .default("16")
            .default_in(&[(ATTENUATION, Some("0.5"))]),
        setting("tau_y", Kind::Length)
            .help("1/e correlation length along the second principal axis")
            .basic(GENERATE)
            .range(Range::Above(0.0))
            .otherwise("tau"),
        basic("smoothness", Kind::Number)
            .help("Smoothness s = tau / sigma, along the first principal axis")
            .commands(RANDOM.and(MODEL))
            .range(Range::FromTo(1e-6, 1e6))
            .arity(Arity::ListIn(SWEEPS.and(MODEL)))
            .default("3")
            .default_in(&[(MODEL, None)])
            .otherwise("none; models of rough surfaces need it"),
        setting("smoothness_y", Kind::Number)
            .help("Smoothness tau_y / sigma along the second principal axis")
            .basic(MODEL)
            .commands(MODEL)
            .range(Range::FromTo(1e-6, 1e6))
            .otherwise("smoothness"),
        basic("slopes_of", Kind::Path)
            .help("Height map, or table x,y,density in .csv, with the slopes")
            .commands(MODEL)
            .value_name("FILE")
            .otherwise("Gaussian slopes of the smoothness"),
        basic("sigma", Kind::Length)
            .help("Root mean square height, in place of smoothness")
            .range(Range::Above(0.0))
            .arity(Arity::ListIn(SWEEPS)),
        basic("sigma", Kind::Length)
            .help("Root mean square height")
            .commands(ATTENUATION)
            .range(Range::Above(0.0))
            .arity(Arity::ListIn(ATTENUATION))
            .default("0.5"),
        basic("structure", STRUCTURE)
            .help("Structure; sigma and tau are then those of roughness on top")
            .otherwise("none: Gaussian surfaces"),
        setting("depth", Kind::Length)
            .help("Mean depth of features; height of caps and pyramids")
            .basic(GENERATE)
            .range(Range::Above(0.0))
            .arity(Arity::ListIn(SWEEPS))
            .otherwise("width / 4; of pyramids width / sqrt 2: facets at 54.74 degrees"),
        setting("width", Kind::Length)
            .help("Mean width of features; the period of grooves")
            .basic(GENERATE)
            .range(Range::Above(0.0))
            .otherwise("16"),
        setting("scratch_length", Kind::Length)
            .help("Mean length of scratches")
            .range(Range::Above(0.0))
            .otherwise("20 widths"),
        setting("density", Kind::Number)
            .help("Area of features over that of the tile, overlaps counted twice")
            .range(Range::AboveTo(0.0, 20.0))
            .otherwise(
                "pits and caps at random 0.5, separate 0.3, on a lattice 0.9069 (touching); \
 scratches 0.5; cracks 0.3; pyramids on a lattice 1 (touching), at random 5",
            ),
        setting("edge_radius", Kind::Length)
            .help("Radius of curvature of edges; not of pyramids and sine grooves")
            .range(Range::AtLeast(0.0))
            .otherwise("0"),
        setting("randomness", Kind::Number)
            .help("Half the range of sizes over their mean; cracks have none")
            .range(Range::FromBelow(0.0, 1.0))
            .otherwise("0"),
        setting("arrangement", ARRANGEMENT)
            .help("Where pits, caps and pyramids lie")
            .otherwise("random; caps and inverted pyramids on a lattice"),
        setting("spread", Kind::Number)
            .help("Standard deviation of the directions of scratches")
            .unit(DEGREES)
            .range(Range::FromTo(0.0, 180.0))
            .otherwise("5"),
        setting("azimuth", Kind::Number)
            .help("Angle from +x to the first principal axis, grooves, scratches")
            .unit(DEGREES)
            .default("0"),
        basic("azimuth", Kind::Number)
            .help("Angle from +x to the first principal axis of the slopes")
            .commands(MODEL)
            .unit(DEGREES),
        REPOSE,
        SLIP_STEPS,
        ETCH,
        basic("unit", DRAWN_UNIT)
            .help("Unit of lengths")
            .commands(RANDOM.and(ATTENUATION))
            .otherwise("that of the first length with a unit, else 1"),
        basic("size", Kind::Count)
            .help("Samples along x and y")
            .arity(Arity::PerAxis)
            .default("512")
            .default_in(&[(GENERATE, Some("1024")), (TRACING, None)])
            .otherwise("a tile of 32 correlation lengths, of 16 widths or more of structures"),
        basic("size", Kind::Count)
            .help("Samples along x and y, in place of length")
            .commands(ATTENUATION)
            .arity(Arity::PerAxis)
            .otherwise("length over spacing"),
        basic("length", Kind::Length)
            .help("Side of the tile, in place of size; a multiple of the spacing")
            .commands(ATTENUATION)
            .range(Range::Above(0.0))
            .arity(Arity::PerAxis)
            .default("12.8"),
        basic("spacing", Kind::Length)
            .help("Distance between samples")
            .commands(RANDOM.and(ATTENUATION))
            .range(Range::Above(0.0))
            .arity(Arity::PerAxis)
            .default("1")
            .default_in(&[(ATTENUATION, Some("0.05")), (TRACING, None)])
            .otherwise(
                "tau / 4 for smooth cells, tau / 16 for flat ones, finer for short waves; \
 of structures width / 16, of scratches and cracks / 8",
            ),
        setting("cells", CELLS)
            .help("What lies between the heights of the grid")
            .basic(HEIGHT_MAPS)
            .commands(TRACING.and(GIVEN).and(ATTENUATION))
            .default("auto")
            .default_in(&[(ATTENUATION, Some("flat"))]),
        basic("border", DRAWN_BORDER)
            .help("What lies beyond the border")
            .commands(ATTENUATION)
            .default("periodic"),
        setting("insist", Kind::Switch)
            .help("Draw surfaces even if the grid cannot resolve or hold them")
            .basic(GENERATE)
            .commands(RANDOM.and(ATTENUATION)),
        setting("psd", PSD)
            .help("Power spectral density: a name, FILE.csv, or like:FILE")
            .basic(GENERATE)
            .value_name("NAME|FILE")
            .otherwise("gaussian"),
        setting("nu", Kind::Number)
            .help("Parameter of the Matern family: 0.5 is exponential")
            .range(Range::AboveTo(0.0, 100.0))
            .otherwise("none; --psd matern needs it"),
        setting("hurst", Kind::Number)
            .help("Hurst exponent of a power law")
            .range(Range::AboveTo(0.0, 1.0))
            .otherwise("none; --psd power-law needs it"),
        setting("roll_off", Kind::Length)
            .help("Wavelength beyond which a power law is level")
            .range(Range::Above(0.0))
            .otherwise("none; --psd power-law needs it"),
        setting("cut_off", Kind::Length)
            .help("Wavelength of the shortest waves of a spectrum")
            .range(Range::Above(0.0))
            .otherwise("none; required, except for matern with nu above 1"),
        setting("second_sigma", Kind::Length)
            .help("Root mean square height of a second scale, Gaussian")
            .range(Range::Above(0.0))
            .otherwise("no second scale"),
        setting("second_tau", Kind::Length)
            .help("1/e correlation length of the second scale")
            .range(Range::Above(0.0))
            .otherwise("no second scale"),
        setting("heights", HEIGHTS)
            .help("Distribution of heights: FILE.csv, or like:FILE")
            .value_name("NAME|FILE")
            .otherwise("gaussian, or by skewness and kurtosis"),
        setting("skewness", Kind::Number)
            .help("Skewness of the heights")
            .otherwise("0"),
        setting("kurtosis", Kind::Number)
            .help("Kurtosis of the heights, 3 if Gaussian; above skewness^2 + 1")
            .range(Range::Above(1.0))
            .otherwise("that of a lognormal distribution of the skewness"),
        setting("slopes", SLOPES)
            .help("Distribution of slopes")
            .basic(MODEL)
            .commands(RANDOM.and(MODEL))
            .otherwise("gaussian"),
        setting("ggx_alpha", Kind::Number)
            .help("Roughness of GGX slopes, in place of smoothness")
            .basic(MODEL)
            .commands(RANDOM.and(MODEL))
            .range(Range::FromTo(1e-6, 10.0))
            .arity(Arity::ListIn(SWEEPS))
            .otherwise("none; --slopes ggx needs it"),
        setting("amplitude_ratio", Kind::Number)
            .help("Correlation length of the amplitude of GGX slopes, over tau")
            .range(Range::FromTo(2.0, 100.0))
            .otherwise("8"),
    ],
);
