//! Tabulated slopes: fluxes of Smith's model of a slope table, as sums over its cells.

use std::f64::consts::{PI, TAU};

use asperity_numerics::elementary::acos;
use asperity_optics::{Incidence, Material, azimuth, polar_angle};
use asperity_tally::{
    BinFilter, HemisphereGrid, InPlaneFilter, Side, SideFluxes, Sides, TallySpec, TallyValues,
};
use glam::DVec3;
use rayon::prelude::*;

use crate::integrals::slope_images::{FacetLight, SlopeImages};
use crate::microfacet::lambda_map::{LambdaMap, MapSize};
use crate::microfacet::slope_grid::SlopeTableError;
use crate::microfacet::slope_table::SlopeTable;
use crate::models::model::{ModelError, check_material};

/// Bins of a tally in which light counts: one of the hemisphere, and one in the plane of incidence if it is near that.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TallyPlace {
    bin: usize,
    in_plane: Option<usize>,
}

/// Single scattering by a table in a tally of `spec`, on its sides.
pub(crate) struct TabulatedTally {
    spec: TallySpec,
    sides: Vec<(Side, SlopeImages<TallyPlace>)>,
}

impl TabulatedTally {
    /// Images of the cells of `table`, divided as finely as its masses require.
    pub(crate) fn new(
        table: &SlopeTable,
        material: Material,
        incidence: Incidence,
        spec: &TallySpec,
    ) -> Self {
        let sides = spec.sides().map(|side| {
            let light = FacetLight {
                wi: incidence.wi(),
                material,
                side,
            };
            let in_plane = InPlane::new(&spec.in_plane_filter(side), incidence);
            let grid = spec.grid();
            let first = side.index() * grid.bins_per_side();
            let place = |wo: DVec3| {
                Some(TallyPlace {
                    bin: grid.index_of(side, wo) - first,
                    in_plane: in_plane.bin_of(wo),
                })
            };
            (side, SlopeImages::new(table, light, place))
        });
        Self {
            spec: *spec,
            sides: sides.collect(),
        }
    }

    /// Fluxes by the masses of `table`, which is on the grid of the images.
    pub(crate) fn fluxes(&self, table: &SlopeTable, size: MapSize) -> TallyValues {
        let map = LambdaMap::new(table, size);
        let mut values = TallyValues::zeros(self.spec);
        for (side, images) in &self.sides {
            let filter: BinFilter = self.spec.bin_filter(*side);
            let mut bins = vec![0.0; filter.len()];
            let mut in_plane = vec![0.0; self.spec.in_plane_filter(*side).len()];
            for (place, flux) in images.fluxes(table, &map) {
                bins[place.bin] += flux;
                if let Some(i) = place.in_plane {
                    in_plane[i] += flux;
                }
            }
            values.set_single_scattering(*side, &SideFluxes::from_bins(&filter, bins, in_plane));
        }
        values
    }
}

/// Bins near the plane of incidence by direction.
struct InPlane {
    forward: f64,
    half_width: f64,
    /// Edges, signed degrees from the normal of the side.
    edges: Vec<f64>,
}

impl InPlane {
    fn new(filter: &InPlaneFilter, incidence: Incidence) -> Self {
        let from = (0..filter.len()).map(|i| filter.theta_deg(i)[0]);
        Self {
            forward: incidence.phi() + PI,
            half_width: filter.half_width(),
            edges: from.collect(),
        }
    }

    fn bin_of(&self, wo: DVec3) -> Option<usize> {
        let turn = (azimuth(wo) - self.forward) / PI;
        let off = PI * (turn - 2.0 * (0.5 * turn).round()).abs();
        let angle = acos(wo.z.abs().min(1.0)).to_degrees();
        let signed = if off <= self.half_width {
            angle
        } else if PI - off <= self.half_width {
            -angle
        } else {
            return None;
        };
        Some(self.edges.partition_point(|&edge| edge <= signed).max(1) - 1)
    }
}

/// Fluxes into the places `0..count` of a side, by `place` of a direction there.
fn fluxes_into(
    table: &SlopeTable,
    light: FacetLight,
    count: usize,
    place: impl Fn(DVec3) -> Option<usize> + Sync,
) -> Vec<f64> {
    let images = SlopeImages::new(table, light, place);
    let map = LambdaMap::new(table, MapSize::FINE);
    let mut fluxes = vec![0.0; count];
    images
        .fluxes(table, &map)
        .for_each(|(place, flux)| fluxes[place] += flux);
    fluxes
}

/// Influence of the slopes of each region of a surface on single scattering: the change of Smith's model in a tally
/// of `spec` if the slopes of the surface were those of the region, to first order.
///
/// `regions`: weights of the cells of `whole`, region by region, two or more. Their mean is what `whole` is made of. Each region is left
/// out in turn, and the change is scaled by the number of the others. The mean over regions is zero.
///
/// # Errors
/// [`ModelError`] for an invalid material or equal indices; [`ModelError::Table`] if a region does not have one weight per cell
/// of `whole`, or its weights are invalid.
///
/// # Source
/// R. G. Miller, The jackknife: a review, Biometrika 61 (1974) 1.
pub fn region_influence(
    whole: &SlopeTable,
    regions: &[Vec<f64>],
    material: Material,
    incidence: Incidence,
    spec: &TallySpec,
) -> Result<Vec<TallyValues>, ModelError> {
    check_material(material)?;
    let tables: Vec<SlopeTable> = without_each(whole, regions)?;
    let images = TabulatedTally::new(whole, material, incidence, spec);
    let others = regions.len() as f64 - 1.0;
    let left: Vec<TallyValues> = tables
        .par_iter()
        .map(|table| images.fluxes(table, MapSize::COARSE))
        .collect();
    let mut mean = TallyValues::zeros(*spec);
    left.iter().for_each(|tally| mean += tally);
    let mean = mean.map(|sum| sum / left.len() as f64);
    Ok(left
        .iter()
        .map(|tally| mean.zip_map(tally, |mean, left| others * (mean - left)))
        .collect())
}

/// Tables of all regions but one, on the grid of `whole`.
fn without_each(
    whole: &SlopeTable,
    regions: &[Vec<f64>],
) -> Result<Vec<SlopeTable>, SlopeTableError> {
    let cells = whole.grid().len();
    let mut sum = vec![0.0; cells];
    for region in regions {
        if region.len() != cells {
            let weights = region.len();
            return Err(SlopeTableError::BadLength { weights, cells });
        }
        sum.iter_mut().zip(region).for_each(|(sum, w)| *sum += w);
    }
    let without = |region: &Vec<f64>| {
        let weights: Vec<f64> = sum
            .iter()
            .zip(region)
            .map(|(all, own)| (all - own).max(0.0))
            .collect();
        SlopeTable::new(whole.grid().clone(), &weights)
    };
    regions.iter().map(without).collect()
}

/// Flux into the ranges of polar angle and azimuth, the latter anywhere and up to a full turn wide.
pub(crate) fn tabulated_flux(
    table: &SlopeTable,
    light: FacetLight,
    theta: [f64; 2],
    phi: [f64; 2],
) -> f64 {
    let place = |wo: DVec3| {
        let (polar, turned) = (polar_angle(wo), (azimuth(wo) - phi[0]).rem_euclid(TAU));
        let inside = polar >= theta[0] && polar <= theta[1] && turned <= phi[1] - phi[0];
        inside.then_some(0)
    };
    fluxes_into(table, light, 1, place)[0]
}

/// All flux on the side of the light.
pub(crate) fn tabulated_energy(table: &SlopeTable, light: FacetLight) -> f64 {
    fluxes_into(table, light, 1, |_| Some(0))[0]
}

/// Fluxes into the bins of `grid` on `sides`; zero on the other.
pub(crate) fn tabulated_bins(
    table: &SlopeTable,
    material: Material,
    wi: DVec3,
    grid: &HemisphereGrid,
    sides: Sides,
) -> Vec<f64> {
    let of_side = grid.bins_per_side();
    let mut fluxes = vec![0.0; grid.len()];
    for side in Side::BOTH.into_iter().filter(|&side| sides.includes(side)) {
        let light = FacetLight { wi, material, side };
        let first = side.index() * of_side;
        let place = |wo: DVec3| Some(grid.index_of(side, wo) - first);
        let found = fluxes_into(table, light, of_side, place);
        fluxes[first..][..of_side].copy_from_slice(&found);
    }
    fluxes
}
