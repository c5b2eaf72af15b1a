//! Mirror: bins on either side of the plane of incidence, averaged where light is equal on both on average.

use std::f64::consts::TAU;

use crate::{Component, Entries, HemisphereGrid, Measure, Side, TallyValues};

/// Distance of edges from their mirror images that counts as rounding of degrees and radians, in widths of a bin.
const ROUNDING: f64 = 1e-9;

/// The plane of incidence as a mirror between bins: each has a partner at the mirrored azimuth.
///
/// If the statistics of a surface are symmetric about that plane, a bin and its partner have the same expected flux, and their
/// average is one estimate with up to half the variance of either.
///
/// # Examples
/// ```
/// use asperity_tally::{Component, HemisphereGrid, Mirror, Side, TallySpec, TallyResult, TallyValues};
///
/// let spec = TallySpec::new(HemisphereGrid::new(2, 4)?, 0.1)?;
/// let mut values = TallyValues::zeros(spec);
/// let bins = spec.bin_entries(Side::Reflected, Component::All);
/// values[bins.get(0)] = 0.2;
/// Mirror::about(0.0, &spec.grid()).unwrap().fold(&mut values);
/// assert_eq!(values[bins], [0.1, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mirror {
    /// Numbers of a sector and its partner add to this, modulo the number of sectors.
    sum: usize,
}

impl Mirror {
    /// The vertical plane at `azimuth` (radians) as a mirror between the bins of `grid`; `None` if it maps edges of
    /// bins onto no edges.
    #[must_use]
    pub fn about(azimuth: f64, grid: &HemisphereGrid) -> Option<Self> {
        let [reflected, transmitted] = Side::BOTH.map(|side| mirrored_sum(azimuth, grid, side));
        let sum = reflected.filter(|_| reflected == transmitted)?;
        Some(Self { sum })
    }

    /// The sector of azimuth that is mirrored onto `sector`, out of `sectors`.
    #[must_use]
    pub const fn partner(&self, sector: usize, sectors: usize) -> usize {
        (self.sum + sectors - sector) % sectors
    }

    /// Replaces bins and their partners by their average. The rays of both count for each, since both estimates are of all of
    /// them. Elements of Mueller matrices that change sign in a mirror are averaged with the opposite sign.
    ///
    /// Sums of bins over a ring stay as they are but for those elements, whose sums vanish. All that is no bin stays as it is.
    pub fn fold(&self, values: &mut TallyValues) {
        let spec = *values.spec();
        for side in spec.sides() {
            let surface = [Component::Single, Component::Multiple];
            for component in surface.iter().chain(spec.components()) {
                self.pair_bins(values, spec.bin_entries(side, *component), Pairing::Mean);
                self.pair_bins(values, spec.hit_entries(side, *component), Pairing::Sum);
            }
            let all = spec.bin_entries(side, Component::All);
            self.pair_bins(values, all, Pairing::Mean);
            self.pair_measures(values, side);
        }
    }

    /// Combines the values of each bin of a side and its partner; `bins` follow ring by ring.
    fn pair_bins(&self, values: &mut TallyValues, bins: Entries, pairing: Pairing) {
        let sectors = values.spec().grid().n_phi();
        for ring in bins.range().step_by(sectors) {
            self.pair(values, |sector| ring + sector, pairing);
        }
    }

    /// Combines the measures of polarised light in each bin of a side and its partner.
    fn pair_measures(&self, values: &mut TallyValues, side: Side) {
        let spec = *values.spec();
        let (offsets, polarimetry) = (spec.offsets(), spec.polarimetry());
        let bins = spec.bin_entries(side, Component::All).range();
        for ring in bins.step_by(spec.grid().n_phi()) {
            for measure in 0..polarimetry.len() {
                let entry = |sector: usize| {
                    offsets.measures_at(offsets.bin_position(ring + sector)) + measure
                };
                self.pair(values, entry, Pairing::of(polarimetry.measure(measure)));
            }
        }
    }

    /// Combines the values of all sectors of one ring and their partners.
    fn pair(&self, values: &mut TallyValues, entry: impl Fn(usize) -> usize, pairing: Pairing) {
        let sectors = values.spec().grid().n_phi();
        let values = values.as_mut_slice();
        for sector in 0..sectors {
            let partner = self.partner(sector, sectors);
            let [a, b] = [sector, partner].map(&entry);
            match pairing {
                // A sector of its own partner is as it was.
                _ if sector > partner => {}
                Pairing::Mean => {
                    let mean = 0.5 * (values[a] + values[b]);
                    [values[a], values[b]] = [mean; 2];
                }
                Pairing::Opposite => {
                    let half = 0.5 * (values[a] - values[b]);
                    [values[a], values[b]] = [half, -half];
                }
                Pairing::Sum if sector < partner => {
                    let sum = values[a] + values[b];
                    [values[a], values[b]] = [sum; 2];
                }
                Pairing::Sum => {}
            }
        }
    }
}

/// Sum of the numbers of two sectors of `side` that mirror each other at a plane, modulo their number, if all edges are mirrored onto edges.
fn mirrored_sum(azimuth: f64, grid: &HemisphereGrid, side: Side) -> Option<usize> {
    let sectors = grid.n_phi();
    let edge = |k: usize| grid.phi_edge(side, k);
    let turns = |angle: f64| angle / TAU - (angle / TAU).round();
    // Distance of the image of edge `k` from edge `to`
    let off = |k: usize, to: usize| TAU * turns(2.0 * azimuth - edge(k) - edge(to)).abs();
    let image = (0..sectors).min_by(|&a, &b| off(0, a).total_cmp(&off(0, b)))?;
    let is_mirrored = |k: usize| {
        let to = (image + sectors - k) % sectors;
        let width = (edge(k + 1) - edge(k)).min(edge(to + 1) - edge(to));
        off(k, to) <= ROUNDING * width
    };
    (0..sectors)
        .all(is_mirrored)
        .then_some((image + sectors - 1) % sectors)
}

/// Combination of the values of a bin and its partner.
#[derive(Clone, Copy)]
enum Pairing {
    /// Their average.
    Mean,
    /// The average of one and the negative other.
    Opposite,
    /// Their sum.
    Sum,
}

impl Pairing {
    /// Elements that couple I and Q with U and V change sign in a mirror.
    const fn of(measure: Measure) -> Self {
        match measure {
            Measure::Element { row, column } if (row < 2) != (column < 2) => Self::Opposite,
            _ => Self::Mean,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Polarimetry, SideEdges, TallyResult, TallySpec};

    fn grid(sectors: usize) -> HemisphereGrid {
        HemisphereGrid::new(2, sectors).unwrap()
    }

    #[test]
    fn partners_lie_at_mirrored_azimuths() {
        for (sectors, degrees) in [
            (36, 0.0),
            (36, 90.0),
            (36, 35.0),
            (7, 0.0),
            (7, 180.0),
            (12, -45.0),
            (1, 0.0),
        ] {
            let azimuth = f64::to_radians(degrees);
            let mirror = Mirror::about(azimuth, &grid(sectors)).unwrap();
            let width = TAU / sectors as f64;
            for sector in 0..sectors {
                let partner = mirror.partner(sector, sectors);
                let centre = |sector: usize| (sector as f64 + 0.5) * width;
                let turned = (2.0 * azimuth - centre(sector) - centre(partner)) / TAU;
                assert!(
                    (turned - turned.round()).abs() < 1e-12,
                    "{sectors} {degrees} {sector}"
                );
                assert_eq!(mirror.partner(partner, sectors), sector);
            }
        }
        for (sectors, degrees) in [(36, 1.0), (7, 90.0), (36, f64::NAN)] {
            assert_eq!(
                Mirror::about(f64::to_radians(degrees), &grid(sectors)),
                None
            );
        }
    }

    #[test]
    fn edges_of_a_mirror_must_be_mirrored() {
        // Narrow about 217.3 degrees; the numbers of sectors and whether an edge lies in the plane differ.
        let phi: Vec<f64> = [0.0, 130.0, 170.0, 179.5, 180.5, 190.0, 230.0, 360.0]
            .map(|deg| deg + 37.3)
            .to_vec();
        let grid_of = |phi: [Vec<f64>; 2]| {
            let [reflected, transmitted] = phi;
            HemisphereGrid::with_edges([
                SideEdges::new(Side::Reflected, vec![0.0, 90.0], reflected).unwrap(),
                SideEdges::new(Side::Transmitted, vec![90.0, 180.0], transmitted).unwrap(),
            ])
            .unwrap()
        };
        let grid = grid_of([phi.clone(), phi.clone()]);
        let mirror = Mirror::about(f64::to_radians(37.3), &grid).unwrap();
        let partners: Vec<usize> = (0..7).map(|k| mirror.partner(k, 7)).collect();
        assert_eq!(partners, [6, 5, 4, 3, 2, 1, 0]);
        let across = Mirror::about(f64::to_radians(37.3 + 180.0), &grid);
        assert_eq!(across, Some(mirror));
        assert_eq!(Mirror::about(0.0, &grid), None);
        let mut skew = phi.clone();
        skew[2] += 1e-3;
        assert_eq!(
            Mirror::about(f64::to_radians(37.3), &grid_of([phi, skew])),
            None
        );
    }

    #[test]
    fn folding_averages_bins_adds_their_rays_and_keeps_the_rest() {
        let spec = TallySpec::new(grid(5), 0.2)
            .unwrap()
            .with_medium()
            .with_polarimetry(Polarimetry::Mueller);
        let before = TallyValues::zeros(spec).with_numbers();
        let mirror = Mirror::about(0.0, &spec.grid()).unwrap();
        let mut after = before.clone();
        mirror.fold(&mut after);
        let mut changed = vec![false; spec.len()];
        for side in Side::BOTH {
            let components = [Component::Single, Component::Multiple, Component::All];
            for component in components.iter().chain(spec.components()) {
                let bins = spec.bin_entries(side, *component);
                for i in 0..10 {
                    let partner = i / 5 * 5 + 4 - i % 5;
                    let [a, b] = [i, partner].map(|i| bins.get(i));
                    changed[a.0] = true;
                    assert_eq!(after[a], 0.5 * (before[a] + before[b]));
                    for (row, column, sign) in
                        [(0, 0, 1.0), (1, 2, -1.0), (3, 2, 1.0), (3, 0, -1.0)]
                    {
                        let measure = Measure::Element { row, column };
                        let of = |flux| spec.measure_entry(flux, measure);
                        if let (Some(a), Some(b)) = (of(a), of(b)) {
                            assert_eq!(after[a], 0.5 * (before[a] + sign * before[b]));
                        }
                    }
                    if *component != Component::All {
                        let hits = spec.hit_entries(side, *component);
                        let [a, b] = [i, partner].map(|i| hits.get(i));
                        changed[a.0] = true;
                        let expected = if a == b {
                            before[a]
                        } else {
                            before[a] + before[b]
                        };
                        assert_eq!(after[a], expected);
                    }
                }
            }
        }
        let all = spec.bin_entries(Side::Reflected, Component::All);
        let bins = spec.offsets().measures_of(all.get(0)).unwrap();
        for (i, changed) in changed.iter().enumerate().take(bins) {
            assert!(
                *changed || after.as_slice()[i] == before.as_slice()[i],
                "{i}"
            );
        }
        let ring = |values: &TallyValues| {
            values
                .bins(Side::Reflected, Component::All)
                .iter()
                .take(5)
                .sum::<f64>()
        };
        assert_eq!(ring(&after), ring(&before));
        let folded = after.clone();
        after.clear_hits();
        let mut again = after.clone();
        mirror.fold(&mut again);
        assert_eq!(again, after);
        assert_ne!(folded, after);
    }

    impl TallyValues {
        /// A number of its own in each entry.
        fn with_numbers(mut self) -> Self {
            let values = self.as_mut_slice().iter_mut();
            values.enumerate().for_each(|(i, value)| *value = i as f64);
            self
        }
    }
}
