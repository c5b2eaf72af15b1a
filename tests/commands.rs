//! The program as its users meet it: files in, files and sentences out.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and speak as tests do"
)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

fn asperity(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_asperity"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs a command that must succeed, and returns its standard output.
fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = asperity(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {errors}");
    assert!(errors.is_empty(), "{arguments:?} on a pipe: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command that must be refused with `code` and one sentence, and returns that.
fn refused(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = asperity(folder, arguments);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {errors}");
    assert!(!errors.contains("panicked"), "{arguments:?}: {errors}");
    assert!(errors.starts_with("asperity: "), "{errors}");
    assert_eq!(
        errors.trim_end().lines().count(),
        1,
        "one sentence: {errors}"
    );
    errors
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// A folder with one small generated surface.
fn with_surface() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "generate",
        "--tau",
        "8",
        "--smoothness",
        "2",
        "--size",
        "64",
        "--seed",
        "7",
    ];
    succeed(folder.path(), &[&arguments[..], &["-o", "h.exr"]].concat());
    let path = folder.path().to_owned();
    (folder, path)
}

#[test]
fn generate_then_inspect_shows_requested_beside_realised() {
    let (_keep, folder) = with_surface();
    let text = succeed(&folder, &["inspect", "h.exr"]);
    for word in [
        "Sq",
        "Sdq",
        "Ssk",
        "Sku",
        "exp(-r^2 / tau^2)",
        "requested",
        "realised",
    ] {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
    let report = json(&succeed(&folder, &["inspect", "h.exr", "--json"]));
    assert_eq!(report["realised"]["sigma"]["requested"], 4.0);
    let realised = report["realised"]["sigma"]["realised"].as_f64().unwrap();
    let scatter = report["realised"]["sigma"]["expected_deviation"]
        .as_f64()
        .unwrap();
    assert!(
        (realised - 4.0).abs() < 4.0 * scatter,
        "{realised} +- {scatter}"
    );
}

#[test]
fn every_format_that_is_written_and_read_holds_the_same_surface() {
    let (_keep, folder) = with_surface();
    for name in ["a.npy", "a.gsf", "a.exr"] {
        succeed(&folder, &["inspect", "h.exr", "-o", name]);
        let sq = |file: &str| {
            let text = succeed(
                &folder,
                &["inspect", file, "--border", "periodic", "--json"],
            );
            json(&text)["sq"].as_f64().unwrap()
        };
        assert!((sq(name) / sq("h.exr") - 1.0).abs() < 1e-6, "{name}");
    }
    let metres = [
        "--tau",
        "8e-6",
        "--smoothness",
        "2",
        "--size",
        "64",
        "--spacing",
        "1e-6",
    ];
    let rest = ["--unit", "m", "--seed", "7", "-o", "m.x3p"];
    succeed(&folder, &[&["generate"], &metres[..], &rest[..]].concat());
    let report = json(&succeed(&folder, &["inspect", "m.x3p", "--json"]));
    assert_eq!(report["unit"], "m");
}

#[test]
fn same_seed_same_bytes_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let surface = [
        "--tau",
        "8",
        "--smoothness",
        "2",
        "--size",
        "128,96",
        "--seed",
        "3",
    ];
    for threads in ["1", "2", "3"] {
        let name = format!("h{threads}.npy");
        let rest = ["-o", &name, "--threads", threads];
        succeed(folder, &[&["generate"], &surface[..], &rest[..]].concat());
        let out = format!("t{threads}");
        let rest = [
            "--theta",
            "40",
            "--rays",
            "3e4",
            "-o",
            &out,
            "--threads",
            threads,
        ];
        succeed(folder, &[&["trace", &name], &rest[..]].concat());
        let out = format!("v{threads}");
        let rays = [
            "--size",
            "128",
            "--tau",
            "8",
            "--realisations",
            "7",
            "--rays",
            "2e4",
        ];
        let rest = ["-o", &out, "--threads", threads];
        succeed(folder, &[&["verify"], &rays[..], &rest[..]].concat());
    }
    let same = |name: &str| {
        let read = |threads: &str| fs::read(folder.join(name.replace('#', threads))).unwrap();
        assert!(
            read("1") == read("2") && read("1") == read("3"),
            "{name} differs"
        );
    };
    same("h#.npy");
    for result in [
        "histogram.csv",
        "theta.csv",
        "in_plane.csv",
        "lobes.svg",
        "lobes.png",
    ] {
        same(&format!("t#/{result}"));
        same(&format!("v#/{result}"));
    }
    same("v#/comparison.csv");
    same("v#/report.txt");
}

#[test]
fn trace_writes_what_it_says() {
    let (_keep, folder) = with_surface();
    let arguments = [
        "trace", "h.exr", "--eta", "1.5", "--theta", "30", "--rays", "2e4", "-o", "out",
    ];
    let text = succeed(&folder, &arguments);
    assert!(
        text.contains("reflected") && text.contains("ray blocks"),
        "{text}"
    );
    let out = folder.join("out");
    for name in [
        "summary.json",
        "histogram.csv",
        "in_plane.csv",
        "theta.csv",
        "height_map.svg",
    ] {
        assert!(out.join(name).exists(), "{name}");
    }
    for name in [
        "lobes",
        "in_plane_reflected",
        "in_plane_transmitted",
        "height_map",
    ] {
        let png = fs::read(out.join(format!("{name}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG"));
        assert!(
            fs::read_to_string(out.join(format!("{name}.svg")))
                .unwrap()
                .contains("<svg")
        );
    }
    let summary = json(&fs::read_to_string(out.join("summary.json")).unwrap());
    assert_eq!(summary["schema"], 1);
    assert_eq!(summary["command"], "trace");
    let energy = |name: &str| summary["energy"][name]["mean"].as_f64().unwrap();
    let names = ["reflected", "transmitted", "absorbed", "truncated", "lost"];
    assert!((names.map(energy).iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert_eq!(energy("lost"), 0.0);
    for key in [
        "realisations",
        "rays",
        "segments",
        "segments_skipped",
        "accelerator",
        "estimator",
        "generate_seconds",
        "build_seconds",
        "trace_seconds",
        "seconds",
        "threads",
    ] {
        assert!(!summary["work"][key].is_null(), "{key}");
    }
    assert_eq!(summary["orders"]["reflected"][0]["order"], 1);
    assert_eq!(summary["paths"][0]["events"], "T");

    // The histogram holds the energies, 18 x 36 bins a side.
    let table = fs::read_to_string(out.join("histogram.csv")).unwrap();
    let header = "side,theta_min_deg,theta_max_deg,phi_min_deg,phi_max_deg,solid_angle_sr,flux,flux_se,intensity,bsdf,bsdf_se";
    assert!(table.starts_with(header));
    let mut sums = [0.0, 0.0];
    let mut rays = 0;
    for line in table.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields[i].parse::<f64>().unwrap();
        let transmitted = fields[0] == "transmitted";
        rays += fields[11].parse::<u64>().unwrap();
        sums[usize::from(transmitted)] += number(6);
        assert_eq!(transmitted, number(1) >= 90.0);
        let cos = 0.5 * (number(1).to_radians().cos() + number(2).to_radians().cos());
        assert!((number(9) * cos.abs() - number(8)).abs() < 1e-9 * number(8).max(1e-3));
        assert!((number(8) * number(5) - number(6)).abs() < 1e-12);
    }
    assert_eq!(table.lines().count(), 1 + 2 * 18 * 36);
    // Every incident ray leaves at least once, and splits into few.
    let traced = summary["work"]["rays"].as_u64().unwrap();
    assert!(rays >= traced && rays < 5 * traced, "{rays} of {traced}");
    assert!((sums[0] - energy("reflected")).abs() < 1e-12);
    assert!((sums[1] - energy("transmitted")).abs() < 1e-12);
}

#[test]
fn flat_surface_reflects_by_fresnel() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "trace", "--flat", "--eta", "1.5", "--theta", "0", "--rays", "100", "--json",
    ];
    let summary = json(&succeed(folder.path(), &arguments));
    let reflected = summary["energy"]["reflected"]["mean"].as_f64().unwrap();
    assert!((reflected - 0.04).abs() < 1e-15);
    let straight = [
        "trace", "--flat", "--eta", "1", "--theta", "60", "--rays", "100", "--json",
    ];
    let summary = json(&succeed(folder.path(), &straight));
    assert_eq!(summary["energy"]["transmitted"]["mean"], 1.0);
}

#[test]
fn mirror_conductor_and_light_from_below_are_traced() {
    let (_keep, folder) = with_surface();
    let energy = |flags: &[&str]| {
        let fixed = ["trace", "h.exr", "--theta", "50", "--rays", "5e3", "--json"];
        let summary = json(&succeed(&folder, &[&fixed[..], flags].concat()));
        ["reflected", "transmitted", "absorbed"]
            .map(|name| summary["energy"][name]["mean"].as_f64().unwrap())
    };
    let [r, t, a] = energy(&["--material", "mirror"]);
    assert!((r - 1.0).abs() < 1e-12 && t == 0.0 && a == 0.0);
    let [r, t, a] = energy(&[
        "--material",
        "conductor",
        "--eta",
        "0.21",
        "--kappa",
        "3.272",
    ]);
    assert!(r > 0.8 && t == 0.0 && a > 0.01);
    let [r, t, _] = energy(&["--eta", "1/1.5", "--from", "below"]);
    assert!(r > 0.3 && t > 0.2, "{r} {t}");
    let [picked, ..] = energy(&["--eta", "1/1.5", "--from", "below", "--branching", "pick"]);
    assert!((picked - r).abs() < 0.05);
}

#[test]
fn mesh_writes_each_format() {
    let (_keep, folder) = with_surface();
    for (name, start) in [("m.ply", "ply\n"), ("m.obj", ""), ("m.stl", "")] {
        let text = succeed(&folder, &["mesh", "h.exr", "-o", name]);
        assert!(text.contains("4225 vertices, 8192 triangles"), "{text}");
        assert!(
            fs::read(folder.join(name))
                .unwrap()
                .starts_with(start.as_bytes())
        );
    }
}

#[test]
fn model_prints_its_bsdf_in_the_plane_of_incidence_and_over_the_sphere() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let fixed = [
        "model",
        "smith",
        "--smoothness",
        "3",
        "--eta",
        "1.4",
        "--theta",
        "30",
    ];
    let text = succeed(folder, &[&fixed[..], &["--step", "10"]].concat());
    assert!(text.starts_with("side,theta_deg,phi_deg,bsdf\n"));
    // 17 directions a side, from -80 to 80 deg.
    assert_eq!(text.lines().count(), 1 + 34);
    succeed(
        folder,
        &[&fixed[..], &["--step", "10", "--sphere", "-o", "m.csv"]].concat(),
    );
    let table = fs::read_to_string(folder.join("m.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 2 * 9 * 36);
    assert!(
        refused(
            folder,
            &["model", "ggx", "--smoothness", "3", "--theta", "0"],
            2
        )
        .contains("xu-sun")
    );
    assert!(refused(folder, &[&fixed[..], &["--step", "0"]].concat(), 2).contains("--step"));
    assert!(refused(folder, &[&fixed[..5], &["1", "--theta", "3"]].concat(), 2).contains("delta"));
}

#[test]
fn verify_judges_every_case_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let config = "
        [surface]
        smoothness = [1, 3]
        tau = 8
        size = 128
        [material]
        eta = [1.4, \"1/1.4\"]
        [run]
        realisations = 12
        rays = 3e4
    ";
    fs::write(folder.join("v.toml"), config).unwrap();
    let text = succeed(
        folder,
        &["verify", "v.toml", "--models", "xu-sun,smith", "-o", "out"],
    );
    assert!(
        text.contains("Single scattering, tested at level"),
        "{text}"
    );
    let out = folder.join("out");
    let cases = [
        "s1_n0.714286_theta30",
        "s1_n1.4_theta30",
        "s3_n0.714286_theta30",
        "s3_n1.4_theta30",
    ];
    for case in cases {
        for name in [
            "summary.json",
            "comparison.csv",
            "in_plane.csv",
            "report.txt",
            "lobes.png",
        ] {
            assert!(out.join(case).join(name).exists(), "{case}/{name}");
        }
    }
    let summary = json(&fs::read_to_string(out.join("summary.json")).unwrap());
    assert_eq!(summary["cases"].as_array().unwrap().len(), 4);
    // A rough surface transmits far more than Xu and Sun's visibility lets through.
    let rough = &summary["cases"][0]["summary"]["comparison"]["models"][0];
    assert_eq!(rough["model"], "xu-sun");
    assert_eq!(rough["verdict"], "fails");
    assert!(rough["single"]["p"].as_f64().unwrap() < 0.01);
}

#[test]
fn verdicts_rest_on_single_scattering_and_the_table_of_bins() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let surface = [
        "--smoothness",
        "1",
        "--tau",
        "8",
        "--size",
        "128",
        "--eta",
        "1/1.4",
    ];
    let run = [
        "--realisations",
        "8",
        "--rays",
        "2e4",
        "--models",
        "smith",
        "--no-plots",
    ];
    let above = [&["verify", "-o", "above", "--json"], &surface[..], &run[..]].concat();
    let summary = json(&succeed(folder, &above));
    let file = json(&fs::read_to_string(folder.join("above/summary.json")).unwrap());
    assert_eq!(summary["comparison"], file["comparison"]);
    let model = &summary["comparison"]["models"][0];
    let distance = |of: &str| model[of]["total_variation"].as_f64().unwrap();
    // Half of this light is scattered more than once: far from all light, near to the single part.
    assert!(distance("total") > 3.0 * distance("single"));
    let table = fs::read_to_string(folder.join("above/comparison.csv")).unwrap();
    let recomputed: f64 = table
        .lines()
        .skip(1)
        .map(|line| {
            let field = |i: usize| line.split(',').nth(i).unwrap().parse::<f64>().unwrap();
            0.5 * (field(5) - field(7)).abs()
        })
        .sum();
    assert!((recomputed - distance("single")).abs() < 1e-12);

    // From below, statistics are the same but the rays are others.
    let below = [
        &["verify", "-o", "below", "--json", "--from", "below"],
        &surface[..],
        &run[..],
    ];
    let below = json(&succeed(folder, &below.concat()));
    let reflected = |summary: &Value| {
        ["mean", "se"].map(|key| summary["energy"]["reflected"][key].as_f64().unwrap())
    };
    let ([a, se_a], [b, se_b]) = (reflected(&summary), reflected(&below));
    assert_ne!(a, b);
    assert!((a - b).abs() < 4.0 * se_a.hypot(se_b), "{a} {b}");
}

#[test]
fn a_new_run_leaves_nothing_of_an_old_one_in_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let fixed = [
        "verify",
        "--tau",
        "8",
        "--size",
        "64",
        "--realisations",
        "6",
        "--rays",
        "6e3",
    ];
    succeed(folder, &[&fixed[..], &["-o", "out"]].concat());
    fs::write(folder.join("out/notes.txt"), "mine").unwrap();
    succeed(
        folder,
        &[
            "trace",
            "--flat",
            "--theta",
            "9",
            "--rays",
            "64",
            "--no-plots",
            "-o",
            "out",
        ],
    );
    let expected = [
        "histogram.csv",
        "in_plane.csv",
        "notes.txt",
        "summary.json",
        "theta.csv",
    ];
    assert_eq!(files(&folder.join("out")), expected);
}

#[test]
fn spacing_and_unit_come_from_the_file_or_from_flags() {
    let (_keep, folder) = with_surface();
    let half = [
        "--tau",
        "4",
        "--smoothness",
        "2",
        "--size",
        "64",
        "--spacing",
        "0.5",
        "--unit",
        "um",
    ];
    let text = succeed(
        &folder,
        &[&["generate", "--seed", "1", "-o", "a.npy"], &half[..]].concat(),
    );
    assert!(text.contains("--spacing 0.5,0.5 --unit um"), "{text}");
    succeed(
        &folder,
        &[&["generate", "--seed", "1", "-o", "a.exr"], &half[..]].concat(),
    );
    let sdq = |arguments: &[&str]| {
        let text = succeed(&folder, &[&["inspect", "--json"], arguments].concat());
        json(&text)["sdq"].as_f64().unwrap()
    };
    let told = sdq(&["a.npy", "--spacing", "0.5", "--unit", "um"]);
    assert!((told / sdq(&["a.exr"]) - 1.0).abs() < 1e-6);
    assert!(succeed(&folder, &["inspect", "a.npy"]).contains("1 was assumed"));
    assert!(!succeed(&folder, &["inspect", "a.exr"]).contains("assumed"));
}

#[test]
fn surfaces_out_of_proportion_are_refused_or_pointed_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, height) in [
        ("huge.txt", "1e40"),
        ("tall.txt", "1e6"),
        ("steep.txt", "100"),
    ] {
        fs::write(
            folder.join(name),
            format!("0 {height} 0\n1 0 1\n0 0 {height}\n"),
        )
        .unwrap();
    }
    fs::write(folder.join("overflow.txt"), "0 1e200\n0 0\n").unwrap();
    let trace = |file: &'static str| ["trace", file, "--theta", "30", "--rays", "64"];
    for file in ["huge.txt", "tall.txt"] {
        assert!(refused(folder, &trace(file), 1).contains("same unit"));
    }
    assert!(refused(folder, &["inspect", "overflow.txt"], 1).contains("1e200"));
    assert!(succeed(folder, &trace("steep.txt")).contains("same unit"));
    let flat_light = [
        "trace",
        "steep.txt",
        "--border",
        "periodic",
        "--theta",
        "89.9999999",
    ];
    assert!(refused(folder, &flat_light, 1).contains("tiles"));
}

#[test]
fn verify_with_one_surface_takes_its_errors_from_ray_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let fixed = [
        "verify",
        "--tau",
        "8",
        "--size",
        "64",
        "--realisations",
        "1",
        "--rays",
        "1e4",
    ];
    let text = succeed(
        folder.path(),
        &[&fixed[..], &["--no-plots", "-o", "out"]].concat(),
    );
    assert!(
        text.contains("ray blocks") && text.contains("not resolved"),
        "{text}"
    );
}

#[test]
fn measured_files_go_through_every_command() {
    let measured = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/measured");
    if !measured.exists() {
        println!("skipped: {} is not there", measured.display());
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, sq, border) in [
        ("profilometer-650x650.x3p", 77e-9, "mirrored"),
        ("interferometer-650x650.asc", 0.24e-6, "open"),
    ] {
        let file = measured.join(name).to_str().unwrap().to_owned();
        let reading = ["--remove", "parabola", "--border", border];
        let inspect = [
            &["inspect", &file, "--json", "--plot", "h.png"],
            &reading[..],
        ]
        .concat();
        let report = json(&succeed(folder, &inspect));
        let found = report["sq"].as_f64().unwrap();
        assert!((found / sq - 1.0).abs() < 0.02, "{name}: Sq {found}");
        let mesh = [&["mesh", &file, "-o", "m.stl"], &reading[..]].concat();
        assert!(succeed(folder, &mesh).contains("842402 triangles"));
        let trace = [
            "trace", &file, "--theta", "60", "--rays", "2e4", "-o", "out", "--json",
        ];
        let summary = json(&succeed(folder, &[&trace[..], &reading[..]].concat()));
        assert_eq!(summary["energy"]["lost"]["mean"], 0.0);
        assert!(folder.join("out/height_map.png").exists());
    }
}

#[test]
fn tall_surface_and_grazing_light_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let surface = [
        "--tau",
        "8",
        "--smoothness",
        "0.25",
        "--size",
        "96",
        "--seed",
        "1",
    ];
    succeed(
        folder,
        &[&["generate"], &surface[..], &["-o", "tall.npy"]].concat(),
    );
    let trace = [
        "trace", "tall.npy", "--theta", "89.9", "--rays", "2e4", "--json",
    ];
    let summary = json(&succeed(folder, &trace));
    assert_eq!(summary["energy"]["lost"]["mean"], 0.0);
    assert!(
        summary["energy"]["truncated"]["mean"]
            .as_f64()
            .unwrap()
            .abs()
            < 1e-3
    );
}

#[test]
fn missing_points_are_refused_or_filled_by_choice() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("gap.txt"), "0 1 2 3\n1 nan 3 4\n2 3 4 5\n").unwrap();
    let error = refused(folder, &["inspect", "gap.txt"], 1);
    assert!(
        error.contains("gap.txt") && error.contains("1 of 12") && error.contains("--missing fill")
    );
    let text = succeed(folder, &["inspect", "gap.txt", "--missing", "fill"]);
    assert!(text.contains("1 missing points were filled"), "{text}");
}

#[test]
fn bad_numbers_get_a_sentence_and_code_2() {
    let (_keep, folder) = with_surface();
    let trace = |flags: &[&'static str]| [&["trace", "h.exr", "--theta", "30"], flags].concat();
    let generate = |flags: &[&'static str]| {
        let fixed: &[&'static str] = &["generate", "--seed", "1", "-o", "x.npy"];
        [fixed, flags].concat()
    };
    for (arguments, expected) in [
        (trace(&["--eta", "0"]), "eta is 0"),
        (trace(&["--eta", "-1.5"]), "eta is -1.5"),
        (trace(&["--eta", "x"]), "no number"),
        (trace(&["--kappa", "1"]), "conductor"),
        (trace(&["--rays", "-5"]), "-5"),
        (trace(&["--rays", "0"]), "1 or more"),
        (trace(&["--bins", "0x3"]), "bins"),
        (trace(&["--bins", "99999x99999"]), "bins"),
        (trace(&["--accelerator", "magic"]), "brute-force"),
        (trace(&["--threads", "0"]), "threads"),
        (trace(&["--threads", "100000"]), "1024"),
        (trace(&["--rays", "18446744073709551615"]), "1e15"),
        (trace(&["--roulette", "0"]), "roulette"),
        (trace(&["--spacing", "0"]), "spacing"),
        (generate(&["--tau", "-16", "--smoothness", "2"]), "tau"),
        (
            generate(&["--tau", "8", "--sigma", "1", "--size", "-5"]),
            "-5",
        ),
        (
            vec![
                "generate", "--tau", "8", "--sigma", "1", "--seed", "1", "-o", "x.foo",
            ],
            ".exr",
        ),
        (vec!["inspect", "h.exr", "-o", "x.bmp"], ".exr"),
        (
            vec![
                "generate", "--tau", "8", "--sigma", "1", "--size", "64", "--seed", "1", "-o",
                "x.x3p",
            ],
            "unit",
        ),
        (
            vec!["verify", "--models", "smith,smith", "-o", "out"],
            "twice",
        ),
        (
            vec!["verify", "--smoothness", "3,3", "-o", "out"],
            "same folder",
        ),
        (trace(&["--roulette", "2"]), "roulette"),
        (trace(&["--max-order", "0"]), "order"),
        (trace(&["--in-plane-half-width", "0"]), "half width"),
        (trace(&["--border", "round"]), "periodic"),
        (trace(&["--remove", "sphere"]), "parabola"),
        (vec!["trace", "h.exr", "--theta", "90"], "below 90"),
        (vec!["trace", "h.exr", "--theta", "-1"], "theta is -1"),
        (vec!["trace", "--theta", "30"], "FILE"),
        (generate(&["--tau", "3", "--smoothness", "2"]), "or insist"),
        (
            generate(&["--tau", "16", "--smoothness", "2", "--size", "64"]),
            "insist",
        ),
        (
            generate(&["--tau", "16", "--smoothness", "0"]),
            "smoothness is 0",
        ),
        (generate(&["--tau", "-4", "--sigma", "1"]), "tau"),
        (
            generate(&["--tau", "8", "--sigma", "1", "--spacing", "0"]),
            "spacing",
        ),
        (
            generate(&["--tau", "8", "--sigma", "1", "--spacing", "-1"]),
            "spacing",
        ),
        (
            generate(&["--tau", "8", "--sigma", "1", "--size", "1"]),
            "2 x 2",
        ),
        (
            generate(&["--tau", "8", "--sigma", "1", "--size", "1,256"]),
            "2 x 2",
        ),
        (
            generate(&["--tau", "8", "--sigma", "1", "--size", "1e9"]),
            "samples",
        ),
        (
            generate(&["--tau", "8", "--sigma", "1", "--size", "1,2,3"]),
            "X,Y",
        ),
        (vec!["verify", "--theta", "95", "-o", "out"], "below 90"),
        (vec!["verify", "--tau", "1", "-o", "out"], "or insist"),
        (vec!["mesh", "h.exr", "-o", "m.xyz"], ".ply"),
        (vec!["inspect", "h.exr", "--plot", "p.gif"], ".svg"),
        (vec!["frobnicate"], "frobnicate"),
    ] {
        let error = refused(&folder, &arguments, 2);
        assert!(error.contains(expected), "{arguments:?}: {error}");
    }
    assert_eq!(files(&folder), ["h.exr"], "nothing half-written stays");
}

#[test]
fn bad_files_get_a_sentence_and_code_1() {
    let (_keep, folder) = with_surface();
    let whole = fs::read(folder.join("h.exr")).unwrap();
    fs::write(folder.join("short.exr"), &whole[..whole.len() / 2]).unwrap();
    fs::write(folder.join("wrong.npy"), &whole).unwrap();
    fs::write(folder.join("empty.gsf"), "").unwrap();
    fs::write(folder.join("inf.txt"), "0 1\n2 inf\n").unwrap();
    fs::write(folder.join("row.txt"), "0 1 2 3\n").unwrap();
    fs::write(folder.join("one.txt"), "5\n").unwrap();
    fs::write(folder.join("h.jpg"), "x").unwrap();
    fs::create_dir(folder.join("folder.exr")).unwrap();
    for (file, expected) in [
        ("none.exr", "none.exr"),
        ("short.exr", "short.exr"),
        ("wrong.npy", "wrong.npy"),
        ("empty.gsf", "empty"),
        ("inf.txt", "inf"),
        ("row.txt", "2 x 2"),
        ("one.txt", "2 x 2"),
        ("h.jpg", ".npy"),
        ("folder.exr", "folder"),
    ] {
        let error = refused(&folder, &["trace", file, "--theta", "30", "-o", "out"], 1);
        assert!(error.contains(expected), "{file}: {error}");
        assert_eq!(error.trim_end().lines().count(), 1, "{error}");
    }
    assert!(!folder.join("out").exists());
    for bad in ["[surface]\ntua = 3\n", "x = ", "[run]\nrays = -1\n"] {
        fs::write(folder.join("bad.toml"), bad).unwrap();
        let error = refused(&folder, &["verify", "bad.toml", "-o", "v"], 2);
        assert!(error.contains("bad.toml: line"), "{error}");
    }
    refused(&folder, &["verify", "none.toml", "-o", "v"], 1);
    assert!(!folder.join("v").exists());
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let (_keep, folder) = with_surface();
    fs::write(folder.join("file"), "x").unwrap();
    let trace = |out: &'static str| {
        [
            "trace", "h.exr", "--theta", "30", "--rays", "1e12", "-o", out,
        ]
    };
    for out in ["file", "file/below"] {
        assert!(refused(&folder, &trace(out), 1).contains("file"));
    }
    assert!(refused(&folder, &["mesh", "h.exr", "-o", "no/m.ply"], 1).contains("no"));
    if Path::new("/dev/full").exists() {
        let model = [
            "model",
            "smith",
            "--smoothness",
            "3",
            "--theta",
            "30",
            "-o",
            "/dev/full",
        ];
        refused(&folder, &model, 1);
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let status = Command::new(env!("CARGO_BIN_EXE_asperity"))
            .current_dir(&folder)
            .args(["inspect", "h.exr"])
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(status.status.code(), Some(1));
    }
}

#[test]
fn quiet_says_nothing_and_help_names_every_command() {
    let (_keep, folder) = with_surface();
    let quiet = ["mesh", "h.exr", "-o", "m.ply", "--quiet"];
    assert!(succeed(&folder, &quiet).is_empty());
    let help = succeed(&folder, &["--help"]);
    for command in ["generate", "inspect", "mesh", "trace", "verify", "model"] {
        assert!(help.contains(command));
    }
    let verbose = asperity(
        &folder,
        &["trace", "h.exr", "--theta", "3", "--rays", "1e3", "-v"],
    );
    assert!(String::from_utf8_lossy(&verbose.stderr).contains("traced in"));
}

#[test]
fn every_example_configuration_is_understood() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut seen = 0;
    for entry in fs::read_dir(examples).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            let text = fs::read_to_string(&path).unwrap();
            let config = asperity_experiment::VerifyConfig::from_toml(&text).unwrap();
            config.run.ray_settings().unwrap();
            config.check_surfaces().unwrap();
            seen += 1;
        }
    }
    assert!(seen >= 5, "{seen}");
}
