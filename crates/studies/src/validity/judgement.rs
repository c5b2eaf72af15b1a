//! Judgement: numbers of a case that must be large, and whether they are.

use std::f64::consts::PI;

use asperity_numerics::elementary::cos;
use asperity_optics::Material;
use asperity_simulate::{Case, SurfaceSource};
use asperity_surface::LengthUnit;
use asperity_tally::{Side, TallySpec};
use serde::Serialize;

use super::coherence::{Coherence, Components};
use crate::surface_lengths::SurfaceLengths;

/// The wavelength unless one is given, in nanometres: the middle of visible light.
pub const DEFAULT_WAVELENGTH_NM: f64 = 550.0;

/// Least value of each number. A phase of 3 leaves 1.2e-4 of the light coherent.
pub const LARGE: f64 = 3.0;

/// Coherent fraction of the light of a side from which on a report begins with it.
pub(super) const MUCH: f64 = 0.01;

/// Lengths of a surface against the wavelength, for one direction of the light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Validity {
    /// Wavelength of the light in vacuum, nanometres.
    pub wavelength_nm: f64,
    /// `true` if it is assumed, none being given.
    pub wavelength_is_assumed: bool,
    /// Light that the surface reflects, none of it coherent if facets are Lambertian; `None` where the side is not recorded. Its phase is the
    /// Rayleigh parameter, `4 pi sigma n_i cos(theta) / lambda`.
    pub reflected: Option<Coherence>,
    /// Light that is transmitted, through a layer without being scattered inside; `None` where there is none or the side is not recorded.
    pub transmitted: Option<Coherence>,
    /// Light that the bottom of a layer reflects and that leaves without being scattered inside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflected_by_bottom: Option<Coherence>,
    /// The shorter correlation length over the wavelength; `None` where the surface has none.
    pub tau_over_wavelength: Option<f64>,
    /// `R cos^3(theta) / lambda`, R being one over the root mean square second derivative along the more curved axis;
    /// `None` for a surface without curvature, or where it is not known.
    pub curvature_radius_over_wavelength: Option<f64>,
    /// `true` if all of them are at least [`LARGE`] and no component is coherent by more than 1 %; `None` where that holds of those that are
    /// known, and others are not known.
    pub holds: Option<bool>,
}

impl Validity {
    /// For the light of a case on a surface of these lengths, whose layer ends on a surface of the lengths `bottom` if that is one of its own;
    /// `None` if their unit is not known, or the surface is flat. `wavelength_nm`: [`DEFAULT_WAVELENGTH_NM`] without one.
    #[must_use]
    pub fn new(
        lengths: &SurfaceLengths,
        bottom: Option<&SurfaceLengths>,
        case: &Case,
        spec: &TallySpec,
        wavelength_nm: Option<f64>,
    ) -> Option<Self> {
        let wavelength_nm = case.at.wavelength_nm().or(wavelength_nm);
        let nanometres = wavelength_nm.unwrap_or(DEFAULT_WAVELENGTH_NM);
        let above = nanometres / case.at.index_above.unwrap_or(1.0);
        let wavelength = LengthUnit::Nanometre.conversion(lengths.unit)?(above);
        if lengths.sigma == 0.0 {
            return None;
        }
        let all = Components::of(lengths, bottom, case, 2.0 * PI / wavelength);
        let recorded = |side| spec.records(side);
        let reflected = all.reflected.filter(|_| recorded(Side::Reflected));
        let reflected = reflected.map(|reflected| match case.material {
            Material::Lambertian { .. } => Coherence {
                coherent_fraction: 0.0,
                ..reflected
            },
            _ => reflected,
        });
        let transmitted = all.transmitted.filter(|_| recorded(Side::Transmitted));
        let reflected_by_bottom = all.by_bottom.filter(|_| recorded(Side::Reflected));
        let cos = cos(case.light.incidence.theta());
        let tau = lengths.tau.map(|tau| tau / wavelength);
        let curvature = lengths.curvature.filter(|curvature| *curvature > 0.0);
        let radius = curvature.map(|curvature| cos.powi(3) / (curvature * wavelength));
        let mut validity = Self {
            wavelength_nm: nanometres,
            wavelength_is_assumed: wavelength_nm.is_none(),
            reflected,
            transmitted,
            reflected_by_bottom,
            tau_over_wavelength: tau,
            curvature_radius_over_wavelength: radius,
            holds: None,
        };
        let is_doubtful = validity.least() < LARGE || validity.is_coherent();
        // A surface without curvature has no radius to fall short.
        let is_complete = tau.is_some() && lengths.curvature.is_some();
        validity.holds = (is_doubtful || is_complete).then_some(!is_doubtful);
        Some(validity)
    }

    /// For the light of a case on random surfaces; `None` on given ones, and as of [`Self::new`].
    pub(crate) fn of_random(
        case: &Case,
        spec: &TallySpec,
        wavelength_nm: Option<f64>,
    ) -> Option<Self> {
        let SurfaceSource::Random(surfaces) = &case.surface else {
            return None;
        };
        // Heights without a unit need not be drawn
        let is_known = LengthUnit::Nanometre.conversion(case.at.unit).is_some();
        let lengths = is_known.then(|| SurfaceLengths::of_random(surfaces, case.at.unit))?;
        Self::new(&lengths, None, case, spec, wavelength_nm)
    }

    /// The least of all numbers that are known.
    pub(super) fn least(&self) -> f64 {
        let lengths = [
            self.tau_over_wavelength,
            self.curvature_radius_over_wavelength,
        ];
        lengths
            .into_iter()
            .flatten()
            .fold(self.least_phase(), f64::min)
    }

    /// The least phase of a side.
    pub(crate) fn least_phase(&self) -> f64 {
        let phases = self.components().map(|one| one.phase_parameter);
        phases.fold(f64::INFINITY, f64::min)
    }

    /// Returns `true` if much of a component is coherent.
    pub(super) fn is_coherent(&self) -> bool {
        self.components().any(|one| one.coherent_fraction > MUCH)
    }

    fn components(&self) -> impl Iterator<Item = Coherence> {
        let all = [self.reflected, self.transmitted, self.reflected_by_bottom];
        all.into_iter().flatten()
    }
}
