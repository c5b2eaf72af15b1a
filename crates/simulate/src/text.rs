//! Errors and counts as people read them.

pub use asperity_surface::short;

/// An error to three digits, as in `2.31e-5`.
#[must_use]
pub fn error_in_short(error: f64) -> String {
    format!("{error:.2e}")
}

/// A number to three digits, as in `0.145` and `12`.
#[must_use]
pub fn three_digits(value: f64) -> String {
    short(format!("{value:.2e}").parse().unwrap_or(value))
}

/// A count with its noun, as in `1 surface` and `2 surfaces`.
#[must_use]
pub fn counted(count: u64, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nouns_agree_with_their_counts() {
        assert_eq!(counted(0, "case"), "0 cases");
        assert_eq!(counted(1, "case"), "1 case");
        assert_eq!(counted(2, "case"), "2 cases");
    }
}
