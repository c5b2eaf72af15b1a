//! Cause of the end of a run.

use serde::{Deserialize, Serialize};

/// Cause of the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StoppedBy {
    /// The target error was reached.
    Target,
    /// Surfaces and rays are as many as the target error takes, but the mesh adds too much to it.
    Mesh,
    /// All that was planned is done.
    Plan,
    /// Its time was over.
    Time,
    /// An interrupt.
    Interrupt,
    /// Shards of the run are missing.
    Shards,
    /// A bound on all that tracing could find lies below the target: nothing was traced.
    Bound,
}
