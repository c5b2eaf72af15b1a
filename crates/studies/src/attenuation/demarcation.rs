//! The angle at which shadow begins, by four definitions.

use asperity_analysis::smith_demarcation;
use asperity_numerics::elementary::atan;
use asperity_tally::Estimate;
use asperity_tracer::Horizon;
use serde::{Deserialize, Serialize};

use super::estimate::mean;
use super::plan::RoughSurfaces;

/// The fraction of points whose shadow counts as its beginning.
const SHADOWED_FRACTION: f64 = 0.01;

/// Rises `cot(theta)` at which shadow begins on one surface, if it does above those that were told apart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Rises {
    first_dark: f64,
    first_shadowed: Option<f64>,
    one_percent_dark: Option<f64>,
    one_percent_shadowed: Option<f64>,
}

impl Rises {
    /// Demarcation of a surface whose points have these horizons, chunk by chunk, which tell rises of `least` and more apart.
    pub(super) fn of(horizons: &[Vec<Horizon>], least: f64) -> Self {
        let horizons = || horizons.iter().flatten();
        let mut steepest: Vec<f64> = horizons().map(|h| h.steepest()).collect();
        let mut own: Vec<f64> = horizons().map(|h| h.own).collect();
        // The steepest first.
        for rises in [&mut steepest, &mut own] {
            rises.sort_unstable_by(|a, b| b.total_cmp(a));
        }
        let enough = (SHADOWED_FRACTION * own.len() as f64).ceil() as usize;
        let told = |rise: &f64| *rise > least;
        let shadowed = horizons().filter(|h| h.beyond > h.own);
        Self {
            first_dark: steepest[0],
            first_shadowed: shadowed
                .map(|h| h.beyond)
                .max_by(f64::total_cmp)
                .filter(told),
            one_percent_dark: steepest.get(enough.max(1) - 1).copied().filter(told),
            one_percent_shadowed: shadowed_fraction(&steepest, &own, enough).filter(told),
        }
    }
}

/// The steepest rise at which `enough` points face the light and yet are dark, both lists in falling
/// order: those with a horizon above it less those that face away.
fn shadowed_fraction(steepest: &[f64], own: &[f64], enough: usize) -> Option<f64> {
    let mut away = 0;
    steepest.iter().enumerate().find_map(|(dark, &rise)| {
        while away < own.len() && own[away] >= rise {
            away += 1;
        }
        (dark + 1 >= enough + away).then_some(rise)
    })
}

/// The angles at which shadow begins on surfaces of one sigma, degrees.
///
/// *Dark* are points that face away from the light or do not see it; *shadowed* those alone that face it and
/// do not see it. Along any line the steepest rise from a point is at most the steepest slope, so the first
/// dark point is one that faces away.
#[derive(Clone, Debug)]
pub struct Demarcation {
    /// Root mean square height of the surfaces, length units.
    pub sigma: f64,
    /// The smallest angle at which one point is dark: beyond it, `lit` is below one.
    pub first_dark: Estimate,
    /// `cot(first_dark)` over the deviation of the slope: the same for every sigma, if angles scale.
    pub first_dark_scaled: Estimate,
    /// The smallest angle at which one point that faces the light is shadowed.
    pub first_shadowed: Option<Estimate>,
    /// The smallest angle at which one point in a hundred is dark.
    pub one_percent_dark: Option<Estimate>,
    /// The smallest angle at which one point in a hundred faces the light and is shadowed.
    pub one_percent_shadowed: Option<Estimate>,
    /// Smith's expectation of `one_percent_dark`.
    pub smith_one_percent_dark: Option<f64>,
    /// Smith's expectation of `one_percent_shadowed`.
    pub smith_one_percent_shadowed: Option<f64>,
    /// The angle that Table 1 of the 2019 paper gives, where its text repeats it and the surfaces are its
    /// own.
    pub paper: Option<f64>,
}

/// Angles of the 2019 paper, Secs. 5.1 and 5.2, for surfaces with tau = 0.5: sigma and degrees.
const PAPER: [(f64, f64); 3] = [(0.1, 85.8), (0.5, 21.4), (0.9, 15.6)];

impl Demarcation {
    /// Demarcation of surfaces `factor` times as high as those with these `rises`.
    pub(super) fn new(surfaces: &RoughSurfaces, tau: f64, rises: &[Rises], factor: f64) -> Self {
        let RoughSurfaces { sigma, slopes, .. } = surfaces;
        let angle = |rise: f64| atan(rise.recip()).to_degrees();
        // An angle that one of the surfaces does not have is none of the ensemble.
        let angles = |of: fn(&Rises) -> Option<f64>| {
            let found: Option<Vec<f64>> = rises.iter().map(of).collect();
            found.map(|found| mean(found.into_iter().map(|rise| angle(factor * rise))))
        };
        let deviation = slopes.xx().sqrt();
        let smith =
            |within_facing| smith_demarcation(slopes, SHADOWED_FRACTION, within_facing).map(angle);
        let paper = PAPER.iter().find(|(of, _)| of == sigma && tau == 0.5);
        let first_dark = rises.iter().map(|rises| factor * rises.first_dark);
        Self {
            sigma: *sigma,
            first_dark: mean(first_dark.clone().map(angle)),
            first_dark_scaled: mean(first_dark.map(|rise| rise / deviation)),
            first_shadowed: angles(|rises| rises.first_shadowed),
            one_percent_dark: angles(|rises| rises.one_percent_dark),
            one_percent_shadowed: angles(|rises| rises.one_percent_shadowed),
            smith_one_percent_dark: smith(false),
            smith_one_percent_shadowed: smith(true),
            paper: paper.map(|(_, degrees)| *degrees),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shadow_begins_where_points_are_counted() {
        // 300 points: each faces away beyond a rise of its own, and is hidden beyond a steeper one, for a
        // third of them a good deal steeper.
        let horizons: Vec<Horizon> = (0..300)
            .map(|i| {
                let own = 0.01 * f64::from(i % 97) - 0.2;
                let above = if i % 3 == 0 { 0.3 } else { -0.1 };
                Horizon {
                    own,
                    beyond: own + above + 1e-5 * f64::from(i),
                }
            })
            .collect();
        let rises = Rises::of(std::slice::from_ref(&horizons), 0.05);
        let dark = |c: f64| horizons.iter().filter(|h| h.steepest() > c).count();
        let shadowed = |c: f64| {
            horizons
                .iter()
                .filter(|h| h.own < c && c < h.beyond)
                .count()
        };
        let (below, above) = (1.0 - 1e-9, 1.0 + 1e-9);
        let c = rises.first_dark;
        assert!(dark(above * c) == 0 && dark(below * c) == 1);
        let c = rises.first_shadowed.unwrap();
        assert!(shadowed(above * c) == 0 && shadowed(below * c) == 1);
        let c = rises.one_percent_dark.unwrap();
        assert!(dark(above * c) == 2 && dark(below * c) == 3);
        let c = rises.one_percent_shadowed.unwrap();
        assert!(shadowed(above * c) == 2 && shadowed(below * c) == 3, "{c}");
        // Rises that are not told apart are no answer.
        assert_eq!(Rises::of(&[horizons], 2.0).one_percent_dark, None);
    }
}
