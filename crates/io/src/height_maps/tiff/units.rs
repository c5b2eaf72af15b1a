//! Units of length by the names that GDAL, ImageJ and OME write.

use crate::height_maps::unit::PowerOfMetre;

/// A unit of length: a number of powers of ten of the metre.
#[derive(Clone, Copy)]
pub(super) struct NamedUnit {
    factor: f64,
    pub(super) power: PowerOfMetre,
}

impl NamedUnit {
    /// Parses a name, with or without an SI prefix.
    pub(super) fn parse(name: &str) -> Option<Self> {
        let unit = |factor, power| {
            let power = PowerOfMetre(power);
            Some(Self { factor, power })
        };
        match name.trim() {
            "metre" | "metres" | "meter" | "meters" => unit(1.0, 0),
            "micron" | "microns" | "micrometer" => unit(1.0, -6),
            "\u{c5}" | "\u{212b}" | "angstrom" => unit(1.0, -10),
            "inch" | "inches" | "in" => unit(2.54, -2),
            "foot" | "feet" | "ft" | "International foot" => unit(0.3048, 0),
            "US survey foot" | "us-ft" | "ftUS" | "Foot_US" | "foot_us" => unit(1200.0 / 3937.0, 0),
            other => Some(Self {
                factor: 1.0,
                power: PowerOfMetre::parse(other)?,
            }),
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
