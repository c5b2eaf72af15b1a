//! Mark of missing points: a number that a header states, and that samples may hold in other digits.

use crate::text_lines::decimal;

/// Size beyond which numbers are marks and no heights.
const HUGE: f64 = 1e30;

/// A number as a text states it.
#[derive(Clone)]
pub(super) struct Mark {
    text: String,
    /// NaN of a word.
    value: f64,
    /// Half a unit of the last digit.
    half_digit: f64,
    /// Number of digits, without zeros in front.
    digits: usize,
}

impl Mark {
    pub(super) fn new(text: &str) -> Self {
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let decimals = mantissa.split_once(['.', ',']).map_or(0, |(_, d)| d.len());
        let exponent = exponent.parse::<i32>().unwrap_or(0);
        let digits = mantissa.trim_start_matches(['-', '+', '0', '.', ',']);
        Self {
            text: text.to_owned(),
            // The largest double, rounded up
            value: decimal(text).unwrap_or(f64::NAN).clamp(f64::MIN, f64::MAX),
            half_digit: 0.5 * 10_f64.powi(exponent.saturating_sub(decimals as i32)),
            digits: digits.bytes().filter(u8::is_ascii_digit).count(),
        }
    }

    /// Returns `true` if `text`, which is that of `number` or of a word, states this mark: as it is, in single precision, or,
    /// beyond all heights, in fewer or more digits.
    pub(super) fn is_stated_by(&self, text: &str, number: Option<f64>) -> bool {
        let is_near = |number: f64| {
            number.is_infinite() || (number - self.value).abs() <= 0.5 * self.value.abs()
        };
        self.text.eq_ignore_ascii_case(text)
            || number.is_some_and(is_near) && {
                let other = Self::new(text);
                self.value == other.value
                    || self.is_rounded(other.value)
                    || other.is_rounded(self.value)
                    || self.is_single(&other)
                    || other.is_single(self)
            }
    }

    /// Returns `true` if this is `number` in fewer digits, and no height.
    pub(super) fn is_rounded(&self, number: f64) -> bool {
        self.value.abs() > HUGE && (self.value - number).abs() <= self.half_digit
    }

    /// Returns `true` if this is `other` in single precision, which takes more digits.
    fn is_single(&self, other: &Self) -> bool {
        let single = f64::from(other.value as f32);
        self.digits > other.digits && (self.value - single).abs() <= self.half_digit
    }
}
