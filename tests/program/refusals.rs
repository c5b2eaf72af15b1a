//! Bad input: one sentence, the right exit code, and nothing left behind.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, errors_of, files, with_surface};

#[test]
fn surfaces_out_of_proportion_are_refused_or_pointed_out() {
    let folder = Folder::new();
    for (name, height) in [
        ("huge.txt", "1e40"),
        ("tall.txt", "1e6"),
        ("steep.txt", "100"),
    ] {
        folder.write(name, format!("0 {height} 0\n1 0 1\n0 0 {height}\n"));
    }
    folder.write("overflow.txt", "0 1e200\n0 0\n");
    for file in ["huge.txt", "tall.txt"] {
        let error = folder.failed(format!("trace {file} --rays 64"));
        error.must_contain("same unit");
    }
    folder.failed("inspect overflow.txt").must_contain("1e200");
    let text = folder.succeed("trace steep.txt --rays 64");
    text.must_contain("same unit");
    // 1600 times higher than the tile is long along y, and 500 times
    folder.write("strip.txt", "0 100 0\n1 0 1\n0 0 100\n");
    let strip = "trace strip.txt --spacing 1,0.03 --rays 64";
    folder
        .failed(strip)
        .must_contain("higher than its tile is long");
    folder.succeed("trace strip.txt --spacing 1,0.1 --rays 64");
    folder
        .failed("trace steep.txt --border periodic --theta 89.9999999")
        .must_contain("tiles");
}

#[test]
fn missing_points_are_refused_or_filled_by_choice() {
    let folder = Folder::new();
    folder.write("gap.txt", "0 1 2 3\n1 nan 3 4\n2 3 4 5\n");
    let error = folder.failed("inspect gap.txt");
    assert!(
        error.contains("gap.txt") && error.contains("1 of 12") && error.contains("--missing fill")
    );
    let text = folder.succeed("inspect gap.txt --missing fill");
    text.must_contain("1 missing point was filled");
}

#[test]
fn bad_numbers_get_a_sentence_and_code_2() {
    let folder = with_surface();
    let cases = "
        trace h.exr --eta 0 => --eta 0: must be a number from 0.01
        trace h.exr --eta -1.5 => --eta -1.5: must be
        trace h.exr --eta x => must be a number
        trace h.exr --kappa 1 => conductor
        trace h.exr --rays -5 => -5
        trace h.exr --rays 0 => 1 or more
        trace h.exr --bins 0x3 => bins
        trace h.exr --bins 99999x99999 => bins
        trace h.exr --accelerator magic => brute-force
        trace h.exr --threads 0 => threads
        trace h.exr --threads 100000 => 1024
        trace h.exr --rays 18446744073709551615 => 1e15
        trace h.exr --roulette 0 => roulette
        trace h.exr --spacing 0 => spacing
        generate --tau -16 --smoothness 2 -o x.npy => tau
        generate --tau 8 --sigma 1 --size -5 -o x.npy => -5
        generate --tau 8 --sigma 1 --seed 1 -o x.foo => .exr
        inspect h.exr -o x.bmp => .exr
        generate --tau 8 --sigma 1 --size 64 --seed 1 -o x.x3p => unit
        verify --models smith,smith -o out => twice
        verify --smoothness 3,3.0000001 -o out => same folder
        trace h.exr --roulette 2 => --roulette 2: must be a number above 0, up to 1, or auto, such as 2e-3 or 1/1.4
        trace h.exr --roulette often => or auto
        trace h.exr --branching both => --branching both: must be auto, split or pick
        trace h.exr --max-order 0 => order
        trace h.exr --max-order many => whole number from 1
        trace h.exr --max-order 1e10 => 4294967295
        verify --accelerator flat -o out => take auto
        trace h.exr --in-plane-half-width 0 => half-width 0: must be a number above 0, up to 90
        trace h.exr --side left => both, reflected or transmitted
        trace h.exr --side transmitted --material mirror => nothing is transmitted
        verify --material conductor --eta 0.2 --kappa 3 --side transmitted -o out => nothing is transmitted
        trace h.exr --border round => periodic
        trace h.exr --remove sphere => parabola
        trace h.exr --theta 90 => below 90
        trace h.exr --theta -1 => --theta -1: must be a number from 0 to below 90
        trace --theta 30 => FILE
        generate --tau 3 --smoothness 2 -o x.npy => or insist
        generate --tau 16 --smoothness 2 --size 64 -o x.npy => insist
        generate --tau 16 --smoothness 0 -o x.npy => --smoothness 0: must be a number from 1e-6
        generate --tau -4 --sigma 1 -o x.npy => tau
        generate --tau 8 --sigma 1 --spacing 0 -o x.npy => spacing
        generate --tau 8 --sigma 1 --spacing -1 -o x.npy => spacing
        generate --tau 8 --sigma 1 --size 1 -o x.npy => 2 x 2
        generate --tau 8 --sigma 1 --size 1,256 -o x.npy => 2 x 2
        generate --tau 8 --sigma 1 --size 1e9 -o x.npy => samples
        generate --tau 8 --sigma 1 --size 1,2,3 -o x.npy => COLUMNSxROWS
        verify --theta 95 -o out => below 90
        verify --tau 1 --spacing 1 -o out => or insist
        mesh h.exr -o m.xyz => .ply
        inspect h.exr --plot p.gif => .svg
        frobnicate => frobnicate
    ";
    folder.refuses(cases);
    assert_eq!(files(&folder), ["h.exr"], "nothing half-written stays");
}

#[test]
fn bad_files_get_a_sentence_and_code_1() {
    let folder = with_surface();
    let whole = fs::read(folder.join("h.exr")).unwrap();
    folder.write("short.exr", &whole[..whole.len() / 2]);
    folder.write("wrong.npy", &whole);
    folder.write("empty.gsf", "");
    folder.write("inf.txt", "0 1\n2 inf\n");
    folder.write("row.txt", "0 1 2 3\n");
    folder.write("one.txt", "5\n");
    folder.write("h.jpg", "x");
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
        let error = folder.failed(format!("trace {file} --theta 30 -o out"));
        error.must_contain(expected);
        assert_eq!(error.trim_end().lines().count(), 1, "{error}");
    }
    assert!(!folder.join("out").exists());
    for bad in ["[surface]\ntua = 3\n", "x = ", "[run]\nrays = -1\n"] {
        folder.write("bad.toml", bad);
        let error = folder.refused("verify bad.toml -o v");
        error.must_contain("bad.toml: line");
    }
    folder.failed("verify none.toml -o v");
    assert!(!folder.join("v").exists());
}

#[test]
fn late_refusals_leave_no_folder_and_take_none_away() {
    let folder = with_surface();
    fs::create_dir(folder.join("mine")).unwrap();
    for out in ["new", "new/deep", "mine"] {
        for command in ["verify --tau 8 --size 64 --smoothness 1", "trace h.exr"] {
            let error = folder.failed(format!("{command} --theta 89.9999999 -o {out}"));
            error.must_contain("tiles");
        }
    }
    assert_eq!(files(&folder), ["h.exr", "mine"]);
    assert_eq!(files(&folder.join("mine")).len(), 0);
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let folder = with_surface();
    folder.write("file", "x");
    for out in ["file", "file/below"] {
        let error = folder.failed(format!("trace h.exr --rays 1e12 -o {out}"));
        error.must_contain("file");
    }
    folder
        .failed("mesh h.exr -o file/m.ply")
        .must_contain("file");
    if Path::new("/dev/full").exists() {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let status = folder.command("inspect h.exr").stdout(full).status();
        assert_eq!(status.unwrap().code(), Some(1));
    }
}

#[test]
fn a_surface_is_named_once_and_an_input_is_no_output() {
    let folder = with_surface();
    let twice = folder.refused("trace h.exr --surface other.npy");
    twice.must_contain("h.exr");
    twice.must_contain("other.npy");
    let before = fs::read(folder.join("h.exr")).unwrap();
    let own = folder.refused("inspect h.exr --remove plane -o h.exr");
    own.must_contain("input");
    assert_eq!(fs::read(folder.join("h.exr")).unwrap(), before);
}

#[test]
fn outputs_keep_the_file_of_a_user_and_each_other() {
    let folder = with_surface();
    folder.write("own.toml", "mine");
    for name in ["own.toml", "h.exr", "new"] {
        let model = "model smith --smoothness 2 --eta 1.5 --theta 30 -o";
        let sentence = folder.refused(format!("{model} {name}"));
        sentence.must_contain("models are written as .csv");
    }
    let sentence = folder.refused("inspect h.exr -o p.png --plot ./p.png");
    sentence.must_contain("given as two outputs");
    assert_eq!(files(&folder), ["h.exr", "own.toml"]);
    assert_eq!(folder.text("own.toml"), "mine");
}

/// A stopped run says in its manifest that it is not complete, and its checkpoints are kept for the same command.
#[test]
fn a_manifest_says_whether_the_run_is_complete() {
    let folder = Folder::new();
    let run =
        "verify --tau 8 --size 64 --rays 2e5 --realisations 16 --models none --no-plots -q -o out";
    for (limit, is_complete) in [("--max-time 0.01", false), ("", true)] {
        let output = folder.run(format!("{run} {limit}"));
        assert!(output.status.success(), "{}", errors_of(&output));
        assert_eq!(folder.json("out/manifest.json")["complete"], is_complete);
    }
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
    let folder = with_surface();
    let long = "x".repeat(100_000);
    for (i, text) in [HIDDEN, long.as_str()].into_iter().enumerate() {
        let quoted = escapes(text);
        let brackets = "[".repeat(3 * i * 10_000);
        for (name, contents) in [
            ("key.toml", format!("[run]\n\"{quoted}\" = 3\n")),
            ("section.toml", format!("[\"{quoted}\"]\nrays = 3\n")),
            ("value.toml", format!("[run]\nrays = \"{quoted}\"\n")),
            ("file.toml", format!("[surface]\npsd = \"{quoted}.csv\"\n")),
            ("syntax.toml", format!("[run]\nrays = {text}\n")),
            ("line.toml", format!("a={brackets}{text}")),
            ("map.txt", format!("1 2\n3 4{text}\n")),
            ("table.csv", format!("k,{text}\n1,2\n")),
            ("mesh.obj", format!("v 0 0 {text}\n")),
            (
                "mesh.ply",
                format!("ply\nformat ascii 1.0\nelement {text} 3\n"),
            ),
        ] {
            folder.write(name, contents);
        }
        for line in [
            "verify key.toml -o out",
            "verify section.toml -o out",
            "verify value.toml -o out",
            "verify file.toml -o out",
            "verify syntax.toml -o out",
            "verify line.toml -o out",
            "inspect map.txt",
            "verify --psd table.csv --size 32 -o out",
            "trace mesh.obj --theta 0",
            "trace mesh.ply --theta 0",
            "inspect @.npy",
            "inspect @",
            "trace @.obj --theta 0",
            "trace h.exr --theta @",
            "trace h.exr --theta 0 --border @",
            "trace h.exr --@ 1",
            "trace h.exr --theta 0 --material @",
            "@",
            "inspect h.exr @",
            "model @",
            "materials @",
            "verify @.toml -o out",
            "verify @ -o out",
            "completions @",
            "inspect h.exr --quiet=@",
            "inspect h.exr -o",
        ] {
            let output = folder.run(line.replace('@', text));
            assert_ne!(output.status.code(), Some(0), "{line}");
            for text in [&output.stdout, &output.stderr] {
                assert_seen(&String::from_utf8_lossy(text), line);
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
    let folder = with_surface();
    let name = format!("a{HIDDEN}.exr");
    fs::rename(folder.join("h.exr"), folder.join(&name)).unwrap();
    let out = format!("out{HIDDEN}");
    let trace = format!("trace {name} --theta 30 --rays 300 --verbose -o {out}");
    let as_json = format!("{trace} --json");
    for line in [trace, format!("inspect {name}"), as_json] {
        let output = folder.run(line);
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
