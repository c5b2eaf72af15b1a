//! Hemispherical energies by integration over facet slopes.
//!
//! Equal energies follow from the bins of [`crate::bin_fluxes`]. Here they are computed independently, with
//! facet slopes `(p, q)` as variables, `m ~ (p, q, 1)`, `p` along the horizontal part of `wi`. All edges of the
//! integrand are conics in `(p, q)` with closed forms: where the facet turns away (a line), where total
//! reflection sets in, and where the light leaves horizontally (a circle). For the kinks of a model see
//! [`Kinks`].

use asperity_numerics::elementary::hypot;
use asperity_tally::{HemisphereGrid, Side};
use glam::{DVec2, DVec3};
use serde::Serialize;

use crate::integrals::flux::bin_fluxes_of;
use crate::integrals::slope_images::FacetLight;
use crate::integrals::tabulated::tabulated_energy;
use crate::microfacet::half_vector::{outgoing_direction, reflecting_facet, refracting_facet};
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slope_frame::SlopeFrame;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::BsdfModel;
use asperity_numerics::quadratic_roots;
use asperity_numerics::quadrature::{AllowedError, Breaks, Pieces, integrate};

/// Flux fractions that a model sends into the two hemispheres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HemisphericalEnergy {
    /// Back into the incident medium.
    pub reflected: f64,
    /// Into the medium behind the surface.
    pub transmitted: f64,
}

/// Largest slope, in units of the deviation times the root of two: the density there is `exp(-42)` of its peak.
const MAX_SLOPE: f64 = 6.5;

/// Error allowed in the integral over slopes.
const ROWS: AllowedError = AllowedError {
    absolute: 1e-300,
    relative: 1e-11,
};

/// The flux fractions that `model` sends into the two hemispheres, to about 1e-10 of their value.
///
/// `wi` is a unit vector with `z > 0`.
///
/// # Examples
/// ```
/// use asperity_analysis::{SlopeCovariance, closed_form, hemispherical_energy};
/// use asperity_optics::{Incidence, Material};
///
/// let slopes = SlopeCovariance::isotropic(3.0)?;
/// let model = closed_form("smith", slopes, Material::dielectric(1.4)?)?;
/// let energy = hemispherical_energy(model.as_ref(), Incidence::from_degrees(30.0, 0.0)?.wi());
/// // Multiple scattering is missing, so the energies add to less than one.
/// let lost = 1.0 - energy.reflected - energy.transmitted;
/// assert!(lost > 0.0 && lost < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn hemispherical_energy(model: &dyn BsdfModel, wi: DVec3) -> HemisphericalEnergy {
    if let Some(table) = model.tabulated() {
        let material = model.material();
        let of_side = |side| match model.sides().includes(side) {
            true => tabulated_energy(table, FacetLight { wi, material, side }),
            false => 0.0,
        };
        return HemisphericalEnergy {
            reflected: of_side(Side::Reflected),
            transmitted: of_side(Side::Transmitted),
        };
    }
    // GGX has facets beyond any slope, so directions are integrated over instead
    if matches!(model.slopes(), SlopeDistribution::Ggx { .. }) {
        let grid = HemisphereGrid::default();
        let fluxes = bin_fluxes_of(model, wi, &grid, model.sides());
        let (up, down) = fluxes.split_at(grid.bins_per_side());
        return HemisphericalEnergy {
            reflected: up.iter().sum(),
            transmitted: down.iter().sum(),
        };
    }
    let parts = model.parts();
    if !parts.is_empty() {
        let energies = parts.iter().map(|part| hemispherical_energy(*part, wi));
        let nothing = HemisphericalEnergy {
            reflected: 0.0,
            transmitted: 0.0,
        };
        return energies.fold(nothing, |sum, part| HemisphericalEnergy {
            reflected: sum.reflected + part.reflected,
            transmitted: sum.transmitted + part.transmitted,
        });
    }
    let reflected = over_slopes(model, wi, None);
    let transmitted = model
        .material()
        .transmitting_index()
        .filter(|_| model.sides().includes(Side::Transmitted))
        .map_or(0.0, |eta| over_slopes(model, wi, Some(eta)));
    HemisphericalEnergy {
        reflected,
        transmitted,
    }
}

/// The flux fraction of one side, refracting with the index `refracted` if given.
fn over_slopes(model: &dyn BsdfModel, wi: DVec3, refracted: Option<f64>) -> f64 {
    let edges = Edges::new(model, wi, refracted);
    over_facing_normals(&model.slopes().covariance(), wi, &edges, |m| {
        per_normal(model, wi, m, refracted)
    })
}

/// `int f(m) dOmega_m` over the normals of the facets that face `wi`, as `int f cos^3(theta_m) dp dq`,
/// to about 1e-11 of its value; `f` falls with the density of slopes.
pub(crate) fn over_facing_normals(
    slopes: &SlopeCovariance,
    wi: DVec3,
    edges: &Edges,
    per_normal: impl Fn(DVec3) -> f64,
) -> f64 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    let sin_i = hypot(wi.x, wi.y);
    let along = if sin_i > 0.0 {
        wi.truncate() / sin_i
    } else {
        DVec2::X
    };
    let frame = SlopeFrame::new(slopes, along);
    let mut row = Row::new(frame, edges);
    let mut largest_row = 0.0_f64;
    integrate(
        &breaks_along(&frame, wi, edges),
        ROWS.within(1000),
        &mut Pieces::default(),
        |p| {
            let value = row.integral(p, largest_row, &per_normal);
            largest_row = largest_row.max(value);
            value
        },
    )
}

/// Subdivision of the slopes `p` along the horizontal part of `wi`.
fn breaks_along(frame: &SlopeFrame, wi: DVec3, edges: &Edges) -> Breaks {
    let unit = (2.0 * frame.variance).sqrt();
    let largest = MAX_SLOPE * unit;
    let sin_i = hypot(wi.x, wi.y);
    let facing = if sin_i > 0.0 { -wi.z / sin_i } else { -largest };
    let mut breaks = Breaks::new(facing.max(-largest), largest);
    breaks.add_root(facing);
    for t in [-2.5, 0.0, 2.5] {
        breaks.add_smooth(t * unit);
    }
    for p in edges.along() {
        breaks.add_root(p);
    }
    breaks.finish();
    breaks
}

/// Integrals over the slopes `q` across, at a given slope `p` along.
struct Row<'a> {
    frame: SlopeFrame,
    edges: &'a Edges,
    /// Deviation of `q` at given `p`, times the root of two.
    unit: f64,
    breaks: Breaks,
    pieces: Pieces,
}

impl<'a> Row<'a> {
    fn new(frame: SlopeFrame, edges: &'a Edges) -> Self {
        Self {
            frame,
            edges,
            unit: (2.0 / frame.inverse_variance_across).sqrt(),
            breaks: Breaks::default(),
            pieces: Pieces::default(),
        }
    }

    /// The integral at `p`. `largest` is the largest row so far: small rows need few digits.
    fn integral(&mut self, p: f64, largest: f64, per_normal: impl Fn(DVec3) -> f64) -> f64 {
        // Given p, q is Gaussian about a line
        let centre = self.frame.regression * p;
        let reach = MAX_SLOPE * self.unit;
        self.breaks.reset(centre - reach, centre + reach);
        for t in [-2.5, 0.0, 2.5] {
            self.breaks.add_smooth(centre + t * self.unit);
        }
        for q in self.edges.across(p) {
            self.breaks.add_root(q);
            self.breaks.add_root(-q);
        }
        self.breaks.finish();
        let error = AllowedError {
            absolute: 1e-13 * largest,
            relative: 1e-12,
        };
        let (along, across) = (self.frame.along, self.frame.across);
        integrate(&self.breaks, error.within(300), &mut self.pieces, |q| {
            let m = (p * along + q * across).extend(1.0).normalize();
            per_normal(m) * m.z.powi(3)
        })
    }
}

/// Flux fraction per solid angle of facet normals.
fn per_normal(model: &dyn BsdfModel, wi: DVec3, m: DVec3, refracted: Option<f64>) -> f64 {
    let Some(wo) = outgoing_direction(&model.material(), wi, m, refracted) else {
        return 0.0;
    };
    let facet = match refracted {
        None if wo.z > 0.0 => reflecting_facet(wi, wo),
        Some(eta) if wo.z < 0.0 => refracting_facet(wi, wo, eta),
        _ => None,
    };
    facet.map_or(0.0, |facet| model.bsdf(wi, wo) * wo.z.abs() / facet.chi)
}

/// Edges of the integrand: conics symmetric in `q`.
pub(crate) struct Edges {
    sin_i: f64,
    cos_i: f64,
    /// `1 - eta^2` where total reflection is possible.
    delta: Option<f64>,
    /// The light leaves horizontally where `1 + p^2 + q^2 = (2 A cos theta_i - shift) / cos^2
    /// theta_i`, with `A = cos theta_i + p sin theta_i`.
    horizontal: Option<f64>,
    /// Index of refraction, if light is refracted.
    refracted: Option<f64>,
    kinks: Kinks,
}

impl Edges {
    /// No edges but the line where facets turn away.
    pub(crate) fn none(wi: DVec3) -> Self {
        Self {
            sin_i: hypot(wi.x, wi.y),
            cos_i: wi.z,
            delta: None,
            horizontal: None,
            refracted: None,
            kinks: Kinks::None,
        }
    }

    /// Adds the `kinks` of reflected light, or of an integrand that does not depend on the outgoing direction.
    #[cfg(test)]
    pub(crate) fn with_kinks(self, kinks: Kinks) -> Self {
        Self { kinks, ..self }
    }

    fn new(model: &dyn BsdfModel, wi: DVec3, refracted: Option<f64>) -> Self {
        let delta = model
            .material()
            .transmitting_index()
            .filter(|&eta| eta < 1.0)
            .map(|eta| (1.0 - eta) * (1.0 + eta));
        let horizontal = match refracted {
            None => Some(0.0),
            // Light that enters the denser medium bends towards the normal and never turns upward.
            Some(_) => delta,
        };
        Self {
            sin_i: hypot(wi.x, wi.y),
            cos_i: wi.z,
            delta,
            horizontal,
            refracted,
            kinks: model.kinks(),
        }
    }

    /// Slopes `p` at which an edge has its ends (`q = 0`), or two edges meet.
    fn along(&self) -> impl Iterator<Item = f64> {
        let (si, ci) = (self.sin_i, self.cos_i);
        let tan = si / ci;
        let mut points = Vec::new();
        if let Some(delta) = self.delta {
            // Total reflection, A^2 = delta (1 + p^2 + q^2), at q = 0.
            points.extend(quadratic_roots(si * si - delta, si * ci, ci * ci - delta));
        }
        if let Some(shift) = self.horizontal {
            points.extend(quadratic_roots(1.0, -tan, shift / (ci * ci) - 1.0));
        }
        if let (Some(delta), Some(shift)) = (self.delta, self.horizontal)
            && si > 0.0
        {
            // A^2 ci^2 - 2 A ci delta + shift delta = 0: the circle meets the critical conic; for
            // refraction, shift = delta, it touches it.
            let root = (delta * (delta - shift)).max(0.0).sqrt();
            for a_ci in [delta + root, delta - root] {
                points.push((a_ci / ci - ci) / si);
            }
        }
        points.extend(self.kinks.along(si, ci, self.refracted));
        points.into_iter()
    }

    /// Slopes `q >= 0` at which edges cross the given `p`.
    fn across(&self, p: f64) -> impl Iterator<Item = f64> {
        let a = self.cos_i + p * self.sin_i;
        let critical = self.delta.map(|delta| a * a / delta - 1.0 - p * p);
        let horizontal = self.horizontal.map(|shift| {
            2.0 * p * self.sin_i / self.cos_i + 1.0 - shift / (self.cos_i * self.cos_i) - p * p
        });
        [critical, horizontal]
            .into_iter()
            .flatten()
            .chain(self.kinks.across(p, self.sin_i, self.cos_i, self.refracted))
            .filter(|q2| *q2 >= 0.0)
            .map(f64::sqrt)
    }
}
