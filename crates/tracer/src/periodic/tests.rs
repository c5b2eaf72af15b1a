//! Borders against copies of the tile, and rays that a border must not lose.

use super::*;
use crate::{BruteForce, Surface};
use asperity_surface::HeightField;
use glam::DVec3;

use crate::geometry::Escape;
use crate::ray::HalfSpace;

/// 3 x 4 samples without symmetry.
fn bumpy(border: Border) -> HeightField {
    let heights = vec![
        0.0, 0.3, -0.1, 0.2, 0.5, -0.4, 0.1, 0.0, 0.6, -0.2, 0.3, 0.1,
    ];
    HeightField::new(heights, [3, 4], [1.0, 1.5])
        .unwrap()
        .with_border(border)
}

/// The tile and its images, copied into one large open surface: `copies` tiles along each axis.
fn unrolled(field: &HeightField, copies: usize) -> Surface {
    let [cx, cy] = field.cells();
    let (nx, ny) = (cx * copies + 1, cy * copies + 1);
    let sample = |i: usize, cells: usize| match field.border() {
        Border::Mirrored if (i / cells) % 2 == 1 => cells - i % cells,
        _ => i % cells,
    };
    let heights = (0..ny)
        .flat_map(|iy| (0..nx).map(move |ix| (ix, iy)))
        .map(|(ix, iy)| field.height(sample(ix, cx), sample(iy, cy)))
        .collect();
    let big = HeightField::new(heights, [ny, nx], field.spacing()).unwrap();
    Surface::new(big.with_border(Border::Open))
}

#[test]
fn a_periodic_border_equals_copies_of_the_tile() {
    let field = bumpy(Border::Periodic);
    let copies = 8;
    let big = unrolled(&field, copies);
    let surface = Surface::new(field);
    let [cx, cy] = surface.cells().map(|n| n as f64);
    let middle = copies as f64 / 2.0;
    let mut met = 0;
    for i in 0..400 {
        let turn = f64::from(i) * 2.399_963;
        let u = (f64::from(i) * 0.754_877).fract();
        let v = (f64::from(i) * 0.569_840).fract();
        let d = DVec3::new(turn.cos(), turn.sin(), -0.05 - 0.4 * u).normalize();
        let origin = DVec3::new(u * cx, v * cy, surface.z_range()[1]);
        let heading = Heading {
            origin,
            direction: d,
            mirrored: [false; 2],
        };
        let shift = DVec3::new(middle * cx, middle * cy, 0.0);
        let far = Heading {
            origin: origin + shift,
            ..heading
        };
        let wrapped = traverse(&surface, &BruteForce, heading, HalfSpace::Above);
        let direct = traverse(&big, &BruteForce, far, HalfSpace::Above);
        if let (TraversalResult::Hit(_, a), TraversalResult::Hit(_, b)) = (wrapped, direct) {
            met += 1;
            let dx = (b.origin.x - a.origin.x).rem_euclid(cx);
            let dy = (b.origin.y - a.origin.y).rem_euclid(cy);
            assert!(
                dx.min(cx - dx) < 1e-9 && dy.min(cy - dy) < 1e-9,
                "{a:?} {b:?}"
            );
            assert!((a.origin.z - b.origin.z).abs() < 1e-9);
        }
    }
    assert!(met > 300, "{met}");
}

#[test]
fn a_mirrored_border_equals_mirrored_copies_of_a_symmetric_split() {
    // Mirroring turns the diagonals of odd images, so the copies agree only where no diagonal
    // matters: a surface without twist in its cells, z = f(x) + g(y).
    let f = [0.0, 0.4, -0.2, 0.3];
    let g = [0.1, -0.3, 0.2];
    let heights = g
        .iter()
        .flat_map(|b| f.iter().map(move |a| a + b))
        .collect();
    let field = HeightField::new(heights, [3, 4], [1.0, 1.5]).unwrap();
    let field = field.with_border(Border::Mirrored);
    let copies = 8;
    let big = unrolled(&field, copies);
    let surface = Surface::new(field);
    let [cx, cy] = surface.cells().map(|n| n as f64);
    let shift = DVec3::new(4.0 * cx, 4.0 * cy, 0.0);
    let mut met = 0;
    for i in 0..400 {
        let turn = f64::from(i) * 2.399_963;
        let u = (f64::from(i) * 0.754_877).fract();
        let v = (f64::from(i) * 0.569_840).fract();
        let d = DVec3::new(turn.cos(), turn.sin(), -0.08 - 0.4 * u).normalize();
        let origin = DVec3::new(u * cx, v * cy, surface.z_range()[1]);
        let heading = Heading {
            origin,
            direction: d,
            mirrored: [false; 2],
        };
        let far = Heading {
            origin: origin + shift,
            ..heading
        };
        let folded = traverse(&surface, &BruteForce, heading, HalfSpace::Above);
        let direct = traverse(&big, &BruteForce, far, HalfSpace::Above);
        if let (TraversalResult::Hit(_, a), TraversalResult::Hit(_, b)) = (folded, direct) {
            met += 1;
            assert!((a.world_direction() - b.world_direction()).length() < 1e-12);
            let fold = |x: f64, size: f64| {
                let x = x.rem_euclid(2.0 * size);
                x.min(2.0 * size - x)
            };
            assert!(
                (fold(b.origin.x, cx) - a.origin.x).abs() < 1e-9,
                "{a:?} {b:?}"
            );
            assert!((fold(b.origin.y, cy) - a.origin.y).abs() < 1e-9);
            assert!((a.origin.z - b.origin.z).abs() < 1e-9);
        }
    }
    assert!(met > 300, "{met}");
}

#[test]
fn unequal_spacings_are_those_of_the_physical_surface() {
    // z = 0.3 x - 0.2 y over cells of 0.5 by 2: a ray in physical coordinates, met by hand.
    let [dx, dy] = [0.5, 2.0];
    let height = |x: f64, y: f64| 0.3 * x - 0.2 * y;
    let heights = (0..9 * 7)
        .map(|i| height(f64::from(i % 9) * dx, f64::from(i / 9) * dy))
        .collect();
    let field = HeightField::new(heights, [7, 9], [dx, dy]).unwrap();
    let middle = 0.5 * (height(4.0, 0.0) + height(0.0, 12.0));
    let surface = Surface::new(field.with_border(Border::Open));
    let d = DVec3::new(0.3, 0.7, -0.4).normalize();
    let start = DVec3::new(1.0, 2.0, 3.0);
    let heading = Heading {
        origin: DVec3::new(start.x / dx, start.y / dy, (start.z - middle) / dx),
        direction: d,
        mirrored: [false; 2],
    };
    let TraversalResult::Hit(_, met) = traverse(&surface, &BruteForce, heading, HalfSpace::Above)
    else {
        panic!("no hit");
    };
    let t = (start.z - height(start.x, start.y)) / (0.3 * d.x - 0.2 * d.y - d.z);
    let expected = start + t * d;
    let found = DVec3::new(
        met.origin.x * dx,
        met.origin.y * dy,
        met.origin.z * dx + middle,
    );
    assert!((found - expected).length() < 1e-12, "{found} {expected}");
    assert_eq!(met.direction, d);
}

#[test]
fn mirror_images_of_mirror_images_are_upright() {
    let surface = Surface::new(bumpy(Border::Mirrored));
    let d = DVec3::new(1.0, 0.0, -0.3).normalize();
    // From near the right border: the surface is met in the image, where x runs backwards.
    let origin = DVec3::new(2.9, 0.5, surface.z_range()[1]);
    for before in [[false, false], [true, false], [false, true], [true, true]] {
        let heading = Heading {
            origin,
            direction: d,
            mirrored: before,
        };
        let TraversalResult::Hit(_, met) =
            traverse(&surface, &BruteForce, heading, HalfSpace::Above)
        else {
            panic!("no hit");
        };
        assert_eq!(met.mirrored, [!before[0], before[1]]);
        assert!((met.world_direction() - heading.world_direction()).length() < 1e-15);
    }
}

#[test]
fn an_open_patch_lets_rays_out_sideways() {
    let surface = Surface::new(bumpy(Border::Open));
    let d = DVec3::new(1.0, 0.0, -0.01).normalize();
    let origin = DVec3::new(1.0, 1.0, surface.z_range()[1] + 0.5);
    let heading = Heading {
        origin,
        direction: d,
        mirrored: [false; 2],
    };
    let journey = traverse(&surface, &BruteForce, heading, HalfSpace::Above);
    assert_eq!(journey, TraversalResult::Ended(TraversalEnd::LeftPatch));
}

#[test]
fn light_from_under_the_rim_of_an_open_patch_is_not_let_in() {
    // A valley between two rims: level light from outside the tile meets the first rim's far side, which
    // is not there, and must not shine through the ground onto the slope behind the valley.
    let profile = [1.0, 0.0, 1.0];
    let heights = (0..9).map(|i| profile[i % 3]).collect();
    let field = HeightField::new(heights, [3, 3], [1.0, 1.0]).unwrap();
    let surface = Surface::new(field.with_border(Border::Open));
    let d = DVec3::new(1.0, 0.0, -0.01).normalize();
    let from = |z: f64| Heading {
        origin: DVec3::new(-1.0, 0.7, z),
        direction: d,
        mirrored: [false; 2],
    };
    let [_, high] = surface.z_range();
    let under = traverse(&surface, &BruteForce, from(high - 0.3), HalfSpace::Above);
    assert_eq!(under, TraversalResult::Ended(TraversalEnd::LeftPatch));
    let over = traverse(&surface, &BruteForce, from(high + 0.015), HalfSpace::Above);
    assert!(matches!(over, TraversalResult::Hit(..)), "{over:?}");
}

#[test]
fn a_ray_steeper_than_every_facet_needs_no_search() {
    let surface = Surface::new(bumpy(Border::Periodic));
    let heading = Heading {
        origin: DVec3::ZERO,
        direction: DVec3::Z,
        mirrored: [false; 2],
    };
    let journey = traverse(&surface, &BruteForce, heading, HalfSpace::Above);
    assert_eq!(
        journey,
        TraversalResult::Ended(TraversalEnd::EscapedUnsearched(Escape::SteeperThanAll))
    );
}
