//! Faces with more than three corners, and strips.

use super::{read, refused};
use crate::damage_tests::changes;
use crate::formats::MeshFormat;

#[test]
fn polygons_become_fans() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nf 1 2 3 4\nf 5 3 4\n";
    let mesh = read(MeshFormat::Obj, obj.as_bytes()).unwrap();
    // The fifth vertex stands where the first does.
    assert_eq!(mesh.vertices.len(), 4);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
}

/// An OBJ file of one face around these corners.
fn face(corners: &[[f64; 3]]) -> String {
    let vertices = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let numbers = (1..=corners.len()).map(|k| format!(" {k}"));
    vertices.collect::<String>() + "f" + &numbers.collect::<String>() + "\n"
}

/// Vector area of a triangle, times two.
fn doubled_area([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        u[i] * v[j] - u[j] * v[i]
    })
}

/// A comb of square teeth, around as seen from above: concave corners, and corners on one line.
fn comb(teeth: usize) -> Vec<[f64; 3]> {
    let tooth = |k: usize| {
        let x = (2 * (teeth - k)) as f64;
        [
            [x, 2.0, 0.0],
            [x - 1.0, 2.0, 0.0],
            [x - 1.0, 1.0, 0.0],
            [x - 2.0, 1.0, 0.0],
        ]
    };
    let below = (0..=2 * teeth).map(|x| [x as f64, 0.0, 0.0]);
    below.chain((0..teeth).flat_map(tooth)).collect()
}

/// A square with a square hole, which a line joins to the outline.
const HOLED: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [4.0, 0.0, 0.0],
    [4.0, 4.0, 0.0],
    [0.0, 4.0, 0.0],
    [0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [1.0, 3.0, 0.0],
    [3.0, 3.0, 0.0],
    [3.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
];

#[test]
fn faces_are_covered_once_by_triangles_of_all_their_corners() {
    let l_shape = [[0, 0], [4, 0], [4, 4], [3, 4], [3, 1], [0, 1]];
    let l_shape = l_shape
        .map(|[x, y]| [f64::from(x), f64::from(y), 0.0])
        .to_vec();
    let mut twice = l_shape.clone();
    twice.insert(4, twice[4]);
    let lying = [
        (l_shape, 7.0, 4),
        (twice, 7.0, 4),
        (
            vec![[0.0; 3], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]],
            4.0,
            2,
        ),
        // A corner on an edge of a square
        (
            vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [2.0, 0.0, 0.0],
                [2.0, 2.0, 0.0],
                [0.0, 2.0, 0.0],
            ],
            4.0,
            3,
        ),
        (comb(8), 24.0, 47),
        (HOLED.to_vec(), 12.0, 8),
    ];
    // Lying, turned over, on edge, and tilted by 45 degrees; beginning at each corner
    type Place = fn([f64; 3]) -> [f64; 3];
    let places: [(Place, f64); 6] = [
        (|p| p, 0.0),
        (|[x, y, z]| [y, x, z], 0.0),
        (|[x, y, z]| [x, z, y], 0.0),
        (|[x, y, _]| [7.0, x, y], 0.0),
        (|[x, y, _]| [x + 1e3, y, x - 2.0], 0.0),
        // In the digits of single precision, so that no four corners lie in one plane: areas are off by 2^-24 of the sides of 4 times these
        (
            |[x, y, _]| {
                let p = [0.7 * x + 0.1 * y, 0.9 * y - 0.2 * x, 0.3 * x + 0.4 * y];
                p.map(|x| f64::from(x as f32))
            },
            1e-6,
        ),
    ];
    for (corners, area, count) in lying {
        for (place, rounding) in places {
            let corners: Vec<_> = corners.iter().copied().map(place).collect();
            let normal = doubled_area(place_of_axes(place));
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            for first in 0..corners.len() {
                let mut corners = corners.clone();
                corners.rotate_left(first);
                let mesh = read(MeshFormat::Obj, face(&corners).as_bytes()).unwrap();
                let triangles = mesh
                    .triangles
                    .iter()
                    .map(|t| t.map(|k| mesh.vertices[k as usize]));
                let along = triangles.map(|t| {
                    let own = doubled_area(t);
                    (0..3).map(|k| own[k] * normal[k] / length).sum::<f64>()
                });
                let along: Vec<f64> = along.collect();
                let full = 2.0 * area * length;
                let sum: f64 = along.iter().sum();
                assert!(
                    (sum - full).abs() < (1e-9 + rounding) * full,
                    "{corners:?}: {sum}, not {full}"
                );
                let least = 1e-9 - rounding * full;
                assert!(along.iter().all(|own| *own > least), "{corners:?}");
                assert_eq!(along.len(), count, "{corners:?}");
                let used = mesh.triangles.as_flattened();
                assert!((0..mesh.vertices.len()).all(|k| used.contains(&(k as u32))));
            }
        }
    }
}

/// The corners 0, x and y, moved.
fn place_of_axes(place: fn([f64; 3]) -> [f64; 3]) -> [[f64; 3]; 3] {
    [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(place)
}

#[test]
fn faces_that_cross_themselves_are_refused() {
    let flat = |corners: &[[i32; 2]]| -> Vec<[f64; 3]> {
        corners
            .iter()
            .map(|[x, y]| [f64::from(*x), f64::from(*y), 0.0])
            .collect()
    };
    let crossing = "edges that cross each other";
    for (corners, words) in [
        (flat(&[[0, 0], [2, 2], [2, 0], [0, 2]]), crossing),
        (flat(&[[0, 0], [3, 3], [3, 0], [0, 2]]), crossing),
        // A star of five points, which only turns left
        (
            flat(&[[-8, 3], [8, 3], [-5, -7], [0, 10], [5, -7]]),
            crossing,
        ),
        // Twice around
        (
            flat(&[
                [0, 0],
                [9, 0],
                [9, 9],
                [1, 9],
                [1, 1],
                [8, 1],
                [8, 8],
                [0, 8],
            ]),
            crossing,
        ),
        // Two triangles that touch at a corner, one of them the wrong way around
        (
            flat(&[[0, 0], [2, 2], [4, 4], [4, 0], [2, 2], [0, 5]]),
            "an outline that touches itself",
        ),
        (comb(1200), "is not convex"),
    ] {
        refused(MeshFormat::Obj, face(&corners).as_bytes(), words);
    }
    // Corners on one line are triangles without area, as before.
    let line = flat(&[[0, 0], [1, 0], [3, 0], [2, 0]]);
    assert_eq!(
        read(MeshFormat::Obj, face(&line).as_bytes())
            .unwrap()
            .triangles
            .len(),
        2
    );
    let start = std::time::Instant::now();
    let wide = read(MeshFormat::Obj, face(&comb(680)).as_bytes()).unwrap();
    assert_eq!(wide.triangles.len(), 6 * 680 - 1);
    assert!(start.elapsed().as_secs() < 20);
}

#[test]
fn strips_of_triangles_are_read() {
    let strip = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 2\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n11 0 1 2 3 -1 2 3 4 4 4 5\n4 3 5 4 4\n";
    let strip = strip.replace("\n11 ", "\n10 ");
    let mesh = read(MeshFormat::Ply, strip.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [3, 5, 4]]);
    let cases = "
        4 3 5 4 4 => 4 3 6 4 4 => its tristrips 1, counted from zero, has the vertex number 6
        element tristrips 2 => element strips 2 => nor strips of triangles
        vertex_indices => corners => its strips of triangles have no list
    ";
    for (strip, words) in changes(&strip, cases) {
        refused(MeshFormat::Ply, strip.as_bytes(), words);
    }
}
