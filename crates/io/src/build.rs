//! Build: version, results epoch and commit of this program, which its results carry.

#[cfg(test)]
mod package_commit;

use serde::{Deserialize, Serialize};

/// Epoch of the numbers that this program writes.
///
/// Raise it with every change after which the same configuration and seed give other numbers, even in
/// the last digit: other algorithms, other random streams, another order of summation. Leave it
/// where only file layouts, words, figures or speed change. Results of different epochs are never
/// mixed: checkpoints of another epoch are refused.
pub const RESULTS_EPOCH: u32 = 21;

/// Build of the program that computed a result. Results of equal builds and configurations have equal numbers.
///
/// # Examples
/// ```
/// use asperity_io::{Build, RESULTS_EPOCH};
///
/// let build = Build::current();
/// assert_eq!(build.results_epoch, RESULTS_EPOCH);
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    /// Version of the program, as in `0.1.0`.
    pub version: String,
    /// [`RESULTS_EPOCH`] of the program.
    pub results_epoch: u32,
    /// Git commit of the sources; `unknown` if they were neither in a git repository nor in a package made of one,
    /// `development` for builds without the release profile.
    pub commit: String,
}

impl Build {
    /// The build that is running.
    #[must_use]
    pub fn current() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            results_epoch: RESULTS_EPOCH,
            commit: env!("ASPERITY_COMMIT").to_owned(),
        }
    }
}
