//! Input of a comparison: the fluxes that a model expects, and checks of all lists.

use asperity_tally::FEW_RAYS;

/// Fluxes that a model expects.
#[derive(Clone, Copy, Debug)]
pub enum Expected<'a> {
    /// Exact fluxes.
    Exact(&'a [f64]),
    /// Sampled fluxes, one list per independent batch, with as many batches as surfaces. Each surface is
    /// compared with a batch of its own, so the differences are independent of each other, and their
    /// scatter is that of surface and model together.
    Batches(&'a [&'a [f64]]),
}

impl<'a> Expected<'a> {
    /// The fluxes that surface `r` is compared with.
    pub(crate) fn of(self, r: usize) -> &'a [f64] {
        match self {
            Self::Exact(fluxes) => fluxes,
            Self::Batches(batches) => batches[r],
        }
    }
}

/// Rays behind a bin, or behind a sum of bins, over all surfaces.
///
/// The test assumes that residuals are as likely as their negatives. Few rays are not: where 2 are expected, 0 or 5 are found.
/// Nor are the few that are missing where nearly all arrive in the same place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCount {
    /// Rays found or expected.
    pub inside: f64,
    /// Rays that might have arrived there and have ended elsewhere, or have taken another path.
    pub elsewhere: f64,
    /// Flux fraction of its surface that a ray inside carries, on average.
    pub flux: f64,
}

impl RayCount {
    /// Rays enough for any test.
    pub const UNLIMITED: Self = Self {
        inside: f64::INFINITY,
        elsewhere: f64::INFINITY,
        flux: 0.0,
    };

    /// No rays, so no test.
    pub const NONE: Self = Self {
        inside: 0.0,
        ..Self::UNLIMITED
    };

    /// Returns `true` if these residuals, one per surface, may be tested.
    ///
    /// If fewer than [`FEW_RAYS`] are missing, residuals must scatter by more than rays that are missing can explain: together by
    /// twice as many. Light that splits at a smooth surface has the same flux on every surface but for rare rays that stray; what
    /// no stray ray was seen of is no deviation. The condition is the same for residuals of either sign, so that a choice by it
    /// leaves the test exact.
    pub(crate) fn suffices(&self, residuals: impl Iterator<Item = f64>) -> bool {
        if self.inside < FEW_RAYS {
            return false;
        }
        let scatter = || residuals.map(f64::abs).sum::<f64>();
        self.elsewhere >= FEW_RAYS || scatter() >= 2.0 * FEW_RAYS * self.flux
    }
}

/// Error of an impossible comparison.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ComparisonError {
    /// No surfaces.
    #[error("there is no surface to compare with the model")]
    NoSurfaces,
    /// Lists of unequal length.
    #[error("{what} has {found} bins; the model has {expected}")]
    BinCount {
        /// The list that differs.
        what: String,
        /// Its length.
        found: usize,
        /// The length of the model's list.
        expected: usize,
    },
    /// Numbers of batches and of surfaces that differ.
    #[error("the model has {batches} batches for {surfaces} surfaces; it needs one per surface")]
    BatchCount {
        /// Batches of the model.
        batches: usize,
        /// Surfaces.
        surfaces: usize,
    },
    /// A flux that is not finite.
    #[error("{what} holds {value} in bin {bin}; fluxes must be finite")]
    NotFinite {
        /// The list that holds it.
        what: String,
        /// Number of the bin.
        bin: usize,
        /// The value.
        value: f64,
    },
}

/// Checks that all lists have finite entries and the length of the model's.
pub(crate) fn validate(
    surfaces: &[Vec<f64>],
    expected: Expected<'_>,
) -> Result<(), ComparisonError> {
    if surfaces.is_empty() {
        return Err(ComparisonError::NoSurfaces);
    }
    if let Expected::Batches(batches) = expected
        && batches.len() != surfaces.len()
    {
        return Err(ComparisonError::BatchCount {
            batches: batches.len(),
            surfaces: surfaces.len(),
        });
    }
    let bins = expected.of(0).len();
    for (r, fluxes) in surfaces.iter().enumerate() {
        check_fluxes("the model", expected.of(r), bins)?;
        check_fluxes(&format!("surface {r}"), fluxes, bins)?;
    }
    Ok(())
}

fn check_fluxes(what: &str, fluxes: &[f64], bins: usize) -> Result<(), ComparisonError> {
    check_length(what, fluxes.len(), bins)?;
    match fluxes.iter().position(|flux| !flux.is_finite()) {
        None => Ok(()),
        Some(bin) => Err(ComparisonError::NotFinite {
            what: what.to_owned(),
            bin,
            value: fluxes[bin],
        }),
    }
}

/// Checks that a list has the length of the model's.
pub(crate) fn check_length(
    what: &str,
    found: usize,
    expected: usize,
) -> Result<(), ComparisonError> {
    if found == expected {
        Ok(())
    } else {
        Err(ComparisonError::BinCount {
            what: what.to_owned(),
            found,
            expected,
        })
    }
}
