//! Range: the numbers that a setting allows.

use std::fmt;

/// The allowed numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Every finite number.
    Any,
    /// More than this.
    Above(f64),
    /// This or more.
    AtLeast(f64),
    /// From the first to the second, both included.
    FromTo(f64, f64),
    /// From the first, included, to the second, excluded.
    FromBelow(f64, f64),
    /// Between both, neither included.
    Between(f64, f64),
    /// Above the first, up to the second.
    AboveTo(f64, f64),
}

impl Range {
    /// Returns `true` if `value` is allowed.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::Above(least) => value > least,
                Self::AtLeast(least) => value >= least,
                Self::FromTo(least, most) => (least..=most).contains(&value),
                Self::FromBelow(least, most) => (least..most).contains(&value),
                Self::Between(least, most) => value > least && value < most,
                Self::AboveTo(least, most) => value > least && value <= most,
            }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => f.write_str("any finite number"),
            Self::Above(least) => write!(f, "above {}", plain(*least)),
            Self::AtLeast(least) => write!(f, "{} or more", plain(*least)),
            Self::FromTo(least, most) => write!(f, "from {} to {}", plain(*least), plain(*most)),
            Self::FromBelow(least, most) => {
                write!(f, "from {} to below {}", plain(*least), plain(*most))
            }
            Self::Between(least, most) => {
                write!(f, "above {} and below {}", plain(*least), plain(*most))
            }
            Self::AboveTo(least, most) => {
                write!(f, "above {}, up to {}", plain(*least), plain(*most))
            }
        }
    }
}

/// A number, with an exponent where zeros would make it long.
fn plain(value: f64) -> String {
    if value == 0.0 || (1e-4..1e6).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
