//! Path trial: compares path strategies by their cost.
//!
//! A pilot run follows paths by several strategies, with the same rays on the same surfaces. Each strategy is judged by
//! cost x variance of the target quantity, with the surfaces and rays that would be planned for it. The variance
//! between surfaces does not depend on the strategy; that of the strategy whose rays scatter least, where it
//! shows best, stands for all. Costs are counted, not timed.

use super::pilot::{Figures, cost_of_all};
use crate::input::target::{Target, ratio};
use crate::output::chosen_paths::{PathStrategy, TriedPaths};

/// Largest cost of a trial, as a fraction of the run that it is to shorten.
const MOST_OF_RUN: f64 = 0.08;

/// Returns `true` if a trial of cost `trial` is worth it for a run of cost `run`.
pub(crate) fn is_worth(trial: f64, run: f64) -> bool {
    trial <= MOST_OF_RUN * run
}

/// Cost x variance of each strategy on random surfaces. `most`: surfaces that results have room for.
pub(crate) fn cost_times_variance(strategies: &[Figures], target: Target, most: u64) -> Vec<f64> {
    let figures = strategies.iter().map(|one| one.figures);
    let with_hits = figures.filter(|figures| figures.variance_of_rays > 0.0);
    let clearest = with_hits.min_by(|a, b| a.variance_of_rays.total_cmp(&b.variance_of_rays));
    let of_surfaces = clearest.map_or(0.0, |figures| figures.variance_of_surfaces);
    let cost = |strategy: &Figures| {
        let effort = strategy.effort(target.error(), 1.0, most);
        let of_rays = strategy.figures.variance_of_rays / effort.rays_per_surface as f64;
        let variance = (of_surfaces + of_rays) / effort.surfaces as f64;
        variance * cost_of_all(&[*strategy], effort.surfaces, effort.rays_per_surface)
    };
    let errors = strategies.iter().map(|one| one.figures.variance_of_rays);
    without_hitless(strategies.iter().map(cost).collect(), errors)
}

/// Costs per strategy; infinite where the pilot recorded no hit, unless the first strategy has none either.
pub(crate) fn without_hitless(
    mut costs: Vec<f64>,
    mut errors: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let first_has_hits = errors.next().is_some_and(|error| error > 0.0);
    for (cost, error) in costs.iter_mut().skip(1).zip(errors) {
        if first_has_hits && error <= 0.0 {
            *cost = f64::INFINITY;
        }
    }
    costs
}

/// Number of the best strategy, the first of equals.
pub(crate) fn best(costs: &[f64]) -> usize {
    let mut best = 0;
    for (i, cost) in costs.iter().enumerate() {
        if *cost < costs[best] {
            best = i;
        }
    }
    best
}

/// Report of strategies with these costs; empty for one alone.
pub(crate) fn report(strategies: &[PathStrategy], costs: &[f64]) -> Vec<TriedPaths> {
    if strategies.len() == 1 {
        return Vec::new();
    }
    let tried = |(strategy, cost): (&PathStrategy, &f64)| TriedPaths {
        strategy: *strategy,
        relative_cost: ratio(*cost, costs[0]),
    };
    strategies.iter().zip(costs).map(tried).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::plan::pilot::tests::figures;
    use crate::input::settings::Settings;
    use crate::input::target::Quantity;
    use crate::methods::method::Method;

    fn strategy(v_s: f64, v_r: f64, cost_of_ray_ns: f64) -> Figures {
        let mut strategy = figures(v_s, v_r, None);
        strategy.figures.cost_of_ray_ns = cost_of_ray_ns;
        strategy
    }

    fn costs(strategies: &[Figures]) -> Vec<f64> {
        let target = Target::new(1e-3, Quantity::default()).unwrap();
        cost_times_variance(strategies, target, 1 << 40)
    }

    /// The least `(v_s + v_r / n) (c_s + n c_r)` is `(sqrt(v_s c_s) + sqrt(v_r c_r))^2`.
    #[test]
    fn strategies_are_judged_by_variance_and_cost_at_the_best_mix() {
        let v_s = 1e-4;
        let found = costs(&[strategy(v_s, 1.0, 1000.0), strategy(v_s, 1.2, 400.0)]);
        let least = |v_r: f64, c_r: f64| ((v_s * 1e6).sqrt() + (v_r * c_r).sqrt()).powi(2);
        let expected = least(1.2, 400.0) / least(1.0, 1000.0);
        // Surfaces and rays are whole numbers, of 4e3 and more.
        assert!((found[1] / found[0] / expected - 1.0).abs() < 1e-3);
        assert_eq!(best(&found), 1);
        // A total, of which rays that pick a branch scatter more than they cost less.
        let total = costs(&[strategy(v_s, 1.0, 1000.0), strategy(v_s, 286.0, 400.0)]);
        assert_eq!(best(&total), 0);
    }

    /// Ray noise inflates the variance between surfaces that a pilot run estimates; the inflated part must not count.
    #[test]
    fn the_variance_between_surfaces_is_that_of_the_clearest_strategy() {
        let [v_s, shown] = [1e-4, 3e-4];
        let found = costs(&[strategy(v_s, 1.0, 1000.0), strategy(shown, 2.0, 400.0)]);
        // The rays planned for it are those of the variance that it shows.
        let n = (2.0 * 1e6 / (shown * 400.0_f64)).sqrt();
        let judged = |v_s: f64| (v_s + 2.0 / n) * (1e6 + 400.0 * n);
        assert!((found[1] / judged(v_s) - 1.0).abs() < 1e-3, "{found:?}");
        assert!(judged(v_s) < found[0] && found[0] < judged(shown));
        assert_eq!(best(&found), 1);
    }

    /// Rays that pick a branch may meet none of little light.
    #[test]
    fn a_strategy_without_hits_is_not_taken() {
        let found = costs(&[strategy(1e-4, 1.0, 1000.0), strategy(0.0, 0.0, 400.0)]);
        let alone = costs(&[strategy(1e-4, 1.0, 1000.0)]);
        assert_eq!((best(&found), found[0]), (0, alone[0]));
        assert_eq!(found[1], f64::INFINITY);
    }

    #[test]
    fn equals_are_left_as_they_are_and_nothing_has_no_ratio() {
        assert_eq!(best(&costs(&[strategy(1.0, 1.0, 1.0); 3])), 0);
        let none = costs(&[strategy(0.0, 0.0, 1.0); 2]);
        assert_eq!((best(&none), &none[..]), (0, &[0.0, 0.0][..]));
        let paths = [PathStrategy::of(&Method::plain(&Settings::default())); 2];
        assert_eq!(report(&paths, &none)[1].relative_cost, 0.0);
        assert_eq!(report(&paths, &[2.0, 1.0])[1].relative_cost, 0.5);
        assert_eq!(report(&paths[..1], &[2.0]), []);
    }

    #[test]
    fn a_trial_may_take_a_small_part_of_the_run() {
        assert!(is_worth(1.0, 1.0 / MOST_OF_RUN) && !is_worth(1.0, 0.9 / MOST_OF_RUN));
    }
}
