//! Geometric attenuation by the command: files, configurations and refusals.

use std::fs;
use std::path::Path;

use asperity_results::Container;
use asperity_studies::SurveyedSurface;
use serde_json::Value;

use crate::attenuation::{SMALL, outcome, rows};
use crate::support::{Folder, InFolder, MustContain, files, json};

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    let command = "attenuation --tau 4 --spacing 1 --size 96 --sigma 1,2 --realisations 3 --theta 10,45,80 --view-theta 30,60 --view-phi 90 --heights --demarcation";
    let text = folder.succeed(format!("{command} --threads 1 -o one"));
    folder.succeed(format!("{command} --threads 2 --quiet -o two"));
    assert_eq!(
        files(&folder.join("one")),
        [
            "attenuation.csv",
            "attenuation_models.png",
            "attenuation_models.svg",
            "attenuation_sigma.png",
            "attenuation_sigma.svg",
            "attenuation_theta.png",
            "attenuation_theta.svg",
            "demarcation.csv",
            "manifest.json",
            "report.txt",
            "results.npz",
            "summary.json",
            "visibility.csv",
            "visibility.png",
            "visibility.svg",
        ]
    );
    for name in files(&folder.join("one")) {
        let [one, two] = ["one", "two"].map(|run| fs::read(folder.join(run).join(&name)).unwrap());
        if name == "summary.json" {
            let [mut one, mut two] =
                [one, two].map(|bytes| json(&String::from_utf8(bytes).unwrap()));
            for summary in [&mut one, &mut two] {
                for key in ["seconds", "threads"] {
                    summary["work"].as_object_mut().unwrap().remove(key);
                }
            }
            assert_eq!(one, two);
            assert_eq!(
                (&one["schema"], &one["command"]),
                (&Value::from(2), &"attenuation".into())
            );
            assert_eq!(one["config"]["run"]["seed"], 1);
        } else if name == "results.npz" {
            // Its machine.json tells seconds and threads.
            let [one, two] = ["one", "two"].map(|run| {
                let place = folder.join(run).join(&name);
                let found: Container<'_, SurveyedSurface> = Container::read(place).unwrap();
                found.comparable_bytes().unwrap()
            });
            assert!(one == two, "{name} differs");
        } else if name == "manifest.json" {
            // It has the fingerprint of summary.json, and so of the seconds there
            let [mut one, mut two] =
                [one, two].map(|bytes| json(&String::from_utf8(bytes).unwrap()));
            for manifest in [&mut one, &mut two] {
                manifest["files"]["summary.json"] = Value::Null;
                manifest["arguments"] = Value::Null;
            }
            assert_eq!(one, two);
        } else {
            assert!(one == two, "{name} differs");
        }
    }
    let report = folder.text("one/report.txt");
    assert_eq!(text, format!("{report}results in one\n"));
    let table = folder.text("one/attenuation.csv");
    let lines: Vec<usize> = table.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(lines, vec![41; 1 + 2 * 3 * 2]);
    // A run of less leaves nothing of an earlier one behind.
    assert_eq!(
        folder.succeed(format!("{SMALL} --theta 45 --no-plots --quiet -o one")),
        ""
    );
    assert_eq!(
        files(&folder.join("one")),
        [
            "attenuation.csv",
            "manifest.json",
            "report.txt",
            "results.npz",
            "summary.json"
        ]
    );
    // Another seed, other surfaces.
    let other = outcome(&format!("{SMALL} --theta 45 --seed 2"));
    assert_ne!(
        rows(&other)[0]["lit"],
        rows(&outcome(&format!("{SMALL} --theta 45")))[0]["lit"]
    );
}

#[test]
fn a_file_says_the_same_as_flags_and_flags_override_it() {
    let folder = Folder::new();
    let text = "
        [surface]
        sigma = 1.5
        tau = 4
        size = 32
        spacing = 1
        [light]
        theta = [20, 60]
        [view]
        theta = 30
        phi = 45
        [run]
        realisations = 2
        mirror = false
    ";
    folder.write("a.toml", text);
    let flags = "attenuation --sigma 1.5 --tau 4 --length 32 --spacing 1 --theta 20,60 --view-theta 30 --view-phi 45 --realisations 2 --no-mirror --json";
    let [from_file, from_flags] = ["attenuation a.toml --json", flags]
        .map(|line| json(&folder.succeed(line))["rows"].clone());
    assert_eq!(from_file, from_flags);
    let overridden = json(&folder.succeed("attenuation a.toml --theta 10 --json"));
    assert_eq!(rows(&overridden).len(), 1);
}

#[test]
fn contradicting_settings_are_refused_in_one_sentence() {
    let folder = Folder::new();
    folder.write("key.toml", "[light]\nthetas = 3\n");
    folder.write("both.toml", "[surface]\nsize = 64\nlength = 3.2\n");
    folder.write("figure.toml", "[output]\nmodels_at_sigma = 0.7\n");
    for (line, expected) in [
        (
            "--length 12.82",
            "must divide the extent 12.82 of the surfaces into whole samples",
        ),
        ("--length 0", "must be a number above 0"),
        ("--spacing 0", "must be a number above 0"),
        ("--spacing -0.05", "must be a number above 0"),
        ("--length 1", "correlation lengths"),
        ("--spacing 0.2", "correlation length"),
        ("--theta 90", "below 90"),
        ("--theta -1", "theta"),
        ("--theta 30,30", "given twice"),
        ("--view-theta 95", "below 90"),
        ("--sigma 0", "sigma"),
        ("--sigma -1", "sigma"),
        ("--tau 0", "tau"),
        ("--realisations 0", "1 or more"),
        ("--border mirrored", "periodic or open"),
        ("--border open --size 40,2 --insist", "3 or more a side"),
        ("--length 12.8 --size 256", "--size"),
        ("--sigma 1e-300", "sigma"),
        ("--realisations 1e15", "take fewer"),
        ("key.toml", "unknown key `thetas`"),
        ("both.toml", "excludes"),
        ("figure.toml", "0.7: must be among"),
        ("missing.toml", "missing.toml"),
    ] {
        let code = if line == "missing.toml" { 1 } else { 2 };
        let sentence = folder.stopped(format!("attenuation {line}"), code);
        sentence.must_contain(expected);
    }
    // Light that would cross too many tiles, and more points than memory holds.
    folder
        .failed("attenuation --theta 89.9999 --sigma 1 --realisations 1")
        .must_contain("tiles");
    folder
        .failed("attenuation --size 40000 --demarcation --theta 45")
        .must_contain("memory");
    assert!(files(&folder).iter().all(|name| name.ends_with(".toml")));
}

#[test]
fn the_examples_are_understood() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for (name, directions) in [("geometric_attenuation", 20), ("visibility", 4)] {
        let path = examples.join(name).with_extension("toml");
        let text = fs::read_to_string(path).unwrap();
        let config = asperity_studies::AttenuationConfig::from_toml(&text).unwrap();
        config.plan().unwrap();
        let thetas = serde_json::to_value(&config.light.theta).unwrap();
        assert_eq!(thetas.as_array().unwrap().len(), directions);
    }
}

#[test]
fn lengths_of_the_table_have_their_unit() {
    let folder = Folder::new();
    let run = |more: &str| {
        let line = format!(
            "attenuation --tau 0.5{more} --sigma 0.1{more} --spacing 0.05{more} --size 160 --theta 42 --realisations 2"
        );
        folder.succeed(&line)
    };
    assert!(run("um").contains("sigma (um)  theta"), "{}", run("um"));
    assert!(run("").contains("sigma  theta"));
}
