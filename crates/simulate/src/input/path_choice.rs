//! Path choice: how paths branch and end, as far as that is named, and what may be chosen where it is not.

use asperity_optics::Material;
use asperity_tracer::{Branching, PathSettings, PathSettingsError, Polarisation};

/// Roulette thresholds that a pilot run tries, after the default.
const THRESHOLDS: [f64; 2] = [0.1, 0.3];

/// Path choice: branching and roulette threshold, as far as they are named.
///
/// With a target error, a pilot run chooses the rest, which brings the error of the target quantity
/// down at the least cost. Otherwise the rest is as in [`PathSettings::default`], which serves totals: both branches,
/// with a low roulette threshold.
///
/// # Examples
/// ```
/// use asperity_simulate::PathChoice;
/// use asperity_tracer::{Branching, PathSettings};
///
/// let free = PathChoice::default();
/// assert_eq!(free.without_pilot(), PathSettings::default());
/// let pick = PathChoice::new(Some(Branching::Pick), None, 1000)?;
/// assert_eq!(pick.without_pilot().branching(), Branching::Pick);
/// # Ok::<(), asperity_tracer::PathSettingsError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathChoice {
    branching: Option<Branching>,
    roulette: Option<f64>,
    without_pilot: PathSettings,
}

impl PathChoice {
    /// Choice by branching and roulette threshold; `None` leaves either free. `max_order`: as of
    /// [`PathSettings::new`].
    ///
    /// # Errors
    /// [`PathSettingsError`] as of [`PathSettings::new`].
    pub fn new(
        branching: Option<Branching>,
        roulette: Option<f64>,
        max_order: u32,
    ) -> Result<Self, PathSettingsError> {
        let threshold = roulette.unwrap_or(PathSettings::DEFAULT_ROULETTE);
        Ok(Self {
            branching,
            roulette,
            without_pilot: PathSettings::new(branching.unwrap_or_default(), threshold, max_order)?,
        })
    }

    /// The choice with another treatment of polarisation.
    #[must_use]
    pub const fn with_polarisation(self, polarisation: Polarisation) -> Self {
        Self {
            without_pilot: self.without_pilot.with_polarisation(polarisation),
            ..self
        }
    }

    /// The paths that are followed unless a pilot run chooses others.
    #[must_use]
    pub const fn without_pilot(&self) -> PathSettings {
        self.without_pilot
    }

    /// Further paths that may serve a surface of `material` better.
    pub(crate) fn alternatives(&self, material: Material) -> Vec<PathSettings> {
        let mut found = Vec::new();
        let first = self.without_pilot;
        let splits = first.branching() == Branching::Split;
        if self.roulette.is_none() && splits && material != Material::Mirror {
            let with = |threshold| first.with(Branching::Split, threshold);
            found.extend(THRESHOLDS.map(with));
        }
        if self.branching.is_none() && material.transmitting_index().is_some() {
            found.push(first.with(Branching::Pick, first.roulette()));
        }
        found
    }
}

impl From<PathSettings> for PathChoice {
    /// Nothing is left to choose.
    fn from(paths: PathSettings) -> Self {
        Self {
            branching: Some(paths.branching()),
            roulette: Some(paths.roulette()),
            without_pilot: paths,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alternatives(choice: PathChoice, material: Material) -> Vec<(Branching, f64)> {
        let found = choice.alternatives(material).into_iter();
        found.map(|p| (p.branching(), p.roulette())).collect()
    }

    #[test]
    fn only_paths_that_are_not_named_and_differ_are_alternatives() {
        let glass = Material::dielectric(1.5).unwrap();
        let gold = Material::conductor(0.2, 3.9).unwrap();
        let split = |threshold: f64| (Branching::Split, threshold);
        let pick = |threshold: f64| (Branching::Pick, threshold);
        let choice = |branching, roulette| PathChoice::new(branching, roulette, 1000).unwrap();
        let free = PathChoice::default();
        assert_eq!(free, choice(None, None));
        assert_eq!(
            alternatives(free, glass),
            [split(0.1), split(0.3), pick(0.01)]
        );
        assert_eq!(alternatives(free, gold), [split(0.1), split(0.3)]);
        assert_eq!(alternatives(free, Material::Mirror), []);
        let of_split = choice(Some(Branching::Split), None);
        assert_eq!(alternatives(of_split, glass), [split(0.1), split(0.3)]);
        assert_eq!(alternatives(choice(None, Some(0.2)), glass), [pick(0.2)]);
        let of_pick = choice(Some(Branching::Pick), None);
        assert_eq!(alternatives(of_pick, glass), []);
        let named = PathChoice::from(PathSettings::default());
        assert_eq!(alternatives(named, glass), []);
    }
}
