//! `[surface]`: structures.

use super::choices::{ARRANGEMENT, STRUCTURE};
use super::{RANDOM, SWEEPS};
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, setting};

const SECTION: &str = "surface";

/// A setting of a structure.
const fn of_structure(key: &'static str, kind: Kind, help: &'static str) -> Setting {
    setting(SECTION, key, kind, RANDOM, help).excludes(&["measured.*"])
}

pub(super) const STRUCTURE_KIND: Setting = of_structure(
    "structure",
    STRUCTURE,
    "Structure; sigma and tau are then those of roughness on top",
)
.otherwise("none: Gaussian surfaces")
.excludes(&["surface.smoothness", "measured.*"]);

pub(super) const DEPTH: Setting = of_structure(
    "depth",
    Kind::Length,
    "Mean depth of features; height of caps and pyramids",
)
.range(Range::Above(0.0))
.arity(Arity::ListIn(SWEEPS))
.otherwise("width / 4; of pyramids width / sqrt 2: facets at 54.74 degrees");

pub(super) const WIDTH: Setting = of_structure(
    "width",
    Kind::Length,
    "Mean width of features; the period of grooves",
)
.range(Range::Above(0.0))
.otherwise("16");

pub(super) const SCRATCH_LENGTH: Setting =
    of_structure("scratch_length", Kind::Length, "Mean length of scratches")
        .range(Range::Above(0.0))
        .otherwise("20 widths");

pub(super) const DENSITY: Setting = of_structure(
    "density",
    Kind::Number,
    "Area of features over that of the tile, overlaps counted twice",
)
.range(Range::AboveTo(0.0, 20.0))
.otherwise(
    "pits and caps at random 0.5, separate 0.3, on a lattice 0.9069 (touching); scratches 0.5; cracks 0.3; \
     pyramids on a lattice 1 (touching), at random 5",
);

pub(super) const EDGE_RADIUS: Setting = of_structure(
    "edge_radius",
    Kind::Length,
    "Radius of curvature of edges; not of pyramids and sine grooves",
)
.range(Range::AtLeast(0.0))
.otherwise("0");

pub(super) const RANDOMNESS: Setting = of_structure(
    "randomness",
    Kind::Number,
    "Half the range of sizes over their mean; cracks have none",
)
.range(Range::FromBelow(0.0, 1.0))
.otherwise("0");

pub(super) const PLACES: Setting = of_structure(
    "arrangement",
    ARRANGEMENT,
    "Where pits, caps and pyramids lie",
)
.otherwise("random; caps and inverted pyramids on a lattice");

pub(super) const SPREAD: Setting = of_structure(
    "spread",
    Kind::Number,
    "Standard deviation of the directions of scratches",
)
.unit(super::DEGREES)
.range(Range::FromTo(0.0, 180.0))
.otherwise("5");
