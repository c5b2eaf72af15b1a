//! Spectrum: reflectance, transmittance, absorptance and emissivity against wavelength.
//!
//! Kirchhoff's law makes the emissivity of an opaque body into a direction its absorptance from there: 1 less its directional-hemispherical
//! reflectance.

use asperity_simulate::{Case, Outcome, short};
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

/// Returns `true` if no light comes through the body below a surface.
fn is_opaque(case: &Case) -> bool {
    match case.layer {
        Some(below) => !below.layer.transmits(),
        None => case.material.transmitting_index().is_none(),
    }
}

/// Emissivity of an opaque body, into the direction that light comes from; `None` of another, or where reflected light is not recorded.
pub(crate) fn emissivity(outcome: &Outcome) -> Option<Estimate> {
    let reflected = Quantity::Reflectance.of(outcome)?.estimate();
    is_opaque(&outcome.case).then_some(Estimate {
        mean: 1.0 - reflected.mean,
        se: reflected.se,
    })
}

/// Results that differ in the wavelength alone, in its order.
pub(crate) struct Spectrum<'a> {
    /// What they share, in words.
    label: String,
    results: Vec<(f64, &'a Outcome)>,
}

/// The spectra among results, of two wavelengths or more.
pub(crate) fn spectra<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Vec<Spectrum<'a>> {
    let mut spectra: Vec<Spectrum<'a>> = Vec::new();
    for outcome in outcomes {
        let Some(wavelength) = outcome.case.at.wavelength_nm() else {
            continue;
        };
        let label = label(&outcome.case);
        let known = spectra.iter_mut().find(|spectrum| spectrum.label == label);
        match known {
            Some(spectrum) => spectrum.results.push((wavelength, outcome)),
            None => spectra.push(Spectrum {
                label,
                results: vec![(wavelength, outcome)],
            }),
        }
    }
    spectra.retain(|spectrum| spectrum.results.len() > 1);
    for spectrum in &mut spectra {
        spectrum.results.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    }
    spectra
}

/// A case in words without its wavelength, and without the absorption of a body, which follows from that.
fn label(case: &Case) -> String {
    let mut without = case.clone();
    without.at.others.clear();
    let medium = without.layer.map(|below| below.layer.medium());
    let is_body = medium.is_some_and(|medium| medium.albedo() == 0.0);
    let parts = without.setting_parts().into_iter();
    let parts = parts.filter(|part| !(is_body && BODY.contains(&part.name.as_str())));
    let parts: Vec<String> = parts.map(|part| part.text()).collect();
    let incidence = case.light.incidence;
    let [theta, phi] = [incidence.theta_deg(), incidence.phi_deg()].map(short);
    format!("{}, theta = {theta} deg, phi = {phi} deg", parts.join(", "))
}

/// Quantities of a body that absorbs, by the names of their parts.
const BODY: [&str; 3] = ["mean free path", "albedo", "g"];

impl Spectrum<'_> {
    /// What its results share, in words.
    pub(crate) fn label(&self) -> &str {
        &self.label
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
