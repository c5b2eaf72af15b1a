//! Lengths in the unit that suits them.

use super::axis::Axis;
use super::numbers::{display_exponent, power_of_ten, scale_down, three_digits};

/// The unit in which lengths are shown.
#[derive(Debug, Clone)]
pub(crate) struct LengthUnit {
    /// Shown unit over given unit.
    pub(crate) unit_size: f64,
    /// "µm", "arb. units", or empty if the unit is unknown.
    symbol: String,
    /// Power of ten taken out of the numbers as well.
    exponent: i32,
}

/// Distance between ticks of a side, about.
const POINTS_PER_TICK: f64 = 38.0;

impl LengthUnit {
    /// The unit in which `max_abs`, given in `unit`, reads best.
    pub(crate) fn choose(unit: &str, max_abs: f64) -> Self {
        let metres = match unit {
            "km" => Some(1e3),
            "m" => Some(1.0),
            "cm" => Some(1e-2),
            "mm" => Some(1e-3),
            // Micro sign and Greek mu look alike and are both common.
            "um" | "\u{b5}m" | "\u{3bc}m" => Some(1e-6),
            "nm" => Some(1e-9),
            _ => None,
        };
        let (unit_size, symbol) = match metres {
            Some(metres) => {
                let size = max_abs * metres;
                let (shown, symbol) = [(1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "µm")]
                    .into_iter()
                    // Rounding must not turn 1 mm into 1000 µm.
                    .find(|(shown, _)| size >= shown * (1.0 - 1e-9))
                    .unwrap_or((1e-9, "nm"));
                (shown / metres, symbol)
            }
            None if unit == "1" => (1.0, "arb. units"),
            None => (1.0, unit),
        };
        LengthUnit {
            unit_size,
            symbol: symbol.to_owned(),
            exponent: display_exponent(max_abs / unit_size),
        }
    }

    /// "x (µm)", "height (10⁻⁶ arb. units)".
    pub(crate) fn label(&self, quantity: &str) -> String {
        match (self.exponent, self.symbol.as_str()) {
            (0, "") => quantity.to_owned(),
            (0, symbol) => format!("{quantity} ({symbol})"),
            (e, symbol) => format!(
                "{quantity} ({})",
                format!("{} {symbol}", power_of_ten(e)).trim_end()
            ),
        }
    }

    /// Unit after a number.
    pub(crate) fn suffix(&self) -> String {
        match self.symbol.as_str() {
            "" => String::new(),
            symbol => format!(" {symbol}"),
        }
    }

    pub(crate) fn number(&self, value: f64) -> String {
        three_digits(value / self.unit_size)
    }

    /// The axis of a side of the map, with fewer ticks if it is short.
    pub(crate) fn side_axis(&self, name: &str, extent: f64, length: f64) -> Axis {
        let count = ((length / POINTS_PER_TICK) as usize).clamp(1, 6);
        self.axis(0.0, extent, count).with_label(&self.label(name))
    }

    /// An axis over lengths in the given unit: its values are in the shown unit without the power of ten.
    pub(crate) fn axis(&self, lo: f64, hi: f64, count: usize) -> Axis {
        let shown = |v: f64| scale_down(v / self.unit_size, self.exponent);
        Axis::linear(shown(lo), shown(hi), count, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_read_as_a_person_would_write_them() {
        for (unit, max, label) in [
            ("m", 2.4e-4, "x (µm)"),
            ("m", 1e-3, "x (mm)"),
            ("um", 240.0, "x (µm)"),
            ("um", 0.3, "x (nm)"),
            ("mm", 2500.0, "x (m)"),
            ("m", 2e-15, "x (10⁻⁶ nm)"),
            ("1", 12.8, "x (arb. units)"),
            ("1", 1e-9, "x (10⁻⁹ arb. units)"),
            ("tau", 3.0, "x (tau)"),
            ("", 3.0, "x"),
        ] {
            assert_eq!(
                LengthUnit::choose(unit, max).label("x"),
                label,
                "{unit} {max}"
            );
        }
    }
}
