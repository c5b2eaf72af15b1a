//! Unshadowed single scattering: the sum over all facets of one surface.

use std::f64::consts::PI;
use std::ops::Range;

use asperity_optics::{Incidence, Material, polarised_conductor, reflect};
use asperity_surface::Border;
use asperity_tally::{
    Azimuth, Component, Event, EventPath, Exit, ExitColumns, JointExit, JointTallies, Side,
    Tallies, Tally, TallyResult, TallySpec, TallyValues, UnshadowedFluxes,
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
        let part = part_of(&facets, part);
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

/// The facets of a part by its number.
fn part_of(facets: &Range<usize>, part: usize) -> Range<usize> {
    let first = facets.start + part * FACETS_OF_PART;
    first..facets.end.min(first + FACETS_OF_PART)
}

/// Unshadowed single scattering of several conductors of relative indices `[eta, kappa]`: as [`sum_over_facets`] for each, bit by bit. Facets
/// and bins, which they have in common, are found once.
#[must_use]
pub fn sum_over_facets_of_conductors<G: Triangles>(
    geometry: &G,
    indices: &[[f64; 2]],
    incidence: Incidence,
    incident: HalfSpace,
    spec: TallySpec,
    facets: Range<usize>,
) -> Vec<TallyValues> {
    let empty = || Tally::new(spec, Azimuth::From(incidence.phi() + PI));
    let parts = 0..facets.len().div_ceil(FACETS_OF_PART);
    let tallies = parts.into_par_iter().map(|part| {
        let part = part_of(&facets, part);
        add_facets_of_conductors(geometry, indices, incidence, incident, part, empty())
    });
    let sum = tallies.reduce_with(|mut sums, parts| {
        for (sum, part) in sums.iter_mut().zip(&parts) {
            *sum += part;
        }
        sums
    });
    let none = || indices.iter().map(|_| Tallies::new(empty(), 1)).collect();
    let each = sum.unwrap_or_else(none).into_iter();
    each.flat_map(|sums| sums.into_fractions(1)).collect()
}

/// A facet that faces the light.
struct LitFacet {
    light: Incident<0>,
    /// Flux that arrives, as a fraction of that on the mean plane.
    flux: f64,
    /// Factors that turn directions on the facet into those of results.
    turn: DVec3,
}

/// Calls `each` with the facets that face the light.
#[inline(always)]
fn for_each_lit_facet<G: Triangles>(
    geometry: &G,
    incidence: Incidence,
    incident: HalfSpace,
    facets: Range<usize>,
    mut each: impl FnMut(&LitFacet),
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
            if flux > 0.0 {
                each(&LitFacet {
                    light: Incident::averaged(true, wi, m),
                    flux,
                    turn: upright * image,
                });
            }
        }
    }
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
    for_each_lit_facet(geometry, incidence, incident, facets, |lit| {
        let scattered = scatter::<AveragedLight, 0>(material, &lit.light);
        tally.add_first_absorbed(lit.flux * scattered.absorbed);
        for (event, out) in scattered.branches() {
            let (side, away) = match event {
                Event::Reflection => (Side::Reflected, 1.0),
                Event::Transmission => (Side::Transmitted, -1.0),
            };
            let wo = out.direction * lit.turn;
            if out.passed.fraction > 0.0 && wo.z * away > 0.0 {
                tally.add_exit(&Exit {
                    side,
                    wo,
                    flux: lit.flux * out.passed.fraction,
                    path: EventPath::default().then(event),
                    scatterings: 0,
                });
            }
        }
    });
}

/// Exits of conductors whose bins are found together.
const EXITS: usize = 1 << 10;

/// Adds what some facets of each conductor do.
fn add_facets_of_conductors<G: Triangles>(
    geometry: &G,
    indices: &[[f64; 2]],
    incidence: Incidence,
    incident: HalfSpace,
    facets: Range<usize>,
    empty: Tally<'static>,
) -> Vec<Tallies<'static>> {
    let number = indices.len();
    let bins = Tallies::new(empty.clone(), 1);
    let mut sums = JointTallies::new(empty, 1, vec![None; number]);
    let mut exits = ExitColumns::default();
    let (mut fluxes, mut absorbed) = (Vec::new(), vec![0.0; number]);
    let flush = |exits: &mut ExitColumns, fluxes: &mut Vec<f64>, sums: &mut JointTallies<'_>| {
        bins.locate(exits);
        sums.add_located(exits, |row| JointExit {
            batch: 0,
            fluxes: &fluxes[row as usize * number..][..number],
            measures: &[],
        });
        fluxes.clear();
    };
    for_each_lit_facet(geometry, incidence, incident, facets, |lit| {
        let light = &lit.light;
        let cos_theta_i = light.cos_theta_i();
        let wo = reflect(-light.k, light.m) * lit.turn;
        let row = fluxes.len() / number;
        for ([eta, kappa], absorbed) in indices.iter().zip(&mut absorbed) {
            let reflected = polarised_conductor(cos_theta_i, *eta, *kappa).reflected.m00;
            fluxes.push(lit.flux * reflected);
            *absorbed = lit.flux * (1.0 - reflected);
        }
        sums.add_first_absorbed(0, &absorbed);
        if wo.z <= 0.0 {
            fluxes.truncate(row * number);
            return;
        }
        let exit = Exit {
            side: Side::Reflected,
            wo,
            flux: lit.flux,
            path: EventPath::default().then(Event::Reflection),
            scatterings: 0,
        };
        exits.push(&exit, row as u32);
        if exits.len() == EXITS {
            flush(&mut exits, &mut fluxes, &mut sums);
        }
    });
    flush(&mut exits, &mut fluxes, &mut sums);
    sums.into_each()
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
