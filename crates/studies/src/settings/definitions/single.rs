//! Settings of single commands: the height map of `generate`, the mesh of `mesh`, `model`, `materials`, `export` and `report`.

use super::choices::{EXPORT_FORMAT, EXPORTED_SIDE, MESH_FORMAT, SURFACE_FORMAT};
use super::commands::{DEGREES, EXPORT, GENERATE, MATERIALS, MERGE, MESH, MODEL, REPORT};
use super::light::WAVELENGTH;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, basic, flags, setting};

pub(super) const GENERATE_SETTINGS: &[Setting] = &flags(
    "generate",
    GENERATE,
    [
        basic("realisation", Kind::Seed)
            .help("Number of the surface, or of the first, among those of the seed")
            .value_name("NUMBER")
            .default("0"),
        basic("format", SURFACE_FORMAT)
            .help("Format of several surfaces in a folder")
            .default("exr"),
    ],
);

pub(super) const MESH_SETTINGS: &[Setting] = &flags(
    "mesh",
    MESH,
    [
        basic("subdivide", Kind::Count)
            .help("Parts of a smooth cell along each axis, two triangles each")
            .default("4"),
        basic("deviation", Kind::Length)
            .help("Largest vertical distance from the surface; sets subdivide")
            .range(Range::Above(0.0))
            .otherwise("not used"),
        basic("format", MESH_FORMAT)
            .help("Format of several meshes in a folder")
            .default("ply"),
    ],
);

pub(super) const MODEL_SETTINGS: &[Setting] = &flags(
    "model",
    MODEL,
    [
        basic("name", Kind::Model).help("Model").flag(Flag::None),
        basic("list", Kind::Switch).help("List the models and where each is meant to hold"),
        basic("step", Kind::Number)
            .help("Distance between directions, for a model with a density")
            .unit(DEGREES)
            .range(Range::AboveTo(0.0, 45.0))
            .otherwise("1"),
        basic("sphere", Kind::Switch).help("The whole sphere, not only the plane of incidence"),
        setting("attenuation_of", Kind::Path)
            .help("attenuation.csv with counted shadowing and masking")
            .value_name("FILE")
            .otherwise("that of the model"),
    ],
);

pub(super) const MATERIALS_SETTINGS: &[Setting] = &flags(
    "materials",
    MATERIALS,
    [
        basic("name", Kind::Material)
            .help("Material whose optical constants are shown")
            .flag(Flag::None)
            .otherwise("all are listed"),
        WAVELENGTH
            .help("Wavelengths at which n and k are shown, and written by -o")
            .basic(MATERIALS)
            .arity(Arity::ListIn(MATERIALS))
            .otherwise("visible ones; all points of the data with -o"),
    ],
);

pub(super) const EXPORT_SETTINGS: &[Setting] = &flags(
    "export",
    EXPORT,
    [
        basic("results", Kind::Path)
            .help("Results that are exported")
            .value_name("DIR")
            .flag(Flag::None),
        basic("format", EXPORT_FORMAT)
            .help("Format of the file")
            .required(EXPORT),
        setting("side", EXPORTED_SIDE)
            .help("The side whose light a file of one side holds")
            .otherwise("reflected, where it is recorded"),
    ],
);

pub(super) const REPORT_SETTINGS: &[Setting] = &flags(
    "report",
    REPORT,
    [basic("folders", Kind::Path)
        .help("Result folders that the page shows")
        .value_name("DIR")
        .arity(Arity::Repeated)
        .flag(Flag::None)],
);

pub(super) const MERGE_SETTINGS: &[Setting] = &flags(
    "merge",
    MERGE,
    [
        basic("folders", Kind::Path)
            .help("Result folders of the shards")
            .value_name("DIR")
            .arity(Arity::Repeated)
            .flag(Flag::None),
        basic("partial", Kind::Switch).help("Merge although shards are missing or not finished"),
    ],
);
