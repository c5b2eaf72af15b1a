//! The error that a run is to reach, and the quantity whose error it is.

use std::fmt;
use std::str::FromStr;

use asperity_optics::{Layer, Material};
use asperity_tally::{
    Component, Entry, Side, TallyResult, TallySpec, TallyStatistics, TallyValues,
};
use serde::{Deserialize, Serialize};

/// Error of an invalid target.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TargetError {
    /// The error is not positive and finite.
    #[error("the target error is {0}; it must be above 0")]
    NotPositive(f64),
    /// A quantity without an error to reach.
    #[error("of = {0} names the quantity of a target error, but no target error is given")]
    NoError(Quantity),
    /// A quantity that the case does not have.
    #[error("{reason}, so it cannot be the quantity of a target")]
    NoSuchFlux {
        /// Reason.
        reason: &'static str,
    },
}

/// The quantity of a target error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// All that is reflected; its error is the standard error of that flux fraction.
    Reflected,
    /// All that is transmitted, likewise.
    Transmitted,
    /// All that is absorbed, likewise.
    Absorbed,
    /// The bins of the hemispheres that are recorded. The error of several fluxes `q` with standard
    /// errors `se` is relative, `sqrt(sum se^2) / sqrt(sum q^2)`.
    #[default]
    Bins,
    /// The rings of equal polar angle, likewise.
    Rings,
    /// The bins about the plane of incidence, likewise.
    InPlane,
}

impl Quantity {
    const ALL: [(Self, &'static str); 6] = [
        (Self::Reflected, "reflected"),
        (Self::Transmitted, "transmitted"),
        (Self::Absorbed, "absorbed"),
        (Self::Bins, "bins"),
        (Self::Rings, "rings"),
        (Self::InPlane, "in-plane"),
    ];

    /// The entries of its fluxes.
    #[must_use]
    pub fn entries(self, spec: &TallySpec) -> Vec<Entry> {
        let all = Component::All;
        match self {
            Self::Reflected => vec![TallySpec::BUDGET.reflected],
            Self::Transmitted => vec![TallySpec::BUDGET.transmitted],
            Self::Absorbed => vec![TallySpec::BUDGET.absorbed],
            Self::Bins => spec.recorded_entries(all).iter().collect(),
            Self::Rings => spec
                .sides()
                .flat_map(|s| spec.ring_entries(s, all))
                .collect(),
            Self::InPlane => spec
                .sides()
                .flat_map(|s| spec.in_plane_entries(s, all))
                .collect(),
        }
    }

    const fn is_total(self) -> bool {
        matches!(self, Self::Reflected | Self::Transmitted | Self::Absorbed)
    }

    /// Norm by which errors are divided, given the sum of squares of the fluxes.
    #[must_use]
    pub fn norm(self, square: f64) -> f64 {
        if self.is_total() { 1.0 } else { square.sqrt() }
    }

    /// The error that `statistics` have; `None` where they have none.
    #[must_use]
    pub fn error(self, statistics: &TallyStatistics) -> Option<f64> {
        let [mut squares, mut errors] = [0.0; 2];
        for entry in self.entries(statistics.spec()) {
            let estimate = statistics.at(entry);
            squares += estimate.mean.powi(2);
            errors += estimate.se?.powi(2);
        }
        Some(ratio(errors.sqrt(), self.norm(squares)))
    }

    /// The error of fluxes which together differ from the true ones by the flux `bound` at most.
    #[must_use]
    pub fn error_within(self, fluxes: &TallyValues, bound: f64) -> f64 {
        if self.is_total() {
            return bound;
        }
        let entries = self.entries(fluxes.spec()).into_iter();
        let squares = entries.map(|entry| fluxes[entry].powi(2));
        // What is lost here is gained there.
        ratio(std::f64::consts::SQRT_2 * bound, self.norm(squares.sum()))
    }

    /// Refuses a quantity that the material does not have, or whose side is not recorded.
    fn check(
        self,
        spec: &TallySpec,
        material: Material,
        layers: &[Layer],
    ) -> Result<(), TargetError> {
        let reason = match (self, material) {
            (Self::Transmitted, _) if material.transmitting_index().is_none() => {
                "nothing is transmitted by a conductor or a mirror"
            }
            (Self::Transmitted, _) if !layers.iter().all(Layer::transmits) => {
                "nothing leaves below this medium"
            }
            (Self::Absorbed, _)
                if layers.is_empty() && !material.absorbs() && !material.is_diffuse() =>
            {
                "nothing is absorbed by a dielectric or a mirror"
            }
            (Self::Reflected, _) if !spec.records(Side::Reflected) => {
                "the side reflected is not recorded"
            }
            (Self::Transmitted, _) if !spec.records(Side::Transmitted) => {
                "the side transmitted is not recorded"
            }
            _ => return Ok(()),
        };
        Err(TargetError::NoSuchFlux { reason })
    }
}

/// `error / norm`; nothing has no error.
pub(crate) fn ratio(error: f64, norm: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / norm }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(aim, _)| aim == self);
        f.write_str(name.map_or("", |(_, name)| name))
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(_, name)| *name == text);
        found.map(|(aim, _)| *aim).ok_or_else(|| {
            format!(
                "unknown quantity `{text}`; allowed are reflected, transmitted, absorbed, bins, rings and in-plane"
            )
        })
    }
}

/// An error to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    error: f64,
    of: Quantity,
}

impl Target {
    /// The error `error` of `of`.
    ///
    /// # Errors
    /// [`TargetError::NotPositive`] unless the error is positive and finite.
    pub fn new(error: f64, of: Quantity) -> Result<Self, TargetError> {
        if error > 0.0 && error.is_finite() {
            Ok(Self { error, of })
        } else {
            Err(TargetError::NotPositive(error))
        }
    }

    /// The target of two optional settings; `None` if neither is given. The quantity has a default.
    ///
    /// # Errors
    /// [`TargetError`] as for [`Target::new`], and if a quantity is named without an error.
    pub fn from_options(
        error: Option<f64>,
        of: Option<Quantity>,
    ) -> Result<Option<Self>, TargetError> {
        match (error, of) {
            (None, None) => Ok(None),
            (None, Some(of)) => Err(TargetError::NoError(of)),
            (Some(error), of) => Self::new(error, of.unwrap_or_default()).map(Some),
        }
    }

    /// The error.
    #[must_use]
    pub const fn error(&self) -> f64 {
        self.error
    }

    /// Quantity of the error.
    #[must_use]
    pub const fn of(&self) -> Quantity {
        self.of
    }

    /// Refuses a target that no result of `material` over `layer`, recorded by `spec`, has.
    ///
    /// # Errors
    /// [`TargetError`].
    pub fn check(
        &self,
        spec: &TallySpec,
        material: Material,
        layers: &[Layer],
    ) -> Result<(), TargetError> {
        self.of.check(spec, material, layers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_bins_are_relative_and_those_of_totals_absolute() {
        let spec = TallySpec::new("2x1".parse().unwrap(), 0.1).unwrap();
        let tally = |x: f64| {
            let mut tally = TallyValues::zeros(spec);
            tally[TallySpec::BUDGET.reflected] = x;
            tally[spec.grid_entries(Component::All).get(0)] = x;
            tally
        };
        let mut statistics = TallyStatistics::new(spec);
        statistics.push(&tally(0.1));
        assert_eq!(Quantity::Bins.error(&statistics), None);
        statistics.push(&tally(0.3));
        // Mean 0.2, standard error 0.1.
        let error = |aim: Quantity| aim.error(&statistics).unwrap();
        assert!((error(Quantity::Reflected) - 0.1).abs() < 1e-12);
        assert!((error(Quantity::Bins) - 0.5).abs() < 1e-12);
        assert_eq!(error(Quantity::Rings), 0.0);
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        for (aim, name) in Quantity::ALL {
            assert_eq!(name.parse(), Ok(aim));
            assert_eq!(aim.to_string(), name);
            assert_eq!(serde_json::to_value(aim).unwrap(), name);
        }
        assert!("ring".parse::<Quantity>().unwrap_err().contains("in-plane"));
    }
}
