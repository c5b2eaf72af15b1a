//! Bottoms on which a layer may end.

use asperity_optics::{Bottom, dielectric};
use asperity_tally::{Component, Side, TallyResult, TallySpec};
use asperity_tracer::{PathSettings, SearchedSurface, TracedLayerError};

use super::{Scene, budget, clear, flat, medium, slab};
use crate::common::{rugged, z_score};
use asperity_surface::Border;

#[test]
fn a_mirror_below_a_clear_layer_returns_all_and_an_absorbing_bottom_nothing() {
    let f = dielectric(30_f64.to_radians().cos(), 1.5).reflected;
    let (found, _) = Scene::new(flat(), slab(clear(), 1.0, Bottom::MIRROR)).trace(4, 10);
    assert!(
        (found.means().budget().reflected + found.means().budget().truncated - 1.0).abs() < 1e-13
    );
    assert_eq!(found.means().budget().absorbed, 0.0);
    let (found, _) = Scene::new(flat(), slab(clear(), 1.0, Bottom::ABSORBING)).trace(4, 10);
    assert!((found.means().budget().reflected - f).abs() < 1e-13);
    assert!((found.means().budget().absorbed - (1.0 - f)).abs() < 1e-13);
}

#[test]
fn a_lambertian_bottom_below_a_clear_layer_follows_saunderson() {
    // R = F + (1 - F) r (1 - Fi) / (1 - r Fi), Fi being the interface's reflectance for diffuse light
    // from inside (Saunderson 1942).
    let n = 100_000;
    let fi: f64 = (0..n)
        .map(|i| {
            let mu2 = (f64::from(i) + 0.5) / f64::from(n);
            dielectric(mu2.sqrt(), 1.0 / 1.5).reflected / f64::from(n)
        })
        .sum();
    let f = dielectric(30_f64.to_radians().cos(), 1.5).reflected;
    for reflectance in [0.3, 0.8, 1.0] {
        let bottom = Bottom::lambertian(reflectance);
        let (found, _) = Scene::new(flat(), slab(clear(), 1.0, bottom)).trace(64, 20);
        let exact = f + (1.0 - f) * reflectance * (1.0 - fi) / (1.0 - reflectance * fi);
        let found = found.budget().reflected;
        let z = z_score(found, exact, 0.0);
        println!("{reflectance}: {exact:.6}, {found:?}, z {z:.2}");
        assert!(z.abs() < 3.5);
    }
}

#[test]
fn an_interface_below_bends_light_into_the_third_medium() {
    // From air through a layer of 1.5 into a medium of 1.2: sin(theta) = 1.2 sin(theta_t).
    let spec = TallySpec::default().with_medium();
    let scene = Scene {
        theta_deg: 52.0,
        ..Scene::new(flat(), slab(clear(), 1.0, Bottom::interface(1.2 / 1.5)))
    };
    let (found, _) = scene.trace(2, 10);
    let theta_t = (52_f64.to_radians().sin() / 1.2).asin().to_degrees();
    let ring = ((180.0 - theta_t) / 5.0) as usize - 18;
    let rings = &found.means()[spec.ring_entries(Side::Transmitted, Component::Unscattered)];
    let all: f64 = rings.iter().sum();
    assert!(all > 0.8 && rings[ring] == all, "{theta_t}: {rings:?}");
}

#[test]
fn the_budget_closes_over_every_bottom_and_border() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        for bottom in [
            Bottom::interface(1.0 / 1.5),
            Bottom::ABSORBING,
            Bottom::MIRROR,
            Bottom::lambertian(0.7),
        ] {
            for rough in [false, true] {
                let scene = Scene {
                    bottom: rough.then(|| rugged(9, 10, 0.8, 3, border)),
                    theta_deg: 60.0,
                    ..Scene::new(
                        rugged(9, 10, 1.0, 2, border),
                        slab(medium(1.5, 0.9), 4.0, bottom),
                    )
                };
                let (found, work) = scene.trace(2, 20);
                assert!((budget(&found) - 1.0).abs() < 1e-12, "{border} {bottom:?}");
                assert_eq!(found.means().budget().lost, 0.0, "{border} {bottom:?}");
                assert!(work.scatterings > 0);
            }
        }
    }
}

#[test]
fn open_bottoms_with_a_shape_are_refused() {
    // An interface of equal indices and no interface at all, under the same surface.
    let surface = || rugged(9, 10, 1.0, 2, Border::Periodic);
    let layer = |bottom| slab(medium(2.0, 0.9), 4.0, bottom);
    let found = |bottom, shape, seed| {
        let scene = Scene {
            bottom: shape,
            seed,
            settings: PathSettings::default(),
            ..Scene::new(surface(), layer(bottom))
        };
        scene.trace(64, 20).0
    };
    let open = found(Bottom::Open, None, 1);
    let matched = found(Bottom::interface(1.0), None, 2);
    for entry in [
        TallySpec::BUDGET.reflected,
        TallySpec::BUDGET.transmitted,
        TallySpec::BUDGET.absorbed,
    ] {
        let z = super::z_between(&open, &matched, entry);
        println!("entry {entry}: z {z:.2}");
        assert!(z.abs() < 3.5);
    }
}

#[test]
fn layers_too_thin_for_their_surfaces_and_bottoms_of_another_tile_are_refused() {
    let top = rugged(9, 10, 1.0, 2, Border::Periodic);
    let refusal =
        |thickness, bottom, shape: Option<SearchedSurface<'_, asperity_tracer::Surface>>| {
            let layer = slab(medium(1.0, 0.5), thickness, bottom);
            crate::common::layer_below(&top, &layer, shape, 100).err()
        };
    let brute = asperity_tracer::BruteForce;
    let under = |geometry| {
        Some(SearchedSurface {
            geometry,
            accelerator: &brute,
        })
    };
    let thin = |error| matches!(error, Some(TracedLayerError::TooThin { .. }));
    assert!(thin(refusal(0.5, Bottom::MIRROR, None)));
    assert!(refusal(1.5, Bottom::MIRROR, None).is_none());
    assert!(thin(refusal(1.5, Bottom::MIRROR, under(&top))));
    assert!(refusal(2.5, Bottom::MIRROR, under(&top)).is_none());
    let deep = TracedLayerError::TooThin {
        layer: 1,
        thickness: 2.0,
        depth: 8.285_231_49,
        height: 0.0,
    };
    assert_eq!(
        deep.to_string(),
        "invalid thickness 2 of layer 1: must exceed 8.28524, since the face above goes 8.28524 below its mean plane and that below rises 0 above its own"
    );
    let other = rugged(10, 10, 1.0, 2, Border::Periodic);
    let error = refusal(9.0, Bottom::MIRROR, under(&other)).unwrap();
    assert!(error.to_string().contains("does not lie under"));
    let error = refusal(9.0, Bottom::Open, under(&top)).unwrap();
    assert_eq!(error, TracedLayerError::OpenShape);
}

#[test]
fn paths_end_at_the_requested_order_at_bottoms_too() {
    // In through the surface is one interaction: the bottom is the second, and may not have it.
    let spec = TallySpec::default().with_medium();
    let interface = Bottom::interface(1.0 / 1.5);
    for (kind, rough) in [
        (Bottom::MIRROR, false),
        (Bottom::MIRROR, true),
        (interface, false),
        (interface, true),
    ] {
        let bottom = rough.then(|| rugged(4, 4, 0.1, 3, Border::Periodic));
        let scene = Scene {
            settings: PathSettings::new(Default::default(), 0.01, 1).unwrap(),
            bottom,
            ..Scene::new(flat(), slab(clear(), 1.0, kind))
        };
        let (found, _) = scene.trace(2, 10);
        let f = dielectric(30_f64.to_radians().cos(), 1.5).reflected;
        assert!((found.means().budget().reflected - f).abs() < 1e-13);
        assert!((found.means().budget().truncated - (1.0 - f)).abs() < 1e-13);
        assert_eq!(found.means()[spec.order_entry(Side::Reflected, 2)], 0.0);
    }
}
