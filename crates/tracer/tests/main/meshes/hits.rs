//! Hits on meshes: every ray that must meet a facet does, the one that brute force finds.

use super::*;

#[test]
fn a_ray_inside_a_closed_body_always_meets_it() {
    let sphere = surface(icosphere(3), Border::Open);
    assert!(sphere.repairs().closed && sphere.repairs().open_edges == 0);
    let bvh = MeshBvh::build(&sphere).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let centre = DVec3::new(512.0, 512.0, 0.0);
    for i in 0..10_000 {
        let facet = rng.random_range(0..sphere.facet_count() as u32);
        let target = point_of(&sphere, facet, &mut rng);
        let (origin, direction) = match i % 4 {
            // From a point inside, anywhere or at a corner, an edge or a facet.
            0 => (centre, random_direction(&mut rng)),
            1 => (centre + 300.0 * random_direction(&mut rng), DVec3::ZERO),
            // Straight up or down onto it, so that corners are met exactly; not along its rim,
            // where edges are vertical.
            2 if target.z.abs() < 100.0 => continue,
            2 => (target.with_z(0.0), DVec3::Z * target.z.signum()),
            // From the skin into the inside.
            _ => (sphere.snap(facet, target), {
                let d = random_direction(&mut rng);
                if d.dot(sphere.normal(facet)) < 0.0 {
                    d
                } else {
                    -d
                }
            }),
        };
        let direction = if direction == DVec3::ZERO {
            (target - origin).normalize()
        } else {
            direction
        };
        let ray = TileRay { origin, direction };
        let query = Query {
            ray,
            half_space: HalfSpace::Below,
        };
        let hit = bvh.closest_hit(&sphere, &query);
        assert!(hit.is_some(), "{i} {ray:?}");
        assert_eq!(hit, BruteForce.closest_hit(&sphere, &query));
    }
}

#[test]
fn bvh_matches_brute_force_under_overhangs() {
    let mesh = surface(mushroom(), Border::Open);
    let bvh = mesh.accelerator(AcceleratorKind::Auto).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut met = 0;
    for i in 0..10_000 {
        let facet = rng.random_range(0..mesh.facet_count() as u32);
        let other = rng.random_range(0..mesh.facet_count() as u32);
        let point = point_of(&mesh, facet, &mut rng);
        let target = point_of(&mesh, other, &mut rng);
        let [a, b, _] = mesh.corners(other);
        let (origin, direction) = match i % 5 {
            // From one point of the surface to another: through corners, edges, insides.
            0 => (
                mesh.snap(facet, point),
                (target - point).normalize_or(DVec3::X),
            ),
            // From afar at a point.
            1 => {
                let d = random_direction(&mut rng);
                (target - 3e3 * d, d)
            }
            // Along an axis, exactly through a point.
            2 => {
                let d = [DVec3::X, DVec3::Y, DVec3::Z][rng.random_range(0..3)];
                (target - 2048.0 * d, d)
            }
            // Along an edge, so along its facets too.
            3 => (a - 100.0 * (b - a), (b - a).normalize()),
            // Anywhere from a point.
            _ => (mesh.snap(facet, point), random_direction(&mut rng)),
        };
        let half_space = random_half_space(&mut rng);
        let ray = TileRay { origin, direction };
        let query = Query { ray, half_space };
        let expected = BruteForce.closest_hit(&mesh, &query);
        assert_eq!(bvh.closest_hit(&mesh, &query), expected, "{query:?}");
        met += usize::from(expected.is_some());
    }
    println!("{met} of 10000 rays meet something");
    assert!(met > 3_000, "{met}");
}

#[test]
fn no_ray_slips_through_where_facets_meet() {
    // A rugged periodic mesh: a ray that moves towards it must meet it, wherever on it it starts.
    for border in [Border::Periodic, Border::Mirrored] {
        let mesh = exported(&rugged(8, 8, 1.5, 7, border));
        let bvh = MeshBvh::build(&mesh).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut met = 0;
        for _ in 0..100_000 {
            let half_space = random_half_space(&mut rng);
            let facet = rng.random_range(0..mesh.facet_count() as u32);
            let origin = mesh.snap(facet, point_of(&mesh, facet, &mut rng));
            let direction = random_direction(&mut rng);
            if half_space.sign() * direction.dot(mesh.normal(facet)) <= 0.0 {
                continue;
            }
            let heading = Heading {
                origin,
                direction,
                mirrored: [false; 2],
            };
            match traverse(&mesh, &bvh, heading, half_space) {
                TraversalResult::Hit(..) => met += 1,
                TraversalResult::Ended(
                    TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_),
                ) => {
                    assert!(
                        half_space.sign() * direction.z > 0.0,
                        "{heading:?} {half_space:?}"
                    );
                }
                other => panic!("{other:?} {heading:?} {half_space:?}"),
            }
        }
        assert!(met > 20_000, "{met}");
    }
}

#[test]
fn no_ray_slips_through_where_tiles_meet() {
    for border in [Border::Periodic, Border::Mirrored] {
        let mesh = exported(&rugged(7, 9, 1.5, 7, border));
        let bvh = MeshBvh::build(&mesh).unwrap();
        let [low, high] = mesh.z_range();
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for i in 0..200_000 {
            // At a place on the border of the tile, from several tiles away.
            let facet = rng.random_range(0..mesh.facet_count() as u32);
            let [a, b, _] = mesh.corners(facet);
            let target = if i % 2 == 0 {
                a
            } else {
                a.lerp(b, rng.random())
            };
            if (0..2).all(|k| target[k] != 0.0 && target[k] != mesh.extent()[k]) {
                continue;
            }
            let half_space = random_half_space(&mut rng);
            let direction = random_direction(&mut rng) * DVec3::new(1.0, 1.0, 0.1);
            let direction = direction.normalize();
            let towards = direction * -half_space.sign() * direction.z.signum();
            let height = (high - low) / towards.z.abs() * rng.random_range(1.0..9.0);
            let heading = Heading {
                origin: target - height * towards,
                direction: towards,
                mirrored: [false; 2],
            };
            let end = traverse(&mesh, &bvh, heading, half_space);
            assert!(
                matches!(end, TraversalResult::Hit(..)),
                "{end:?} {heading:?}"
            );
        }
    }
}
