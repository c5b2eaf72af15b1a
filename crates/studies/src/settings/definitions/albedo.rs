//! `[albedo]`: the axes of tables of directional albedos, and the surfaces.

use super::choices::ALBEDO_SLOPES;
use super::commands::ALBEDO;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Setting, basic, setting, table};

const LIST: Arity = Arity::ListIn(ALBEDO);

pub(super) const SETTINGS: &[Setting] = &table(
    "albedo",
    ALBEDO,
    [
        basic("alpha", Kind::Number)
            .help("Roughness; of Gaussian slopes sqrt 2 times their rms per axis")
            .range(Range::FromTo(1e-3, 10.0))
            .arity(LIST)
            .default("0.125:1:0.125"),
        basic("slopes", ALBEDO_SLOPES)
            .help("Distribution of slopes")
            .default("gaussian"),
        basic("cosines", Kind::Count)
            .help("Number of cosines of incidence: centres of equal intervals")
            .range(Range::FromTo(1.0, 1024.0))
            .otherwise("16"),
        basic("cos", Kind::Number)
            .help("Cosines of incidence, in place of their number")
            .range(Range::AboveTo(0.0, 1.0))
            .arity(LIST)
            .otherwise("centres of equal intervals"),
        setting("samples", Kind::Number)
            .help("Samples of surfaces per correlation length")
            .range(Range::FromTo(2.5, 64.0))
            .default("4"),
    ],
);
