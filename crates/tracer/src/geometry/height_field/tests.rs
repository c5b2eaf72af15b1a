//! Facets, and the hits of rays on them.

use super::*;

/// A tilted plane `z = 0.5 x - 0.25 y` over 2 x 2 cells, open, with `dy = 2 dx`.
fn tilted() -> Surface {
    let heights = (0..9)
        .map(|i| 0.5 * f64::from(i % 3) - 0.25 * f64::from(i / 3))
        .collect();
    let field = HeightField::new(heights, [3, 3], [1.0, 2.0]).unwrap();
    Surface::new(field.with_border(Border::Open))
}

#[test]
fn normal_is_that_of_the_physical_plane() {
    let surface = tilted();
    // dh/dx = 0.5; dh/dy = -0.25 a row of two length units.
    let expected = DVec3::new(-0.5, 0.125, 1.0).normalize();
    for facet in surface.facets() {
        assert!((surface.normal(facet) - expected).length() < 1e-15);
    }
}

#[test]
fn a_vertical_ray_meets_exactly_one_facet_and_only_from_its_own_side() {
    let surface = tilted();
    let down = TileRay {
        origin: DVec3::new(0.7, 1.2, 5.0),
        direction: DVec3::NEG_Z,
    };
    let hits: Vec<_> = surface
        .facets()
        .filter_map(|f| {
            surface
                .intersect(f, &down, HalfSpace::Above)
                .map(|t| (f, t))
        })
        .collect();
    assert_eq!(hits.len(), 1);
    let (facet, t) = hits[0];
    assert_eq!(
        facet,
        Facet {
            iy: 1,
            ix: 0,
            triangle: Triangle::Lower
        }
    );
    let on_plane = surface.snap(facet, down.at(t));
    assert!((on_plane - down.at(t)).length() < 1e-14);
    assert!(
        surface
            .facets()
            .all(|f| surface.intersect(f, &down, HalfSpace::Below).is_none())
    );
}

#[test]
fn corners_lie_on_the_plane_and_turn_counter_clockwise() {
    let surface = tilted();
    for facet in surface.facets() {
        let [a, b, c] = surface.corners(facet);
        assert!((b - a).cross(c - a).z > 0.0);
        for p in [a, b, c] {
            assert!((surface.snap(facet, p) - p).length() < 1e-15);
        }
    }
}

/// Hits of a ray in `HalfSpace::Above` on each facet.
fn hits(surface: &Surface, origin: DVec3, direction: DVec3) -> Vec<(Facet, f64)> {
    let ray = TileRay { origin, direction };
    let hit = |f| surface.intersect(f, &ray, HalfSpace::Above).map(|t| (f, t));
    surface.facets().filter_map(hit).collect()
}

#[test]
fn a_ray_that_comes_in_under_the_rim_of_a_patch_meets_no_wall_there() {
    // At x = 0, y = 0.5 the plane is at -0.375 (its middle is 0.25); over the rim, and under it.
    let surface = tilted();
    let direction = DVec3::new(1.0, 0.0, -0.1).normalize();
    let over = hits(&surface, DVec3::new(-3.0, 0.5, 0.0), direction);
    assert_eq!(over.len(), 1);
    let under = hits(&surface, DVec3::new(-3.0, 0.5, -0.2), direction);
    assert_eq!(under, []);
}

#[test]
fn a_ray_that_has_left_the_tile_along_its_border_is_not_met_by_a_corner() {
    // It crosses the border x = 5 by rounding, near t = 133, and passes z = 0 at t = 135.2 in the
    // neighbouring tile. Where it runs past the corner (5, 1) it is 2.5e-4 under the plane.
    let field = HeightField::new(vec![7.0; 20], [4, 5], [1.0; 2]).unwrap();
    let origin = DVec3::new(4.999999999999992, 137.1965056830754, 0.033368251402507744);
    let direction = DVec3::new(
        5.999999817250078e-17,
        -0.9999999695416797,
        -0.00024681296471070006,
    );
    let surface = Surface::new(field);
    assert_eq!(hits(&surface, origin, direction), []);
    let outside = hits(&surface, origin - DVec3::new(5.0, 0.0, 0.0), direction);
    let crossing = origin.z / -direction.z;
    assert_eq!(outside.len(), 1);
    assert!((outside[0].1 - crossing).abs() < 1e-9);
}

#[test]
fn a_ray_on_the_wrong_side_of_an_edge_by_rounding_is_caught_by_the_next_facet() {
    // Over the edge x = 1 the ray is at z - h = -1e-15, and falls further.
    let surface = tilted();
    let edge = DVec3::new(1.0, 0.25, 0.5 - 0.0625 - 0.25 - 1e-15);
    let direction = DVec3::new(1.0, 0.0, -0.1).normalize();
    let caught = hits(&surface, edge, direction);
    assert!(caught.iter().any(|(f, t)| f.ix == 1 && *t == 0.0));
}

#[test]
fn offsets_and_units_leave_tile_coordinates_alone() {
    let heights: Vec<f64> = vec![0.0, 1.0, 2.0, -1.0];
    let plain = Surface::new(HeightField::new(heights.clone(), [2, 2], [1.0, 1.0]).unwrap());
    let scaled = heights.iter().map(|h| 1024.0 * h + 4096.0).collect();
    let scaled = Surface::new(HeightField::new(scaled, [2, 2], [1024.0, 1024.0]).unwrap());
    assert_eq!(plain.z_range(), scaled.z_range());
    assert_eq!(plain.mean_plane(), scaled.mean_plane());
    for facet in plain.facets() {
        assert_eq!(plain.corners(facet), scaled.corners(facet));
    }
}
