//! Unshadowed single scattering of one surface: the sum over all of its facets.

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
use crate::interaction::facet::scatter;
use crate::ray::HalfSpace;

/// Fewest facets that are summed over at a time.
const MIN_FACETS: usize = 1 << 10;

/// What the `facets` given, by their numbers, do with light that comes from `incidence` through the
/// `incident` medium if nothing is in its way, before or after: flux fractions, summed in parallel.
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
    let parts = facets.into_par_iter().with_min_len(MIN_FACETS);
    let tallies = parts.fold(empty, |mut tally, index| {
        add_facet(geometry, material, incidence, incident, index, &mut tally);
        tally
    });
    let sum = tallies.reduce(empty, |mut sum, part| {
        sum += &part;
        sum
    });
    sum.into_fractions(1)
}

/// Adds what one facet does.
fn add_facet<G: Triangles>(
    geometry: &G,
    material: Material,
    incidence: Incidence,
    incident: HalfSpace,
    index: usize,
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
    let corners = geometry.corners(geometry.facet(index));
    let [a, b, c] = corners.map(|p| DVec3::new(p.x, p.y / geometry.aspect(), p.z));
    // Its length is the facet's area.
    let normal = 0.5 * incident.sign() * (b - a).cross(c - a);
    let Some(m) = normal.try_normalize() else {
        return;
    };
    for &[x, y] in images {
        let image = DVec3::new(x, y, 1.0);
        let wi = incidence.wi() * upright * image;
        let flux = wi.dot(normal) / (incidence.wi().z * area);
        if flux <= 0.0 {
            continue;
        }
        let scattered = scatter(material, true, wi, m);
        tally.add_first_absorbed(flux * scattered.absorbed);
        for branch in scattered.branches {
            let (side, away) = match branch.event {
                Event::Reflection => (Side::Reflected, 1.0),
                Event::Transmission => (Side::Transmitted, -1.0),
            };
            let wo = branch.direction * upright * image;
            if branch.fraction > 0.0 && wo.z * away > 0.0 {
                tally.add_exit(&Exit {
                    side,
                    wo,
                    flux: flux * branch.fraction,
                    path: EventPath::default().then(branch.event),
                    scatterings: 0,
                });
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
