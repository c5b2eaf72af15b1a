//! Triangle meshes of smooth cells: how far they are from the surface, and that they say so.

use std::fs;
use std::path::Path;

use asperity_io::{read_height_map, read_mesh};
use asperity_surface::{Border, MissingPolicy, SplineSurface};

use crate::support::{InFolder, MustContain, with_surface};

/// The deviation that the output of `mesh` states, with the line that does.
fn stated(text: &str) -> (f64, &str) {
    let line = text.lines().nth(1).expect("a second line");
    let number = line.split("at most ").nth(1).expect("a bound");
    let number = number.split(' ').next().expect("a number");
    (number.parse().expect("a number"), line)
}

/// The spline through the heights of a file.
fn spline(path: &Path) -> SplineSurface {
    let raw = read_height_map(path).unwrap();
    let field = raw.into_height_field(MissingPolicy::Refuse, Border::Mirrored);
    SplineSurface::through(&field.unwrap())
}

/// Largest vertical distance from the surface of the middles of edges and of facets.
fn largest_distance(surface: &SplineSurface, path: &Path) -> f64 {
    let mesh = read_mesh(path).unwrap();
    let mut largest = 0.0_f64;
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|k| mesh.vertices[k as usize]);
        for places in [&[a][..], &[a, b], &[b, c], &[c, a], &[a, b, c]] {
            let mean = |i: usize| places.iter().map(|p| p[i]).sum::<f64>() / places.len() as f64;
            let distance = (mean(2) - surface.height(mean(0), mean(1))).abs();
            largest = largest.max(distance);
        }
    }
    largest
}

#[test]
fn triangles_of_smooth_cells_are_as_near_as_the_output_says() {
    let folder = with_surface();
    let surface = spline(&folder.join("h.exr"));
    let mut before = f64::INFINITY;
    for (flags, cells) in [
        ("--subdivide 1", 64),
        ("", 4 * 64),
        ("--subdivide 7", 7 * 64),
    ] {
        let line = format!("mesh h.exr --cells smooth -o m.obj {flags}");
        let text = folder.succeed(line.trim_end());
        let counts = format!(
            "{} vertices, {} triangles",
            (cells + 1_u32).pow(2),
            2 * cells * cells
        );
        text.must_contain(&counts);
        let (bound, _) = stated(&text);
        let found = largest_distance(&surface, &folder.join("m.obj"));
        assert!(
            found <= bound && found > 0.5 * bound,
            "{flags}: {found} {bound}"
        );
        assert!(bound < before);
        before = bound;
    }
}

#[test]
fn a_deviation_takes_as_many_parts_as_needed_and_stands_in_the_file() {
    let folder = with_surface();
    let smooth = "mesh h.exr --assume-unit um --cells smooth";
    for name in ["m.ply", "m.obj", "m.stl"] {
        let text = folder.succeed(format!("{smooth} --deviation 0.01 -o {name}"));
        let (bound, comment) = stated(&text);
        assert!(bound < 0.010_02 && comment.ends_with(" um off"), "{text}");
        let file = fs::read(folder.join(name)).unwrap();
        let head = String::from_utf8_lossy(&file[..200]);
        head.must_contain(comment);
        // One part less is farther off.
        let parts = comment.split(' ').nth(2).expect("parts");
        let fewer = parts.parse::<u32>().unwrap() - 1;
        let text = folder.succeed(format!("{smooth} --subdivide {fewer} -o {name}"));
        let (bound, _) = stated(&text);
        assert!(bound > 0.01, "{fewer}");
    }
}

#[test]
fn flat_cells_are_written_as_two_triangles_and_without_a_comment() {
    let folder = with_surface();
    for name in ["m.ply", "m.obj", "m.stl"] {
        let written = |flags: &str| {
            let text = folder.succeed(format!("mesh h.exr -o {name}{flags}"));
            assert_eq!(text.lines().count(), 1, "{text}");
            fs::read(folder.join(name)).unwrap()
        };
        let plain = written("");
        assert!(plain == written(" --cells flat") && plain == written(" --cells auto"));
        let head = String::from_utf8_lossy(&plain[..100]);
        assert!(!head.contains("spline"), "{head}");
    }
}

#[test]
fn wrong_fineness_is_refused() {
    let folder = with_surface();
    let files = crate::support::files(&folder);
    for (flags, expected) in [
        ("--subdivide 2", "--subdivide 2 needs --cells smooth"),
        ("--deviation 2 --cells flat", "goes with cells smooth"),
        ("--cells smooth --subdivide 0", "whole number of 1 or more"),
        ("--cells smooth --deviation 0", "a number above 0"),
        (
            "--cells smooth --deviation 1e-300",
            "to which heights of this surface are rounded",
        ),
        ("--cells smooth --deviation 1 --subdivide 2", "--deviation"),
    ] {
        let said = folder.refused(format!("mesh h.exr -o m.ply {flags}"));
        said.must_contain(expected);
    }
    let said = folder.failed("mesh h.exr -o m.ply --cells smooth --subdivide 1e9");
    said.must_contain("this mesh");
    assert_eq!(crate::support::files(&folder), files);
}
