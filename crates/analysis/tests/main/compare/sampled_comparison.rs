//! Surfaces against a model that is itself sampled: its noise must be part of the errors.

use asperity_analysis::{ComparisonError, Expected, RayCount, compare};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const BINS: usize = 12;
const SURFACES: usize = 12;

/// Batches of fluxes of mean 1 whose bins share a factor.
fn batches(rng: &mut ChaCha8Rng, deviation: f64) -> Vec<Vec<f64>> {
    let mut normal = || {
        let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
        radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
    };
    (0..SURFACES)
        .map(|_| {
            let common = normal();
            (0..BINS)
                .map(|_| 1.0 + deviation * (common + normal()))
                .collect()
        })
        .collect()
}

fn slices(batches: &[Vec<f64>]) -> Vec<&[f64]> {
    batches.iter().map(Vec::as_slice).collect()
}

#[test]
fn a_correct_model_keeps_its_level_only_if_its_noise_counts() {
    // The model's mean is as uncertain as that of the surfaces.
    const REPETITIONS: usize = 400;
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let (mut paired, mut as_exact) = (0, 0);
    for seed in 0..REPETITIONS as u64 {
        let surfaces = batches(&mut rng, 0.1);
        let model = batches(&mut rng, 0.1);
        let mean: Vec<f64> = (0..BINS)
            .map(|b| model.iter().map(|batch| batch[b]).sum::<f64>() / SURFACES as f64)
            .collect();
        let p = |expected| {
            let result =
                compare(&surfaces, expected, &[RayCount::UNLIMITED; BINS], &[], seed).unwrap();
            result.test.unwrap().p
        };
        let model = slices(&model);
        paired += usize::from(p(Expected::Batches(&model)) < 0.05);
        as_exact += usize::from(p(Expected::Exact(&mean)) < 0.05);
    }
    println!("of {REPETITIONS} at level 0.05: {paired} with batches, {as_exact} taken as exact");
    // 20 +- 4.4 are due.
    assert!((7..=34).contains(&paired));
    // t is larger by the root of two: far more fail.
    assert!(as_exact > 60);
}

#[test]
fn errors_are_those_of_the_difference() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    let surfaces = batches(&mut rng, 0.1);
    let model = batches(&mut rng, 0.3);
    let of_batches =
        |expected| compare(&surfaces, expected, &[RayCount::UNLIMITED; BINS], &[], 1).unwrap();
    let batches = slices(&model);
    let paired = of_batches(Expected::Batches(&batches));
    let alone = of_batches(Expected::Exact(&[1.0; BINS]));
    let mean = |of: &[Vec<f64>]| of.iter().map(|x| x[0]).sum::<f64>() / SURFACES as f64;
    assert!((paired.bins[0].mean - mean(&surfaces)).abs() < 1e-12);
    assert!((paired.bins[0].model - mean(&model)).abs() < 1e-12);
    // Variances add: 1 + 9 to 1 over many bins; with eleven degrees of freedom the mean of so few
    // scatters by some tens of percent.
    let squares = |comparison: &asperity_analysis::Comparison| -> f64 {
        let bins = comparison.bins.iter();
        bins.map(|b| b.standard_error.unwrap().powi(2)).sum()
    };
    let ratio = squares(&paired) / squares(&alone);
    println!("variance of differences over that of surfaces: {ratio:.1}");
    assert!((4.0..25.0).contains(&ratio));
    let noise = |c: &asperity_analysis::Comparison| c.total_variation.noise.unwrap();
    assert!(noise(&paired) > 1.8 * noise(&alone));
}

#[test]
fn batches_and_surfaces_must_be_equal_in_number() {
    let surfaces = vec![vec![0.5]; 8];
    let model: &[f64] = &[0.5];
    let error = compare(
        &surfaces,
        Expected::Batches(&[model; 7]),
        &[RayCount::UNLIMITED],
        &[],
        1,
    )
    .unwrap_err();
    assert_eq!(
        error,
        ComparisonError::BatchCount {
            batches: 7,
            surfaces: 8
        }
    );
}
