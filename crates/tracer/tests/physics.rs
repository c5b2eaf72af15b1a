//! Light on surfaces whose answer is known exactly.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and speak as tests do"
)]

mod common;

use asperity_optics::{Incidence, Material, dielectric};
use asperity_surface::{Border, HeightField};
use asperity_tally::{BatchStatistics, HemisphereGrid, Layout, OrderClass, Share, Side, Sides};
use asperity_tracer::{
    AcceleratorKind, Branching, BruteForce, Geometry, Illumination, Medium, MeshBvh, PathSettings,
    Surface, Tracer,
};
use common::{Run, rugged, waves, z_score};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const GLASS: f64 = 1.5;

fn flat(border: Border) -> Surface {
    let field = HeightField::new(vec![3.0; 12], [3, 4], [0.5, 2.0]).unwrap();
    Surface::new(field.with_border(border))
}

fn glass() -> Material {
    Material::dielectric(GLASS).unwrap()
}

/// Both branches always: no roulette, so that budgets hold ray by ray.
fn exhaustive() -> PathSettings {
    PathSettings::new(Branching::Split, 1e-6, 1_000_000).unwrap()
}

fn budget(statistics: &BatchStatistics) -> f64 {
    statistics.means()[..5].iter().sum()
}

#[test]
fn flat_surface_gives_exact_fresnel_and_snell() {
    let layout = Layout::new(HemisphereGrid::new(90, 360).unwrap(), 0.1).unwrap();
    for border in [Border::Periodic, Border::Mirrored] {
        let surface = flat(border);
        let bvh = MeshBvh::build(&surface).unwrap();
        for (eta, theta_deg, phi_deg) in [
            (1.5, 0.0, 0.0),
            (1.5, 30.5, 70.5),
            (1.5, 89.9, 180.5),
            (1.0 / 1.5, 40.5, 10.5),
            (1.0 / 1.5, 60.5, 200.5),
            (1.0, 45.5, 300.5),
        ] {
            let material = Material::dielectric(eta).unwrap();
            let run = Run {
                theta_deg,
                phi_deg,
                layout,
                ..Run::new(&surface, &bvh, material)
            };
            let (statistics, _) = run.go(2, 4);
            let fresnel = dielectric(f64::to_radians(theta_deg).cos(), eta);
            let values = statistics.means();
            // The normal is exact, so only the cosine is rounded; grazing magnifies it by 1/cos.
            let tolerance = 1e-12;
            assert!((values[Layout::REFLECTED] - fresnel.reflected).abs() < tolerance);
            assert!((values[Layout::TRANSMITTED] - fresnel.transmitted).abs() < tolerance);
            assert_eq!(values[Layout::LOST], 0.0);
            // All light of a side lies in the one bin that Snell's law names.
            let (sin_phi, cos_phi) = (phi_deg + 180.0).to_radians().sin_cos();
            let bin_of = |side, sin: f64, z: f64| {
                let wo = DVec3::new(sin * cos_phi, sin * sin_phi, z);
                layout.bins(Share::Single).start + layout.grid().index_of(side, wo)
            };
            let (sin_alpha, cos_alpha) = f64::to_radians(theta_deg).sin_cos();
            let mirrored = bin_of(Side::Reflected, sin_alpha, cos_alpha);
            assert!((values[mirrored] - fresnel.reflected).abs() < tolerance);
            if fresnel.transmitted > 0.0 {
                let sin_beta = sin_alpha / eta;
                let z = -(1.0 - sin_beta * sin_beta).sqrt();
                let refracted = bin_of(Side::Transmitted, sin_beta, z);
                assert!((values[refracted] - fresnel.transmitted).abs() < tolerance);
            }
        }
    }
}

#[test]
fn light_of_any_azimuth_is_turned_back_to_the_plane_of_incidence() {
    // On a flat surface every ray leaves in its own plane of incidence: turned back, all leave in one
    // bin, and in the forward half of the in-plane profile.
    let surface = flat(Border::Periodic);
    let layout = Layout::default();
    let tracer = Tracer::new(
        &surface,
        &BruteForce,
        glass(),
        Medium::Above,
        PathSettings::default(),
    );
    for (theta_deg, phi_deg) in [(32.0, 3.0), (47.0, 101.0), (62.0, 305.0)] {
        let incidence = Incidence::from_degrees(theta_deg, phi_deg).unwrap();
        let expected = dielectric(incidence.theta().cos(), GLASS).reflected;
        for any_azimuth in [false, true] {
            let mut rng = ChaCha8Rng::seed_from_u64(5);
            let (values, _) = tracer.batch(
                &Illumination::new(incidence, any_azimuth),
                6,
                layout,
                None,
                &mut rng,
            );
            let (sin_phi, cos_phi) = (incidence.phi() + std::f64::consts::PI).sin_cos();
            let (sin, cos) = incidence.theta().sin_cos();
            let wo = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
            let bin = layout.bins(Share::Total).start + layout.grid().index_of(Side::Reflected, wo);
            assert!(
                (values[bin] - expected).abs() < 1e-12,
                "{theta_deg} {phi_deg} {any_azimuth}"
            );
            let profile = layout.in_plane(Side::Reflected, OrderClass::All);
            let forward_bin = profile.start + 18 + (theta_deg / 5.0) as usize;
            assert!((values[forward_bin] - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn free_azimuth_of_vertical_light_is_the_mean_over_azimuths() {
    let surface = Surface::new(waves(32, 1.5, 8));
    let bvh = MeshBvh::build(&surface).unwrap();
    let layout = Layout::default();
    let settings = PathSettings::default();
    let tracer = Tracer::new(&surface, &bvh, glass(), Medium::Above, settings);
    let batches = |theta_deg, seed| {
        let incidence = Incidence::from_degrees(theta_deg, 33.0).unwrap();
        let mut statistics = BatchStatistics::new(layout.len());
        for block in 0..400 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(block);
            statistics.push(
                &tracer
                    .batch(
                        &Illumination::new(incidence, true),
                        24,
                        layout,
                        None,
                        &mut rng,
                    )
                    .0,
            );
        }
        statistics
    };
    // Light a hair off the vertical has an azimuth, and goes the ordinary way.
    let (free, found) = (batches(0.0, 1), batches(1e-9, 3));
    let rays = 400.0 * 24.0 * 24.0;
    let n_phi = layout.grid().n_phi();
    let mut compared = 0_u32;
    let mut squares = 0.0;
    let mut check = |i: usize| {
        let reference = found.estimate(i);
        let z = z_score(free.estimate(i), reference.mean, reference.se.unwrap());
        // 2000 entries: one family in 70 has a |z| above 4.5; the seeds are fixed.
        assert!(z.abs() < 4.5, "entry {i}: z = {z}");
        compared += 1;
        squares += z * z;
    };
    for (share, hits) in [
        (Share::Single, Share::Single),
        (Share::Multiple, Share::Multiple),
    ] {
        for (bin, hit) in layout.bins(share).zip(layout.hits(hits)) {
            // Fewer rays have skewed errors. The free ones choose: they scatter less.
            if free.means()[hit] * rays >= 200.0 {
                check(bin);
                check(hit);
            }
        }
    }
    for side in Side::BOTH {
        for class in OrderClass::ALL {
            for (i, ring) in layout.rings(side, class).enumerate() {
                let share = 2.0 * layout.in_plane_half_width() / std::f64::consts::TAU;
                let from_normal = match side {
                    Side::Reflected => i,
                    Side::Transmitted => 17 - i,
                };
                // Rays are not counted by class; relative errors say how many there are.
                if free.estimate(ring).se.unwrap() < free.means()[ring] / 40.0 {
                    check(ring);
                    let start = layout.in_plane(side, class).start;
                    for entry in [start + 18 + from_normal, start + 17 - from_normal] {
                        check(entry);
                        let exact = share * free.means()[ring];
                        assert!((free.means()[entry] - exact).abs() < 1e-12);
                    }
                }
            }
        }
        check(side.index());
        (1..=2).for_each(|order| check(layout.order(side, order)));
    }
    let mean_square = squares / f64::from(compared);
    println!("{compared} entries, mean square of z {mean_square}");
    assert!(compared > 1500, "{compared}");
    // Fluxes and numbers of rays go together, and bins of a ring share its free value: 0.05 or so.
    assert!((mean_square - 1.0).abs() < 0.2, "{mean_square}");
    for share in Share::ALL {
        for ring in free.means()[layout.bins(share)].chunks_exact(n_phi) {
            assert!(ring.iter().all(|flux| *flux == ring[0]));
        }
    }
}

#[test]
fn matched_indices_let_light_go_straight_through_any_surface() {
    let surface = rugged(12, 10, 2.0, 3, Border::Periodic);
    let bvh = MeshBvh::build(&surface).unwrap();
    let material = Material::dielectric(1.0).unwrap();
    let run = Run {
        theta_deg: 52.0,
        phi_deg: 15.0,
        ..Run::new(&surface, &bvh, material)
    };
    let (statistics, _) = run.go(4, 8);
    let layout = run.layout;
    let wo = -Incidence::from_degrees(52.0, 15.0).unwrap().wi();
    let bin = layout.bins(Share::Total).start + layout.grid().index_of(Side::Transmitted, wo);
    assert!((statistics.means()[bin] - 1.0).abs() < 1e-12);
}

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
                // Every path goes on until it is weak beyond notice; what is cut off is booked.
                let settings = PathSettings::new(Branching::Split, 1e-3, 1_000_000).unwrap();
                let run = Run {
                    theta_deg,
                    settings,
                    ..Run::new(surface, &bvh, material)
                };
                let (statistics, _) = run.go(4, 6);
                assert_eq!(
                    statistics.means()[Layout::LOST],
                    0.0,
                    "{material:?} {theta_deg}"
                );
                assert_eq!(statistics.means()[Layout::ABSORBED], 0.0);
                assert!((budget(&statistics) - 1.0).abs() < 1e-12);
                if material == Material::Mirror {
                    assert!((statistics.means()[Layout::REFLECTED] - 1.0).abs() < 1e-12);
                }
            }
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
    assert!(values[Layout::ABSORBED] > 0.01);
    assert_eq!(values[Layout::TRANSMITTED], 0.0);
    // Each reflection keeps at most as much as grazing light and at least as much as normal light.
    let flat_loss = 1.0 - asperity_optics::conductor(1.0, 0.21, 3.272).reflected;
    assert!(values[Layout::ABSORBED] < 12.0 * flat_loss);
}

#[test]
fn split_and_picked_branches_agree_and_so_does_roulette() {
    let surface = Surface::new(waves(32, 2.0, 5));
    let bvh = MeshBvh::build(&surface).unwrap();
    let with = |branching, roulette, seed| {
        let settings = PathSettings::new(branching, roulette, 100_000).unwrap();
        Run {
            settings,
            seed,
            theta_deg: 60.0,
            ..Run::new(&surface, &bvh, glass())
        }
        .go(60, 16)
        .0
    };
    let exact = with(Branching::Split, 1e-6, 1);
    let layout = Layout::default();
    // 14 quantities a comparison, three comparisons: |z| < 4 fails by chance once in 400 runs, and
    // the seeds are fixed. Quantities that fewer than 20 paths make up have no normal error.
    let rays = 60.0 * 16.0 * 16.0;
    for (other, flux_of_a_path) in [
        (with(Branching::Pick, 1e-6, 2), 1.0),
        (with(Branching::Split, 0.5, 3), 0.5),
        (with(Branching::Split, 0.02, 4), 0.02),
    ] {
        assert!((budget(&other) - 1.0).abs() < 1e-12);
        let mut entries = vec![Layout::REFLECTED, Layout::TRANSMITTED];
        for side in Side::BOTH {
            entries.extend((1..=6).map(|order| layout.order(side, order)));
        }
        for i in entries {
            let reference = exact.estimate(i);
            if reference.mean * rays < 20.0 * flux_of_a_path {
                continue;
            }
            let z = z_score(other.estimate(i), reference.mean, reference.se.unwrap());
            assert!(z.abs() < 4.0, "entry {i}: z = {z}");
        }
    }
}

#[test]
fn light_from_below_equals_light_from_above_on_the_inverted_surface() {
    let field = waves(24, 1.2, 9);
    let inverted = field
        .with_heights(field.heights().iter().map(|h| -h).collect())
        .unwrap();
    let (surface, inverted) = (Surface::new(field), Surface::new(inverted));
    let below = Run {
        incident: Medium::Below,
        theta_deg: 50.0,
        ..Run::new(&surface, &BruteForce, glass())
    };
    let above = Run {
        theta_deg: 50.0,
        ..Run::new(&inverted, &BruteForce, glass())
    };
    let (below, above) = (below.go(2, 5).0, above.go(2, 5).0);
    for (a, b) in below.means().iter().zip(above.means()) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn diffuse_light_passes_both_ways_alike() {
    // Radiance over the squared index is conserved, so with diffuse light on both sides the flux
    // from above to below, n_1^2 T_12, equals that from below to above, n_2^2 T_21.
    let surface = Surface::new(waves(32, 2.5, 7));
    let bvh = MeshBvh::build(&surface).unwrap();
    let diffuse = |incident, eta, seed| {
        let material = Material::dielectric(eta).unwrap();
        let tracer = Tracer::new(&surface, &bvh, material, incident, PathSettings::default());
        let layout = Layout::new(HemisphereGrid::new(1, 1).unwrap(), 0.1).unwrap();
        let mut statistics = BatchStatistics::new(layout.len());
        for block in 0..40 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(block);
            // Cosine-distributed directions, stratified over sin^2(theta).
            let mut sum = vec![0.0; layout.len()];
            let directions = 64;
            for i in 0..directions {
                let sin2 = (f64::from(i) + rng.random::<f64>()) / f64::from(directions);
                let theta = sin2.sqrt().asin().to_degrees().min(89.999);
                let phi = 360.0 * rng.random::<f64>();
                let incidence = Incidence::from_degrees(theta, phi).unwrap();
                let (values, _) = tracer.batch(
                    &Illumination::new(incidence, false),
                    3,
                    layout,
                    None,
                    &mut rng,
                );
                sum.iter_mut()
                    .zip(values)
                    .for_each(|(s, v)| *s += v / f64::from(directions));
            }
            statistics.push(&sum);
        }
        statistics.estimate(Layout::TRANSMITTED)
    };
    let down = diffuse(Medium::Above, GLASS, 1);
    let up = diffuse(Medium::Below, 1.0 / GLASS, 2);
    let n2 = GLASS * GLASS;
    let z = z_score(down, n2 * up.mean, n2 * up.se.unwrap());
    println!("down {down:?}, n^2 up {}, z = {z}", n2 * up.mean);
    assert!(z.abs() < 4.0, "z = {z}");
    assert!(down.se.unwrap() < 1e-3);
}

#[test]
fn scale_changes_nothing() {
    let field = waves(24, 1.5, 13);
    let run = |scale: f64| {
        let heights = field.heights().iter().map(|h| h * scale).collect();
        let scaled = HeightField::new(heights, field.shape(), [scale; 2]).unwrap();
        let surface = Surface::new(scaled);
        let bvh = MeshBvh::build(&surface).unwrap();
        Run {
            theta_deg: 65.0,
            ..Run::new(&surface, &bvh, glass())
        }
        .go(4, 10)
        .0
    };
    let reference = run(1.0);
    for scale in [1e-6, 1e6, 1e-9, 1e9] {
        for (a, b) in run(scale).means().iter().zip(reference.means()) {
            assert!((a - b).abs() < 1e-9, "scale {scale}");
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
                statistics.means()[Layout::LOST],
                0.0,
                "{theta_deg} {material:?}"
            );
            assert!((budget(&statistics) - 1.0).abs() < 1e-12);
            assert!(work.segments > work.rays);
        }
    }
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
    assert!(statistics.means()[Layout::TRUNCATED] > 0.01);
    assert!((budget(&statistics) - 1.0).abs() < 1e-12);
}

#[test]
fn what_is_recorded_of_a_side_does_not_depend_on_asking_for_the_other() {
    let surfaces = [
        rugged(16, 16, 1.0, 2, Border::Periodic),
        rugged(16, 16, 1.0, 3, Border::Open),
    ];
    // Silicon: both branches are strong.
    let silicon = Material::dielectric(3.5).unwrap();
    let mut skipped = 0;
    for surface in &surfaces {
        let bvh = MeshBvh::build(surface).unwrap();
        for branching in [Branching::Split, Branching::Pick] {
            for (max_order, incident) in [
                (1, Medium::Above),
                (2, Medium::Above),
                (3, Medium::Below),
                (1000, Medium::Above),
            ] {
                // Roulette decides about most branches, so that a draw more or less would be seen.
                let settings = PathSettings::new(branching, 0.5, max_order).unwrap();
                let asking = |sides| {
                    Run {
                        settings,
                        incident,
                        layout: Layout::default().with_sides(sides),
                        ..Run::new(surface, &bvh, silicon)
                    }
                    // More rays than are followed together, so that starts wait for room.
                    .go(2, 48)
                };
                let (both, work_of_both) = asking(Sides::Both);
                assert_eq!(work_of_both.branches_not_asked, 0);
                for sides in [Sides::Reflected, Sides::Transmitted] {
                    let (one, work) = asking(sides);
                    // All that differs is the way of the flux that went to the other side.
                    let mut expected = both.means().to_vec();
                    let mut found = one.means().to_vec();
                    assert!((budget(&one) - 1.0).abs() < 1e-12);
                    assert!(found[Layout::NOT_ASKED] > 0.01);
                    let layout = Layout::default();
                    for side in Side::BOTH.into_iter().filter(|&side| !sides.ask(side)) {
                        expected[side.index()] = 0.0;
                        expected[layout.multiple(side)] = 0.0;
                        (1..=64).for_each(|order| expected[layout.order(side, order)] = 0.0);
                        for path in layout.listed_paths() {
                            expected[layout.path(side, path)] = 0.0;
                        }
                        expected[layout.longer_paths(side)] = 0.0;
                        for class in OrderClass::ALL {
                            expected[layout.rings(side, class)].fill(0.0);
                            expected[layout.in_plane(side, class)].fill(0.0);
                        }
                        let bins = layout.grid().bins_per_side();
                        let of_side = |all: std::ops::Range<usize>| {
                            all.start + side.index() * bins..all.start + (side.index() + 1) * bins
                        };
                        for share in Share::ALL {
                            expected[of_side(layout.bins(share))].fill(0.0);
                        }
                        for share in [Share::Single, Share::Multiple] {
                            expected[of_side(layout.hits(share))].fill(0.0);
                        }
                    }
                    for i in [
                        Layout::TRUNCATED,
                        Layout::LEFT_PATCH,
                        Layout::LOST,
                        Layout::NOT_ASKED,
                    ] {
                        (expected[i], found[i]) = (0.0, 0.0);
                    }
                    assert!(found == expected, "{branching:?} {max_order} {sides}");
                    // Followed, a branch of the highest order is one segment.
                    assert_eq!(
                        work.segments + work.segments_skipped + work.branches_not_asked,
                        work_of_both.segments + work_of_both.segments_skipped
                    );
                    skipped += work.branches_not_asked;
                }
            }
        }
    }
    assert!(skipped > 1000, "{skipped}");
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
    assert!(values[Layout::LEFT_PATCH] > 0.01);
    assert_eq!(values[Layout::LOST], 0.0);
    assert!((budget(&statistics) - 1.0).abs() < 1e-12);
}

#[test]
fn mirrored_border_of_a_symmetric_tile_equals_its_periodic_continuation() {
    // One period of z = f(x) + g(y), even in both: half of it mirrored is the whole of it repeated.
    let n = 12;
    let whole = |i: usize| (std::f64::consts::TAU * i as f64 / n as f64).cos();
    let build = |columns: usize, border| {
        let heights = (0..columns * columns)
            .map(|i| 1.7 * whole(i % columns) + 1.1 * whole(i / columns))
            .collect();
        let field = HeightField::new(heights, [columns; 2], [1.0, 1.0]).unwrap();
        Surface::new(field.with_border(border))
    };
    let periodic = build(n, Border::Periodic);
    let mirrored = build(n / 2 + 1, Border::Mirrored);
    let go = |surface: &Surface, seed| {
        let bvh = surface.accelerator(AcceleratorKind::Auto).unwrap();
        Run {
            theta_deg: 50.0,
            phi_deg: 200.0,
            seed,
            ..Run::new(surface, &*bvh, glass())
        }
        .go(60, 60)
        .0
    };
    let (a, b) = (go(&periodic, 1), go(&mirrored, 2));
    let layout = Layout::default();
    // Orders, and every in-plane bin, most of whose light has crossed borders; compared where 20 or
    // more rays make a normal error.
    let mut entries: Vec<usize> = Vec::new();
    for side in Side::BOTH {
        entries.extend((1..=4).map(|order| layout.order(side, order)));
        for class in [OrderClass::First, OrderClass::Second, OrderClass::Third] {
            entries.extend(layout.in_plane(side, class));
        }
    }
    let mut compared = 0;
    for i in entries {
        let (found, reference) = (a.estimate(i), b.estimate(i));
        let enough = |e: asperity_tally::Estimate| e.se.unwrap() < e.mean / 20_f64.sqrt();
        if enough(found) && enough(reference) {
            let z = z_score(found, reference.mean, reference.se.unwrap());
            assert!(z.abs() < 4.5, "entry {i}: z = {z}");
            compared += 1;
        }
    }
    assert!(compared > 25, "{compared}");
}
