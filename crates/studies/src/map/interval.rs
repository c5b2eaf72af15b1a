//! The test of the map: an interval that contains the true distance, against a tolerance.

use asperity_numerics::elementary::tan;
use serde::Serialize;

/// Verdict on a measure, or on a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CellVerdict {
    /// All that the distance may be lies within the tolerance.
    Within,
    /// All that it may be lies beyond.
    Beyond,
    /// Neither, at this budget.
    NotResolved,
}

impl CellVerdict {
    /// All verdicts.
    pub const ALL: [Self; 3] = [Self::Within, Self::Beyond, Self::NotResolved];

    /// Form of tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Within => "within",
            Self::Beyond => "beyond",
            Self::NotResolved => "not resolved",
        }
    }

    /// Verdict on several: beyond if one is, within if all are.
    pub(super) fn of_all(verdicts: impl IntoIterator<Item = Self>) -> Self {
        verdicts
            .into_iter()
            .fold(Self::Within, |all, one| match (all, one) {
                (Self::Beyond, _) | (_, Self::Beyond) => Self::Beyond,
                (Self::NotResolved, _) | (_, Self::NotResolved) => Self::NotResolved,
                _ => Self::Within,
            })
    }
}

/// A distance, and where it lies with a probability of 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Results.
    pub value: f64,
    /// Least and largest that the truth may be; `None` where nothing is known of the error.
    pub range: Option<[f64; 2]>,
}

impl Interval {
    /// `value` with a half width.
    pub(super) fn about(value: f64, half_width: Option<f64>) -> Self {
        Self {
            value,
            range: half_width.map(|w| [value - w, value + w]),
        }
    }

    /// Variant for values that are never below zero.
    pub(super) fn not_below_zero(self) -> Self {
        Self {
            range: self.range.map(|[low, high]| [low.max(0.0), high]),
            ..self
        }
    }

    /// Verdict on the magnitude and `tolerance`: within if the whole range does, beyond if none of it
    /// does. The tolerance itself is within.
    #[must_use]
    pub fn verdict(&self, tolerance: f64) -> CellVerdict {
        match self.range {
            Some([low, high]) if low >= -tolerance && high <= tolerance => CellVerdict::Within,
            Some([low, high]) if low > tolerance || high < -tolerance => CellVerdict::Beyond,
            _ => CellVerdict::NotResolved,
        }
    }
}

/// Standard errors that a mean over `count` normal values stays within with a probability of 95 %:
/// Student's quantile of `count - 1` degrees of freedom; `None` for fewer than two values.
///
/// # Source
/// Abramowitz and Stegun 1964, 26.7.5, to 0.1 % from four degrees on; closed forms for one and two.
pub(super) fn student_95(count: u64) -> Option<f64> {
    const Z: f64 = 1.959_963_984_540_054;
    let degrees = count.checked_sub(1)? as f64;
    Some(match count {
        0 | 1 => return None,
        2 => tan(0.475 * std::f64::consts::PI),
        // 2 p - 1 = 0.95 and 4 p (1 - p) = 0.0975.
        3 => 0.95 * (2.0_f64 / 0.0975).sqrt(),
        _ => {
            let z2 = Z * Z;
            let terms = [
                (z2 + 1.0) / 4.0,
                (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / 96.0,
                (3.0 * z2 * z2 * z2 + 19.0 * z2 * z2 + 17.0 * z2 - 15.0) / 384.0,
                (79.0 * z2.powi(4) + 776.0 * z2.powi(3) + 1482.0 * z2 * z2 - 1920.0 * z2 - 945.0)
                    / 92_160.0,
            ];
            let sum: f64 = terms
                .iter()
                .enumerate()
                .map(|(k, term)| term / degrees.powi(k as i32 + 1))
                .sum();
            Z * (1.0 + sum)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_interval_decides_and_the_tolerance_is_within() {
        use CellVerdict::{Beyond, NotResolved, Within};
        let judge = |low: f64, high: f64| {
            let range = Some([low, high]);
            Interval { value: 0.0, range }.verdict(0.25)
        };
        for (low, high, expected) in [
            (0.0, 0.25, Within),
            (-0.25, 0.25, Within),
            (0.0, 0.2500001, NotResolved),
            (0.25, 0.5, NotResolved),
            (0.2500001, 0.5, Beyond),
            (-0.5, -0.2500001, Beyond),
            (-0.5, -0.25, NotResolved),
            (-0.5, 0.5, NotResolved),
            (f64::NAN, f64::NAN, NotResolved),
            (0.0, f64::INFINITY, NotResolved),
        ] {
            assert_eq!(judge(low, high), expected, "{low} {high}");
        }
        let unknown = Interval::about(7.0, None);
        assert_eq!(unknown.verdict(0.25), NotResolved);
    }

    #[test]
    fn distances_are_not_below_zero() {
        let found = Interval::about(0.125, Some(0.25)).not_below_zero();
        assert_eq!(found.range, Some([0.0, 0.375]));
        let found = Interval::about(0.5, Some(0.25)).not_below_zero();
        assert_eq!(found.range, Some([0.25, 0.75]));
    }

    #[test]
    fn a_cell_is_beyond_if_one_measure_is_and_within_if_all_are() {
        use CellVerdict::{Beyond, NotResolved, Within};
        let of = |verdicts: &[CellVerdict]| CellVerdict::of_all(verdicts.iter().copied());
        assert_eq!(of(&[Within, Within]), Within);
        assert_eq!(of(&[Within, NotResolved]), NotResolved);
        assert_eq!(of(&[NotResolved, Beyond, Within]), Beyond);
        assert_eq!(of(&[Beyond, NotResolved]), Beyond);
    }

    /// Quantiles from the tables of Abramowitz and Stegun 1964, 26.10.
    #[test]
    fn student_has_its_tabulated_quantiles() {
        for (degrees, quantile) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (7, 2.365),
            (15, 2.131),
            (31, 2.040),
            (120, 1.980),
        ] {
            let found = student_95(degrees + 1).unwrap();
            println!("{degrees}: {found}");
            assert!((found / quantile - 1.0).abs() < 5e-3, "{degrees}: {found}");
        }
        assert_eq!((student_95(0), student_95(1)), (None, None));
    }
}
