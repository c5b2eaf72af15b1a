//! Random surfaces controlled by their slopes.

use asperity_simulate::{Effort, Estimator, Outcome, Settings};
use asperity_tally::TallyResult;

use crate::support::{Rough, glass, run};

fn outcome(estimator: Estimator, seed: u64, surfaces: u64) -> Outcome {
    let settings = Settings {
        estimator,
        seed,
        effort: Effort::Rays {
            total: 400 * surfaces,
            surfaces,
        },
        mesh_quadrature: false,
        ..Settings::default()
    };
    run(Rough::smooth(2.0, 4.0, 32).case(glass(), 30.0), &settings)
}

/// Runs of 40 small surfaces, whose slopes differ much from one to the next, against plain rays on 1500 of them. A mean of 16 squared t
/// values of 39 degrees of freedom is 1.05 on average and scatters by 0.38.
#[test]
fn controlled_surfaces_agree_with_plain_ones_within_smaller_errors() {
    let truth = outcome(Estimator::Plain, 1000, 1500);
    assert_eq!(truth.work.slope_control, None);
    let truth = truth.statistics.budget().reflected;
    let runs = 16;
    let (mut squares, mut remaining) = (0.0, 0.0);
    for seed in 0..runs {
        let found = outcome(Estimator::Controlled, seed, 40);
        let part = found.work.slope_control;
        assert!(part.is_none_or(|part| part < 0.97), "{part:?}");
        remaining += part.unwrap_or(1.0) / runs as f64;
        let reflected = found.statistics.budget().reflected;
        let variance = reflected.se.unwrap().powi(2) + truth.se.unwrap().powi(2);
        squares += (reflected.mean - truth.mean).powi(2) / variance / runs as f64;
        let sum = found.statistics.means().budget().total();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
    println!("mean squared t {squares:.2}, variance that remains {remaining:.2}");
    assert!(squares < 1.05 + 4.0 * 0.38, "{squares}");
}

/// Too few surfaces for coefficients are left as they are.
#[test]
fn few_surfaces_are_not_controlled() {
    assert_eq!(
        outcome(Estimator::Controlled, 1, 31).work.slope_control,
        None
    );
}
