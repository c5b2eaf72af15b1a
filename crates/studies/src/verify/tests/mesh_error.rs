//! What meshes of several spacings show.

use crate::config::VerifyConfig;
use crate::verify::{VerifyOutcome, verify};
use asperity_simulate::Silent;
use asperity_tally::{Component, Side, TallyResult, TallySpec};

/// Vertical or slanting light on 64 refined surfaces of mirrors of `size` samples a side.
fn run([smoothness, tau, theta]: [f64; 3], size: u64, rays: u64, bins: &str) -> VerifyOutcome {
    let text = format!(
        "
        [surface]
        smoothness = {smoothness}
        tau = {tau}
        size = {size}
        [material]
        kind = 'mirror'
        [light]
        theta = {theta}
        [run]
        realisations = 64
        rays = {rays}
        bins = '{bins}'
        refine = true
        estimator = 'plain'
        [compare]
        models = []
        "
    );
    verify(&VerifyConfig::from_toml(&text).unwrap(), &Silent).unwrap()
}

#[test]
fn second_order_is_seen_on_a_smooth_surface() {
    let outcome = run([1.0, 8.0, 30.0], 64, 1_000_000, "18x36");
    let (case, spec) = (&outcome.cases[0], outcome.spec);
    let refinement = case.errors.refinement().unwrap();
    let multiple = spec.flux_entry(Side::Reflected, Component::Multiple);
    let order = refinement.order(multiple).unwrap();
    println!(
        "{:?} {:?} {order}",
        refinement.coarser_shift(multiple),
        refinement.shift(multiple)
    );
    assert!((order - 2.0).abs() < 0.4, "{order}");
    // What is reported, less the rest that is left of its mesh, is Richardson's value.
    let extrapolated = refinement.extrapolated(multiple).unwrap();
    let found = case.statistics.at(multiple);
    let remaining = case.errors.at(multiple).mesh.unwrap();
    assert!((found.mean - remaining - extrapolated.mean).abs() < 1e-12);
    assert!((extrapolated.se.unwrap() / found.se.unwrap() - 1.0).abs() < 0.2);
    // All light is reflected by every mesh.
    assert!(refinement.order(TallySpec::BUDGET.reflected).is_err());
}
