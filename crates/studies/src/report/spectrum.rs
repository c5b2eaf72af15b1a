//! Spectrum: reflectance, transmittance, absorptance and emissivity against wavelength.
//!
//! Kirchhoff's law makes the emissivity of an opaque body into a direction its absorptance from there: 1 less its directional-hemispherical
//! reflectance.

use std::collections::BTreeMap;

use asperity_simulate::{Case, CaseGroup, CasePart, Outcome, short};
use asperity_tally::{Component, Estimate, Side, TallyResult};

use crate::output::EstimateWithLimit;
use crate::report::flux_basis::FluxBasis;

/// Sentence on the emissivity, for reports.
pub(crate) const EMISSIVITY: &str = "emissivity is 1 less the directional-hemispherical reflectance of an opaque body at the angle of incidence, by Kirchhoff's law";

/// A quantity of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Reflectance,
    Transmittance,
    Absorptance,
}

impl Quantity {
    pub(crate) const ALL: [Self; 3] = [Self::Reflectance, Self::Transmittance, Self::Absorptance];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Transmittance => "transmittance",
            Self::Absorptance => "absorptance",
        }
    }

    pub(crate) const fn about(self) -> &'static str {
        match self {
            Self::Reflectance => "directional-hemispherical reflectance",
            Self::Transmittance => "directional-hemispherical transmittance",
            Self::Absorptance => "absorbed fraction of the light",
        }
    }

    /// The quantity of a result; `None` where it is not recorded.
    pub(crate) fn of(self, outcome: &Outcome) -> Option<EstimateWithLimit> {
        let (basis, statistics) = (FluxBasis::of(outcome), &outcome.statistics);
        let side = match self {
            Self::Reflectance => Side::Reflected,
            Self::Transmittance => Side::Transmitted,
            Self::Absorptance => return Some(basis.absorbed(statistics.budget().absorbed)),
        };
        let is_recorded = statistics.spec().records(side);
        is_recorded.then(|| basis.flux(side, statistics.flux(side, Component::All)))
    }
}

/// Emissivity of an opaque body, into the direction that unpolarised light comes from; `None` of another, or where reflected light is not recorded.
pub(crate) fn emissivity(outcome: &Outcome) -> Option<Estimate> {
    let reflected = Quantity::Reflectance.of(outcome)?.estimate();
    let is_unpolarised = outcome.case.light.stokes == [0.0; 3];
    (!outcome.case.transmits() && is_unpolarised).then_some(Estimate {
        mean: 1.0 - reflected.mean,
        se: reflected.se,
    })
}

/// Place of the wavelengths among the nested lists whose combinations are the cases of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wavelengths {
    /// Number of wavelengths.
    count: usize,
    /// Successive cases of one wavelength.
    stride: usize,
}

impl Wavelengths {
    /// The wavelengths of all cases that are planned, in their order; `None` without any.
    pub(crate) fn of<'c>(cases: impl IntoIterator<Item = &'c Case>) -> Option<Self> {
        let all = cases.into_iter().map(|case| case.at.wavelength_nm());
        let all: Vec<f64> = all.collect::<Option<_>>()?;
        let first = *all.first()?;
        let stride = all.iter().take_while(|one| **one == first).count();
        let mut distinct: Vec<u64> = all.iter().map(|one| one.to_bits()).collect();
        distinct.sort_unstable();
        distinct.dedup();
        Some(Self {
            count: distinct.len(),
            stride,
        })
    }

    /// Returns `true` if there are several.
    pub(crate) const fn are_several(self) -> bool {
        self.count > 1
    }

    /// Number of the first of the cases that differ from that of a `number` in the wavelength alone.
    const fn first(self, number: usize) -> usize {
        let block = self.stride * self.count;
        number / block * block + number % self.stride
    }
}

/// Results that differ in the wavelength alone, in its order.
pub(crate) struct Spectrum<'a> {
    /// Words for what its results have in common, quantity by quantity.
    parts: Vec<String>,
    results: Vec<(f64, &'a Outcome)>,
}

/// The spectra among results, of two wavelengths or more.
pub(crate) fn spectra<'a>(
    wavelengths: Option<Wavelengths>,
    outcomes: impl IntoIterator<Item = &'a Outcome>,
) -> Vec<Spectrum<'a>> {
    let mut found: BTreeMap<usize, Vec<(f64, &'a Outcome)>> = BTreeMap::new();
    for outcome in outcomes {
        if let (Some(all), Some(nm)) = (wavelengths, outcome.case.at.wavelength_nm()) {
            let results = found.entry(all.first(outcome.number)).or_default();
            results.push((nm, outcome));
        }
    }
    let several = found.into_values().filter(|results| results.len() > 1);
    let spectra = several.map(|mut results| {
        results.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Spectrum {
            parts: common_parts(&results),
            results,
        }
    });
    spectra.collect()
}

/// The parts of the cases in words that all results have in common, and the direction of the light.
fn common_parts(results: &[(f64, &Outcome)]) -> Vec<String> {
    let parts = |outcome: &Outcome| {
        let mut parts = outcome.case.setting_parts();
        parts.retain(|part| part.group != CaseGroup::Light || part.value != "from above");
        parts
    };
    let mut common = parts(results[0].1);
    for (_, outcome) in results {
        let others = parts(outcome);
        common.retain(|part| others.contains(part));
    }
    let common = common.iter().map(CasePart::text);
    let incidence = results[0].1.case.light.incidence;
    let [theta, phi] = [incidence.theta_deg(), incidence.phi_deg()].map(short);
    let light = [format!("theta = {theta} deg"), format!("phi = {phi} deg")];
    common.chain(light).collect()
}

impl Spectrum<'_> {
    /// Words for what its results have in common.
    pub(crate) fn label(&self) -> String {
        self.parts.join(", ")
    }

    /// The parts of its label that `others` have too, or those that they have not.
    pub(crate) fn label_beside(&self, others: &[Spectrum<'_>], is_shared: bool) -> String {
        let parts = self.parts.iter();
        let parts = parts.filter(|part| {
            let mut others = others.iter();
            others.all(|other| other.parts.contains(part)) == is_shared
        });
        parts.map(String::as_str).collect::<Vec<_>>().join(", ")
    }

    /// Returns `true` if most of its results are of visible light.
    pub(crate) fn is_visible(&self) -> bool {
        let visible = self
            .results
            .iter()
            .filter(|(nm, _)| (380.0..=750.0).contains(nm));
        2 * visible.count() > self.results.len()
    }

    /// Wavelengths, and the flux that leaves on `side`, where it is recorded.
    pub(crate) fn side(&self, side: Side) -> impl Iterator<Item = (f64, Estimate)> {
        let quantity = match side {
            Side::Reflected => Quantity::Reflectance,
            Side::Transmitted => Quantity::Transmittance,
        };
        self.values(quantity)
    }

    /// Wavelengths, and the values of a quantity, where it is recorded.
    pub(crate) fn values(&self, quantity: Quantity) -> impl Iterator<Item = (f64, Estimate)> {
        let results = self.results.iter();
        results.filter_map(move |(wavelength, outcome)| {
            Some((*wavelength, quantity.of(outcome)?.estimate()))
        })
    }
}

/// The results of spectra, one after the other.
pub(crate) fn results_of<'a>(spectra: &[Spectrum<'a>]) -> Vec<&'a Outcome> {
    let results = spectra.iter().flat_map(|spectrum| &spectrum.results);
    results.map(|(_, outcome)| *outcome).collect()
}

/// A weighted sum of estimates that share rays or surfaces: errors add.
pub(crate) fn weighted_sum(parts: impl IntoIterator<Item = (f64, Estimate)>) -> Estimate {
    let none = Estimate {
        mean: 0.0,
        se: Some(0.0),
    };
    parts.into_iter().fold(none, |sum, (weight, one)| Estimate {
        mean: sum.mean + weight * one.mean,
        se: sum.se.zip(one.se).map(|(sum, se)| sum + weight.abs() * se),
    })
}
