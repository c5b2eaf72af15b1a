//! What meshes of several spacings show.

use crate::config::VerifyConfig;
use crate::verify::{VerifyOutcome, verify};
use asperity_simulate::{MeshErrors, Method, Silent, finer};
use asperity_surface::Synthesis;
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

/// On four spacings a correlation length, facets lack 3 % of the slope variance, and the middle of the
/// lobe is brighter for it. Each of three rings passes |z| < 4 with probability 1 - 7e-5, if Smith's
/// visible shares, all above 0.97 and taken for one here, do not change with the mesh.
#[test]
fn quadrature_foresees_what_halving_a_coarse_spacing_changes() {
    let outcome = run([3.0, 4.0, 0.0], 128, 2_000_000, "6x1");
    let (case, spec) = (&outcome.cases[0], outcome.spec);
    let foreseen = |synthesis: &Synthesis| {
        let case = (&case.case, &Method::PLAIN);
        MeshErrors::of_case(synthesis, case, &spec, true, None).remaining
    };
    let given = Synthesis::new(case.case.psd, [128, 128], [1.0, 1.0], false).unwrap();
    let [coarse, fine] = [&given, &finer(&given).unwrap()].map(foreseen);
    let refinement = case.errors.refinement().unwrap();
    let mut strongest: f64 = 0.0;
    for ring in spec
        .ring_entries(Side::Reflected, Component::Single)
        .iter()
        .take(3)
    {
        let expected = coarse[ring].unwrap() - fine[ring].unwrap();
        let found = refinement.shift(ring);
        let se = found.se.unwrap();
        let z = (found.mean - expected) / se;
        println!(
            "{:.5} +- {se:.5} against {expected:.5}, z = {z:.2}",
            found.mean
        );
        assert!(z.abs() < 4.0, "{z}");
        strongest = strongest.max(expected.abs() / se);
    }
    assert!(strongest > 6.0, "{strongest}");
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
