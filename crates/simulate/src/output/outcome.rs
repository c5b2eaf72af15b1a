//! Outcome: what was found of one case.

use std::fmt;

use asperity_tally::{TallyStatistics, TallyValues};
use serde::{Deserialize, Serialize};

use super::stopping::Stopping;
use super::work::SummaryWork;
use crate::errors::budget::ErrorBudget;
use crate::input::case::Case;

/// Outcome of one case.
///
/// It is written and read as a whole. What depends on the machine and the moment is in [`SummaryWork::machine`] alone.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// Number of the case among those that were given.
    pub number: usize,
    /// The case, on the surfaces that were traced: a target error may have changed their spacing.
    pub case: Case,
    /// Flux fractions with their standard errors, by the tally of the settings.
    pub statistics: TallyStatistics,
    /// Source of the standard errors.
    pub errors_from: ErrorSource,
    /// Flux fractions of each surface, or of each region of a given one, with which models are compared; empty
    /// [without details](Self::without_details).
    #[serde(with = "rows")]
    pub surfaces: Vec<TallyValues>,
    /// The errors of the fluxes by where they come from; none of them [without details](Self::without_details).
    pub errors: ErrorBudget,
    /// Largest deviation of any sum of fluxes, if no rays were traced.
    pub deviation_bound: Option<f64>,
    /// Work, and its time.
    pub work: SummaryWork,
    /// End of the run.
    pub stopping: Stopping,
    /// The seed of surfaces and rays.
    pub seed: u64,
}

/// Tallies of one spec as rows of one array.
mod rows {
    use asperity_tally::{Numbers, TallySpec, TallyValues};
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Rows {
        spec: TallySpec,
        values: Vec<Numbers<'static>>,
    }

    pub(super) fn serialize<S: Serializer>(
        tallies: &[TallyValues],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let rows = tallies.first().map(|first| Rows {
            spec: *first.spec(),
            values: tallies
                .iter()
                .map(|tally| Numbers(tally.iter().copied().collect()))
                .collect(),
        });
        rows.serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        source: D,
    ) -> Result<Vec<TallyValues>, D::Error> {
        let Some(Rows { spec, values }) = Option::deserialize(source)? else {
            return Ok(Vec::new());
        };
        let tally = |Numbers(row): Numbers<'_>| {
            let mut row = row.iter().copied();
            let is_whole = row.len() == spec.len();
            let tally = TallyValues::from_fn(spec, |_| row.next().unwrap_or(f64::NAN));
            is_whole
                .then_some(tally)
                .ok_or_else(|| D::Error::custom("rows of another tally spec"))
        };
        values.into_iter().map(tally).collect()
    }
}

impl Outcome {
    /// Means and standard errors alone, without what takes a tally per surface and the errors by where they come from.
    #[must_use]
    pub fn without_details(self) -> Self {
        Self {
            surfaces: Vec::new(),
            errors: self.errors.without_values(),
            ..self
        }
    }
}

/// Source of standard errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorSource {
    /// The scatter between surfaces.
    Surfaces,
    /// The scatter between the regions of the one surface there is.
    Regions,
    /// The scatter between the ray blocks of the one surface there is.
    RayBlocks,
    /// A bound on what rays could find. None were traced.
    DeviationBound,
}

impl ErrorSource {
    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Surfaces => "surfaces",
            Self::Regions => "regions",
            Self::RayBlocks => "ray blocks",
            Self::DeviationBound => "deviation bound",
        }
    }
}

impl fmt::Display for ErrorSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
