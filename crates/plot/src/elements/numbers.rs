//! Numbers as text, and round numbers.

/// `value` with `decimals` decimals and a true minus sign; never "-0".
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().any(|b| (b'1'..=b'9').contains(&b)) => format!("−{digits}"),
        Some(digits) => digits.to_owned(),
        None => text,
    }
}

/// `value` with three significant digits.
pub(crate) fn three_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = exponent10(value);
    if (-3..6).contains(&exponent) {
        fixed(value, usize::try_from(2 - exponent).unwrap_or(0))
    } else {
        // In two steps: ten to a large power is out of range before the quotient is.
        let half = exponent / 2;
        let mantissa = value / 10f64.powi(half) / 10f64.powi(exponent - half);
        format!("{} × {}", fixed(mantissa, 2), power_of_ten(exponent))
    }
}

/// The decimal exponent of |`value`|; zero for zero.
pub(crate) fn exponent10(value: f64) -> i32 {
    if value == 0.0 {
        0
    } else {
        // The library rounds correctly, a logarithm would not at exact powers.
        format!("{:e}", value.abs())
            .split_once('e')
            .and_then(|(_, e)| e.parse().ok())
            .unwrap_or(0)
    }
}

/// "10⁻³" for -3.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    let digits = exponent.to_string();
    let superscript = digits.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    });
    "10".chars().chain(superscript).collect()
}

/// The exponent to take out of tick texts for values up to `max_abs`: zero for values that read well as they are.
pub(crate) fn display_exponent(max_abs: f64) -> i32 {
    let exponent = exponent10(max_abs);
    if (-2..4).contains(&exponent) {
        0
    } else {
        exponent
    }
}

/// "(1/sr)" with the power of ten that [`display_exponent`] took out.
pub(crate) fn per_steradian(exponent: i32) -> String {
    match exponent {
        0 => "(1/sr)".into(),
        e => format!("({}/sr)", power_of_ten(e)),
    }
}

/// `value` / 10^`exponent`, in two steps because either power alone may be out of range.
pub(crate) fn scale_down(value: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    value / 10f64.powi(half) / 10f64.powi(exponent - half)
}

/// A round distance between ticks, and the decimals that tell them apart.
pub(crate) struct RoundStep {
    pub(crate) step: f64,
    pub(crate) decimals: usize,
}

/// The round step 1, 2 or 5 times a power of ten at or above `raw`, and the decimals its multiples need after
/// division by 10^`exponent`.
pub(crate) fn round_step(raw: f64, exponent: i32) -> RoundStep {
    if !raw.is_normal() || raw < 0.0 {
        return RoundStep {
            step: 1.0,
            decimals: 0,
        };
    }
    let power = exponent10(raw);
    let mantissa = scale_down(raw, power);
    let (factor, carry) = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|f| mantissa <= f * (1.0 + 1e-9))
        .map_or((1.0, 1), |f| (f, 0));
    let power = power + carry;
    let decimals = usize::try_from(exponent - power).unwrap_or(0).min(12);
    // Parsed, so that a step of 0.1 is the number a reader would write.
    let step = format!("{factor}e{power}").parse().unwrap_or(raw);
    RoundStep { step, decimals }
}

/// The largest of 1, 2 or 5 times a power of ten that is at most `raw`; `raw` itself if that is out of range.
pub(crate) fn round_step_below(raw: f64) -> f64 {
    if !raw.is_normal() {
        return raw;
    }
    let power = exponent10(raw);
    let mantissa = scale_down(raw, power) * (1.0 + 1e-9);
    let factor = [5.0, 2.0]
        .into_iter()
        .find(|f| *f <= mantissa)
        .unwrap_or(1.0);
    format!("{factor}e{power}").parse().unwrap_or(raw)
}

/// Decimals that show multiples of `step` without loss, six at most.
pub(crate) fn decimals(step: f64) -> usize {
    let exact = |n: &usize| {
        let scaled = step.abs() * 10f64.powi(*n as i32);
        (scaled - scaled.round()).abs() <= 1e-6 * scaled
    };
    (0..6).find(exact).unwrap_or(6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(fixed(-1.5, 1), "−1.5");
        assert_eq!(three_digits(0.0123456), "0.0123");
        assert_eq!(three_digits(240.0), "240");
        assert_eq!(three_digits(-1.5e-9), "−1.50 × 10⁻⁹");
        assert_eq!(three_digits(1e300), "1.00 × 10³⁰⁰");
        assert_eq!(three_digits(1e-320), "1.00 × 10⁻³²⁰");
        assert_eq!(power_of_ten(-12), "10⁻¹²");
    }

    #[test]
    fn steps_below_are_round_and_keep_their_decimals() {
        for (raw, step) in [(3.3, 2.0), (0.05, 0.05), (0.99e-12, 5e-13), (1e9, 1e9)] {
            assert_eq!(round_step_below(raw), step);
        }
        for (step, n) in [(0.25, 2), (5.0, 0), (0.0008, 4), (2.5, 1)] {
            assert_eq!(decimals(step), n);
        }
    }
}
