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
        error.to_string().contains("are folded onto each other"),
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
