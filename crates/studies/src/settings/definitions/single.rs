//! Settings of single commands: the height map of `generate`, erosion by `inspect`, the mesh of `mesh`, and `model`.

use super::{DEGREES, GENERATE, INSPECT, MESH, MODEL};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Flag, Setting, flags, setting};

pub(super) const GENERATE_SETTINGS: &[Setting] = &flags(
    "generate",
    GENERATE,
    [setting(
        "realisation",
        Kind::Seed,
        "Number of the surface among those of the seed",
    )
    .basic(Commands::ALL)
    .value_name("NUMBER")
    .default("0")],
);

pub(super) const EROSION: &[Setting] = &flags(
    "erosion",
    INSPECT,
    [
        setting(
            "repose",
            Kind::Number,
            "Let material slip down slopes steeper than this angle",
        )
        .basic(Commands::ALL)
        .unit(DEGREES)
        .range(Range::FromBelow(0.0, 90.0))
        .otherwise("not done"),
        setting("slip_steps", Kind::Count, "Steps of slipping")
            .range(Range::FromTo(1.0, 100_000.0))
            .default("1000"),
        setting(
            "etch",
            Kind::Length,
            "Etch isotropically to this depth, after slipping",
        )
        .basic(Commands::ALL)
        .range(Range::Above(0.0))
        .otherwise("not done"),
    ],
);

pub(super) const MESH_SETTINGS: &[Setting] = &flags(
    "mesh",
    MESH,
    [
        setting(
            "subdivide",
            Kind::Count,
            "Parts of a smooth cell along each axis, two triangles each",
        )
        .basic(Commands::ALL)
        .default("4"),
        setting(
            "deviation",
            Kind::Length,
            "Largest vertical distance from the surface; sets subdivide",
        )
        .basic(Commands::ALL)
        .range(Range::Above(0.0))
        .otherwise("not used"),
    ],
);

pub(super) const MODEL_SETTINGS: &[Setting] = &flags(
    "model",
    MODEL,
    [
        setting("name", Kind::Model, "Model")
            .basic(Commands::ALL)
            .flag(Flag::None),
        setting(
            "list",
            Kind::Switch,
            "List the models and where each is meant to hold",
        )
        .basic(Commands::ALL),
        setting(
            "step",
            Kind::Number,
            "Distance between directions, for a model with a density",
        )
        .basic(Commands::ALL)
        .unit(DEGREES)
        .range(Range::AboveTo(0.0, 45.0))
        .otherwise("1"),
        setting(
            "sphere",
            Kind::Switch,
            "The whole sphere, not only the plane of incidence",
        )
        .basic(Commands::ALL),
    ],
);
