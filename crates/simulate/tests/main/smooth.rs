//! Random surfaces of smooth cells.

use asperity_optics::Material;
use asperity_simulate::{Case, Cells, Estimator, Outcome, Quantity, RandomSurfaces, Settings};
use asperity_synthesis::Psd;
use asperity_tally::{Component, Side, TallyResult, TallySpec};

use crate::support::{effort, glass, lit, run, target};

/// Light at `theta` on surfaces of `size` cells per side, four to a correlation length.
fn case(cells: Cells, smoothness: f64, size: usize, material: Material, theta: f64) -> Case {
    let psd = Psd::gaussian(4.0 / smoothness, 4.0).unwrap();
    let surfaces = RandomSurfaces::new(cells, psd, [size; 2], [1.0; 2], false).unwrap();
    lit(surfaces, material, theta)
}

fn reflected(outcome: &Outcome) -> [f64; 2] {
    let flux = outcome.statistics.flux(Side::Reflected, Component::All);
    [flux.mean, flux.se.unwrap()]
}

/// Vertical light that leaves glass, s = 1: the turn from facet to facet keeps light inside that would leave. The limit
/// is that of 400 surfaces of 256 x 256 smooth cells, eight per correlation length, within 0.0003.
#[test]
fn smooth_cells_at_four_per_correlation_length_have_the_reflectance_of_fine_meshes() {
    const LIMIT: f64 = 0.4782;
    let leaving = Material::dielectric(1.0 / 1.5).unwrap();
    let off = |cells: Cells| {
        let case = case(cells, 1.0, 64, leaving, 0.0);
        let [mean, se] = reflected(&run(case, &effort(96, 400_000)));
        println!("{cells}: {mean:.5} +- {se:.5}");
        (mean - LIMIT) / se
    };
    assert!(off(Cells::Smooth).abs() < 4.0);
    assert!(off(Cells::Flat) > 8.0);
}

/// If light of the first order is all but everything, the control variate must be that of these surfaces.
#[test]
fn controlled_and_plain_means_agree_on_smooth_cells() {
    for (smoothness, theta) in [(6.0, 30.0), (3.0, 0.0), (2.0, 60.0)] {
        let found = [Estimator::Plain, Estimator::Controlled].map(|estimator| {
            let settings = Settings {
                estimator,
                ..effort(64, 200_000)
            };
            run(
                case(Cells::Smooth, smoothness, 32, glass(), theta),
                &settings,
            )
        });
        let [[plain, plain_se], [controlled, se]] = found.each_ref().map(reflected);
        let z = (plain - controlled) / plain_se.hypot(se);
        println!("s = {smoothness}: {plain:.6} +- {plain_se:.6}, {controlled:.6} +- {se:.6}");
        assert!(z.abs() < 4.0, "{z}");
        assert!(smoothness < 3.0 || se < plain_se);
    }
}

/// Three and six cells per correlation length are compared; loose targets take the coarser ones, tight ones the finer.
#[test]
fn a_target_error_chooses_the_spacing_of_smooth_cells() {
    let outcome = |cells: Cells, error: f64| {
        let settings = Settings {
            effort: target(error, Quantity::Bins),
            ..Settings::default()
        };
        run(case(cells, 3.0, 48, glass(), 30.0), &settings)
    };
    let mut of_coarse: f64 = 0.0;
    for (error, size) in [(0.05, 36), (7e-4, 48)] {
        let smooth = outcome(Cells::Smooth, error);
        assert_eq!(smooth.case.surface.cells(), Some(Cells::Smooth));
        assert_eq!(smooth.case.surface.size(), Some([size; 2]), "{error}");
        let [mesh, difference] = [
            smooth.stopping.mesh_error.unwrap(),
            smooth.stopping.pilot.unwrap().mesh_difference.unwrap(),
        ];
        // The difference is that of 3 and 6 per correlation length.
        let expected = difference / 15.0 * (72.0 / size as f64).powi(4);
        println!("{error}: {mesh:e} of {difference:e}");
        assert!((mesh / expected - 1.0).abs() < 1e-12, "{mesh} {expected}");
        assert!(mesh < error / 3.0);
        assert!(smooth.errors.mesh_explanation().contains("pilot run"));
        of_coarse = of_coarse.max(mesh);
    }
    // Of facets all that two spacings differ by, since no order is seen.
    let flat = outcome(Cells::Flat, 0.05);
    assert!(flat.errors.mesh_explanation().contains("pilot run"));
    let flat = flat.stopping;
    println!("{:?}", flat.mesh_error);
    assert_eq!(flat.mesh_error, flat.pilot.unwrap().mesh_difference);
    assert!(flat.mesh_error.unwrap() > 5.0 * of_coarse);
}

/// Refined, smooth cells show a difference that is far below that of facets, and a fifteenth of it remains.
#[test]
fn smooth_cells_are_refined_by_fourth_order() {
    let outcome = |cells: Cells| {
        let settings = Settings {
            refine: true,
            estimator: Estimator::Plain,
            ..effort(32, 200_000)
        };
        let leaving = Material::dielectric(1.0 / 1.5).unwrap();
        run(case(cells, 1.0, 32, leaving, 0.0), &settings)
    };
    let smooth = outcome(Cells::Smooth);
    let entry = TallySpec::BUDGET.reflected;
    let shift = |outcome: &Outcome| outcome.errors.refinement().unwrap().shift(entry);
    let of_smooth = shift(&smooth);
    let remaining = smooth.errors.at(entry).mesh.unwrap();
    assert!((remaining - of_smooth.mean / 15.0).abs() < 1e-15);
    assert!(smooth.errors.mesh_warning().is_none());
    let flat = outcome(Cells::Flat);
    let of_flat = shift(&flat);
    println!("{of_smooth:?} {of_flat:?}");
    // Four cells per correlation length, s = 1: no order of facets is seen, and all of the difference counts.
    assert_eq!(flat.errors.at(entry).mesh.unwrap(), of_flat.mean);
    assert!(
        flat.errors
            .mesh_warning()
            .unwrap()
            .contains("finer spacing")
    );
    assert!(of_flat.mean > 4.0 * of_flat.se.unwrap());
    assert!(of_smooth.mean.abs() < 0.1 * of_flat.mean);
}

/// Flat and smooth cells of equal spectrum and grid are other surfaces.
#[test]
fn flat_and_smooth_cells_do_not_share_surfaces() {
    let [flat, smooth] =
        [Cells::Flat, Cells::Smooth].map(|cells| case(cells, 1.0, 32, glass(), 30.0));
    assert_ne!(flat.surface, smooth.surface);
    assert_eq!(smooth.surface, smooth.surface.clone());
    let together = asperity_simulate::simulate(
        &[flat, smooth.clone()],
        &effort(4, 4000),
        &asperity_simulate::Silent,
    );
    let alone = run(smooth, &effort(4, 4000));
    assert_eq!(together.unwrap()[1].surfaces, alone.surfaces);
}
