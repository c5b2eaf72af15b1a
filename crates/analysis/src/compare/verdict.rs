//! Verdict: whether a model is rejected, given the error of the explicit result.

use std::fmt;

use asperity_numerics::elementary::log2;

use crate::compare::comparison::Comparison;
use crate::compare::multiple_tests::sidak_level;
use crate::compare::sign_flip::{MIN_P, Untested};

/// The probability with which at least one correct model is rejected.
pub const DEFAULT_LEVEL: f64 = 0.01;

/// Result of a comparison for one model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// No deviation beyond the error was found. A smaller error might still find one: the noise of the total
    /// variation says how large a deviation would have been detected.
    NotRejected,
    /// The deviation is significant.
    Rejected,
    /// The data cannot decide.
    NotResolved(Unresolved),
}

/// Reason for which the data cannot decide on a model.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unresolved {
    /// There is no p value.
    #[error(transparent)]
    Untested(#[from] Untested),
    /// The least possible p value is above the level.
    #[error(
        "the least p value is {min_p:.2e}, above the level {level:.2e}; {}",
        match needed {
            Some(needed) => format!("{needed} surfaces can decide"),
            None => "test fewer models, or at a larger level".to_owned(),
        }
    )]
    LevelOutOfReach {
        /// The least p value.
        min_p: f64,
        /// The level of one test.
        level: f64,
        /// Number of surfaces whose least p value is below the level; `None` if the number of random flips
        /// limits it.
        needed: Option<u32>,
    },
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotRejected => f.write_str("not rejected"),
            Self::Rejected => f.write_str("rejected"),
            Self::NotResolved(reason) => write!(f, "not resolved: {reason}"),
        }
    }
}

/// One verdict for each of the models compared with the same surfaces.
///
/// A model is rejected if `p` is below the Sidak level `1 - (1 - level)^(1 / n)` of `n` comparisons, so that no correct
/// model is rejected with a probability of `1 - level`. This is exact for independent comparisons. Comparisons on the
/// same surfaces, and of components of the same light, are dependent. As far as they depend positively on
/// each other, which is not proven, the test is conservative.
#[must_use]
pub fn verdicts(comparisons: &[&Comparison], level: f64) -> Vec<Verdict> {
    let level = sidak_level(level, comparisons.len());
    comparisons
        .iter()
        .map(|comparison| match &comparison.test {
            Err(reason) => Verdict::NotResolved((*reason).into()),
            Ok(test) if test.min_p >= level => Verdict::NotResolved(Unresolved::LevelOutOfReach {
                min_p: test.min_p,
                level,
                // R surfaces have 2^(R - 1) distinct flips, and the number tried is limited.
                needed: (level > MIN_P).then(|| 2 + (-log2(level)).floor() as u32),
            }),
            Ok(test) if test.p < level => Verdict::Rejected,
            Ok(_) => Verdict::NotRejected,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Expected, RayCount, compare};

    fn surfaces(count: usize) -> Vec<Vec<f64>> {
        // Deviations from 0.3 of either sign, the same in sum.
        (0..count)
            .map(|r| vec![0.3 + if r % 2 == 0 { 1e-3 } else { -1e-3 } * (1.0 + r as f64 / 8.0)])
            .collect()
    }

    #[test]
    fn verdicts_print_as_rejected_and_not_rejected() {
        let right = compare(
            &surfaces(10),
            Expected::Exact(&[0.3]),
            &[RayCount::UNLIMITED],
            &[],
            0,
        )
        .unwrap();
        let wrong = compare(
            &surfaces(10),
            Expected::Exact(&[0.31]),
            &[RayCount::UNLIMITED],
            &[],
            0,
        )
        .unwrap();
        let both = verdicts(&[&right, &wrong], DEFAULT_LEVEL);
        assert_eq!(both, [Verdict::NotRejected, Verdict::Rejected]);
        assert_eq!(
            format!("{}, {}", both[0], both[1]),
            "not rejected, rejected"
        );
    }

    #[test]
    fn too_few_surfaces_give_no_verdict() {
        // Seven surfaces reach p = 1/64 at best: no deviation could fail a model at 0.01.
        for (count, text) in [
            (1, "not resolved: one surface has"),
            (4, "not resolved: too few surfaces: 4, at least 6"),
            (7, "not resolved: the least p value"),
        ] {
            let wrong = compare(
                &surfaces(count),
                Expected::Exact(&[0.9]),
                &[RayCount::UNLIMITED],
                &[],
                0,
            )
            .unwrap();
            let verdict = verdicts(&[&wrong], DEFAULT_LEVEL)[0].to_string();
            assert!(verdict.starts_with(text), "{verdict}");
        }
        let wrong = compare(
            &surfaces(8),
            Expected::Exact(&[0.9]),
            &[RayCount::UNLIMITED],
            &[],
            0,
        )
        .unwrap();
        assert_eq!(verdicts(&[&wrong], DEFAULT_LEVEL), [Verdict::Rejected]);
    }

    /// The Sidak level of two comparisons at 0.01 is 0.00501, of three 0.00334.
    #[test]
    fn comparisons_divide_the_level() {
        let of_p = |p: f64| {
            let mut found = compare(
                &surfaces(12),
                Expected::Exact(&[0.3]),
                &[RayCount::UNLIMITED],
                &[],
                0,
            )
            .unwrap();
            found.test.as_mut().unwrap().p = p;
            found
        };
        let cases = [
            (
                0.007,
                [
                    Verdict::Rejected,
                    Verdict::NotRejected,
                    Verdict::NotRejected,
                ],
            ),
            (
                0.004,
                [Verdict::Rejected, Verdict::Rejected, Verdict::NotRejected],
            ),
            (0.003, [Verdict::Rejected; 3]),
        ];
        for (p, expected) in cases {
            for (others, expected) in expected.into_iter().enumerate() {
                let all = vec![of_p(p); others + 1];
                let all: Vec<&Comparison> = all.iter().collect();
                let found = verdicts(&all, 0.01);
                assert_eq!(found, vec![expected; others + 1], "{p} {others}");
            }
        }
    }

    /// Eight surfaces reach 1/128 = 0.0078 at best: enough for one model, and for none of two.
    #[test]
    fn two_models_need_more_surfaces_than_one() {
        let wrong = compare(
            &surfaces(8),
            Expected::Exact(&[0.9]),
            &[RayCount::UNLIMITED],
            &[],
            0,
        )
        .unwrap();
        assert_eq!(verdicts(&[&wrong], 0.01), [Verdict::Rejected]);
        let reason = Unresolved::LevelOutOfReach {
            min_p: 1.0 / 128.0,
            level: sidak_level(0.01, 2),
            needed: Some(9),
        };
        let expected = [Verdict::NotResolved(reason); 2];
        assert_eq!(verdicts(&[&wrong, &wrong], 0.01), expected);
    }
}
