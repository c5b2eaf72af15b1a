//! Numbers as people write them.

/// Largest count: more rays than anybody can trace, and products of counts still fit.
pub(crate) const MOST_COUNT: f64 = 1e15;

/// A number, or a quotient of two: `1.4`, `1/1.4`, `2e-3`.
///
/// # Errors
/// A sentence that says what was found.
pub(crate) fn parse_number(text: &str) -> Result<f64, String> {
    let number = |part: &str| {
        part.trim()
            .parse::<f64>()
            .map_err(|_| format!("`{text}` is not a number; write it as 1.4, 2e-3 or 1/1.4"))
    };
    let value = match text.split_once('/') {
        Some((over, under)) => number(over)? / number(under)?,
        None => number(text)?,
    };
    if value.is_finite() {
        Ok(value)
    } else {
        Err(format!("`{text}` is not a finite number"))
    }
}

/// A count of one or more: `1000`, `1e6`, `1_000_000`.
///
/// # Errors
/// A sentence that says what was found and what is allowed.
pub(crate) fn parse_count(text: &str) -> Result<u64, String> {
    let plain: String = text.chars().filter(|&c| c != '_').collect();
    count_from_number(parse_number(&plain)?).map_err(|reason| format!("`{text}` {reason}"))
}

/// A positive number of seconds, or of minutes or hours: `90`, `90s`, `10m`, `1.5h`.
///
/// # Errors
/// A sentence that says what was found and what is allowed.
pub(crate) fn parse_seconds(text: &str) -> Result<f64, String> {
    let trimmed = text.trim();
    let (number, unit) = match trimmed.strip_suffix(['s', 'm', 'h']) {
        Some(number) if trimmed.ends_with('h') => (number, 3600.0),
        Some(number) if trimmed.ends_with('m') => (number, 60.0),
        Some(number) => (number, 1.0),
        None => (trimmed, 1.0),
    };
    parse_number(number)
        .ok()
        .and_then(|value| seconds_from_number(value * unit).ok())
        .ok_or_else(|| {
            format!("`{text}` is not a time above 0; write it in seconds as 90, or as 10m or 2h")
        })
}

/// A positive number of seconds.
fn seconds_from_number(value: f64) -> Result<f64, String> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(format!(
            "{value} is not a time above 0; write it in seconds as 90, or as \"10m\" or \"2h\""
        ))
    }
}

/// A whole number of one or more that was written as a decimal one.
pub(crate) fn count_from_number(value: f64) -> Result<u64, String> {
    if value.fract() == 0.0 && (1.0..=MOST_COUNT).contains(&value) {
        Ok(value as u64)
    } else {
        Err(format!(
            "is out of range; a count is a whole number of 1 or more, up to {MOST_COUNT:e}, as 1000 or 1e6"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_may_be_quotients() {
        assert_eq!(parse_number("1.4"), Ok(1.4));
        assert_eq!(parse_number("1/1.4"), Ok(1.0 / 1.4));
        assert_eq!(parse_number(" 2e-3 "), Ok(2e-3));
        for bad in ["", "a", "1/0", "1/", "inf", "nan", "1/2/3"] {
            assert!(parse_number(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn times_have_units() {
        for (text, seconds) in [
            ("90", 90.0),
            ("0.5s", 0.5),
            ("10m", 600.0),
            ("1.5h", 5400.0),
        ] {
            assert_eq!(parse_seconds(text), Ok(seconds));
        }
        for bad in ["", "m", "0", "-1", "-2h", "1d", "nan", "inf", "1e308h"] {
            assert!(parse_seconds(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn counts_are_whole_and_positive() {
        assert_eq!(parse_count("1e6"), Ok(1_000_000));
        assert_eq!(parse_count("1_000"), Ok(1_000));
        assert_eq!(parse_count("1e15"), Ok(1_000_000_000_000_000));
        assert!(parse_count("18446744073709551615").is_err());
        for bad in ["0", "-5", "1.5", "1e30", "many"] {
            assert!(parse_count(bad).is_err(), "{bad}");
        }
    }
}
