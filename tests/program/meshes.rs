//! Triangle meshes as users trace them.

use crate::support::{Folder, InFolder, MustContain, files, json, unwrapped, with_surface};
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
    let folder = with_surface();
    let flags = "--theta 40 --rays 4e4 --json";
    let trace = |file: &str, more: &str| {
        let text = folder.succeed(format!("trace {file} {more} {flags}"));
        json(&text)
    };
    let expected = trace("h.exr", "");
    for file in ["m.ply", "m.obj", "m.stl"] {
        folder.succeed(format!("mesh h.exr -o {file}"));
        let found = trace(file, "--border periodic");
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
    let folder = Folder::new();
    folder.write("table.obj", TABLE);
    let trace = "trace table.obj --theta 30 --rays 1e4";
    let tile = format!("{trace} --border mirrored -o out");
    let text = folder.succeed(&tile);
    text.must_contain("lost         0 (< ");
    let written = files(&folder.join("out"));
    assert!(written.contains(&"lobes.svg".to_owned()), "{written:?}");
    assert!(!written.iter().any(|name| name.starts_with("height_map")));
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["work"]["accelerator"], "mesh");
    assert_eq!(summary["config"]["surface"]["vertices"], 12);
    assert_eq!(summary["config"]["surface"]["triangles"], 14);
    assert_eq!(
        summary["config"]["surface"]["extent"],
        serde_json::json!([6.0, 6.0, 2.5])
    );
    let energies = |kind: &str| {
        let line = format!("{trace} --border mirrored --accelerator {kind} --json");
        json(&folder.succeed(line))["energy"].clone()
    };
    assert_eq!(energies("mesh"), energies("brute-force"));

    let (_, cube) = TABLE.split_once("f 1 2 3 4\n").unwrap();
    let corners = &TABLE[..TABLE.find("f 1").unwrap()];
    folder.write("cube.obj", [corners, cube].concat());
    let text = folder.succeed("trace cube.obj --theta 0 --rays 1e3");
    text.must_contain("the mesh is closed");

    for border in ["periodic", "mirrored"] {
        let error = folder.failed(format!("trace cube.obj --theta 0 --border {border} -o no"));
        error.must_contain("cover the tile 0 times");
        error.must_contain("`--border open`");
    }
    assert!(!folder.join("no").exists());

    // An open patch unless requested otherwise; turned over and with a hole, it says so.
    let text = folder.succeed(trace);
    text.must_contain("the patch is open");
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
    folder.write("table.obj", worse);
    let text = folder.succeed(trace);
    text.must_contain("turned over");
    text.must_contain("1 triangles without area");
    text.must_contain("4 edges inside the tile have one triangle only");
}

#[test]
fn settings_that_meshes_do_not_have_are_refused_in_one_sentence() {
    let folder = Folder::new();
    folder.write("table.obj", TABLE);
    folder.write("cut.ply", "ply\nformat ascii 1.0\n");
    let cases = "
        trace table.obj --spacing 2 => --spacing is for height maps
        trace table.obj --unit um => the file states no unit
        trace table.obj --flip => --flip is for height maps
        trace table.obj --missing fill => --missing is for height maps
        trace table.obj --remove plane => --remove is for height maps
        trace table.obj --accelerator pyramid => pyramid needs a height field
        inspect table.obj => a height map is needed
        mesh table.obj -o x.ply => a height map is needed
        verify table.obj -o out => reads a configuration
    ";
    folder.refuses(cases);
    folder
        .failed("trace cut.ply --theta 30")
        .must_contain("end_header");
    folder
        .failed("trace none.stl --theta 30")
        .must_contain("does not exist");
    folder.write("table.obj", TABLE.replace("v 3 3 0\n", "v 3 3 1\n"));
    let error = folder.failed("trace table.obj --border periodic");
    error.must_contain("table.obj: the border must be periodic along x");
    folder.write("table.obj", TABLE.replace("f 9 10 11 12", "f 12 11 10 9"));
    let error = folder.failed("trace table.obj");
    error.must_contain("face opposite sides");
    assert_eq!(files(&folder), ["cut.ply", "table.obj"]);
}

#[test]
fn concave_faces_reflect_by_their_area() {
    let folder = Folder::new();
    let corners = ["0 0", "4 0", "4 4", "3 4", "3 1", "0 1"];
    let vertices: String = corners.map(|corner| format!("v {corner} 0\n")).concat();
    // An L of area 7 in a square of 16, from the corner that a fan is right around, and from another
    for (name, face) in [
        ("fan.obj", "f 5 6 1 2 3 4"),
        ("concave.obj", "f 1 2 3 4 5 6"),
    ] {
        folder.write(name, format!("{vertices}{face}\n"));
        let flags =
            "--border open --material mirror --theta 0 --estimator plain --rays 4000 --json";
        let summary = json(&folder.succeed(format!("trace {name} {flags}")));
        let reflected = &summary["energy"]["reflected"];
        let apart = number(reflected, "mean") - 7.0 / 16.0;
        assert!(
            apart.abs() <= 4.0 * number(reflected, "se") + 1e-12,
            "{name}: {apart}"
        );
    }
    let fan = format!("{vertices}f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 6\n");
    folder.write("folded.obj", fan);
    let error = folder.failed("trace folded.obj --theta 30");
    error.must_contain("lie in each other at [");
}

/// Two squares, the second of triangles that share no edge with those of the first.
#[test]
fn sheets_over_one_another_are_refused_or_told() {
    let folder = Folder::new();
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
        folder.write("sheets.obj", sheets);
        "trace sheets.obj --theta 30 --rays 500"
    };
    let up = "f 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n";
    let down = "f 6 5 9\nf 7 6 9\nf 8 7 9\nf 5 8 9\n";
    // In single precision these lie in one plane
    for height in ["0", "1e-7"] {
        for faces in [up, down] {
            let error = folder.failed(trace(height, faces));
            error.must_contain("lie in each other at [");
        }
    }
    // Three quarters of each
    let told = unwrapped(&folder.succeed(trace("1", up)));
    let (_, share) = told.split_once("note: ").unwrap();
    told.must_contain("% of the mesh face the back of other parts");
    let share = share.split(" % of the mesh").next().unwrap();
    let share: f64 = share.rsplit(' ').next().unwrap().parse().unwrap();
    assert!((share - 75.0).abs() < 2.0, "{told}");
}

#[test]
fn meshes_that_stand_on_edge_are_told_and_laid_down() {
    let folder = Folder::new();
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
    folder.write("z.obj", sheet(|x, y, z| [x, y, z]));
    folder.write("y.obj", sheet(|x, y, z| [x, z, -y]));
    folder.write("x.obj", sheet(|x, y, z| [z, x, y]));
    let trace = |name: &str, up: &str| {
        unwrapped(&folder.succeed(format!("trace {name} {up} --theta 30 --eta 1.5 --rays 500")))
    };
    let flux = |text: &str| {
        let start = text.find("flux fractions").unwrap();
        text[start..].split("sum").next().unwrap().to_owned()
    };
    let lying = trace("z.obj", "");
    assert!(!lying.contains("stands on edge"), "{lying}");
    for (name, up) in [("y.obj", "--up y"), ("x.obj", "--up x")] {
        let standing = trace(name, "");
        standing.must_contain("stands on edge");
        standing.must_contain(up);
        let laid = trace(name, up);
        assert!(!laid.contains("stands on edge"), "{laid}");
        assert_eq!(flux(&laid), flux(&lying), "{name}");
    }
    let flat = "v 0 0 0\nv 1 0 0\nv 1 0 1\nf 1 2 3\n";
    folder.write("flat.obj", flat);
    folder
        .failed("trace flat.obj --theta 0")
        .must_contain("`--up y`");
    folder.succeed("trace flat.obj --theta 0 --up y --rays 100");
    folder.write("map.txt", "0 1\n1 0\n");
    let error = folder.refused("trace map.txt --theta 0 --up y");
    error.must_contain("--up is for triangle meshes");
}
