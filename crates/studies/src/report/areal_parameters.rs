//! Areal parameters of ISO 25178 as text.

use asperity_simulate::short;
use asperity_surface::{Iso25178, LengthUnit};

use super::roughness::{Parameter, number, parameter_table};

/// Functional, hybrid and spatial parameters with their meaning; lengths are in `unit`.
pub(crate) fn areal_table(parameters: &Iso25178, unit: LengthUnit) -> String {
    let (f, s) = (&parameters.functional, &parameters.spatial);
    let unit = unit.suffix();
    let length = |value| format!("{}{unit}", short(value));
    let lag = |value: Option<f64>| value.map_or("-".to_owned(), length);
    let percent = |value| format!("{} %", short(value));
    let row = Parameter::new;
    let angle = s.std.map(|angle| format!("{} deg", short(angle)));
    let rows = [
        row(
            "Sdr",
            percent(parameters.sdr),
            "area added to the mean plane",
        ),
        row("Sk", length(f.sk), "core height"),
        row("Spk", length(f.spk), "reduced peak height"),
        row("Svk", length(f.svk), "reduced valley depth"),
        row("Smr1", percent(f.smr1), "material ratio above the core"),
        row("Smr2", percent(f.smr2), "material ratio down to its end"),
        row("Vmp", length(f.vmp), "peak material volume per area"),
        row("Vmc", length(f.vmc), "core material volume per area"),
        row("Vvc", length(f.vvc), "core void volume per area"),
        row("Vvv", length(f.vvv), "valley void volume per area"),
        row("Sal", lag(s.sal), "shortest decay of correlation to 0.2"),
        row("Str", number(s.str), "Sal over the longest such decay"),
        row(
            "Std",
            angle.unwrap_or("-".to_owned()),
            "azimuth across the grooves, from +x",
        ),
    ];
    parameter_table().folded_text(rows)
}
