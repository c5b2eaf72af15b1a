//! `[converge]`: methods and their effort.

use super::choices::{ACCELERATOR, BRANCHINGS, ESTIMATOR, SAMPLING, SIDE};
use super::commands::CONVERGE;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, basic, setting, table};

const LIST: Arity = Arity::ListIn(CONVERGE);

pub(super) const SETTINGS: &[Setting] = &table(
    "converge",
    CONVERGE,
    [
        basic("estimators", ESTIMATOR)
            .help("Estimators")
            .value_name("NAMES")
            .arity(LIST)
            .default("plain,controlled"),
        basic("samplings", SAMPLING)
            .help("How rays are distributed")
            .value_name("NAMES")
            .arity(LIST)
            .default("random,stratified,quasi-random"),
        setting("branchings", BRANCHINGS)
            .help("Branches that paths follow")
            .value_name("NAMES")
            .arity(LIST)
            .default("split"),
        setting("peer_rate", Kind::Number)
            .help("Rays per second of a peer, to be compared with")
            .range(Range::Above(0.0))
            .otherwise("no peer"),
        setting("accelerators", ACCELERATOR)
            .help("How hits are found")
            .value_name("NAMES")
            .arity(LIST)
            .default("auto"),
        setting("spacings", Kind::Length)
            .help("Distances between samples, over the same extent")
            .range(Range::Above(0.0))
            .arity(LIST)
            .otherwise("that of the surface"),
        basic("rays", Kind::Count)
            .help("Rays per surface: one for all, or as many values as surfaces")
            .arity(LIST)
            .default("16384"),
        basic("surfaces", Kind::Count)
            .help("Surfaces per run: one for all, or as many values as rays")
            .arity(LIST)
            .default("4,16,64"),
        basic("repeats", Kind::Count)
            .help("Runs per method and effort")
            .default("8"),
        basic("reference_rays", Kind::Count)
            .help("Rays per surface of the reference")
            .default("65536"),
        basic("reference_surfaces", Kind::Count)
            .help("Surfaces of the reference")
            .range(Range::AtLeast(2.0))
            .default("512"),
        setting("reference_spacing", Kind::Length)
            .help("Distance between samples of the reference")
            .range(Range::Above(0.0))
            .otherwise("the finest of spacings"),
        basic("seed", Kind::Seed)
            .help("Seed from which the seeds of all runs derive")
            .default("1"),
        setting("bins", Kind::Grid)
            .help("Bins of a hemisphere")
            .value_name("THETAxPHI")
            .default("18x36"),
        setting("side", SIDE)
            .help("Side whose bins enter the errors")
            .default("both"),
        setting("errors", Kind::Number)
            .help("Relative errors for which run times are reported")
            .range(Range::Above(0.0))
            .arity(LIST)
            .default("1e-2,1e-3,1e-4"),
    ],
);
