//! The triangle mesh that `mesh` writes.

use super::MESH;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Setting, setting};

const SECTION: &str = "mesh";

pub(super) const SETTINGS: &[Setting] = &[
    setting(
        SECTION,
        "subdivide",
        Kind::Count,
        MESH,
        "Parts of a smooth cell along each axis, two triangles each",
    )
    .default("4")
    .default_yields()
    .excludes(&["mesh.deviation"])
    .flag_only(),
    setting(
        SECTION,
        "deviation",
        Kind::Length,
        MESH,
        "Largest vertical distance from the surface; sets subdivide",
    )
    .range(Range::Above(0.0))
    .otherwise("not used")
    .excludes(&["mesh.subdivide"])
    .flag_only(),
];
