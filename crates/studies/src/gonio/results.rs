//! What was found for one direction.

use std::borrow::Cow;

use asperity_simulate::Outcome;
use asperity_tally::{Component, Estimate, Score, Side, TallyResult, TallySpec, TallyStatistics};
use serde::{Deserialize, Serialize};

use crate::output::Supported;
use crate::report::energies::lost_warning;
use crate::report::flux_support::FluxSupport;

/// Means with their standard errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Means {
    /// The means.
    pub mean: Vec<f64>,
    /// Their standard errors; `None` if there are none to be had.
    pub se: Option<Vec<f64>>,
}

impl Means {
    fn collect(estimates: Vec<Estimate>) -> Self {
        Self {
            mean: estimates.iter().map(|e| e.mean).collect(),
            se: estimates.iter().map(|e| e.se).collect(),
        }
    }

    /// Mean and error of quantity `i`.
    #[must_use]
    pub fn estimate(&self, i: usize) -> Estimate {
        Estimate {
            mean: self.mean[i],
            se: self.se.as_ref().map(|se| se[i]),
        }
    }

    fn is_sound(&self, len: usize) -> bool {
        let errors = self.se.iter().flatten();
        self.mean.len() == len
            && self.mean.iter().all(|v| v.abs() <= 2.0)
            && self.se.as_ref().is_none_or(|se| se.len() == len)
            && errors.into_iter().all(|e| (0.0..=2.0).contains(e))
    }
}

/// Flux fractions of one component of the light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredComponent {
    /// `all`; `unscattered`, `once` or `more` with a medium; `single` or `multiple` without.
    pub name: String,
    /// By side, of those recorded.
    pub sides: Means,
    /// By bin of the grid, of the recorded sides.
    pub bins: Means,
    /// By recorded side and bin of the in-plane profile.
    pub in_plane: Means,
}

/// All that was found for a direction: what its file holds. Fluxes are fractions of what falls on the mean plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectionResults {
    /// Surfaces.
    pub surfaces: u64,
    /// Rays over all of them.
    pub rays: u64,
    /// What the errors come from: `surfaces`, `ray blocks`, or a `deviation bound` where nothing was traced.
    pub errors_from: String,
    /// What fluxes rest on whose samples all agree.
    pub support: FluxSupport,
    /// What was absorbed, truncated and lost.
    pub budget: Means,
    /// All light, then its components, which add up to it.
    pub components: Vec<MeasuredComponent>,
    /// What a reader should know.
    pub warnings: Vec<String>,
}

/// The components that results keep: all light, and those that it is split into.
fn kept_components(spec: &TallySpec) -> impl Iterator<Item = Component> {
    [Component::All]
        .into_iter()
        .chain(spec.split().iter().copied())
}

/// Names of the components that results of a spec have.
pub(super) fn component_names(spec: &TallySpec) -> Vec<Cow<'static, str>> {
    kept_components(spec).map(Component::name).collect()
}

/// Flux into the in-plane bins of a side; of a component that no tally keeps, the sum of the orders that it
/// consists of.
fn in_plane(statistics: &TallyStatistics, side: Side, component: Component) -> Vec<Estimate> {
    if statistics.spec().keeps(Score::InPlaneFlux, component) {
        return statistics.in_plane(side, component).iter().collect();
    }
    let higher = Component::ORDERS[1..].iter();
    let sums = higher.map(|&order| statistics.in_plane(side, order).iter().collect());
    // Errors of a sum add up at most.
    let add = |(a, b): (Estimate, Estimate)| Estimate {
        mean: a.mean + b.mean,
        se: a.se.zip(b.se).map(|(a, b)| a + b),
    };
    sums.reduce(|a: Vec<Estimate>, b| a.into_iter().zip(b).map(add).collect())
        .unwrap_or_default()
}

impl MeasuredComponent {
    fn of(component: Component, statistics: &TallyStatistics) -> Self {
        let sides = statistics.spec().sides();
        let collect = |of: &dyn Fn(Side) -> Vec<Estimate>| {
            Means::collect(sides.clone().flat_map(of).collect())
        };
        Self {
            name: component.name().into_owned(),
            sides: collect(&|side| vec![statistics.flux(side, component)]),
            bins: collect(&|side| statistics.bins(side, component).iter().collect()),
            in_plane: collect(&|side| in_plane(statistics, side, component)),
        }
    }

    /// Flux that left on `side`; `None` if it was not requested.
    #[must_use]
    pub fn side(&self, spec: &TallySpec, side: Side) -> Option<Estimate> {
        let place = spec.sides().position(|s| s == side)?;
        Some(self.sides.estimate(place))
    }

    /// Flux into bin `bin` of the grid; `None` if its side was not requested.
    #[must_use]
    pub fn bin(&self, spec: &TallySpec, bin: usize) -> Option<Estimate> {
        let recorded = spec.recorded_bins();
        recorded
            .contains(&bin)
            .then(|| self.bins.estimate(bin - recorded.start))
    }

    /// Flux into in-plane bin `i` of `side`; `None` if it was not requested.
    #[must_use]
    pub fn in_plane(&self, spec: &TallySpec, side: Side, i: usize) -> Option<Estimate> {
        let place = spec.sides().position(|s| s == side)?;
        Some(self.in_plane.estimate(place * spec.in_plane_len() + i))
    }
}

/// What light fluxes may miss each other by where they add up: rounding, of sums over all bins.
const ROUNDING: f64 = 1e-9;

impl DirectionResults {
    /// Takes from a run what a measurement keeps.
    pub(super) fn of(outcome: &Outcome) -> Self {
        let statistics = &outcome.statistics;
        Self {
            surfaces: outcome.work.realisations,
            rays: outcome.work.rays,
            errors_from: outcome.errors_from.name().to_owned(),
            support: FluxSupport::of(outcome),
            budget: endings_of(statistics),
            components: components_of(statistics),
            warnings: lost_warning(statistics).into_iter().collect(),
        }
    }

    /// Returns the flux of component number `component` that left on `side`, or `None` if it was not recorded.
    pub(super) fn flux(&self, spec: &TallySpec, component: usize, side: Side) -> Option<Supported> {
        let flux = self.components.get(component)?.side(spec, side)?;
        Some(self.support.flux(side, flux))
    }

    /// Flux that was absorbed, truncated and lost.
    pub(super) fn endings(&self) -> [Supported; 3] {
        let [absorbed, truncated, lost] = [0, 1, 2].map(|i| self.budget.estimate(i));
        [
            self.support.absorbed(absorbed),
            self.support.ended(truncated),
            self.support.ended(lost),
        ]
    }

    /// Whether a run with this spec may have found these numbers: they are fluxes and add up.
    pub(super) fn is_sound(&self, spec: &TallySpec) -> bool {
        let recorded = spec.recorded_bins().len();
        let sides = spec.sides().count();
        let lengths = |component: &MeasuredComponent| {
            component.sides.is_sound(sides)
                && component.bins.is_sound(recorded)
                && component.in_plane.is_sound(sides * spec.in_plane_len())
        };
        let names = self
            .components
            .iter()
            .map(|component| component.name.as_str());
        if !(names.eq(component_names(spec))
            && self.budget.is_sound(3)
            && self.components.iter().all(lengths))
        {
            return false;
        }
        let sum = |values: &[f64]| values.iter().sum::<f64>();
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING;
        let (all, components) = (&self.components[0], &self.components[1..]);
        let adds_up = |of: fn(&MeasuredComponent) -> &Means| {
            (0..of(all).mean.len()).all(|i| {
                near(
                    components.iter().map(|p| of(p).mean[i]).sum(),
                    of(all).mean[i],
                )
            })
        };
        let fills_sides = |component: &MeasuredComponent| {
            component
                .bins
                .mean
                .chunks(spec.grid().bins_per_side())
                .zip(&component.sides.mean)
                .all(|(bins, side)| near(sum(bins), *side))
        };
        near(sum(&all.sides.mean) + sum(&self.budget.mean), 1.0)
            && adds_up(|component| &component.sides)
            && adds_up(|component| &component.bins)
            && adds_up(|component| &component.in_plane)
            && self.components.iter().all(fills_sides)
    }
}

/// Flux that was absorbed, truncated and lost.
fn endings_of(statistics: &TallyStatistics) -> Means {
    let budget = statistics.budget();
    Means::collect(vec![budget.absorbed, budget.truncated, budget.lost])
}

fn components_of(statistics: &TallyStatistics) -> Vec<MeasuredComponent> {
    kept_components(statistics.spec())
        .map(|component| MeasuredComponent::of(component, statistics))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_tally::{HemisphereGrid, TallyValues};

    /// Results of a tally whose bins, sides and components hold what adds up.
    fn results(spec: &TallySpec) -> DirectionResults {
        let mut tally = TallyValues::zeros(*spec);
        let side = Side::Reflected;
        let [all, unscattered, once, more] = [1.0, 0.5, 0.25, 0.25];
        for (component, fraction) in [
            (Component::All, all),
            (Component::Unscattered, unscattered),
            (Component::ScatteredOnce, once),
            (Component::ScatteredMore, more),
        ] {
            tally[spec.flux_entry(side, component)] = 0.75 * fraction;
            tally[spec.bin_entries(side, component).get(1)] = 0.75 * fraction;
            tally[spec.in_plane_entries(side, component).get(0)] = 0.1 * fraction;
        }
        tally[TallySpec::BUDGET.absorbed] = 0.25;
        let mut statistics = TallyStatistics::new(*spec);
        (0..2).for_each(|_| statistics.push(&tally));
        let support = serde_json::json!({
            "basis": { "samples": 1000.0 },
            "has_medium": true,
            "absorbs": true,
            "transmits": true,
        });
        DirectionResults {
            surfaces: 2,
            rays: 1000,
            errors_from: "surfaces".to_owned(),
            support: serde_json::from_value(support).unwrap(),
            budget: endings_of(&statistics),
            components: components_of(&statistics),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn numbers_that_no_run_finds_are_not_believed() {
        let grid = HemisphereGrid::new(2, 3).unwrap();
        let spec = TallySpec::new(grid, 0.1).unwrap().with_medium();
        assert!(results(&spec).is_sound(&spec));
        // Another grid, other components.
        let other = HemisphereGrid::new(3, 2).unwrap();
        let other = TallySpec::new(other, 0.1).unwrap().with_medium();
        assert!(!results(&spec).is_sound(&other));
        assert!(!results(&spec).is_sound(&TallySpec::new(grid, 0.1).unwrap()));
        type Spoil = fn(&mut DirectionResults);
        let spoilt: [(&str, Spoil); 9] = [
            ("budget", |r| r.budget.mean[0] = 0.3),
            ("side", |r| r.components[0].sides.mean[0] = 0.7),
            ("bin", |r| r.components[0].bins.mean[1] = 0.7),
            ("bin of a component", |r| r.components[2].bins.mean[0] = 0.1),
            ("profile", |r| r.components[1].in_plane.mean[0] = 0.2),
            ("name", |r| r.components[1].name = "once".to_owned()),
            ("component", |r| drop(r.components.pop())),
            ("error below zero", |r| {
                r.components[0].bins.se = Some(vec![-1.0; 12]);
            }),
            ("errors of other bins", |r| {
                r.components[0].bins.se = Some(vec![0.0; 3])
            }),
        ];
        for (what, spoil) in spoilt {
            let mut results = results(&spec);
            spoil(&mut results);
            assert!(!results.is_sound(&spec), "{what}");
        }
    }
}
