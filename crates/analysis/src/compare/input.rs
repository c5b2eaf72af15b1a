//! Input of a comparison: the fluxes that a model expects, and checks of all lists.

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

/// Why a comparison is impossible.
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
    enough: &[bool],
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
    let rays = || "the list of bins with enough rays".to_owned();
    check_length(rays, enough.len(), bins)?;
    for (r, fluxes) in surfaces.iter().enumerate() {
        check_fluxes(|| "the model".to_owned(), expected.of(r), bins)?;
        check_fluxes(|| format!("surface {r}"), fluxes, bins)?;
    }
    Ok(())
}

fn check_fluxes(
    what: impl Fn() -> String,
    fluxes: &[f64],
    bins: usize,
) -> Result<(), ComparisonError> {
    check_length(&what, fluxes.len(), bins)?;
    match fluxes.iter().position(|flux| !flux.is_finite()) {
        None => Ok(()),
        Some(bin) => Err(ComparisonError::NotFinite {
            what: what(),
            bin,
            value: fluxes[bin],
        }),
    }
}

fn check_length(
    what: impl Fn() -> String,
    found: usize,
    expected: usize,
) -> Result<(), ComparisonError> {
    if found == expected {
        Ok(())
    } else {
        Err(ComparisonError::BinCount {
            what: what(),
            found,
            expected,
        })
    }
}
