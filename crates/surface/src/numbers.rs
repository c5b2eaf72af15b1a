//! Numbers as people read them.

use std::ops::Range;

use asperity_numerics::elementary::log10;

/// At least six significant digits, without trailing zeros; with an exponent, as in `1.5e-150`, where zeros would
/// make it long.
#[must_use]
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !PLAIN.contains(&value.abs()) {
        let text = format!("{value:.5e}");
        return match text.split_once('e') {
            Some((mantissa, exponent)) => format!("{}e{exponent}", without_zeros(mantissa)),
            None => text,
        };
    }
    let digits = (5 - log10(value.abs()).floor() as i32).max(0) as usize;
    without_zeros(&format!("{value:.digits$}")).to_owned()
}

/// Magnitudes written without an exponent.
const PLAIN: Range<f64> = 1e-4..1e15;

/// A number without zeros at the end of its fraction.
fn without_zeros(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

/// Writes a number like [`short`], but never above `value`: for the largest number that is allowed.
#[must_use]
pub fn short_below(value: f64) -> String {
    let text = short(value);
    match text.parse::<f64>() {
        Ok(shown) if shown > value => {
            let scale = 10_f64.powi(5 - log10(value.abs()).floor() as i32);
            short((value * scale).floor() / scale)
        }
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn numbers_are_shortened_for_people() {
        assert_eq!(short(1.0 / 1.4), "0.714286");
        assert_eq!(short(2.522), "2.522");
        assert_eq!(short(30.0), "30");
        assert_eq!(short(100.0), "100");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(1e-9), "1e-9");
        assert_eq!(short(1e-4), "0.0001");
        assert_eq!(short(7.728_03e-8), "7.72803e-8");
    }

    #[test]
    fn extreme_numbers_stay_short_and_different() {
        for (value, text) in [
            (1e200, "1e200"),
            (-1.5e200, "-1.5e200"),
            (1e-150, "1e-150"),
            (1.234_567_8e-150, "1.23457e-150"),
            (f64::MAX, "1.79769e308"),
            (5e-324, "4.94066e-324"),
            (1e15, "1e15"),
            (9e14, "900000000000000"),
            (1e-12, "1e-12"),
            (9.9e-13, "9.9e-13"),
            (1.5e-12, "1.5e-12"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), text);
        }
        // From one to the next tenth of a decade, over all that a number can be.
        let all: Vec<String> = (-3070..3080)
            .map(|i| short(10_f64.powf(f64::from(i) / 10.0)))
            .collect();
        assert!(all.iter().all(|text| text.len() <= 20), "{all:?}");
        assert!(all.iter().collect::<HashSet<_>>().len() == all.len());
    }

    #[test]
    fn the_largest_number_allowed_is_never_exceeded() {
        assert_eq!(short_below(2.0 / 3.0), "0.666666");
        assert_eq!(short_below(1.0 / 3.0), "0.333333");
        assert_eq!(short_below(12.5), "12.5");
        assert_eq!(short_below(6.66e-77 / 9.0), "7.4e-78");
    }
}
