//! Validity: meshes that are surfaces, and meshes that are refused.

use super::*;

#[test]
fn what_faces_down_or_inwards_is_turned_over() {
    let turn = |(vertices, triangles): Mesh| {
        (
            vertices,
            triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect(),
        )
    };
    for mesh in [mushroom(), icosphere(1)] {
        let right = surface(mesh.clone(), Border::Open);
        let wrong = surface(turn(mesh), Border::Open);
        assert!(!right.repairs().turned_over && wrong.repairs().turned_over);
        for facet in 0..right.facet_count() as u32 {
            assert!((right.normal(facet) - wrong.normal(facet)).length() < 1e-12);
        }
    }
}

#[test]
fn invalid_surfaces_are_refused() {
    let square = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.5],
        [0.5, 0.5, 3.0],
    ];
    let refused = |triangles: &[[u32; 3]], border, words: &str| {
        let error = MeshSurface::new(&square, triangles.to_vec(), border).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        error
    };
    refused(&[], Border::Open, "none of 0 triangles");
    refused(&[[0, 1, 5]], Border::Open, "there are 5 vertices");
    refused(
        &[[0, 2, 2]],
        Border::Open,
        "none of 1 triangles has an area",
    );
    let error = refused(
        &[[0, 1, 2], [0, 2, 3], [0, 2, 4]],
        Border::Open,
        "3 triangles share",
    );
    assert!(matches!(error, MeshSurfaceError::Branching { .. }));
    refused(
        &[[0, 1, 2], [0, 3, 2]],
        Border::Open,
        "from [0.0, 0.0, 0.0] to [1.0, 1.0, 0.0]",
    );
    refused(
        &[[0, 1, 2], [0, 2, 3]],
        Border::Periodic,
        "periodic along x",
    );
    refused(&[[0, 1, 2], [0, 2, 3]], Border::Periodic, "[0.0, 1.0, 0.5]");
    for (vertices, words) in [
        (
            vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, f64::NAN, 0.0]],
            "finite",
        ),
        (vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0]], "extent"),
        (
            vec![[0.0; 3], [1e-200, 0.0, 0.0], [0.0, 1e-200, 0.0]],
            "1e-150",
        ),
        (
            vec![[-1e308; 3], [1e308, 0.0, 0.0], [0.0, 1e308, 0.0]],
            "1e150",
        ),
    ] {
        let error = MeshSurface::new(&vertices, vec![[0, 1, 2]], Border::Open).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let mesh = MeshSurface::new(&square, vec![[0, 1, 2], [0, 2, 3], [1, 1, 2]], Border::Open);
    let mesh = mesh.unwrap();
    assert_eq!((mesh.repairs().dropped, mesh.facet_count()), (1, 2));
    assert_eq!(mesh.size(), [1.0, 1.0, 0.5]);
}

/// Two meshes as one.
fn together((mut vertices, mut triangles): Mesh, (more, of_more): Mesh) -> Mesh {
    let first = vertices.len() as u32;
    vertices.extend(more);
    triangles.extend(of_more.iter().map(|t| t.map(|k| k + first)));
    (vertices, triangles)
}

fn scaled((vertices, triangles): Mesh, factor: f64, lift: f64) -> Mesh {
    let place = |v: &[f64; 3]| [factor * v[0], factor * v[1], factor * v[2] + lift];
    (vertices.iter().map(place).collect(), triangles)
}

fn turned_over((vertices, triangles): Mesh) -> Mesh {
    let turn = |[a, b, c]: &[u32; 3]| [*a, *c, *b];
    (vertices, triangles.iter().map(turn).collect())
}

#[test]
fn periodic_meshes_must_be_one_sheet_without_gaps() {
    let sphere = || icosphere(1);
    let two_grounds = || together(mushroom(), scaled(mushroom(), 1.0, 5.0));
    let slab = || together(mushroom(), scaled(turned_over(mushroom()), 1.0, -5.0));
    // Opposite borders with the same corners, joined in the order requested on the second.
    let strip = |[a, b, c, d]: [u32; 4]| -> Mesh {
        let at = |x: f64| [[0.0, 0.0], [0.3, 0.1], [0.6, -0.1], [1.0, 0.0]].map(|[y, z]| [x, y, z]);
        let triangles = vec![
            [0, a, b],
            [0, b, 1],
            [1, b, c],
            [1, c, 2],
            [2, c, d],
            [2, d, 3],
        ];
        ([at(0.0), at(1.0)].concat(), triangles)
    };
    surface(strip([4, 5, 6, 7]), Border::Periodic);
    let crossed = strip([4, 6, 5, 7]);
    let error = MeshSurface::new(&crossed.0, crossed.1, Border::Periodic).unwrap_err();
    assert!(
        error.to_string().contains("6 edges inside the tile"),
        "{error}"
    );
    for border in [Border::Periodic, Border::Mirrored] {
        let over = together(mushroom(), scaled(sphere(), 0.5, 3.0));
        assert_eq!(surface(over, border).repairs().open_edges, 0);
        for (mesh, words) in [
            (sphere(), "cover the tile 0 times"),
            (pipe(), "cover the tile 0 times"),
            (slab(), "cover the tile 0 times"),
            (two_grounds(), "cover the tile 2 times"),
            (holed(), "3 edges inside the tile"),
        ] {
            let error = MeshSurface::new(&mesh.0, mesh.1, border).unwrap_err();
            let error = error.to_string();
            assert!(error.contains(words), "{border}: {error}");
            assert!(
                error.contains(&format!("a {border} border needs")),
                "{error}"
            );
        }
    }
}

/// A square of side 2 about `centre`, of four triangles around its middle, so that no edge but its sides is one of [`square`].
fn crossed_square(centre: [f64; 3]) -> Mesh {
    let [x, y, z] = centre;
    let corner = |[i, j]: [f64; 2]| [x + i, y + j, z];
    let corners = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [0.0, 0.0],
    ];
    let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    (corners.map(corner).to_vec(), triangles)
}

/// A square of side 2 about the origin.
fn square() -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = corners.map(|[x, y]| [x, y, 0.0]);
    (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// The mesh turned by two angles, and its coordinates rounded to single precision.
fn tilted((vertices, triangles): Mesh) -> Mesh {
    let turn = |[x, y, z]: [f64; 3]| {
        let (x, y) = (0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y);
        let (y, z) = (0.96 * y - 0.28 * z, 0.28 * y + 0.96 * z);
        [x, y, z].map(|x| f64::from(x as f32))
    };
    (vertices.into_iter().map(turn).collect(), triangles)
}

#[test]
fn triangles_that_lie_in_each_other_are_refused_whatever_edges_they_share() {
    // A concave face of six corners as a fan that leaves it, its triangles with corners of their own
    let l = [[0, 0], [4, 0], [4, 4], [3, 4], [3, 1], [0, 1]]
        .map(|[x, y]| [f64::from(x), f64::from(y), 0.0]);
    let fan = || {
        let corners = (1..5).flat_map(|k| [l[0], l[k], l[k + 1]]);
        (
            corners.collect(),
            (0..4).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        )
    };
    let on_edge = |(vertices, triangles): Mesh| -> Mesh {
        let place = |[x, y, z]: [f64; 3]| [x, z, -y];
        let wall = (vertices.into_iter().map(place).collect(), triangles);
        together(scaled(square(), 5.0, -9.0), wall)
    };
    let sheets = |x: f64| together(square(), crossed_square([x, 0.0, 0.0]));
    let back = together(square(), turned_over(crossed_square([1.9, 1.9, 0.0])));
    // A box of which the bottom lies on the ground
    let (corners, _) = icosphere(0);
    let lowest = corners
        .iter()
        .fold(f64::INFINITY, |least, p| least.min(p[2]));
    let standing = together(
        scaled(square(), 3.0, lowest),
        crossed_square([0.0, 0.0, lowest]),
    );
    for (name, mesh) in [
        ("fan", fan()),
        ("fan of a wall", on_edge(fan())),
        ("sheets", sheets(0.0)),
        ("shifted sheets", sheets(1.8)),
        ("corners of sheets of opposite sides", back),
        ("sheet on the ground", standing),
    ] {
        for (mesh, rounding) in [(mesh.clone(), "double"), (tilted(mesh), "single")] {
            let found = surface(mesh, Border::Open).check_overlaps();
            let found = found.map_err(|error| error.to_string());
            let error = found.expect_err(&format!("{name}, {rounding} precision"));
            assert!(error.contains("lie in each other at ["), "{error}");
        }
    }
}

/// The fraction is that of the area: of two sheets all, of a sphere halfway in the ground what lies under it and within it.
#[test]
fn parts_that_face_the_backs_of_others_are_counted_by_area() {
    let behind = |mesh| surface(mesh, Border::Open).check_overlaps().unwrap();
    for mesh in [
        mushroom(),
        pipe(),
        icosphere(2),
        holed(),
        together(mushroom(), scaled(icosphere(2), 0.5, 3.0)),
    ] {
        assert_eq!(behind(mesh.clone()), 0.0);
        assert_eq!(behind(tilted(mesh)), 0.0);
    }
    let over = |height: f64, shift: f64| together(square(), crossed_square([shift, 0.0, height]));
    assert_eq!(behind(over(1e-3, 0.0)), 1.0);
    // The points lie in strata of equal area, so that a cut through them is off by some of their 128 rows
    assert!((behind(over(0.5, 1.0)) - 0.5).abs() < 0.02);
    assert_eq!(
        behind(together(
            square(),
            turned_over(crossed_square([0.0, 0.0, -0.5]))
        )),
        0.0
    );
    let half = behind(together(scaled(square(), 4.0, 0.0), icosphere(3)));
    // Of 64 + 4 pi: the ground within the sphere, and the upper half of the sphere, from which the ground is seen first; not from facets
    // that touch the ground, 3 % of that half
    let expected = 3.0 * PI / (64.0 + 4.0 * PI);
    assert!((half / expected - 1.0).abs() < 0.03, "{half} {expected}");
}
