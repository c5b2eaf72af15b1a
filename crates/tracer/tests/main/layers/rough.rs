//! A medium below a rough surface: limits of the mean free path, scaling, and ways of finding hits.

use asperity_optics::{Bottom, Layer};
use asperity_surface::{Border, HeightField};
use asperity_tally::{TallyResult, TallySpec, TallyStatistics};
use asperity_tracer::{AcceleratorKind, BuildAccelerator, HalfSpace, Surface, Tracer};

use super::{Scene, medium, slab, z_between};
use crate::common::waves;

/// A tile of 16 x 16 columns whose waves are 8 to 16 columns long, as steep as `amplitude`.
fn rough(amplitude: f64) -> Surface {
    Surface::new(waves(16, amplitude, 5))
}

fn reflectance(mean_free_path: f64, seed: u64) -> TallyStatistics {
    let scene = Scene {
        seed,
        theta_deg: 60.0,
        ..Scene::new(rough(1.0), Layer::half_space(medium(mean_free_path, 0.9)))
    };
    scene.trace(64, 24).0
}

#[test]
fn short_and_long_mean_free_paths_tend_to_limits_which_differ() {
    let [shortest, short] = [reflectance(1e-4, 1), reflectance(1e-3, 2)];
    let [long, longest] = [reflectance(1e4, 3), reflectance(1e5, 4)];
    let z = |a, b| z_between(a, b, TallySpec::BUDGET.reflected);
    println!(
        "R {:.5} {:.5} {:.5} {:.5}; z {:.2} {:.2} {:.2}",
        shortest.budget().reflected.mean,
        short.budget().reflected.mean,
        long.budget().reflected.mean,
        longest.budget().reflected.mean,
        z(&shortest, &short),
        z(&long, &longest),
        z(&short, &long)
    );
    assert!(z(&shortest, &short).abs() < 3.5);
    assert!(z(&long, &longest).abs() < 3.5);
    assert!(z(&short, &long).abs() > 6.0);
}

#[test]
fn light_from_any_distance_below_hits_the_surface() {
    let near = reflectance(1e4, 3);
    for (i, mean_free_path) in [1e9, 1e11].into_iter().enumerate() {
        for border in [Border::Periodic, Border::Mirrored] {
            let field = waves(16, 1.0, 5).with_border(border);
            let scene = Scene {
                seed: 10 + i as u64,
                theta_deg: 60.0,
                ..Scene::new(
                    Surface::new(field),
                    Layer::half_space(medium(mean_free_path, 0.9)),
                )
            };
            let (far, _) = scene.trace(16, 24);
            assert_eq!(far.means().budget().lost, 0.0);
            if border == Border::Periodic {
                let z = z_between(&far, &near, TallySpec::BUDGET.reflected);
                println!("{mean_free_path}: z {z:.2}");
                assert!(z.abs() < 3.5);
            }
        }
    }
}

#[test]
fn lengths_that_rounding_would_blur_are_refused() {
    // Over a tile of 16 columns.
    let surface = rough(1.0);
    let refusal = |layer, shape| {
        let refused = crate::common::layer_below(&surface, &layer, shape, 10);
        refused.err().map(|error| error.to_string())
    };
    let flat = || None;
    let half_space = |path| refusal(Layer::half_space(medium(path, 0.5)), flat());
    for path in [1e-12, 1e12] {
        assert!(half_space(path).unwrap().contains("mean free path"));
    }
    for path in [1e-10, 1e11] {
        assert_eq!(half_space(path), None);
    }
    let deep = |thickness, shape| refusal(slab(medium(1e6, 0.5), thickness, Bottom::MIRROR), shape);
    let own = || {
        Some(asperity_tracer::SearchedSurface {
            geometry: &surface,
            accelerator: &asperity_tracer::BruteForce,
        })
    };
    assert!(deep(1e12, flat()).unwrap().contains("thickness"));
    assert!(deep(1e8, own()).unwrap().contains("thickness"));
    assert_eq!(deep(1e11, flat()), None);
    assert_eq!(deep(1e7, own()), None);
    // A plane is alike everywhere.
    let plane = super::flat();
    let layer = Layer::half_space(medium(1e100, 0.5));
    assert!(crate::common::layer_below(&plane, &layer, flat(), 10).is_ok());
}

#[test]
fn a_medium_that_only_absorbs_far_below_leaves_the_bare_surface() {
    let surface = rough(1.0);
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let run = crate::common::Run {
        theta_deg: 60.0,
        phi_deg: 20.0,
        seed: 1,
        spec: TallySpec::default(),
        ..crate::common::Run::new(
            &surface,
            &*accelerator,
            asperity_optics::Material::dielectric(1.5).unwrap(),
        )
    };
    let (bare, _) = run.go(64, 24);
    let scene = Scene {
        theta_deg: 60.0,
        seed: 2,
        ..Scene::new(rough(1.0), Layer::half_space(medium(1e9, 0.0)))
    };
    let (found, _) = scene.trace(64, 24);
    for entry in [
        TallySpec::BUDGET.reflected,
        TallySpec::default().order_entry(asperity_tally::Side::Reflected, 1),
        TallySpec::default().order_entry(asperity_tally::Side::Reflected, 3),
    ] {
        let z = z_between(&found, &bare, entry);
        println!("entry {entry}: z {z:.2}");
        assert!(z.abs() < 3.5);
    }
    let (absorbed, transmitted) = (found.budget().absorbed, bare.budget().transmitted);
    let z = crate::common::z_score(absorbed, transmitted.mean, transmitted.se.unwrap());
    assert!(z.abs() < 3.5, "{z}");
}

#[test]
fn scaling_all_lengths_changes_no_byte() {
    // By powers of two, which rounding does not notice.
    let scene = |scale: f64| {
        let field = waves(16, 1.0, 5);
        let heights = field.heights().iter().map(|h| scale * h).collect();
        let field = HeightField::new(heights, [16, 16], [scale; 2]).unwrap();
        let bottom = Bottom::interface(0.8);
        let scene = Scene {
            bottom: Some(Surface::new(field.clone())),
            ..Scene::new(
                Surface::new(field),
                slab(medium(2.0 * scale, 0.9), 16.0 * scale, bottom),
            )
        };
        scene.trace(2, 20).0.means().clone()
    };
    let reference = scene(1.0);
    assert!(reference.budget().transmitted > 0.01);
    for scale in [1.0 / 1024.0, 4.0] {
        assert!(scene(scale) == reference);
    }
}

#[test]
fn the_accelerator_changes_no_byte() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        let found = |accelerator| {
            let surface = || Surface::new(waves(16, 1.5, 7).with_border(border));
            let bottom = Bottom::interface(1.0 / 1.5);
            let scene = Scene {
                accelerator,
                bottom: Some(surface()),
                theta_deg: 70.0,
                ..Scene::new(surface(), slab(medium(3.0, 0.95), 24.0, bottom))
            };
            scene.trace(1, 20).0.means().clone()
        };
        let reference = found(AcceleratorKind::BruteForce);
        for kind in [AcceleratorKind::Pyramid, AcceleratorKind::Mesh] {
            assert!(found(kind) == reference, "{border} {kind}");
        }
    }
}

#[test]
#[should_panic(expected = "lit from above")]
fn light_from_below_a_layer_is_refused() {
    let surface = rough(1.0);
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let layer = Layer::half_space(medium(1.0, 0.5));
    let shape = None;
    let layer = crate::common::layer_below(&surface, &layer, shape, 10).unwrap();
    let glass = asperity_optics::Material::dielectric(1.5).unwrap();
    let _ = Tracer::new(
        &surface,
        &*accelerator,
        glass,
        HalfSpace::Below,
        Default::default(),
    )
    .over(layer);
}
