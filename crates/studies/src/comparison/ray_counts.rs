//! Ray counts: how many rays lie behind each bin, ring and side that a model is tested in.

use asperity_analysis::{Expectation, RayCount};
use asperity_simulate::Outcome;
use asperity_tally::{Component, Side, TallySpec, TallyValues};
use asperity_tracer::Branching;

/// Counts the rays of one component of the light, of a case and of a model.
pub(super) struct RayCounts<'a> {
    pub(super) outcome: &'a Outcome,
    pub(super) expectation: &'a Expectation,
    pub(super) component: Component,
    /// `true` if rings are spread evenly over azimuth, so that each bin stands for its ring.
    pub(super) free_azimuth: bool,
}

impl RayCounts<'_> {
    fn spec(&self) -> &TallySpec {
        self.expectation.statistics().spec()
    }

    /// Counts of every recorded bin. Where rings are spread evenly over azimuth, a bin stands for its ring.
    pub(super) fn of_bins(&self) -> Vec<RayCount> {
        let sectors = self.spec().grid().n_phi();
        let bins = 0..self.spec().recorded_bins().len();
        if !self.free_azimuth {
            return bins.map(|i| self.of(&[i], 1.0)).collect();
        }
        let rings = bins.step_by(sectors).map(|first| {
            let of_ring = self.of_groups(&[(first..first + sectors).collect()])[0];
            RayCount {
                flux: of_ring.flux / sectors as f64,
                ..of_ring
            }
        });
        rings.flat_map(|of_ring| vec![of_ring; sectors]).collect()
    }

    /// Counts of sums of bins, which count from the first that is recorded.
    pub(super) fn of_groups(&self, groups: &[Vec<usize>]) -> Vec<RayCount> {
        // The rays of a bin and of its mirror image count for both.
        let weight = if self.outcome.work.folded { 0.5 } else { 1.0 };
        let of_group = |group: &Vec<usize>| self.of(group, weight);
        groups.iter().map(of_group).collect()
    }

    /// Count of a sum of bins, each of whose rays counts with `weight`.
    fn of(&self, bins: &[usize], weight: f64) -> RayCount {
        let means = self.outcome.statistics.means();
        let of_model = self.expectation.statistics().means();
        let component = self.component;
        let first = self.spec().recorded_bins().start;
        let sum = |values: &TallyValues, component| -> f64 {
            let hits = bins.iter().map(|i| values.grid_hits(component, first + i));
            weight * hits.sum::<f64>()
        };
        let fluxes = self.spec().recorded_entries(component);
        let sum_of_fluxes =
            |values: &TallyValues| -> f64 { bins.iter().map(|&i| values[fluxes.get(i)]).sum() };
        let rays = self.outcome.work.rays as f64;
        let found = sum(means, component);
        let (inside, elsewhere) = match self.outcome.work.control_variate {
            // Under a control variate a ray counts only if it deviates from what is expected.
            Some(_) => (found, f64::INFINITY),
            None => (
                found.max(sum_of_fluxes(of_model)),
                self.elsewhere(bins, &sum),
            ),
        };
        // Few rays of a sampled model are no better than few rays on the surfaces.
        let of_sampled = if self.expectation.samples(component) {
            sum(of_model, component) * self.expectation.rays() as f64
        } else {
            f64::INFINITY
        };
        let of_surface = rays / self.outcome.surfaces.len() as f64;
        RayCount {
            inside: (inside * rays).min(of_sampled),
            elsewhere: elsewhere * rays,
            flux: if found > 0.0 {
                sum_of_fluxes(means) / found / of_surface
            } else {
                0.0
            },
        }
    }

    /// Rays per incident ray that ended outside of these bins of one side, or there on another path: those that were scattered
    /// more than once, those that were scattered once to elsewhere on the side, and, if one branch is picked, those of the other
    /// side. Light of several orders has no such place of its own: any number of rays may miss it.
    fn elsewhere(&self, bins: &[usize], sum: &impl Fn(&TallyValues, Component) -> f64) -> f64 {
        let means = self.outcome.statistics.means();
        let spec = self.spec();
        let of_a_side = spec.grid().bins_per_side();
        let all = |side: Side, component| -> f64 {
            (0..of_a_side).map(|i| means.hits(side, component, i)).sum()
        };
        let on_both = |component| {
            Side::BOTH
                .map(|side| all(side, component))
                .iter()
                .sum::<f64>()
        };
        // Bins are counted twice where they are folded, here as in `sum`.
        let weight = if self.outcome.work.folded { 0.5 } else { 1.0 };
        match self.component {
            Component::Single | Component::All => {
                let side = Side::BOTH[(spec.recorded_bins().start + bins[0]) / of_a_side];
                let of_side = match self.outcome.work.branching {
                    Branching::Pick => on_both(Component::Single),
                    _ => all(side, Component::Single),
                };
                let missing = weight * of_side - sum(means, Component::Single);
                weight * on_both(Component::Multiple) + missing.max(0.0)
            }
            Component::Multiple => f64::INFINITY,
            component => (weight * on_both(Component::All) - sum(means, component)).max(0.0),
        }
    }
}
