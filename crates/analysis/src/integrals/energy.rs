//! Hemispherical energies by integration over facet slopes.
//!
//! The same energies follow from the bins of [`crate::bin_fluxes`]; here they come by another way,
//! with facet slopes `(p, q)` as variables, `m ~ (p, q, 1)`, `p` along the horizontal part of `wi`.
//! All edges of the integrand are conics in `(p, q)` with closed forms: where the facet turns away
//! (a line), where total reflection sets in, and where the light leaves horizontally (a circle). Where a
//! model has kinks beside, see [`Kinks`].

use asperity_tally::Side;
use glam::{DVec2, DVec3};
use serde::Serialize;

use crate::microfacet::half_vector::{outgoing_direction, reflecting_facet, refracting_facet};
use crate::microfacet::slope_frame::SlopeFrame;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::BsdfModel;
use crate::numerics::quadrature::{Breaks, Pieces, Tolerance, integrate, quadratic_roots};

/// Flux fractions that a model sends into the two hemispheres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HemisphericalEnergy {
    /// Back into the incident medium.
    pub reflected: f64,
    /// Into the medium behind the surface.
    pub transmitted: f64,
}

/// Slopes end at this multiple of their deviation times the root of two: the density there is `exp(-42)`
/// of its peak.
const LARGEST_SLOPE: f64 = 6.5;

/// The flux fractions that `model` sends into the two hemispheres, to about 1e-10 of their value.
///
/// `wi` is a unit vector with `z > 0`.
#[must_use]
pub fn hemispherical_energy(model: &dyn BsdfModel, wi: DVec3) -> HemisphericalEnergy {
    let reflected = over_slopes(model, wi, None);
    let transmitted = model
        .material()
        .transmitting_index()
        .filter(|_| model.sides().ask(Side::Transmitted))
        .map_or(0.0, |eta| over_slopes(model, wi, Some(eta)));
    HemisphericalEnergy {
        reflected,
        transmitted,
    }
}

/// The flux fraction of one side, refracting with the index `refracted` if given.
fn over_slopes(model: &dyn BsdfModel, wi: DVec3, refracted: Option<f64>) -> f64 {
    let edges = Edges::new(model, wi, refracted);
    over_facing_normals(&model.slopes(), wi, &edges, |m| {
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
    let sin_i = wi.x.hypot(wi.y);
    let along = if sin_i > 0.0 {
        wi.truncate() / sin_i
    } else {
        DVec2::X
    };
    let frame = SlopeFrame::new(slopes, along);
    let across = frame.across;
    let unit = (2.0 * frame.variance).sqrt();
    let unit_across = (2.0 / frame.inverse_variance_across).sqrt();
    let largest = LARGEST_SLOPE * unit;
    let facing = if sin_i > 0.0 { -wi.z / sin_i } else { -largest };

    let mut outer = Breaks::new(facing.max(-largest), largest);
    outer.add_root(facing);
    for t in [-2.5, 0.0, 2.5] {
        outer.add_smooth(t * unit);
    }
    for p in edges.along() {
        outer.add_root(p);
    }
    outer.finish();
    let tolerance = Tolerance {
        absolute: 1e-300,
        relative: 1e-11,
        max_pieces: 1000,
    };
    let inner_tolerance = Tolerance {
        relative: 1e-12,
        max_pieces: 300,
        ..tolerance
    };
    let mut inner_pieces = Pieces::default();
    let mut inner = Breaks::default();
    let mut largest_row = 0.0_f64;
    integrate(&outer, tolerance, &mut Pieces::default(), |p| {
        let centre = frame.regression * p;
        let reach = LARGEST_SLOPE * unit_across;
        inner.reset(centre - reach, centre + reach);
        for t in [-2.5, 0.0, 2.5] {
            inner.add_smooth(centre + t * unit_across);
        }
        for q in edges.across(p) {
            inner.add_root(q);
            inner.add_root(-q);
        }
        inner.finish();
        // Rows that hardly count need not be known to many digits.
        let tolerance = Tolerance {
            absolute: 1e-13 * largest_row,
            ..inner_tolerance
        };
        let row = integrate(&inner, tolerance, &mut inner_pieces, |q| {
            let m = (p * along + q * across).extend(1.0).normalize();
            per_normal(m) * m.z.powi(3)
        });
        largest_row = largest_row.max(row);
        row
    })
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

/// Where the integrand has edges: conics symmetric in `q`.
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
    /// Those of an integrand that has none but the line where facets turn away.
    pub(crate) fn none(wi: DVec3) -> Self {
        Self {
            sin_i: wi.x.hypot(wi.y),
            cos_i: wi.z,
            delta: None,
            horizontal: None,
            refracted: None,
            kinks: Kinks::None,
        }
    }

    /// The same with the `kinks` of light that is reflected, or of what does not depend on where it goes.
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
            // Entering the denser medium, light bends towards the normal and never turns upward.
            Some(_) => delta,
        };
        Self {
            sin_i: wi.x.hypot(wi.y),
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
