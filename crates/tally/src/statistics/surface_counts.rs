//! Surface counts: how many surfaces have sent light into each entry.
//!
//! Twenty rays of one surface are one sample of surfaces: where one surface in fifty lights a ring, most runs of 32 find none that does, and
//! their rays, which agree, say nothing of it.

use super::sample_groups::{
    FEW_RAYS, entries_of, flux_groups, measured_groups, raise, raise_unseen,
};
use crate::spec::filters::Half;
use crate::values::single_path;
use crate::{Component, Score, TallySpec, TallyValues};

/// Scores whose entries light is divided among.
const SCORES: [Score; 3] = [Score::BinFlux, Score::RingFlux, Score::InPlaneFlux];

/// Numbers of surfaces that have sent light into each entry; under a control variate, light of order one that deviates from it.
#[derive(Clone, Debug)]
pub struct SurfaceCounts {
    surfaces: f64,
    lit: TallyValues,
}

impl SurfaceCounts {
    /// No surfaces yet.
    #[must_use]
    pub fn new(spec: TallySpec) -> Self {
        Self {
            surfaces: 0.0,
            lit: TallyValues::zeros(spec),
        }
    }

    /// Adds a surface by its tally.
    ///
    /// # Panics
    /// If it is of another spec.
    pub fn push(&mut self, tally: &TallyValues) {
        let spec = *tally.spec();
        let mut is_lit = tally.map(|&value| value != 0.0);
        // Where a control variate gives every entry some light, rays tell.
        for side in spec.sides() {
            let bins = spec.grid().bins_per_side();
            let sectors = spec.grid().n_phi();
            for component in [Component::Single, Component::All] {
                let has_rays: Vec<bool> = (0..bins)
                    .map(|bin| tally.hits(side, component, bin) > 0.0)
                    .collect();
                let entries = spec.bin_entries(side, component);
                for (entry, has_rays) in entries.iter().zip(&has_rays) {
                    is_lit[entry] &= has_rays;
                }
                for (ring, bins) in has_rays.chunks(sectors).enumerate() {
                    let has_rays = bins.contains(&true);
                    is_lit[spec.ring_entries(side, component).get(ring)] &= has_rays;
                    for half in Half::BOTH {
                        let slice = spec.in_plane_filter(side).number(ring, half);
                        is_lit[spec.in_plane_entries(side, component).get(slice)] &= has_rays;
                    }
                }
                let has_rays = has_rays.contains(&true);
                is_lit[spec.flux_entry(side, component)] &= has_rays;
                if component == Component::Single {
                    is_lit[spec.event_path_entry(side, single_path(side))] &= has_rays;
                }
            }
        }
        self.surfaces += 1.0;
        self.lit.update(&is_lit, |count, is_lit| {
            *count += if *is_lit { 1.0 } else { 0.0 }
        });
    }

    /// Adds the surfaces of `more`.
    ///
    /// # Panics
    /// If they are of another spec.
    pub fn append(&mut self, more: &Self) {
        self.surfaces += more.surfaces;
        self.lit += &more.lit;
    }

    /// Standard errors below which none should be reported where few of the surfaces, and less than half, are lit. `squares`: of the standard
    /// errors of `means` by the scatter of surfaces.
    ///
    /// `features`: how many features of random slopes a surface has, each of which sends its part of the light of a side into one direction,
    /// if it consists of such. No scatter tells of directions that none of them has lit yet.
    #[must_use]
    pub fn least(
        &self,
        means: &TallyValues,
        squares: &TallyValues,
        features: Option<f64>,
    ) -> TallyValues {
        let spec = *squares.spec();
        let mut least = TallyValues::zeros(spec);
        let few = FEW_RAYS.min(0.5 * self.surfaces);
        let measured = measured_groups(&spec).flat_map(|(side, score, component)| {
            let fluxes = entries_of(&spec, score, side, component);
            let measures = spec.polarimetry().measures();
            measures.map(move |measure| {
                let beside = fluxes
                    .iter()
                    .filter_map(|&f| spec.measure_entry(f, measure));
                beside.collect()
            })
        });
        for entries in flux_groups(&spec, SCORES).chain(measured) {
            let samples: Vec<f64> = entries.iter().map(|&entry| self.lit[entry]).collect();
            raise(&mut least, squares, &entries, &samples, [few; 2]);
        }
        raise_unseen(&mut least, squares, |entry| self.lit[entry], few);
        if let Some(features) = features {
            self.raise_empty(&mut least, means, self.surfaces * features);
        }
        least.map(|square| square.sqrt())
    }

    /// Raises squares of errors in entries that no surface has lit, as if one more of `features` might light any of them, and in all others of
    /// the same side by what would be missing there. All light is as uncertain as its components together.
    fn raise_empty(&self, least: &mut TallyValues, means: &TallyValues, features: f64) {
        let spec = *means.spec();
        for side in spec.sides() {
            for score in SCORES {
                let components: &[Component] = match score {
                    Score::BinFlux => &Component::SURFACE,
                    _ => &Component::ORDERS,
                };
                let all = spec.component_entries(score, side, Component::All);
                let mut sums = vec![0.0; all.len()];
                for &component in components.iter().chain(spec.components()) {
                    let entries = spec.component_entries(score, side, component);
                    let flux: f64 = means[entries].iter().sum();
                    let dark = self.lit[entries].iter().filter(|&&n| n == 0.0).count();
                    let feature = (flux / features).powi(2);
                    for (entry, sum) in entries.iter().zip(&mut sums) {
                        let expected = match self.lit[entry] == 0.0 {
                            true => 1.0 / dark as f64,
                            false if dark > 0 && flux > 0.0 => (means[entry] / flux).powi(2),
                            false => 0.0,
                        };
                        least[entry] = least[entry].max(expected * feature);
                        if !component.is_of_medium() {
                            *sum += expected * feature;
                        }
                    }
                }
                for (entry, sum) in all.iter().zip(sums) {
                    least[entry] = least[entry].max(sum);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HemisphereGrid, Side, TallyStatistics};

    /// Forty surfaces light the first two rings alike; one of them a third ring, with all of twenty rays. Nothing else is lit.
    #[test]
    fn rays_of_one_surface_are_one_sample() {
        let spec = TallySpec::new(HemisphereGrid::new(6, 4).unwrap(), 0.2).unwrap();
        let component = Component::Multiple;
        let mut lit = SurfaceCounts::new(spec);
        let mut statistics = TallyStatistics::new(spec);
        for surface in 0..40 {
            let mut tally = TallyValues::zeros(spec);
            for ring in 0..if surface == 7 { 3 } else { 2 } {
                tally[spec.hit_entries(Side::Reflected, component).get(4 * ring)] = 0.02;
                for component in [Component::Order(2), Component::All] {
                    tally[spec.ring_entries(Side::Reflected, component).get(ring)] = 0.02;
                }
            }
            lit.push(&tally);
            statistics.push(&tally);
        }
        let squares = statistics.error_squares();
        let least = lit.least(statistics.means(), &squares, None);
        for component in [Component::Order(2), Component::All] {
            let rings = &least[spec.ring_entries(Side::Reflected, component)];
            // A surface that lights a ring adds a fortieth of its flux to the mean; the next one may light any of three dark rings.
            let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
            assert_eq!(rings[..2], [0.0; 2]);
            assert!(near(rings[2], 0.0005), "{rings:?}");
            let dark = 0.0005 * (1.0_f64 / 3.0).sqrt();
            assert!(rings[3..].iter().all(|&error| near(error, dark)));
        }
        assert!(least.iter().all(|error| error.is_finite()));

        // Of one feature a surface, or 40 in all, one more might light any of three dark rings, and would be missing in the others.
        let least = lit.least(statistics.means(), &squares, Some(1.0));
        for component in [Component::Order(2), Component::All] {
            let rings = spec.ring_entries(Side::Reflected, component);
            let flux: f64 = statistics.means()[rings].iter().sum();
            let feature = flux / 40.0;
            let dark = least[rings.get(4)];
            assert!(dark >= feature * (1.0_f64 / 3.0).sqrt() && dark < feature);
            let bright = feature * 0.02 / flux;
            assert!((least[rings.get(0)] / bright - 1.0).abs() < 1e-12);
        }
    }
}
