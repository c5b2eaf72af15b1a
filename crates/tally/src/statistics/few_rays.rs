//! Few rays: the errors and confidence limits of estimates whose scatter says little.
//!
//! The scatter of few rays says little of how far they may be off. Where one ray in fifty carries half of the flux, eight rays
//! without it agree well with each other and lie far too low. Where no ray was seen to deviate from a control variate, nothing scatters
//! at all. An entry of fewer than [`FEW_RAYS`] rays that carry its quantity therefore has an error of at least one more ray of the root
//! mean square flux that rays carry to its side, times the root of the number of rays that are expected in it where that is below one.
//!
//! Rays are counted in bins. In rings and in-plane bins of single orders their number is that of equal rays which would scatter as
//! much. Rays that met the surface once carry nothing of what averaging s and p changes.
//!
//! An estimate of zero variance has no such error where all samples may have missed a rare event: [`zero_variance_limit`] bounds its
//! probability.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::batches::Estimate;
use super::sample_groups::{
    FEW_RAYS, entries_of, expected_samples, flux_groups, measured_groups, raise, raise_unseen,
};
use crate::spec::filters::Half;
use crate::values::single_path;
use crate::{
    Component, ControlVariate, Entries, Entry, Measure, Score, Side, TallyResult, TallySpec,
    TallyValues,
};

/// Upper limit, at 95 %, of the expected number of events of which none was seen: `-ln 0.05`, as the rule of three has it.
const UNSEEN: f64 = 3.0;

/// Returns `true` if an estimate has the relative standard error of fewer than [`FEW_RAYS`] rays of equal weight, or a larger one.
///
/// An exact value does not, nor does one without light and without error. A value of zero with an error does.
#[must_use]
pub fn is_of_few_rays(estimate: Estimate) -> bool {
    let few = |se: f64| se > estimate.mean.abs() / FEW_RAYS.sqrt();
    estimate.se.is_some_and(few)
}

/// Confidence limit of a zero-variance estimate: the probability, at 95 %, that an event which none of `samples` independent samples
/// showed does not exceed. It may exceed one.
#[must_use]
pub fn zero_variance_limit(samples: f64) -> f64 {
    UNSEEN / samples
}

/// A result of rays, as far as its errors depend on their number.
#[derive(Clone, Copy, Debug)]
pub struct RayErrors<'a> {
    /// All means.
    pub means: &'a TallyValues,
    /// Squares of the standard errors of all means by the scatter of rays; not a number where they do not scatter.
    pub squares: &'a TallyValues,
    /// Incident rays.
    pub rays: u64,
    /// Azimuth towards which the light travels, radians.
    pub forward_azimuth: f64,
    /// `true` if bins are averaged with their mirror images, whose rays count for both.
    pub folded: bool,
    /// The control variate, with which rays of order one are counted only where they deviate from it.
    pub control_variate: Option<&'a ControlVariate>,
}

/// Rays of one component of the light that ended on one side.
struct SideRays {
    side: Side,
    component: Component,
    /// Number of them.
    count: f64,
    /// Mean square of the flux fraction that each carries, relative to the flux of all incident rays.
    square: f64,
}

impl SideRays {
    /// Entries of a score that the rays add to, as far as they are kept: of their component, and of all light if the surface tells components
    /// apart.
    fn entries(&self, spec: &TallySpec, score: Score) -> Vec<Entries> {
        let all = Component::SURFACE.contains(&self.component);
        let components = [self.component].into_iter();
        components
            .chain(all.then_some(Component::All))
            .filter(|&component| spec.keeps(score, component))
            .map(|component| spec.component_entries(score, self.side, component))
            .collect()
    }
}

impl RayErrors<'_> {
    /// Standard errors below which none should be reported; zero where the scatter of rays can be trusted, and where no ray is
    /// expected.
    #[must_use]
    pub fn least(&self) -> TallyValues {
        let spec = *self.means.spec();
        let mut squares = TallyValues::zeros(spec);
        for side in spec.sides() {
            for &component in Component::SURFACE.iter().chain(spec.components()) {
                let rays = self.on_side(side, component);
                let in_rings = self.in_rings(&rays);
                let expected = expected_samples(&in_rings, FEW_RAYS);
                self.add_bins(&mut squares, &rays, &expected);
                self.add_rings(&mut squares, &rays, &in_rings, &expected);
                self.add_totals(&mut squares, &rays);
            }
        }
        self.raise_orders(&mut squares);
        self.raise_measures(&mut squares);
        let mut least = squares.map(|square| square.sqrt());
        self.add_budget(&mut least);
        least
    }

    /// The control variate, if it is subtracted from this component.
    fn expected(&self, component: Component) -> Option<&TallyValues> {
        let is_controlled = component == Component::Single;
        let control_variate = self.control_variate.filter(|_| is_controlled)?;
        Some(control_variate.expected())
    }

    fn on_side(&self, side: Side, component: Component) -> SideRays {
        let spec = self.means.spec();
        let rays = self.rays as f64;
        let hits: f64 = self
            .hits(side, component, 0..spec.grid().bins_per_side())
            .sum();
        let count = if self.folded { 0.5 } else { 1.0 } * hits * rays;
        let flux = spec.flux_entry(side, component);
        let square = match self.expected(component) {
            // Light carries its fraction of what it began with.
            Some(expected) => (expected[flux] / expected.budget().total() / rays).powi(2),
            None if count > 0.0 => {
                let mean = self.means[flux] / count;
                (self.squares[flux] / count).max(mean * mean)
            }
            None => 0.0,
        };
        SideRays {
            side,
            component,
            count,
            square,
        }
    }

    /// Rays that are expected in an entry, at most one: those found there or, of a control variate, the part of those that deviate, and of
    /// one more, that would be there if they deviated anywhere alike.
    fn expected_rays(&self, rays: &SideRays, entry: Entry, found: f64) -> f64 {
        let expected = match self.expected(rays.component) {
            Some(expected) => {
                let of_side = expected[self.means.spec().flux_entry(rays.side, rays.component)];
                let part = expected[entry] / of_side;
                found.max((rays.count + 1.0) * if part.is_nan() { 0.0 } else { part })
            }
            None => found,
        };
        expected.min(1.0)
    }

    /// Rays of each ring.
    fn in_rings(&self, rays: &SideRays) -> Vec<f64> {
        let grid = self.means.spec().grid();
        let bins: Vec<f64> = self
            .hits(rays.side, rays.component, 0..grid.bins_per_side())
            .collect();
        let each = if self.folded { 0.5 } else { 1.0 } * self.rays as f64;
        let in_ring = |bins: &[f64]| each * bins.iter().sum::<f64>();
        bins.chunks(grid.n_phi()).map(in_ring).collect()
    }

    /// Rays per incident ray in bins of a side. Bins and their mirror images have all rays of both.
    fn hits(
        &self,
        side: Side,
        component: Component,
        bins: Range<usize>,
    ) -> impl Iterator<Item = f64> {
        bins.map(move |i| self.means.hits(side, component, i))
    }

    /// `in_rings`: rays that are expected in rings of few.
    fn add_bins(&self, squares: &mut TallyValues, rays: &SideRays, in_rings: &[f64]) {
        let spec = *self.means.spec();
        let sectors = spec.grid().n_phi();
        // A ray counts half in its own bin and half in the mirror image.
        let square = if self.folded { 0.25 } else { 1.0 } * rays.square;
        let kept = rays.entries(&spec, Score::BinFlux);
        for (ring, &expected_there) in in_rings.iter().enumerate() {
            let hits = self.hits(
                rays.side,
                rays.component,
                ring * sectors..(ring + 1) * sectors,
            );
            let in_bins: Vec<f64> = hits.map(|hits| hits * self.rays as f64).collect();
            let in_ring = in_bins.iter().sum::<f64>().max(expected_there);
            for (sector, &found) in in_bins.iter().enumerate() {
                let of_ring = spec.grid().part_of_ring(rays.side, sector, in_ring);
                let i = ring * sectors + sector;
                let by_ring = match self.expected(rays.component) {
                    Some(_) => found,
                    None => found.max(of_ring),
                };
                if found < FEW_RAYS {
                    let expected = self.expected_rays(rays, kept[0].get(i), by_ring);
                    for bins in &kept {
                        squares[bins.get(i)] += square * expected;
                    }
                }
            }
        }
    }

    /// Rings, and the in-plane bins over them, whose rays are those of the bins that they lie over. `expected`: rays of rings of few.
    fn add_rings(
        &self,
        squares: &mut TallyValues,
        rays: &SideRays,
        in_rings: &[f64],
        expected: &[f64],
    ) {
        let spec = *self.means.spec();
        let grid = spec.grid();
        let filter = spec.in_plane_filter(rays.side);
        let kept = [Score::RingFlux, Score::InPlaneFlux].map(|score| rays.entries(&spec, score));
        for (ring, &in_ring) in in_rings.iter().enumerate() {
            let bins = ring * grid.n_phi()..(ring + 1) * grid.n_phi();
            let hits: Vec<f64> = self.hits(rays.side, rays.component, bins).collect();
            let each = if self.folded { 0.5 } else { 1.0 } * self.rays as f64;
            let ring_entries = kept[0].iter().map(|rings| rings.get(ring));
            self.add(squares, rays, in_ring, expected[ring], ring_entries);
            for half in Half::BOTH {
                let parts = self.parts_in_slice(rays.side, half);
                let found: f64 = hits
                    .iter()
                    .zip(parts)
                    .map(|(hits, part)| each * hits * part)
                    .sum();
                let evenly = spec.in_plane_half_width() / PI * in_ring.max(expected[ring]);
                let slices = kept[1].iter();
                let slices = slices.map(|slices| slices.get(filter.number(ring, half)));
                self.add(squares, rays, found, found.max(evenly), slices);
            }
        }
    }

    /// Parts of the sectors of a side that lie in one half of the in-plane slice.
    fn parts_in_slice(&self, side: Side, half: Half) -> impl Iterator<Item = f64> {
        let spec = *self.means.spec();
        let grid = spec.grid();
        let width = spec.in_plane_half_width();
        let middle = match half {
            Half::Forward => self.forward_azimuth,
            Half::Backward => self.forward_azimuth + PI,
        };
        (0..grid.n_phi()).map(move |sector| {
            let [from, to] = [0, 1].map(|k| grid.phi_edge(side, sector + k));
            let first = middle + TAU * ((from - middle) / TAU).floor();
            let overlap =
                |middle: f64| (to.min(middle + width) - from.max(middle - width)).max(0.0);
            [first, first + TAU, first + 2.0 * TAU]
                .map(overlap)
                .iter()
                .sum::<f64>()
                / (to - from)
        })
    }

    fn add_totals(&self, squares: &mut TallyValues, rays: &SideRays) {
        let spec = *self.means.spec();
        let path = spec.event_path_entry(rays.side, single_path(rays.side));
        let entries = rays.entries(&spec, Score::Flux).into_iter();
        let entries = entries.map(|entries| entries.get(0));
        let path = (rays.component == Component::Single).then_some(path);
        self.add(squares, rays, rays.count, rays.count, entries.chain(path));
    }

    /// Adds the square of the error of few rays to `entries`, the first of which tells how many rays deviate from a control variate.
    /// `found`: rays of them; `expected`: rays that are expected without a control variate.
    fn add(
        &self,
        squares: &mut TallyValues,
        rays: &SideRays,
        found: f64,
        expected: f64,
        entries: impl Iterator<Item = Entry>,
    ) {
        if found >= FEW_RAYS {
            return;
        }
        let mut entries = entries.peekable();
        let Some(&first) = entries.peek() else {
            return;
        };
        let expected = match self.expected(rays.component) {
            Some(_) => found,
            None => expected,
        };
        let square = rays.square * self.expected_rays(rays, first, expected);
        entries.for_each(|entry| squares[entry] += square);
    }

    /// Orders of two and more and their event paths, whose rays are not counted.
    fn raise_orders(&self, squares: &mut TallyValues) {
        let spec = *self.means.spec();
        let first = |side: Side| {
            let path = spec.event_path_entry(side, single_path(side));
            [spec.flux_entry(side, Component::Single), path]
        };
        let controlled: Vec<Entry> = spec.sides().flat_map(first).collect();
        for mut entries in flux_groups(&spec, [Score::RingFlux, Score::InPlaneFlux]) {
            entries.retain(|entry| !controlled.contains(entry));
            let samples: Vec<f64> = entries
                .iter()
                .map(|&entry| self.equal_rays(entry))
                .collect();
            self.raise(squares, &entries, &samples);
        }
        raise_unseen(
            squares,
            self.squares,
            |entry| self.equal_rays(entry),
            FEW_RAYS,
        );
    }

    fn raise(&self, squares: &mut TallyValues, entries: &[Entry], samples: &[f64]) {
        let limits = [FEW_RAYS, f64::INFINITY];
        raise(squares, self.squares, entries, samples, limits);
    }

    /// Number of equal rays that would scatter as much as the light of an entry.
    fn equal_rays(&self, entry: Entry) -> f64 {
        let mean = self.means[entry];
        match mean == 0.0 {
            true => 0.0,
            false => mean * mean / self.squares[entry],
        }
    }

    /// Measures of polarised light, by the rays that carry them: those of orders in which the measure is not zero on the side.
    fn raise_measures(&self, squares: &mut TallyValues) {
        let spec = *self.means.spec();
        let first = Measure::Element { row: 0, column: 0 };
        let rays = |flux: Entry| self.equal_rays(spec.measure_entry(flux, first).unwrap_or(flux));
        for measure in spec.polarimetry().measures() {
            let beside = |flux: Entry| spec.measure_entry(flux, measure);
            let is_carried = |side: Side, order: Component| {
                let entry = beside(spec.flux_entry(side, order));
                entry.is_some_and(|entry| self.means[entry] != 0.0 || self.squares[entry] > 0.0)
            };
            for (side, score, component) in measured_groups(&spec) {
                let of_order = |order: Component| component == Component::All || component == order;
                let orders = Component::ORDERS.into_iter();
                let orders: Vec<Component> = orders
                    .filter(|&order| of_order(order) && is_carried(side, order))
                    .collect();
                let fluxes = entries_of(&spec, score, side, component);
                let carriers = |i: usize| -> f64 {
                    if score != Score::BinFlux {
                        let of = |&order: &Component| {
                            rays(spec.component_entries(score, side, order).get(i))
                        };
                        orders.iter().map(of).sum()
                    } else if orders.contains(&Component::Single) {
                        rays(fluxes[i])
                    } else if orders.is_empty() {
                        0.0
                    } else {
                        self.rays as f64 * self.means.hits(side, Component::Multiple, i)
                    }
                };
                let samples: Vec<f64> = (0..fluxes.len()).map(carriers).collect();
                let entries: Vec<Entry> = fluxes.into_iter().filter_map(beside).collect();
                self.raise(squares, &entries, &samples);
            }
        }
    }

    /// Parts of the budget that a control variate expects and that are no flux of a side; and, since the budget closes, no part is less
    /// certain than all others together.
    fn add_budget(&self, least: &mut TallyValues) {
        let Some(control_variate) = self.control_variate else {
            return;
        };
        let expected = control_variate.expected();
        let known = expected.budget().total();
        let sides = Side::BOTH.map(|side| self.on_side(side, Component::Single).count);
        if sides.iter().sum::<f64>() < FEW_RAYS {
            let budget = TallySpec::BUDGET;
            let of_one_ray = |entry: Entry| expected[entry] / known / self.rays as f64;
            for part in [budget.absorbed, budget.truncated, budget.lost] {
                least[part] = of_one_ray(part);
            }
            least[budget.not_recorded] = of_one_ray(budget.truncated);
        }
        let parts = TallySpec::BUDGET.parts();
        let all = least.budget().total();
        for (part, own) in parts.into_iter().zip(least.budget().parts()) {
            least[part] = own.min(all - own);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HemisphereGrid, UnshadowedFluxes, VisibleFractions};

    const RAYS: u64 = 1000;

    fn spec() -> TallySpec {
        TallySpec::new(HemisphereGrid::new(2, 3).unwrap(), 0.2).unwrap()
    }

    /// Rays of order two that are reflected into these bins: 4 into the first, 40 into the second ring's first; each carries 0.1.
    fn means() -> TallyValues {
        let mut means = TallyValues::zeros(spec());
        let component = Component::Multiple;
        for (bin, rays) in [(0, 4.0), (3, 40.0)] {
            let flux = 0.1 * rays / RAYS as f64;
            let hits = spec().hit_entries(Side::Reflected, component);
            means[hits.get(bin)] = rays / RAYS as f64;
            for component in [component, Component::All] {
                means[spec().bin_entries(Side::Reflected, component).get(bin)] = flux;
                means[spec().flux_entry(Side::Reflected, component)] += flux;
            }
            means[spec()
                .ring_entries(Side::Reflected, Component::All)
                .get(bin / 3)] += flux;
        }
        means
    }

    fn least(squares: &TallyValues, folded: bool) -> TallyValues {
        RayErrors {
            means: &means(),
            squares,
            rays: RAYS,
            forward_azimuth: 0.0,
            folded,
            control_variate: None,
        }
        .least()
    }

    #[test]
    fn few_rays_are_known_by_their_relative_error() {
        let estimate = |mean, se| Estimate { mean, se };
        assert!(is_of_few_rays(estimate(1.0, Some(0.23))));
        assert!(!is_of_few_rays(estimate(1.0, Some(0.22))));
        assert!(!is_of_few_rays(estimate(1.0, Some(1.7e-5))));
        assert!(is_of_few_rays(estimate(0.0, Some(1e-9))));
        assert!(!is_of_few_rays(estimate(0.0, Some(0.0))));
        assert!(!is_of_few_rays(estimate(1.0, None)));
    }

    #[test]
    fn bins_of_few_rays_have_the_error_of_one_more() {
        let nothing = TallyValues::zeros(spec());
        let found = least(&nothing, false);
        let one_ray = 0.1 / RAYS as f64;
        for component in [Component::Multiple, Component::All] {
            let bins = found.bins(Side::Reflected, component);
            let near = |i: usize, expected: f64| (bins.get(i) - expected).abs() < 1e-12;
            assert!(near(0, one_ray));
            // None was seen in its neighbours, where as many are expected.
            assert!(near(1, one_ray) && near(2, one_ray));
            // Forty rays scatter as they do; where none was seen beside them, one may have been missed.
            assert!(near(3, 0.0) && near(4, one_ray));
        }
        let rings = found.rings(Side::Reflected, Component::All);
        assert!((rings.get(0) - one_ray).abs() < 1e-12 && rings.get(1) == 0.0);
        // No ray has reached the other side, and enough have reached this one.
        assert_eq!(found.flux(Side::Reflected, Component::All), 0.0);
        let bins = found.bins(Side::Transmitted, Component::All);
        assert!(bins.iter().all(|error| error == 0.0));
    }

    /// Rays that carry ten times their mean now and then: the mean square is that which the scatter of the side shows.
    #[test]
    fn the_error_of_a_ray_is_that_of_the_side() {
        let mut squares = TallyValues::zeros(spec());
        let mean_square = 0.09 / (RAYS as f64).powi(2);
        squares[spec().flux_entry(Side::Reflected, Component::Multiple)] = 44.0 * mean_square;
        let bins = |found: &TallyValues| found.bins(Side::Reflected, Component::All).get(0);
        let found = bins(&least(&squares, false));
        assert!((found - 0.3 / RAYS as f64).abs() < 1e-12, "{found}");
        // Folded, 22 rays count twice, and carry half of their flux into each of two bins.
        let folded = bins(&least(&squares, true));
        assert!((folded / found - 0.5_f64.sqrt()).abs() < 1e-12, "{folded}");
        // Blocks that do not scatter at all, or a single one
        squares[spec().flux_entry(Side::Reflected, Component::Multiple)] = f64::NAN;
        assert!((bins(&least(&squares, false)) - 0.1 / RAYS as f64).abs() < 1e-12);
    }

    /// A tenth of the light is reflected, half is transmitted, a fifth absorbed, before fractions.
    fn control_variate() -> ControlVariate {
        let fluxes = UnshadowedFluxes {
            bins: [vec![0.1 / 6.0; 6], vec![0.5 / 6.0; 6]].concat(),
            rings: [vec![0.05; 2], vec![0.25; 2]],
            in_plane: [vec![0.001; 4], vec![0.005; 4]],
            absorbed: 0.2,
        };
        let fractions = VisibleFractions {
            rings: [vec![0.5, 0.0], vec![1.0, 0.8]],
            absorbed: 0.9,
        };
        ControlVariate::new(spec(), fractions, &fluxes)
    }

    #[test]
    fn where_no_ray_deviates_from_a_control_variate_the_next_one_might() {
        let control_variate = control_variate();
        let known = 0.025 + 0.45 + 0.18;
        let zeros = TallyValues::zeros(spec());
        let mut means = zeros.clone();
        let least = |means: &TallyValues| {
            RayErrors {
                means,
                squares: &zeros,
                rays: RAYS,
                forward_azimuth: 0.0,
                folded: false,
                control_variate: Some(&control_variate),
            }
            .least()
        };
        let found = least(&means);
        let one_ray = 1e-3 * 0.025 / known;
        let bins = found.bins(Side::Reflected, Component::All);
        // One ray anywhere on the side: a third of it, on average, in each bin that is controlled.
        assert!((bins.get(0) - one_ray * (1.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        // A ring of which nothing is visible is not controlled.
        assert_eq!(bins.get(3), 0.0);
        let of_one = 1e-3 * 0.45 / known;
        assert!((found.order(Side::Transmitted, 1) - of_one).abs() < 1e-15);
        // What is not transmitted is reflected or absorbed.
        assert!((found.budget().transmitted - 1e-3 * 0.205 / known).abs() < 1e-15);
        assert_eq!(found.budget().lost, 0.0);

        // Where thirty rays deviate in the neighbouring bin, ten may in this one; totals scatter as they do.
        let hits = spec().hit_entries(Side::Reflected, Component::Single);
        means[hits.get(1)] = 30.0 / RAYS as f64;
        let found = least(&means);
        let bins = found.bins(Side::Reflected, Component::All);
        assert!((bins.get(0) - one_ray).abs() < 1e-15 && bins.get(1) == 0.0);
        assert_eq!(found.flux(Side::Reflected, Component::Single), 0.0);
    }

    /// Four rays scattered twice reach one bin, and 40 scattered once another: the first alone carry what averaging changes.
    #[test]
    fn what_averaging_changes_is_carried_by_rays_scattered_twice() {
        let spec = spec().with_polarimetry(crate::Polarimetry::Averaging);
        let side = Side::Reflected;
        let (mut means, mut squares) = (TallyValues::zeros(spec), TallyValues::zeros(spec));
        let one = 0.1 / RAYS as f64;
        let beside = |flux| spec.measure_entry(flux, Measure::Averaging).unwrap();
        let bins = spec.bin_entries(side, Component::All);
        for (bin, rays, component) in [(0, 4.0, Component::Multiple), (4, 40.0, Component::Single)]
        {
            means[spec.hit_entries(side, component).get(bin)] = rays / RAYS as f64;
            means[bins.get(bin)] = rays * one;
        }
        let [second, difference] = {
            let flux = spec.flux_entry(side, Component::Order(2));
            [flux, beside(flux)]
        };
        (means[second], squares[second]) = (4.0 * one, 4.0 * one * one);
        for entry in [difference, beside(bins.get(0))] {
            (means[entry], squares[entry]) = (0.02 * one, 4.0 * (0.1 * one).powi(2));
        }
        let found = least_of(&means, &squares);
        let near = |bin: usize, expected: f64| {
            let found = found[beside(bins.get(bin))];
            assert!((found - expected).abs() < 1e-12, "{bin}: {found}");
        };
        near(0, 0.1 * one);
        // The next may fall into any of five bins, 40 other rays or not.
        near(4, 0.1 * one * 0.2_f64.sqrt());
        near(1, 0.1 * one * 0.2_f64.sqrt());
    }

    /// Rays of the forward half tell nothing of the backward one.
    #[test]
    fn in_plane_bins_rest_on_the_rays_of_the_bins_there() {
        let mut means = TallyValues::zeros(spec());
        // Sectors of a third of a turn, the first from azimuth 0: that and the last hold the forward half.
        for bin in [0, 2] {
            let hits = spec().hit_entries(Side::Reflected, Component::Multiple);
            means[hits.get(bin)] = 900.0 / RAYS as f64;
        }
        let component = Component::Multiple;
        means[spec().flux_entry(Side::Reflected, component)] = 0.1;
        let squares = TallyValues::zeros(spec());
        let found = least_of(&means, &squares);
        let filter = spec().in_plane_filter(Side::Reflected);
        let slice = |half| {
            let slices = spec().in_plane_entries(Side::Reflected, Component::All);
            found[slices.get(filter.number(0, half))]
        };
        assert_eq!(slice(Half::Forward), 0.0);
        assert!(slice(Half::Backward) > 0.0);
    }

    fn least_of(means: &TallyValues, squares: &TallyValues) -> TallyValues {
        RayErrors {
            means,
            squares,
            rays: RAYS,
            forward_azimuth: 0.0,
            folded: false,
            control_variate: None,
        }
        .least()
    }
}
