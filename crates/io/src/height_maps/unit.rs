//! Units of length as files spell them.

use asperity_surface::LengthUnit;

/// A unit of length as a power of ten of the metre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PowerOfMetre(pub(crate) i32);

impl PowerOfMetre {
    /// Parses `m` with or without an SI prefix.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let prefix = text.trim().strip_suffix('m')?;
        let power = match prefix {
            "k" => 3,
            "" => 0,
            "d" => -1,
            "c" => -2,
            "m" => -3,
            // The sign for micro exists twice in Unicode.
            "u" | "\u{b5}" | "\u{3bc}" => -6,
            // In UTF-8, where ISO 8859-1 is read.
            "\u{c2}\u{b5}" | "\u{ce}\u{bc}" => -6,
            "n" => -9,
            "p" => -12,
            "f" => -15,
            _ => return None,
        };
        Some(Self(power))
    }

    /// The unit to keep the numbers in: this one if surfaces know it, else the metre.
    pub(crate) fn kept_as(self) -> LengthUnit {
        match self.0 {
            3 => LengthUnit::Kilometre,
            -3 => LengthUnit::Millimetre,
            -6 => LengthUnit::Micrometre,
            -9 => LengthUnit::Nanometre,
            _ => LengthUnit::Metre,
        }
    }

    /// Converts a length in this unit into `unit`, rounding once; `None` without a physical unit.
    pub(crate) fn convert(self, unit: LengthUnit) -> Option<impl Fn(f64) -> f64 + Copy> {
        let target = match unit {
            LengthUnit::Kilometre => 3,
            LengthUnit::Metre => 0,
            LengthUnit::Millimetre => -3,
            LengthUnit::Micrometre => -6,
            LengthUnit::Nanometre => -9,
            LengthUnit::Arbitrary => return None,
        };
        let power = self.0 - target;
        let ten = 10_f64.powi(power.abs());
        Some(move |value: f64| if power < 0 { value / ten } else { value * ten })
    }
}

/// The physical unit of a surface as a power of ten of the metre.
pub(crate) fn power_of(unit: LengthUnit) -> Option<PowerOfMetre> {
    PowerOfMetre::parse(unit.symbol())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn si_prefixes_are_distinguished() {
        let power = |text| PowerOfMetre::parse(text).map(|p| p.0);
        assert_eq!(power("m"), Some(0));
        assert_eq!(power(" mm "), Some(-3));
        assert_eq!(power("µm"), Some(-6));
        assert_eq!(power("Âµm"), Some(-6));
        assert_eq!(power("μm"), Some(-6));
        assert_eq!(power("V"), None);
        assert_eq!(power("rad"), None);
        assert_eq!(power_of(LengthUnit::Arbitrary), None);
    }

    #[test]
    fn conversion_rounds_once() {
        let to_um = PowerOfMetre(-9).convert(LengthUnit::Micrometre).unwrap();
        assert_eq!(to_um(250.0), 0.25);
        assert_eq!(to_um(0.3), 0.3 / 1000.0);
    }
}
