//! Participating medium: absorption, scattering and phase function.

use serde::{Deserialize, Serialize};

use crate::phase::PhaseFunction;

/// A homogeneous participating medium.
///
/// Held as extinction and albedo, lengths in the unit of the surface above it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParticipatingMedium {
    extinction: f64,
    albedo: f64,
    phase: PhaseFunction,
}

/// Error of an invalid medium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParticipatingMediumError {
    /// A coefficient is negative or not finite.
    #[error(
        "the {name} coefficient is {value:?}; it must be zero, or from 1e-150 to 1e150, in 1 / length"
    )]
    BadCoefficient {
        /// Absorption or scattering.
        name: &'static str,
        /// The given value.
        value: f64,
    },
    /// The mean free path is out of range.
    #[error("the mean free path is {0:?}; it must be a length from 1e-150 to 1e150")]
    BadMeanFreePath(f64),
    /// The albedo is out of range.
    #[error("the albedo is {0:?}; it must be from 0 to 1")]
    BadAlbedo(f64),
}

impl ParticipatingMedium {
    /// A medium of `absorption` and `scattering` coefficients, each per length.
    ///
    /// # Errors
    /// [`ParticipatingMediumError::BadCoefficient`] unless each is zero, or from 1e-150 to 1e150.
    pub fn from_coefficients(
        absorption: f64,
        scattering: f64,
        phase: PhaseFunction,
    ) -> Result<Self, ParticipatingMediumError> {
        for (name, value) in [("absorption", absorption), ("scattering", scattering)] {
            if value != 0.0 && !(1.0 / MAX_LENGTH..=MAX_LENGTH).contains(&value) {
                return Err(ParticipatingMediumError::BadCoefficient { name, value });
            }
        }
        let extinction = absorption + scattering;
        Ok(Self {
            extinction,
            albedo: if extinction > 0.0 {
                scattering / extinction
            } else {
                0.0
            },
            phase,
        })
    }

    /// A medium of the given mean free path, in which a fraction `albedo` of interactions scatters and
    /// the rest absorbs.
    ///
    /// # Errors
    /// [`ParticipatingMediumError`] unless `1e-150 <= mean_free_path <= 1e150` and `0 <= albedo <= 1`.
    pub fn from_mean_free_path(
        mean_free_path: f64,
        albedo: f64,
        phase: PhaseFunction,
    ) -> Result<Self, ParticipatingMediumError> {
        if !(1.0 / MAX_LENGTH..=MAX_LENGTH).contains(&mean_free_path) {
            return Err(ParticipatingMediumError::BadMeanFreePath(mean_free_path));
        }
        if !(0.0..=1.0).contains(&albedo) {
            return Err(ParticipatingMediumError::BadAlbedo(albedo));
        }
        Ok(Self {
            extinction: 1.0 / mean_free_path,
            albedo,
            phase,
        })
    }

    /// Absorption and scattering together, per length.
    #[must_use]
    pub const fn extinction(&self) -> f64 {
        self.extinction
    }

    /// Mean distance between interactions; infinite in a clear medium.
    #[must_use]
    pub fn mean_free_path(&self) -> f64 {
        1.0 / self.extinction
    }

    /// Single-scattering albedo, `[0, 1]`.
    #[must_use]
    pub const fn albedo(&self) -> f64 {
        self.albedo
    }

    /// Phase function.
    #[must_use]
    pub const fn phase(&self) -> PhaseFunction {
        self.phase
    }

    /// Returns `true` if the medium neither absorbs nor scatters.
    #[must_use]
    pub const fn is_clear(&self) -> bool {
        self.extinction == 0.0
    }
}

/// Largest and, inverted, smallest length: squares of it are finite.
const MAX_LENGTH: f64 = 1e150;

#[cfg(test)]
mod tests {
    use super::*;

    const PHASE: PhaseFunction = PhaseFunction::Isotropic;

    #[test]
    fn mean_free_path_and_coefficients_agree() {
        let by_path = ParticipatingMedium::from_mean_free_path(0.5, 0.75, PHASE).unwrap();
        let by_coefficients = ParticipatingMedium::from_coefficients(0.5, 1.5, PHASE).unwrap();
        assert_eq!(by_path, by_coefficients);
        assert_eq!(by_path.mean_free_path(), 0.5);
    }

    #[test]
    fn medium_without_interactions_is_clear() {
        let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PHASE).unwrap();
        assert!(clear.is_clear() && clear.mean_free_path().is_infinite());
    }

    #[test]
    fn invalid_media_are_refused() {
        let coefficients =
            |a, s| ParticipatingMedium::from_coefficients(a, s, PHASE).map_err(|e| e.to_string());
        assert!(coefficients(-1.0, 1.0).unwrap_err().contains("absorption"));
        assert!(coefficients(1.0, -1e-9).unwrap_err().contains("scattering"));
        assert!(coefficients(1.0, f64::NAN).is_err());
        assert!(coefficients(5e-324, 0.0).is_err());
        for (path, albedo) in [(0.0, 0.5), (-1.0, 0.5), (1.0, 1.01), (1.0, -0.1)] {
            assert!(ParticipatingMedium::from_mean_free_path(path, albedo, PHASE).is_err());
        }
    }
}
