//! Light on meshes: budgets, borders, and a height field as a mesh.

use super::*;

#[test]
fn a_sphere_of_glass_keeps_the_budget() {
    let sphere = surface(icosphere(3), Border::Open);
    let (statistics, work) = trace(&sphere, AcceleratorKind::Mesh, HalfSpace::Above, 30.0);
    let at = |i| statistics.means()[i];
    println!("{work:?}");
    assert_eq!(at(TallySpec::BUDGET.lost), 0.0);
    assert_eq!(at(TallySpec::BUDGET.transmitted), 0.0);
    // All light ends outside of the sphere; what leaves it downwards finds nothing there.
    assert!(at(TallySpec::BUDGET.reflected) > 0.02 && at(TallySpec::BUDGET.left_patch) > 0.5);
    assert!((budget(&statistics) - 1.0).abs() < 1e-12);
}

/// A flat rectangle of width 1 and this depth, cut along x into strips of two triangles each.
fn flat_strips(depth: f64, strips: u32) -> Mesh {
    let row = |i| depth * f64::from(i) / f64::from(strips);
    let vertices = (0..=strips).flat_map(|i| [[0.0, row(i), 0.0], [1.0, row(i), 0.0]]);
    let triangles = (0..strips).flat_map(|i| {
        let k = 2 * i;
        [[k, k + 1, k + 3], [k, k + 3, k + 2]]
    });
    (vertices.collect(), triangles.collect())
}

#[test]
fn a_flat_mesh_of_elongated_triangles_loses_no_light() {
    // Rays begin in the very plane of the mesh, so that each starts on a facet.
    for (depth, strips) in [(1e-2, 1), (1.0, 50), (1e-3, 7)] {
        let mesh = surface(flat_strips(depth, strips), Border::Periodic);
        for theta in [0.0, 30.0, 60.0, 88.0] {
            for kind in [AcceleratorKind::Mesh, AcceleratorKind::BruteForce] {
                let (statistics, _) = trace(&mesh, kind, HalfSpace::Above, theta);
                let lost = statistics.means().budget().lost;
                assert_eq!(lost, 0.0, "{depth} {strips} {theta} {kind:?}");
                assert!((budget(&statistics) - 1.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_mushroom_keeps_the_budget() {
    for (border, theta) in [
        (Border::Periodic, 20.0),
        (Border::Mirrored, 50.0),
        (Border::Open, 70.0),
    ] {
        for incident in [HalfSpace::Above, HalfSpace::Below] {
            let mesh = surface(mushroom(), border);
            assert_eq!(mesh.repairs(), Default::default());
            let (statistics, _) = trace(&mesh, AcceleratorKind::Auto, incident, theta);
            assert_eq!(
                statistics.means().budget().lost,
                0.0,
                "{border} {incident:?}"
            );
            assert!((budget(&statistics) - 1.0).abs() < 1e-12);
            assert!(statistics.means().budget().transmitted > 0.4);
        }
    }
}

#[test]
fn an_exported_tile_is_traced_as_the_height_field_itself() {
    let heights = waves(24, 1.3, 5).heights().to_vec();
    let field = HeightField::new(heights, [24, 24], [0.5, 0.75]).unwrap();
    let surface = Surface::new(field.with_border(Border::Periodic));
    let mesh = exported(&surface);
    assert_eq!(mesh.repairs(), Default::default());
    for (incident, theta) in [(HalfSpace::Above, 30.0), (HalfSpace::Below, 60.0)] {
        let (expected, work) = trace(&surface, AcceleratorKind::Auto, incident, theta);
        let (found, own) = trace(&mesh, AcceleratorKind::Auto, incident, theta);
        let spec = TallySpec::default();
        assert_eq!(found.means().budget().lost, 0.0);
        let orders = Side::BOTH.into_iter().flat_map(|side| {
            (1..=MAX_LISTED_ORDER).map(move |order| spec.order_entry(side, order))
        });
        for i in orders.chain([TallySpec::BUDGET.reflected, TallySpec::BUDGET.transmitted]) {
            let (a, b) = (expected.at(i), found.at(i));
            let error = a.se.unwrap().hypot(b.se.unwrap());
            assert!((a.mean - b.mean).abs() <= 3.0 * error, "{i}: {a:?} {b:?}");
        }
        // The same paths but for rounding: the same random numbers lead the same ways.
        let apart = own.segments + own.segments_skipped;
        let apart = apart.abs_diff(work.segments + work.segments_skipped);
        println!("{work:?} {own:?}");
        assert!(apart * 1000 <= work.segments, "{work:?} {own:?}");
    }
}

#[test]
fn light_that_passes_by_an_open_patch_is_truncated() {
    assert_eq!(surface(holed(), Border::Open).repairs().open_edges, 3);
    for mesh in [icosphere(1), pipe(), holed()] {
        let mesh = surface(mesh, Border::Open);
        for (incident, theta) in [(HalfSpace::Above, 0.0), (HalfSpace::Below, 60.0)] {
            let (statistics, _) = trace(&mesh, AcceleratorKind::Auto, incident, theta);
            assert_eq!(statistics.means().budget().lost, 0.0);
            assert!(statistics.means().budget().left_patch > 1e-4);
            assert!((budget(&statistics) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn light_over_the_rim_of_an_open_patch_escapes_upwards_alone() {
    let mut heights = vec![0.0; 16];
    heights[5] = 10.0;
    let field = HeightField::new(heights, [4, 4], [1.0, 1.0]).unwrap();
    let surface = Surface::new(field.with_border(Border::Open));
    let [low, high] = surface.z_range();
    // Between lowest and highest point, by the rim at x = 0
    let origin = DVec3::new(0.2, 2.5, low + 0.5 * (high - low));
    for (rise, expected) in [
        (0.1, TraversalEnd::Escaped),
        (1e-6, TraversalEnd::Escaped),
        (0.0, TraversalEnd::LeftPatch),
        (-0.1, TraversalEnd::LeftPatch),
    ] {
        let heading = Heading {
            origin,
            direction: DVec3::new(-1.0, 0.0, rise).normalize(),
            mirrored: [false; 2],
        };
        let found = traverse(&surface, &BruteForce, heading, HalfSpace::Above);
        assert_eq!(found, TraversalResult::Ended(expected), "{rise}");
    }
}

#[test]
fn scale_and_place_change_nothing() {
    let (vertices, triangles) = mushroom();
    let plain = surface((vertices.clone(), triangles.clone()), Border::Open);
    let moved = vertices
        .iter()
        .map(|v| [v[0] * 1e-6 + 5.0, v[1] * 1e-6 - 3.0, v[2] * 1e-6 + 100.0])
        .collect();
    let moved = surface((moved, triangles), Border::Open);
    for facet in 0..plain.facet_count() as u32 {
        for (p, q) in plain.corners(facet).into_iter().zip(moved.corners(facet)) {
            // An offset of 100 takes 2^-46 of it from lengths of 4e-6, of which 1024 are the longest.
            assert!((p - q).length() < 1e-5, "{p} {q}");
        }
    }
}
