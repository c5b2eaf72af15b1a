//! Bad input: one sentence, the right exit code, and nothing left behind.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{asperity, errors_of, files, refused, succeed, with_surface, words};

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
    // 1600 times higher than the tile is long along y, and 500 times
    fs::write(folder.join("strip.txt"), "0 100 0\n1 0 1\n0 0 100\n").unwrap();
    let strip = words("trace strip.txt --spacing 1,0.03 --rays 64");
    assert!(refused(folder, &strip, 1).contains("higher than its tile is long"));
    succeed(folder, &words("trace strip.txt --spacing 1,0.1 --rays 64"));
    let flat_light = words("trace steep.txt --border periodic --theta 89.9999999");
    assert!(refused(folder, &flat_light, 1).contains("tiles"));
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
    assert!(text.contains("1 missing point was filled"), "{text}");
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
        (
            trace(&["--eta", "0"]),
            "--eta 0: must be a number from 0.01",
        ),
        (trace(&["--eta", "-1.5"]), "--eta -1.5: must be"),
        (trace(&["--eta", "x"]), "must be a number"),
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
            vec!["verify", "--smoothness", "3,3.0000001", "-o", "out"],
            "same folder",
        ),
        (
            trace(&["--roulette", "2"]),
            "--roulette 2: must be a number above 0, up to 1, or auto, such as 2e-3 or 1/1.4",
        ),
        (trace(&["--roulette", "often"]), "or auto"),
        (
            trace(&["--branching", "both"]),
            "--branching both: must be auto, split or pick",
        ),
        (trace(&["--max-order", "0"]), "order"),
        (trace(&["--max-order", "many"]), "whole number from 1"),
        (trace(&["--max-order", "1e10"]), "4294967295"),
        (
            vec!["verify", "--accelerator", "flat", "-o", "out"],
            "take auto",
        ),
        (
            trace(&["--in-plane-half-width", "0"]),
            "half-width 0: must be a number above 0, up to 90",
        ),
        (trace(&["--side", "left"]), "both, reflected or transmitted"),
        (
            trace(&["--side", "transmitted", "--material", "mirror"]),
            "nothing is transmitted",
        ),
        (
            vec![
                "verify",
                "--material",
                "conductor",
                "--eta",
                "0.2",
                "--kappa",
                "3",
                "--side",
                "transmitted",
                "-o",
                "out",
            ],
            "nothing is transmitted",
        ),
        (trace(&["--border", "round"]), "periodic"),
        (trace(&["--remove", "sphere"]), "parabola"),
        (vec!["trace", "h.exr", "--theta", "90"], "below 90"),
        (
            vec!["trace", "h.exr", "--theta", "-1"],
            "--theta -1: must be a number from 0 to below 90",
        ),
        (vec!["trace", "--theta", "30"], "FILE"),
        (generate(&["--tau", "3", "--smoothness", "2"]), "or insist"),
        (
            generate(&["--tau", "16", "--smoothness", "2", "--size", "64"]),
            "insist",
        ),
        (
            generate(&["--tau", "16", "--smoothness", "0"]),
            "--smoothness 0: must be a number from 1e-6",
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
            "COLUMNSxROWS",
        ),
        (vec!["verify", "--theta", "95", "-o", "out"], "below 90"),
        (
            vec!["verify", "--tau", "1", "--spacing", "1", "-o", "out"],
            "or insist",
        ),
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
        (
            "h.jpg",
            ".spm, .di, .000 and .gwy as height maps, and from .ply, .obj and .stl as meshes",
        ),
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
fn late_refusals_leave_no_folder_and_take_none_away() {
    let (_keep, folder) = with_surface();
    fs::create_dir(folder.join("mine")).unwrap();
    let flat_light = ["--theta", "89.9999999", "--smoothness", "1", "-o"];
    for out in ["new", "new/deep", "mine"] {
        let verify = [&["verify", "--tau", "8", "--size", "64"], &flat_light[..]].concat();
        let trace = ["trace", "h.exr", "--theta", "89.9999999", "-o"];
        for arguments in [&verify[..], &trace] {
            let error = refused(&folder, &[arguments, &[out]].concat(), 1);
            assert!(error.contains("tiles"), "{error}");
        }
    }
    assert_eq!(files(&folder), ["h.exr", "mine"]);
    assert_eq!(files(&folder.join("mine")).len(), 0);
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
    assert!(refused(&folder, &["mesh", "h.exr", "-o", "file/m.ply"], 1).contains("file"));
    if Path::new("/dev/full").exists() {
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
fn a_surface_is_named_once_and_an_input_is_no_output() {
    let (_keep, folder) = with_surface();
    let twice = refused(&folder, &words("trace h.exr --surface other.npy"), 2);
    assert!(
        twice.contains("h.exr") && twice.contains("other.npy"),
        "{twice}"
    );
    let before = fs::read(folder.join("h.exr")).unwrap();
    let own = refused(&folder, &words("inspect h.exr --remove plane -o h.exr"), 2);
    assert!(own.contains("input"), "{own}");
    assert_eq!(fs::read(folder.join("h.exr")).unwrap(), before);
}

/// A stopped run says in its manifest that it is not complete, and its checkpoints are kept for the same command.
#[test]
fn outputs_keep_the_file_of_a_user_and_each_other() {
    let (_keep, folder) = with_surface();
    fs::write(folder.join("own.toml"), "mine").unwrap();
    for name in ["own.toml", "h.exr", "new"] {
        let model = words("model smith --smoothness 2 --eta 1.5 --theta 30 -o");
        let sentence = refused(&folder, &[&model[..], &[name]].concat(), 2);
        assert!(
            sentence.contains("models are written as .csv"),
            "{sentence}"
        );
    }
    let inspect = words("inspect h.exr -o p.png --plot ./p.png");
    let sentence = refused(&folder, &inspect, 2);
    assert!(sentence.contains("given as two outputs"), "{sentence}");
    assert_eq!(files(&folder), ["h.exr", "own.toml"]);
    assert_eq!(fs::read_to_string(folder.join("own.toml")).unwrap(), "mine");
}

#[test]
fn a_manifest_says_whether_the_run_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let run =
        "verify --tau 8 --size 64 --rays 2e5 --realisations 16 --models none --no-plots -q -o out";
    let complete = |folder: &Path| {
        crate::support::json(&fs::read_to_string(folder.join("out/manifest.json")).unwrap())["complete"].clone()
    };
    succeed_with_notes(folder.path(), &format!("{run} --max-time 0.01"));
    assert_eq!(complete(folder.path()), false);
    succeed_with_notes(folder.path(), run);
    assert_eq!(complete(folder.path()), true);
}

/// Runs a command that must succeed, whatever it says on standard error.
fn succeed_with_notes(folder: &Path, line: &str) {
    let output = crate::support::asperity(folder, &words(line));
    assert!(output.status.success(), "{}", errors_of(&output));
}

/// Texts that command a terminal or hide others.
const HIDDEN: &str = "\u{1b}[31m\u{9b}2J\u{202e}\u{200b}";

/// The characters of [`HIDDEN`] that are not seen.
const MARKS: [char; 4] = ['\u{1b}', '\u{9b}', '\u{202e}', '\u{200b}'];

fn assert_seen(text: &str, of: &str) {
    assert!(!text.contains(MARKS), "{of}: {text:?}");
    assert!(text.len() < 6000, "{of}: {} bytes", text.len());
}

#[test]
fn foreign_text_in_messages_is_seen_and_short() {
    let (_keep, folder) = with_surface();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    let long = "x".repeat(100_000);
    for (i, text) in [HIDDEN, long.as_str()].into_iter().enumerate() {
        write(
            &format!("key{i}.toml"),
            &format!("[run]\n\"{}\" = 3\n", escapes(text)),
        );
        write(
            &format!("section{i}.toml"),
            &format!("[\"{}\"]\nrays = 3\n", escapes(text)),
        );
        write(
            &format!("value{i}.toml"),
            &format!("[run]\nrays = \"{}\"\n", escapes(text)),
        );
        write(
            &format!("file{i}.toml"),
            &format!("[surface]\npsd = \"{}.csv\"\n", escapes(text)),
        );
        write(
            &format!("syntax{i}.toml"),
            &format!("[run]\nrays = {text}\n"),
        );
        write(
            &format!("line{i}.toml"),
            &format!("a={}{text}", "[".repeat(3 * i * 10_000)),
        );
        write(&format!("map{i}.txt"), &format!("1 2\n3 4{text}\n"));
        write(&format!("table{i}.csv"), &format!("k,{text}\n1,2\n"));
        write(&format!("mesh{i}.obj"), &format!("v 0 0 {text}\n"));
        write(
            &format!("mesh{i}.ply"),
            &format!("ply\nformat ascii 1.0\nelement {text} 3\n"),
        );
        let toml = |name: &str| format!("verify {name}{i}.toml -o out");
        let mut commands: Vec<Vec<String>> = [
            toml("key"),
            toml("section"),
            toml("value"),
            toml("file"),
            toml("syntax"),
            toml("line"),
            format!("inspect map{i}.txt"),
            format!("verify --psd table{i}.csv --size 32 -o out"),
            format!("trace mesh{i}.obj --theta 0"),
            format!("trace mesh{i}.ply --theta 0"),
        ]
        .iter()
        .map(|line| line.split(' ').map(str::to_owned).collect())
        .collect();
        for line in [
            &["inspect", "@.npy"][..],
            &["inspect", "@"],
            &["trace", "@.obj", "--theta", "0"],
            &["trace", "h.exr", "--theta", "@"],
            &["trace", "h.exr", "--theta", "0", "--border", "@"],
            &["trace", "h.exr", "--@", "1"],
            &["trace", "h.exr", "--theta", "0", "--material", "@"],
            &["@"],
            &["inspect", "h.exr", "@"],
            &["model", "@"],
            &["verify", "@.toml", "-o", "out"],
            &["verify", "@", "-o", "out"],
            &["completions", "@"],
            &["inspect", "h.exr", "--quiet=@"],
            &["inspect", "h.exr", "-o"],
        ] {
            commands.push(line.iter().map(|word| word.replace('@', text)).collect());
        }
        for command in commands {
            let arguments: Vec<&str> = command.iter().map(String::as_str).collect();
            let output = asperity(&folder, &arguments);
            assert_ne!(output.status.code(), Some(0));
            let of = command[..2.min(command.len())].join(" ");
            for text in [&output.stdout, &output.stderr] {
                assert_seen(&String::from_utf8_lossy(text), &of[..of.len().min(80)]);
            }
        }
    }
}

/// A text as TOML writes it in quotes.
fn escapes(text: &str) -> String {
    let escape = |c: char| match c.is_ascii_graphic() {
        true => c.to_string(),
        false => format!("\\u{:04x}", u32::from(c)),
    };
    text.chars().map(escape).collect()
}

#[test]
fn foreign_text_in_results_is_seen() {
    let (_keep, folder) = with_surface();
    let name = format!("a{HIDDEN}.exr");
    fs::rename(folder.join("h.exr"), folder.join(&name)).unwrap();
    let out = format!("out{HIDDEN}");
    let trace = [
        "trace",
        &name,
        "--theta",
        "30",
        "--rays",
        "300",
        "--verbose",
        "-o",
        &out,
    ];
    let as_json = [&trace[..], &["--json"]].concat();
    for arguments in [&trace[..], &["inspect", &name], &as_json] {
        let output = asperity(&folder, arguments);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let text =
            String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
        assert!(!text.contains(MARKS) && text.contains("\\u"), "{text:?}");
    }
    let mut named = 0;
    for file in files(&folder.join(&out)) {
        let is_text = [".txt", ".csv", ".svg", ".json"]
            .iter()
            .any(|ending| file.ends_with(ending));
        if is_text {
            let text = fs::read_to_string(folder.join(&out).join(&file)).unwrap();
            assert!(!text.contains(MARKS), "{file}");
            named += usize::from(text.contains("[31m"));
        }
    }
    // The summary and the figure of the heights
    assert!(named >= 2, "{named}");
}
