//! Unshadowed single scattering: the sum over all facets of one surface.

use std::f64::consts::PI;
use std::ops::Range;

use asperity_optics::{Incidence, Material};
use asperity_surface::Border;
use asperity_tally::{
    Azimuth, Component, Event, EventPath, Exit, Side, Tally, TallyResult, TallySpec, TallyValues,
    UnshadowedFluxes,
};
use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::Triangles;
use crate::interaction::facet::{Incident, scatter};
use crate::interaction::polarised::AveragedLight;
use crate::ray::HalfSpace;

/// Facets that are summed over at a time.
const FACETS_OF_PART: usize = 1 << 14;

/// Unshadowed single scattering of the `facets` given by their numbers, of light from `incidence` through the `incident`
/// medium: flux fractions, summed in parallel. Nothing blocks the light before or after the facet.
///
/// Sums over parts of the facets add up to that over all; [`unshadowed_fluxes`] reads the sum.
#[must_use]
pub fn sum_over_facets<G: Triangles>(
    geometry: &G,
    material: Material,
    incidence: Incidence,
    incident: HalfSpace,
    spec: TallySpec,
    facets: Range<usize>,
) -> TallyValues {
    let empty = || Tally::new(spec, Azimuth::From(incidence.phi() + PI));
    let parts = 0..facets.len().div_ceil(FACETS_OF_PART);
    let tallies = parts.into_par_iter().map(|part| {
        let first = facets.start + part * FACETS_OF_PART;
        let part = first..facets.end.min(first + FACETS_OF_PART);
        let mut tally = empty();
        add_facets(geometry, material, incidence, incident, part, &mut tally);
        tally
    });
    let sum = tallies.reduce_with(|mut sum, part| {
        sum += &part;
        sum
    });
    sum.unwrap_or_else(empty).into_fractions(1)
}

/// Adds what some facets do.
fn add_facets<G: Triangles>(
    geometry: &G,
    material: Material,
    incidence: Incidence,
    incident: HalfSpace,
    facets: Range<usize>,
    tally: &mut Tally<'_>,
) {
    let [cx, cy] = geometry.extent();
    let upright = DVec3::new(1.0, 1.0, incident.sign());
    // A tile of mirrored borders has images in which the light comes from another side.
    let images: &[[f64; 2]] = match geometry.border() {
        Border::Mirrored => &[[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]],
        Border::Periodic | Border::Open => &[[1.0, 1.0]],
    };
    let area = images.len() as f64 * cx * cy / geometry.aspect();
    for index in facets {
        let corners = geometry.corners(geometry.facet(index));
        let [a, b, c] = corners.map(|p| DVec3::new(p.x, p.y / geometry.aspect(), p.z));
        // Its length is the facet's area.
        let normal = 0.5 * incident.sign() * (b - a).cross(c - a);
        let Some(m) = normal.try_normalize() else {
            continue;
        };
        for &[x, y] in images {
            let image = DVec3::new(x, y, 1.0);
            let wi = incidence.wi() * upright * image;
            let flux = wi.dot(normal) / (incidence.wi().z * area);
            if flux <= 0.0 {
                continue;
            }
            let light = Incident::averaged(true, wi, m);
            let scattered = scatter::<AveragedLight, 0>(material, &light);
            tally.add_first_absorbed(flux * scattered.absorbed);
            for (event, out) in scattered.branches() {
                let (side, away) = match event {
                    Event::Reflection => (Side::Reflected, 1.0),
                    Event::Transmission => (Side::Transmitted, -1.0),
                };
                let wo = out.direction * upright * image;
                if out.passed.fraction > 0.0 && wo.z * away > 0.0 {
                    tally.add_exit(&Exit {
                        side,
                        wo,
                        flux: flux * out.passed.fraction,
                        path: EventPath::default().then(event),
                        scatterings: 0,
                    });
                }
            }
        }
    }
}

/// The fluxes over all facets that a control variate is made of.
#[must_use]
pub fn unshadowed_fluxes(tally: &TallyValues) -> UnshadowedFluxes {
    let single = Component::Single;
    UnshadowedFluxes {
        bins: tally[tally.spec().grid_entries(single)].to_vec(),
        rings: Side::BOTH.map(|side| tally.rings(side, single).iter().collect()),
        in_plane: Side::BOTH.map(|side| tally.in_plane(side, single).iter().collect()),
        absorbed: tally.budget().absorbed,
    }
}
