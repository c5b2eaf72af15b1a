//! `[converge]`: methods and their effort.

use super::CONVERGE;
use super::choices::{ACCELERATOR, BRANCHINGS, ESTIMATOR, SAMPLING, SIDE};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, setting};

const SECTION: &str = "converge";
const LIST: Arity = Arity::ListIn(CONVERGE);

pub(super) const SETTINGS: &[Setting] = &[
    setting(SECTION, "estimators", ESTIMATOR, CONVERGE, "Estimators")
        .value_name("NAMES")
        .arity(LIST)
        .default("plain,controlled"),
    setting(
        SECTION,
        "samplings",
        SAMPLING,
        CONVERGE,
        "How rays are distributed",
    )
    .value_name("NAMES")
    .arity(LIST)
    .default("random,stratified,quasi-random"),
    setting(
        SECTION,
        "branchings",
        BRANCHINGS,
        CONVERGE,
        "Branches that paths follow",
    )
    .value_name("NAMES")
    .arity(LIST)
    .default("split"),
    setting(
        SECTION,
        "peer_rate",
        Kind::Number,
        CONVERGE,
        "Rays per second of a peer, to be compared with",
    )
    .range(Range::Above(0.0))
    .otherwise("no peer"),
    setting(
        SECTION,
        "accelerators",
        ACCELERATOR,
        CONVERGE,
        "How hits are found",
    )
    .value_name("NAMES")
    .arity(LIST)
    .default("auto"),
    setting(
        SECTION,
        "spacings",
        Kind::Length,
        CONVERGE,
        "Distances between samples, over the same extent",
    )
    .range(Range::Above(0.0))
    .arity(LIST)
    .otherwise("that of the surface"),
    setting(
        SECTION,
        "rays",
        Kind::Count,
        CONVERGE,
        "Rays per surface: one for all, or as many values as surfaces",
    )
    .arity(LIST)
    .default("16384"),
    setting(
        SECTION,
        "surfaces",
        Kind::Count,
        CONVERGE,
        "Surfaces per run: one for all, or as many values as rays",
    )
    .arity(LIST)
    .default("4,16,64"),
    setting(
        SECTION,
        "repeats",
        Kind::Count,
        CONVERGE,
        "Runs per method and effort",
    )
    .default("8"),
    setting(
        SECTION,
        "reference_rays",
        Kind::Count,
        CONVERGE,
        "Rays per surface of the reference",
    )
    .default("65536"),
    setting(
        SECTION,
        "reference_surfaces",
        Kind::Count,
        CONVERGE,
        "Surfaces of the reference",
    )
    .range(Range::AtLeast(2.0))
    .default("512"),
    setting(
        SECTION,
        "reference_spacing",
        Kind::Length,
        CONVERGE,
        "Distance between samples of the reference",
    )
    .range(Range::Above(0.0))
    .otherwise("the finest of spacings"),
    setting(
        SECTION,
        "seed",
        Kind::Seed,
        CONVERGE,
        "Seed from which the seeds of all runs derive",
    )
    .default("1"),
    setting(
        SECTION,
        "bins",
        Kind::Grid,
        CONVERGE,
        "Bins of a hemisphere",
    )
    .value_name("THETAxPHI")
    .default("18x36"),
    setting(
        SECTION,
        "side",
        SIDE,
        CONVERGE,
        "Side whose bins enter the errors",
    )
    .default("both"),
    setting(
        SECTION,
        "errors",
        Kind::Number,
        CONVERGE,
        "Relative errors for which run times are reported",
    )
    .range(Range::Above(0.0))
    .arity(LIST)
    .default("1e-2,1e-3,1e-4"),
];
