//! Run time against error: the files, the numbers in them that never change, and refusals.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, files, json};

const CONFIG: &str = "
    [surface]
    tau = 4
    size = 32
    [converge]
    samplings = [\"random\", \"stratified\"]
    accelerators = [\"mesh\", \"pyramid\"]
    rays = 256
    surfaces = [2, 8]
    repeats = 3
    reference_rays = 1024
    reference_surfaces = 128
    bins = \"6x12\"
    seed = 5
";

/// The first line of a convergence.csv.
const HEADER: &str = "estimator,sampling,branching,peer_rate,accelerator,spacing,rays_per_surface,surfaces,repeats,\
    seconds,seconds_min,seconds_max,error,error_se,reference_error,error_exact,energy_error,usable";

/// Rows of a convergence.csv, each by the names of its columns.
fn rows(path: &Path) -> Vec<BTreeMap<&'static str, String>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next().unwrap(), HEADER);
    let row = |line: &str| {
        let fields = line.split(',').map(str::to_owned);
        HEADER.split(',').zip(fields).collect()
    };
    lines.map(row).collect()
}

/// A row without its seconds and its accelerator.
fn lasting(row: &BTreeMap<&'static str, String>) -> BTreeMap<&'static str, String> {
    let mut row = row.clone();
    row.retain(|name, _| !name.starts_with("seconds") && *name != "accelerator");
    row
}

#[test]
fn converge_writes_its_files_and_the_same_errors_on_any_number_of_threads() {
    let folder = Folder::new();
    folder.write("c.toml", CONFIG);
    let text = folder.succeed("converge c.toml --threads 1 -o one");
    let report = folder.text("one/report.txt");
    assert_eq!(text, format!("{report}\nresults in one\n"));
    assert!(report.contains("controlled, stratified, pyramid") && report.contains("s to 1e-3"));
    assert_eq!(
        files(&folder.join("one")),
        [
            "convergence.csv",
            "convergence.png",
            "convergence.svg",
            "manifest.json",
            "report.txt",
            "results.npz",
            "summary.json"
        ]
    );
    let plot = folder.text("one/convergence.svg");
    assert!(plot.contains("Run time against error: s = 3, n = 1.5, θᵢ = 30°"));
    assert!(plot.contains("on 1 thread, seed ") && report.contains("on 1 thread;"));

    let quiet = "converge c.toml --threads 3 --quiet --no-plots -o three";
    assert_eq!(folder.succeed(quiet), "");
    assert!(!folder.join("three/convergence.svg").exists());
    let [one, three] = ["one", "three"].map(|run| rows(&folder.join(run).join("convergence.csv")));
    assert_eq!(one.len(), 2 * 2 * 2 * 2);
    for (a, b) in one.iter().zip(&three) {
        assert_eq!(lasting(a), lasting(b));
        assert_eq!(a["accelerator"], b["accelerator"]);
    }
    // The accelerator changes no result: rows of the mesh come before those of the pyramid.
    let (mesh, pyramid) = one.split_at(8);
    for (a, b) in mesh.iter().zip(pyramid) {
        assert_eq!(lasting(a), lasting(b));
        assert_eq!([&a["accelerator"], &b["accelerator"]], ["mesh", "pyramid"]);
    }
    for row in &one {
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        assert!(number("seconds_min") > 0.0 && number("seconds_min") <= number("seconds"));
        assert!(number("seconds") <= number("seconds_max"));
        assert!(number("error") > 0.0 && number("error_se") > 0.0);
        let above = number("error") >= 2.0 * number("reference_error");
        assert_eq!(number("usable"), f64::from(u8::from(above)));
        assert!(row["error_exact"].is_empty());
        assert!(number("energy_error").abs() < 0.1);
    }
    // Another seed, other errors.
    let other = "converge c.toml --seed 6 --quiet --no-plots -o other";
    folder.succeed(other);
    let other = rows(&folder.join("other/convergence.csv"));
    assert!((0..16).all(|i| other[i]["error"] != one[i]["error"]));
    // Errors to be reached are computed from the runs that are there.
    let results = |run: &str| fs::read(folder.join(run).join("results.npz")).unwrap();
    let before = results("one");
    folder.succeed("converge c.toml --errors 1e-1 --quiet -o one");
    assert!(results("one") == before);
}

#[test]
fn the_summary_holds_slopes_seconds_and_gains() {
    let folder = Folder::new();
    folder.write("c.toml", CONFIG);
    let line = "converge c.toml --accelerators auto --estimators plain --errors 1e-1,1e-2 --no-plots --json -o out";
    let summary = json(&folder.succeed(line));
    let file = folder.json("out/summary.json");
    assert_eq!(summary, file);
    assert_eq!(
        (&summary["schema"], &summary["command"]),
        (&2.into(), &"converge".into())
    );
    assert_eq!(summary["seed"], 5);
    assert_eq!(summary["config"]["converge"]["surface"]["size"], 32);
    assert_eq!(summary["reference"]["surfaces"], 128);
    assert_eq!(summary["work"]["runs"], 1 + 2 * 2 * 3);
    let methods = summary["methods"].as_array().unwrap();
    assert_eq!(methods.len(), 2);
    assert_eq!(methods[0]["name"], "plain, random");
    assert_eq!(methods[0]["efficiency"]["ratio"], 1.0);
    for method in methods {
        // Two points have one line through both. Where the machine took longer for the easier one, it
        // rises and leads to no error; all else follows from the points.
        let points = method["measurements"].as_array().unwrap();
        let [(t, e), (t_more, e_less)] = [&points[0], &points[1]].map(|point| {
            let error = &point["error"]["rms"];
            (point["seconds"].as_f64().unwrap(), error.as_f64().unwrap())
        });
        let slope = (e_less / e).ln() / (t_more / t).ln();
        let found = method["slope"].as_f64().unwrap();
        assert!((found / slope - 1.0).abs() < 1e-9, "{found} {slope}");
        let to = method["seconds_to"].as_array().unwrap();
        assert_eq!((to.len(), &to[1]["error"]), (2, &0.01.into()));
        for to in to {
            let ln_seconds = t.ln() + (to["error"].as_f64().unwrap() / e).ln() / slope;
            match to["seconds"].as_f64() {
                Some(seconds) => {
                    assert!((seconds.ln() - ln_seconds).abs() < 1e-6 * ln_seconds.abs().max(1.0))
                }
                None => assert!(slope > 0.0 || ln_seconds.abs() > 700.0),
            }
        }
        assert!(slope > 0.0 || to[1]["extrapolated"] == true);
    }
    let first = &methods[0];
    let gain = &first["seconds_to"][1]["plain_random_over_this"];
    assert!(*gain == 1.0 || first["slope"].as_f64().unwrap() > 0.0);
}

#[test]
fn several_cases_and_spacings_have_their_places() {
    let folder = Folder::new();
    let line = "converge --smoothness 3,60 --material mirror --tau 4 --size 32 --spacings 1,0.5 \
                --estimators plain --samplings random --rays 64 --surfaces 2 --repeats 2 \
                --reference-rays 64 --reference-surfaces 16 --bins 6x12 --side reflected -o out";
    let text = folder.succeed(line);
    text.must_contain("spacing 0.5");
    text.must_contain("of 64 x 64");
    let out = folder.join("out");
    assert_eq!(
        files(&out),
        [
            "manifest.json",
            "report.txt",
            "results.npz",
            "s3_mirror_theta30",
            "s60_mirror_theta30",
            "summary.json"
        ]
    );
    let summary = out.json("summary.json");
    assert_eq!(summary["cases"].as_array().unwrap().len(), 2);
    for (case, exact) in [("s3_mirror_theta30", false), ("s60_mirror_theta30", true)] {
        assert!(out.join(case).join("convergence.png").exists());
        let rows = rows(&out.join(case).join("convergence.csv"));
        let spacings: Vec<&str> = rows.iter().map(|row| row["spacing"].as_str()).collect();
        assert_eq!(spacings, ["1", "0.5"]);
        for row in rows {
            assert_eq!(row["error_exact"].is_empty(), !exact, "{case}");
            // A mirror returns all light.
            assert!(row["energy_error"].parse::<f64>().unwrap() < 1e-3);
        }
    }
    // The folder of a case belongs to the run that made it.
    folder.failed("trace --flat --theta 9 --rays 64 --no-plots -o out/s3_mirror_theta30");
    assert!(out.join("s3_mirror_theta30/convergence.csv").exists());
}

#[test]
fn bad_convergence_runs_are_refused_in_a_sentence_and_leave_nothing() {
    let folder = Folder::new();
    for (line, code, expected) in [
        ("--estimators best", 2, "plain or controlled"),
        ("--samplings random,random", 2, "given twice"),
        ("--accelerators flat", 2, "take auto"),
        ("--spacings 3", 2, "divide the extent"),
        ("--spacings 8", 2, "--insist"),
        ("--rays 0", 2, "1 or more"),
        ("--rays 10,100 --surfaces 1,2,3", 2, "value by value"),
        ("--reference-surfaces 1", 2, "2 or more"),
        ("--errors 0", 2, "above 0"),
        ("--theta 90", 2, "below 90"),
        (
            "--material mirror --side transmitted",
            2,
            "nothing is transmitted",
        ),
        ("--surfaces 1e8", 1, "GiB"),
        ("nowhere.toml", 1, "nowhere.toml"),
    ] {
        let line = format!("converge {line} -o out");
        folder.stopped(&line, code).must_contain(expected);
    }
    folder.write("c.toml", "[converge]\nestimator = \"plain\"\n");
    let error = folder.refused("converge c.toml -o out");
    error.must_contain("c.toml");
    error.must_contain("line 2");
    folder.write("m.ply", "ply\n");
    let error = folder.refused("converge m.ply -o out");
    error.must_contain("asperity converge");
    assert_eq!(files(&folder), ["c.toml", "m.ply"]);
}

#[test]
fn the_example_is_understood() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/converge.toml");
    let text = fs::read_to_string(path).unwrap();
    let config = asperity_studies::ConvergeConfig::from_toml(&text).unwrap();
    config.plan().unwrap();
}

/// No control variate is known for these slopes or facets, so that the reference is plain as well.
#[test]
fn surfaces_without_a_control_variate_converge_with_plain_rays() {
    let folder = Folder::new();
    let effort = "--rays 64,256 --surfaces 2 --repeats 2 --reference-rays 1024 --reference-surfaces 2 --no-plots";
    for (i, surface) in [
        "--structure pits --depth 4 --width 16",
        "--slopes ggx --ggx-alpha 0.2 --tau 4 --size 256 --insist",
        "--material lambertian --reflectance 0.5",
    ]
    .into_iter()
    .enumerate()
    {
        let line = format!("converge {surface} --estimators plain {effort} --json -o out{i}");
        let summary = json(&folder.succeed(&line));
        assert_eq!(summary["methods"][0]["estimator"], "plain");
    }
    for flags in [
        "--structure pits --depth 4 --width 16",
        "--material lambertian --reflectance 0.5",
    ] {
        let said = folder.refused(format!("converge {flags} {effort} -o other"));
        said.must_contain("give --estimators plain");
    }
}
