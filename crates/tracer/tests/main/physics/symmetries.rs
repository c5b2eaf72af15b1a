//! Symmetries: light seen upside down, the other way round, in other units, and mirrored.

use asperity_optics::{Incidence, Material};
use asperity_surface::{Border, HeightField};
use asperity_tally::{
    Component, Entry, HemisphereGrid, Side, TallyResult, TallySpec, TallyStatistics, TallyValues,
};
use asperity_tracer::{
    AcceleratorKind, BruteForce, BuildAccelerator, HalfSpace, Illumination, MeshBvh, PathSettings,
    PathStream, Surface, Tracer,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{GLASS, glass};
use crate::common::{Run, waves, z_score};

#[test]
fn light_from_below_equals_light_from_above_on_the_inverted_surface() {
    let field = waves(24, 1.2, 9);
    let inverted = field
        .with_heights(field.heights().iter().map(|h| -h).collect())
        .unwrap();
    let (surface, inverted) = (Surface::new(field), Surface::new(inverted));
    let below = Run {
        incident: HalfSpace::Below,
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
        let spec = TallySpec::new(HemisphereGrid::new(1, 1).unwrap(), 0.1).unwrap();
        let mut statistics = TallyStatistics::new(spec);
        for block in 0..40 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(block);
            // Cosine-distributed directions, stratified over sin^2(theta).
            let mut sum = TallyValues::zeros(spec);
            let directions = 64_u32;
            for i in 0..directions {
                let sin2 = (f64::from(i) + rng.random::<f64>()) / f64::from(directions);
                let theta = sin2.sqrt().asin().to_degrees().min(89.999);
                let phi = 360.0 * rng.random::<f64>();
                let incidence = Incidence::from_degrees(theta, phi).unwrap();
                let (values, _) = tracer.batch(
                    &Illumination::new(incidence, false),
                    3,
                    spec,
                    None,
                    PathStream::new(seed, block).from_path(u64::from(9 * i)),
                );
                sum.update(&values, |s, v| *s += v / f64::from(directions));
            }
            statistics.push(&sum);
        }
        statistics.budget().transmitted
    };
    let down = diffuse(HalfSpace::Above, GLASS, 1);
    let up = diffuse(HalfSpace::Below, 1.0 / GLASS, 2);
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
    let spec = TallySpec::default();
    // Orders, and every in-plane bin, most of whose light has crossed borders; compared where 20 or
    // more rays make a normal error.
    let mut entries: Vec<Entry> = Vec::new();
    for side in Side::BOTH {
        entries.extend((1..=4).map(|order| spec.order_entry(side, order)));
        for class in [Component::Single, Component::Order(2), Component::Order(3)] {
            entries.extend(spec.in_plane_entries(side, class));
        }
    }
    let mut compared = 0;
    for i in entries {
        let (found, reference) = (a.at(i), b.at(i));
        let enough = |e: asperity_tally::Estimate| e.se.unwrap() < e.mean / 20_f64.sqrt();
        if enough(found) && enough(reference) {
            let z = z_score(found, reference.mean, reference.se.unwrap());
            assert!(z.abs() < 4.5, "entry {i}: z = {z}");
            compared += 1;
        }
    }
    assert!(compared > 25, "{compared}");
}
