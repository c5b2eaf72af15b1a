//! No light is lost: what does not come back is absorbed, cut off or gone sideways, and booked as that.

use asperity_optics::Material;
use asperity_surface::Border;
use asperity_tally::TallyResult;
use asperity_tracer::{Branching, MeshBvh, PathSettings, Surface};

use super::{GLASS, budget, exhaustive, glass};
use crate::common::{Run, rugged, waves};

#[test]
fn white_furnace_loses_nothing() {
    let surfaces = [
        Surface::new(waves(32, 0.4, 1)),
        Surface::new(waves(32, 4.0, 2)),
        rugged(24, 20, 6.0, 4, Border::Periodic),
        rugged(24, 20, 1.0, 4, Border::Mirrored),
    ];
    for surface in &surfaces {
        let bvh = MeshBvh::build(surface).unwrap();
        for material in [
            Material::Mirror,
            glass(),
            Material::dielectric(1.0 / GLASS).unwrap(),
        ] {
            for theta_deg in [0.0, 45.0, 80.0, 89.9] {
                // Every path continues until its flux is negligible; what is cut off is booked.
                let settings = PathSettings::new(Branching::Split, 1e-3, 1_000_000).unwrap();
                let run = Run {
                    theta_deg,
                    settings,
                    ..Run::new(surface, &bvh, material)
                };
                let (statistics, _) = run.go(4, 6);
                assert_eq!(
                    statistics.means().budget().lost,
                    0.0,
                    "{material:?} {theta_deg}"
                );
                assert_eq!(statistics.means().budget().absorbed, 0.0);
                assert!((budget(&statistics) - 1.0).abs() < 1e-12);
                if material == Material::Mirror {
                    assert!((statistics.means().budget().reflected - 1.0).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn tall_surfaces_and_grazing_light_lose_nothing() {
    // Root mean square slope about 8: smoothness 0.25.
    let surface = Surface::new(waves(48, 7.0, 21));
    let bvh = MeshBvh::build(&surface).unwrap();
    for (theta_deg, phi_deg) in [
        (0.0, 0.0),
        (60.0, 33.0),
        (89.9, 90.0),
        (89.9, 12.3),
        (89.99, 0.0),
    ] {
        for material in [
            glass(),
            Material::dielectric(0.25).unwrap(),
            Material::Mirror,
        ] {
            let run = Run {
                theta_deg,
                phi_deg,
                ..Run::new(&surface, &bvh, material)
            };
            let (statistics, work) = run.go(4, 12);
            assert_eq!(
                statistics.means().budget().lost,
                0.0,
                "{theta_deg} {material:?}"
            );
            assert!((budget(&statistics) - 1.0).abs() < 1e-12);
            assert!(work.segments > work.rays);
        }
    }
}

#[test]
fn conductor_absorbs_what_it_does_not_reflect() {
    let surface = rugged(16, 16, 1.5, 6, Border::Periodic);
    let bvh = MeshBvh::build(&surface).unwrap();
    let gold = Material::conductor(0.21, 3.272).unwrap();
    let run = Run {
        settings: exhaustive(),
        ..Run::new(&surface, &bvh, gold)
    };
    let (statistics, _) = run.go(4, 8);
    let values = statistics.means();
    assert!((budget(&statistics) - 1.0).abs() < 1e-12);
    assert!(values.budget().absorbed > 0.01);
    assert_eq!(values.budget().transmitted, 0.0);
    // Each reflection keeps at most as much as grazing light and at least as much as normal light.
    let flat_loss = 1.0 - asperity_optics::conductor(1.0, 0.21, 3.272).reflected;
    assert!(values.budget().absorbed < 12.0 * flat_loss);
}

#[test]
fn bounce_limit_is_booked_as_truncated() {
    let surface = rugged(16, 16, 8.0, 2, Border::Periodic);
    let bvh = MeshBvh::build(&surface).unwrap();
    let settings = PathSettings::new(Branching::Split, 1e-6, 2).unwrap();
    let run = Run {
        settings,
        ..Run::new(&surface, &bvh, Material::Mirror)
    };
    let (statistics, _) = run.go(2, 8);
    assert!(statistics.means().budget().truncated > 0.01);
    assert!((budget(&statistics) - 1.0).abs() < 1e-12);
}

#[test]
fn an_open_patch_books_what_leaves_it_sideways() {
    let surface = rugged(16, 16, 2.0, 2, Border::Open);
    let bvh = MeshBvh::build(&surface).unwrap();
    let run = Run {
        theta_deg: 70.0,
        ..Run::new(&surface, &bvh, glass())
    };
    let (statistics, _) = run.go(2, 16);
    let values = statistics.means();
    assert!(values.budget().left_patch > 0.01);
    assert_eq!(values.budget().lost, 0.0);
    assert!((budget(&statistics) - 1.0).abs() < 1e-12);
}
