//! Units of length by the names that GDAL, ImageJ and OME write.

use crate::height_maps::unit::PowerOfMetre;

/// A unit of length: a number of powers of ten of the metre.
#[derive(Clone, Copy)]
pub(super) struct NamedUnit {
    factor: f64,
    pub(super) power: PowerOfMetre,
}

/// Names of SI prefixes and their powers of ten.
const PREFIXES: [(&str, i32); 8] = [
    ("", 0),
    ("kilo", 3),
    ("deci", -1),
    ("centi", -2),
    ("milli", -3),
    ("micro", -6),
    ("nano", -9),
    ("pico", -12),
];

impl NamedUnit {
    /// Parses a name, in small or capital letters, or a symbol, with or without an SI prefix.
    pub(super) fn parse(name: &str) -> Option<Self> {
        let unit = |factor, power| {
            let power = PowerOfMetre(power);
            Some(Self { factor, power })
        };
        let word = name.trim().to_lowercase();
        let singular = word.strip_suffix('s').unwrap_or(&word);
        if let Some(prefix) = ["metre", "meter"]
            .iter()
            .find_map(|metre| singular.strip_suffix(metre))
        {
            let prefixes = PREFIXES.iter();
            let found = prefixes.copied().find(|(name, _)| *name == prefix);
            return unit(1.0, found?.1);
        }
        match word.as_str() {
            "micron" | "microns" => unit(1.0, -6),
            "\u{e5}" | "angstrom" | "angstroms" | "\u{e5}ngstr\u{f6}m" => unit(1.0, -10),
            "inch" | "inches" | "in" => unit(2.54, -2),
            "foot" | "feet" | "ft" | "international foot" => unit(0.3048, 0),
            "us survey foot" | "us-ft" | "ftus" | "foot_us" => unit(1200.0 / 3937.0, 0),
            // In small letters it might be another one
            _ => unit(1.0, PowerOfMetre::parse(name)?.0),
        }
    }

    /// A length of this unit in another.
    pub(super) fn convert(self, value: f64, unit: asperity_surface::LengthUnit) -> f64 {
        let value = value * self.factor;
        self.power
            .convert(unit)
            .map_or(value, |convert| convert(value))
    }
}
