//! Triangle meshes as users trace them.

use std::fs;

use crate::support::{files, json, refused, succeed, unwrapped, with_surface, words};
use serde_json::Value;

/// A cube of side 2 on a square ground of side 6 with a gap beneath it, by polygons.
const TABLE: &str = "v -3 -3 0\nv 3 -3 0\nv 3 3 0\nv -3 3 0\nf 1 2 3 4\n\
    v -1 -1 0.5\nv 1 -1 0.5\nv 1 1 0.5\nv -1 1 0.5\nv -1 -1 2.5\nv 1 -1 2.5\nv 1 1 2.5\nv -1 1 2.5\n\
    f 8 7 6 5\nf 9 10 11 12\nf 5 6 10 9\nf 6 7 11 10\nf 7 8 12 11\nf 8 5 9 12\n";

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap()
}

#[test]
fn an_exported_tile_gives_the_energies_of_the_height_map() {
    let (_keep, folder) = with_surface();
    let flags = ["--theta", "40", "--rays", "4e4", "--json"];
    let trace = |file: &str, more: &[&str]| {
        let text = succeed(&folder, &[&["trace", file], more, &flags].concat());
        json(&text)
    };
    let expected = trace("h.exr", &[]);
    for file in ["m.ply", "m.obj", "m.stl"] {
        succeed(&folder, &["mesh", "h.exr", "-o", file]);
        let found = trace(file, &["--border", "periodic"]);
        let surface = &found["config"]["surface"];
        assert_eq!(surface["vertices"], 65 * 65);
        assert_eq!(surface["triangles"], 2 * 64 * 64);
        assert_eq!(surface["triangles_dropped"], 0);
        assert_eq!(number(&found["energy"]["lost"], "mean"), 0.0, "{file}");
        for part in ["reflected", "transmitted"] {
            let [a, b] = [&expected, &found].map(|summary| &summary["energy"][part]);
            let error = number(a, "se").hypot(number(b, "se"));
            let apart = (number(a, "mean") - number(b, "mean")).abs();
            assert!(apart <= 3.0 * error, "{file} {part}: {apart} {error}");
        }
    }
}

#[test]
fn a_cube_above_the_ground_is_traced() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("table.obj"), TABLE).unwrap();
    let trace = ["trace", "table.obj", "--theta", "30", "--rays", "1e4"];
    let tile = [&trace[..], &["--border", "mirrored", "-o", "out"]].concat();
    let text = succeed(folder, &tile);
    assert!(text.contains("lost         0 (< "), "{text}");
    assert!(text.contains("accelerator mesh"), "{text}");
    let written = files(&folder.join("out"));
    assert!(written.contains(&"lobes.svg".to_owned()), "{written:?}");
    assert!(!written.iter().any(|name| name.starts_with("height_map")));
    let summary = json(&fs::read_to_string(folder.join("out/summary.json")).unwrap());
    assert_eq!(summary["config"]["surface"]["vertices"], 12);
    assert_eq!(summary["config"]["surface"]["triangles"], 14);
    assert_eq!(
        summary["config"]["surface"]["extent"],
        serde_json::json!([6.0, 6.0, 2.5])
    );
    let reference = [
        &tile[..5],
        &["1e4", "--border", "mirrored", "--accelerator"],
    ]
    .concat();
    let energies = |kind: &str| {
        let arguments = [&reference[..], &[kind, "--json"]].concat();
        json(&succeed(folder, &arguments))["energy"].clone()
    };
    assert_eq!(energies("mesh"), energies("brute-force"));

    let (_, cube) = TABLE.split_once("f 1 2 3 4\n").unwrap();
    let corners = &TABLE[..TABLE.find("f 1").unwrap()];
    fs::write(folder.join("cube.obj"), [corners, cube].concat()).unwrap();
    let text = succeed(
        folder,
        &["trace", "cube.obj", "--theta", "0", "--rays", "1e3"],
    );
    assert!(text.contains("the mesh is closed"), "{text}");

    for border in ["periodic", "mirrored"] {
        let asked = [
            "trace", "cube.obj", "--theta", "0", "--border", border, "-o", "no",
        ];
        let error = refused(folder, &asked, 1);
        assert!(error.contains("cover the tile 0 times"), "{error}");
        assert!(error.contains("`--border open`"), "{error}");
    }
    assert!(!folder.join("no").exists());

    // An open patch unless requested otherwise; turned over and with a hole, it says so.
    let text = succeed(folder, &trace);
    assert!(text.contains("the patch is open"), "{text}");
    assert!(
        !text.contains("turned over") && !text.contains("triangle only"),
        "{text}"
    );
    let worse: String = TABLE
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some("9 10 11 12") => "f 9 12 12\n".to_owned(),
            Some(corners) => {
                let turned: Vec<&str> = corners.split(' ').rev().collect();
                format!("f {}\n", turned.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect();
    fs::write(folder.join("table.obj"), worse).unwrap();
    let text = succeed(folder, &trace);
    assert!(text.contains("turned over"), "{text}");
    assert!(text.contains("1 triangles without area"), "{text}");
    assert!(
        text.contains("4 edges inside the tile have one triangle only"),
        "{text}"
    );
}

#[test]
fn settings_that_meshes_do_not_have_are_refused_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("table.obj"), TABLE).unwrap();
    fs::write(folder.join("cut.ply"), "ply\nformat ascii 1.0\n").unwrap();
    let trace = |flags: &[&'static str]| [&["trace", "table.obj", "--theta", "30"], flags].concat();
    for (arguments, code, words) in [
        (
            trace(&["--spacing", "2"]),
            2,
            "--spacing is for height maps",
        ),
        (trace(&["--unit", "um"]), 2, "the file states no unit"),
        (trace(&["--flip"]), 2, "--flip is for height maps"),
        (
            trace(&["--missing", "fill"]),
            2,
            "--missing is for height maps",
        ),
        (
            trace(&["--remove", "plane"]),
            2,
            "--remove is for height maps",
        ),
        (
            trace(&["--accelerator", "pyramid"]),
            2,
            "pyramid needs a height field",
        ),
        (vec!["inspect", "table.obj"], 2, "a height map is needed"),
        (
            vec!["mesh", "table.obj", "-o", "x.ply"],
            2,
            "a height map is needed",
        ),
        (
            vec!["verify", "table.obj", "-o", "out"],
            2,
            "reads a configuration",
        ),
        (vec!["trace", "cut.ply", "--theta", "30"], 1, "end_header"),
        (
            vec!["trace", "none.stl", "--theta", "30"],
            1,
            "does not exist",
        ),
    ] {
        let error = refused(folder, &arguments, code);
        assert!(error.contains(words), "{error}");
    }
    fs::write(
        folder.join("table.obj"),
        TABLE.replace("v 3 3 0\n", "v 3 3 1\n"),
    )
    .unwrap();
    let error = refused(folder, &trace(&["--border", "periodic"]), 1);
    assert!(
        error.contains("table.obj: the border must be periodic along x"),
        "{error}"
    );
    fs::write(
        folder.join("table.obj"),
        TABLE.replace("f 9 10 11 12", "f 12 11 10 9"),
    )
    .unwrap();
    let error = refused(folder, &trace(&[]), 1);
    assert!(error.contains("face opposite sides"), "{error}");
    assert_eq!(files(folder), ["cut.ply", "table.obj"]);
}

#[test]
fn concave_faces_reflect_by_their_area() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let corners = ["0 0", "4 0", "4 4", "3 4", "3 1", "0 1"];
    let vertices: String = corners.map(|corner| format!("v {corner} 0\n")).concat();
    // An L of area 7 in a square of 16, from the corner that a fan is right around, and from another
    for (name, face) in [
        ("fan.obj", "f 5 6 1 2 3 4"),
        ("concave.obj", "f 1 2 3 4 5 6"),
    ] {
        fs::write(folder.join(name), format!("{vertices}{face}\n")).unwrap();
        let flags =
            "--border open --material mirror --theta 0 --estimator plain --rays 4000 --json";
        let summary = json(&succeed(
            folder,
            &[vec!["trace", name], words(flags)].concat(),
        ));
        let reflected = &summary["energy"]["reflected"];
        let apart = number(reflected, "mean") - 7.0 / 16.0;
        assert!(
            apart.abs() <= 4.0 * number(reflected, "se") + 1e-12,
            "{name}: {apart}"
        );
    }
    let fan = format!("{vertices}f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 6\n");
    fs::write(folder.join("folded.obj"), fan).unwrap();
    let error = refused(folder, &words("trace folded.obj --theta 30"), 1);
    assert!(error.contains("lie in each other at ["), "{error}");
}

/// Two squares, the second of triangles that share no edge with those of the first.
#[test]
fn sheets_over_one_another_are_refused_or_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let trace = |height: &str, faces: &str| {
        let corners = ["0 0", "4 0", "4 4", "0 4"].map(|corner| format!("v {corner} 0\n"));
        let others = ["1 0", "5 0", "5 4", "1 4", "3 2"].map(|at| format!("v {at} {height}\n"));
        let sheets = [
            &corners.concat(),
            "f 1 2 3\nf 1 3 4\n",
            &others.concat(),
            faces,
        ]
        .concat();
        fs::write(folder.join("sheets.obj"), sheets).unwrap();
        words("trace sheets.obj --theta 30 --rays 500")
    };
    let up = "f 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n";
    let down = "f 6 5 9\nf 7 6 9\nf 8 7 9\nf 5 8 9\n";
    // In single precision these lie in one plane
    for height in ["0", "1e-7"] {
        for faces in [up, down] {
            let error = refused(folder, &trace(height, faces), 1);
            assert!(error.contains("lie in each other at ["), "{error}");
        }
    }
    // Three quarters of each
    let told = unwrapped(&succeed(folder, &trace("1", up)));
    let (_, share) = told.split_once("note: ").unwrap();
    assert!(
        told.contains("% of the mesh face the back of other parts"),
        "{told}"
    );
    let share = share.split(" % of the mesh").next().unwrap();
    let share: f64 = share.rsplit(' ').next().unwrap().parse().unwrap();
    assert!((share - 75.0).abs() < 2.0, "{told}");
}

#[test]
fn meshes_that_stand_on_edge_are_told_and_laid_down() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let sheet = |place: fn(f64, f64, f64) -> [f64; 3]| {
        let heights = [0.1, 0.3, 0.2, 0.5, 0.0, 0.4, 0.3, 0.2, 0.1];
        let vertex = |k: usize| place((k % 3) as f64, (k / 3) as f64, heights[k]);
        let vertices = (0..9).map(|k| vertex(k).map(|x| x.to_string()).join(" "));
        let vertices: String = vertices.map(|vertex| format!("v {vertex}\n")).collect();
        let cells = [0, 1, 3, 4].map(|k| {
            [k + 1, k + 2, k + 5, k + 4]
                .map(|k| k.to_string())
                .join(" ")
        });
        vertices + &cells.map(|cell| format!("f {cell}\n")).concat()
    };
    fs::write(folder.join("z.obj"), sheet(|x, y, z| [x, y, z])).unwrap();
    fs::write(folder.join("y.obj"), sheet(|x, y, z| [x, z, -y])).unwrap();
    fs::write(folder.join("x.obj"), sheet(|x, y, z| [z, x, y])).unwrap();
    let trace = |name: &'static str, up: &'static str| {
        let flags = words("--theta 30 --eta 1.5 --rays 500");
        unwrapped(&succeed(
            folder,
            &[vec!["trace", name], up.split_whitespace().collect(), flags].concat(),
        ))
    };
    let flux = |text: &str| {
        let start = text.find("reflected").unwrap();
        text[start..].split("sum").next().unwrap().to_owned()
    };
    let lying = trace("z.obj", "");
    assert!(!lying.contains("stands on edge"), "{lying}");
    for (name, up) in [("y.obj", "--up y"), ("x.obj", "--up x")] {
        let standing = trace(name, "");
        assert!(
            standing.contains("stands on edge") && standing.contains(up),
            "{standing}"
        );
        let laid = trace(name, up);
        assert!(!laid.contains("stands on edge"), "{laid}");
        assert_eq!(flux(&laid), flux(&lying), "{name}");
    }
    let flat = "v 0 0 0\nv 1 0 0\nv 1 0 1\nf 1 2 3\n";
    fs::write(folder.join("flat.obj"), flat).unwrap();
    assert!(refused(folder, &words("trace flat.obj --theta 0"), 1).contains("`--up y`"));
    succeed(folder, &words("trace flat.obj --theta 0 --up y --rays 100"));
    fs::write(folder.join("map.txt"), "0 1\n1 0\n").unwrap();
    let error = refused(folder, &words("trace map.txt --theta 0 --up y"), 2);
    assert!(error.contains("--up is for triangle meshes"), "{error}");
}
