//! `[converge]`: methods and their effort.

use super::CONVERGE;
use super::choices::{ACCELERATOR, BRANCHINGS, ESTIMATOR, SAMPLING, SIDE};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, setting, table};

const LIST: Arity = Arity::ListIn(CONVERGE);

pub(super) const SETTINGS: &[Setting] = &table(
    "converge",
    CONVERGE,
    [
        setting("estimators", ESTIMATOR, "Estimators")
            .basic(Commands::ALL)
            .value_name("NAMES")
            .arity(LIST)
            .default("plain,controlled"),
        setting("samplings", SAMPLING, "How rays are distributed")
            .basic(Commands::ALL)
            .value_name("NAMES")
            .arity(LIST)
            .default("random,stratified,quasi-random"),
        setting("branchings", BRANCHINGS, "Branches that paths follow")
            .value_name("NAMES")
            .arity(LIST)
            .default("split"),
        setting(
            "peer_rate",
            Kind::Number,
            "Rays per second of a peer, to be compared with",
        )
        .range(Range::Above(0.0))
        .otherwise("no peer"),
        setting("accelerators", ACCELERATOR, "How hits are found")
            .value_name("NAMES")
            .arity(LIST)
            .default("auto"),
        setting(
            "spacings",
            Kind::Length,
            "Distances between samples, over the same extent",
        )
        .range(Range::Above(0.0))
        .arity(LIST)
        .otherwise("that of the surface"),
        setting(
            "rays",
            Kind::Count,
            "Rays per surface: one for all, or as many values as surfaces",
        )
        .basic(Commands::ALL)
        .arity(LIST)
        .default("16384"),
        setting(
            "surfaces",
            Kind::Count,
            "Surfaces per run: one for all, or as many values as rays",
        )
        .basic(Commands::ALL)
        .arity(LIST)
        .default("4,16,64"),
        setting("repeats", Kind::Count, "Runs per method and effort")
            .basic(Commands::ALL)
            .default("8"),
        setting(
            "reference_rays",
            Kind::Count,
            "Rays per surface of the reference",
        )
        .basic(Commands::ALL)
        .default("65536"),
        setting(
            "reference_surfaces",
            Kind::Count,
            "Surfaces of the reference",
        )
        .basic(Commands::ALL)
        .range(Range::AtLeast(2.0))
        .default("512"),
        setting(
            "reference_spacing",
            Kind::Length,
            "Distance between samples of the reference",
        )
        .range(Range::Above(0.0))
        .otherwise("the finest of spacings"),
        setting(
            "seed",
            Kind::Seed,
            "Seed from which the seeds of all runs derive",
        )
        .basic(Commands::ALL)
        .default("1"),
        setting("bins", Kind::Grid, "Bins of a hemisphere")
            .value_name("THETAxPHI")
            .default("18x36"),
        setting("side", SIDE, "Side whose bins enter the errors").default("both"),
        setting(
            "errors",
            Kind::Number,
            "Relative errors for which run times are reported",
        )
        .range(Range::Above(0.0))
        .arity(LIST)
        .default("1e-2,1e-3,1e-4"),
    ],
);
