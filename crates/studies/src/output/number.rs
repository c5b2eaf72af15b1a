//! Numbers with errors as text.

use asperity_numerics::elementary::log10;
use asperity_simulate::short;
use asperity_tally::Estimate;

/// Largest standard error that is rounding: a path of a thousand events rounds its flux by 2e-13 of the incident one.
pub(crate) const NO_SCATTER: f64 = 1e-12;

/// A mean with its standard error to two digits, as in `0.024812 +- 0.000042`.
pub(crate) fn with_error(estimate: Estimate) -> String {
    match estimate.se {
        Some(se) if se > NO_SCATTER => {
            let digits = (1 - log10(se).floor() as i32).clamp(0, 12) as usize;
            let mean = format!("{:.digits$}", estimate.mean);
            // What rounds to zero has no sign.
            let is_zero = mean.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
            let mean = mean.strip_prefix('-').filter(|_| is_zero).unwrap_or(&mean);
            format!("{mean} +- {se:.digits$}")
        }
        Some(_) => format!("{} (no scatter)", in_steps(estimate.mean, NO_SCATTER)),
        None => format!("{} (no error)", short(estimate.mean)),
    }
}

/// A number to the sixth digit of `scale`, below which it is noise: 0 where all of it is.
pub(crate) fn beside(value: f64, scale: f64) -> String {
    match scale > 0.0 {
        true => in_steps(value, 10_f64.powi(log10(scale).floor() as i32 - 5)),
        false => short(value),
    }
}

/// A number rounded to a multiple of `step`.
pub(crate) fn in_steps(value: f64, step: f64) -> String {
    short((value / step).round() * step + 0.0)
}

/// Sentence on results that a stop cut short, if there are any.
pub(crate) fn cut_short(count: usize, all: usize, what: &str) -> Option<String> {
    (count > 0).then(|| {
        format!(
            "{count} of {all} {what} were cut short: their results are of the surfaces that were finished, so they depend on when the run was ended; the same command resumes"
        )
    })
}

/// Three significant digits, with an exponent where there would be many zeros.
pub(crate) fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = log10(value.abs()).floor() as i32;
    if (-4..6).contains(&exponent) {
        let places = (2 - exponent).max(0) as usize;
        format!("{value:.places$}")
    } else {
        format!("{value:.2e}")
    }
}

/// A number that is not negative to two digits, as in `2.3e-5`.
pub(crate) fn two_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    format!("{value:.1e}")
}

/// A total variation distance: five decimals, or two digits where five decimals would not show it.
pub(crate) fn distance(value: f64) -> String {
    if value == 0.0 || value >= 1e-3 {
        format!("{value:.5}")
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_two_digits_and_means_as_many_places() {
        let estimate = |mean, se| with_error(Estimate { mean, se: Some(se) });
        assert_eq!(estimate(0.024_812_3, 0.000_041_7), "0.024812 +- 0.000042");
        assert_eq!(estimate(0.5, 0.0), "0.5 (no scatter)");
        assert_eq!(estimate(1.0, 2e-15), "1 (no scatter)");
        assert_eq!(estimate(-3e-17, 2e-17), "0 (no scatter)");
        assert_eq!(estimate(-0.000_41, 0.023), "0.000 +- 0.023");
        assert_eq!(estimate(-0.000_61, 0.023), "-0.001 +- 0.023");
        assert_eq!(
            with_error(Estimate {
                mean: 0.25,
                se: None
            }),
            "0.25 (no error)"
        );
    }

    #[test]
    fn numbers_below_the_last_digit_of_their_scale_are_zero() {
        assert_eq!(beside(2.64698e-22, 1.5e-7), "0");
        assert_eq!(beside(-6.2e-10, 1.6), "0");
        assert_eq!(beside(1234.56, 30.0), "1234.56");
        assert_eq!(beside(-9.26715e-6, 0.1087), "-9e-6");
        assert_eq!(beside(1e-30, 0.0), "1e-30");
    }

    #[test]
    fn three_digits_are_significant() {
        assert_eq!(significant(123_456.0), "123456");
        assert_eq!(significant(1.5e-5), "1.50e-5");
        assert_eq!(significant(0.012_345), "0.0123");
        assert_eq!(significant(0.0), "0");
    }
}
