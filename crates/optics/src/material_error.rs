//! Material errors: the ranges of indices and thin films, and the errors of values outside of them.

/// Error of an invalid material.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// The relative index is out of range.
    #[error("eta is {0:?}; the relative refractive index must be from 1e-6 to 1e6")]
    BadEta(f64),
    /// The absorption index is out of range.
    #[error("kappa is {0:?}; the absorption index must be from 0 to 1e6")]
    BadKappa(f64),
    /// The reflectance is out of range.
    #[error("reflectance is {0:?}; the reflectance of a facet must be from 0 to 1")]
    BadReflectance(f64),
    /// The stack has too many thin films.
    #[error("{0} thin films are too many; at most {max} are allowed", max = MAX_FILMS)]
    TooManyFilms(usize),
    /// The phase of a thin film is out of range.
    #[error("the phase 2 pi d / lambda of a thin film is {0:?}; it must be from 0 to {max:e}", max = MAX_FILM_PHASE)]
    BadPhase(f64),
}

/// Most thin films on an interface.
pub(crate) const MAX_FILMS: usize = 8;

/// Largest phase of a thin film, radians: phases keep ten digits.
pub(crate) const MAX_FILM_PHASE: f64 = 1e6;

/// Largest index, far above that of any matter: squares of it and of its inverse stay exact enough.
const MAX_INDEX: f64 = 1e6;

pub(crate) fn valid_eta(eta: f64) -> Result<f64, MaterialError> {
    if (1.0 / MAX_INDEX..=MAX_INDEX).contains(&eta) {
        Ok(eta)
    } else {
        Err(MaterialError::BadEta(eta))
    }
}

pub(crate) fn valid_kappa(kappa: f64) -> Result<f64, MaterialError> {
    if (0.0..=MAX_INDEX).contains(&kappa) {
        Ok(kappa)
    } else {
        Err(MaterialError::BadKappa(kappa))
    }
}
