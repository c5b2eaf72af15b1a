//! Runs that are interrupted: what they write, the exit code, and what they leave behind.

#![cfg(unix)]

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

use asperity_results::ResultSet;

use crate::support::{Folder, InFolder, MustContain, Table, files, json, with_surface};

/// Runs that take long, without their output; with what they say of the same command run again.
const LONG: [(&str, &str); 7] = [
    ("trace h.exr --theta 30 --rays 1e10 --no-plots", "resumes"),
    (
        "verify --tau 8 --size 128 --smoothness 2 --models none --rays 1e9 --realisations 10000 --no-plots",
        "resumes",
    ),
    (
        "map --tau 4 --size 32 --theta 0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19 --smoothness 1,2,3,4,5,6,7,8,9,10 --models smith --rays 2e4 --realisations 20 --bins 6x6 --no-plots",
        "resumes",
    ),
    (
        "gonio --tau 4 --size 32 --theta 0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19 --smoothness 1,2,3,4,5,6,7,8,9,10 --rays 2e4 --realisations 20 --bins 6x6 --no-plots",
        "resumes",
    ),
    (
        "attenuation --tau 4 --spacing 1 --size 64 --sigma 1 --theta 45 --realisations 1e6 --no-plots",
        "resumes",
    ),
    (
        "converge --tau 4 --size 32 --theta 0,10,20,30,40,50,60,70 --samplings random --accelerators pyramid --estimators plain --rays 1e4 --surfaces 4 --repeats 40 --reference-rays 1e3 --reference-surfaces 8 --no-plots",
        "resumes",
    ),
    ("render h.exr --size 24x18 --samples 1e9", "starts again"),
];

fn send(signal: &str, program: &Child) {
    let id = program.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status();
    assert!(sent.unwrap().success());
}

/// The exit code of a program, and what it said.
fn ended(program: Child) -> (Option<i32>, String) {
    let output = program.wait_with_output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), errors)
}

/// Sends interrupts to a run after a while, as Ctrl-C does, and returns its exit code and what it said.
fn interrupted(folder: &Path, line: &str, after: Duration, times: u32) -> (Option<i32>, String) {
    let program = folder.begin(line);
    sleep(after);
    for _ in 0..times {
        send("-INT", &program);
        sleep(Duration::from_millis(50));
    }
    ended(program)
}

#[test]
fn an_interrupt_writes_the_results_so_far_and_has_an_exit_code_of_its_own() {
    let folder = with_surface();
    for (command, again) in LONG {
        let out = if command.starts_with("render") {
            "out.exr"
        } else {
            "out"
        };
        let line = format!("{command} -o {out}");
        // A slow machine has nothing to write yet.
        let patience = [500, 1000, 2500, 6000].map(Duration::from_millis);
        let mut runs = patience
            .into_iter()
            .map(|after| interrupted(&folder, &line, after, 1));
        let (code, errors) = runs.find(|(code, _)| *code != Some(1)).unwrap();
        assert_eq!(code, Some(3), "{line}: {errors}");
        assert_eq!(errors.lines().count(), 1, "{errors}");
        assert!(errors.starts_with("interrupted"), "{errors}");
        errors.must_contain(again);
        let out = folder.join(out);
        if out.is_file() {
            fs::remove_file(out).unwrap();
            continue;
        }
        let written = |name: &str| out.json(name);
        assert_eq!(written("manifest.json")["complete"], false, "{line}");
        let summary = written("summary.json");
        if let Some(stopping) = summary.get("stopping") {
            assert_eq!(stopping["stopped_by"], "interrupt");
            assert!(summary["warnings"].to_string().contains("interrupted"));
            assert!(summary["work"]["rays"].as_u64().unwrap() > 0);
        }
        fs::remove_dir_all(out).unwrap();
    }
}

/// Each run of the command gets further, and the last one completes the measurement.
#[test]
fn an_interrupted_convergence_run_resumes_to_the_same_errors() {
    let folder = Folder::new();
    let command = "converge --tau 4 --size 32 --theta 0,40 --samplings random --rays 2e4 --surfaces 4 --repeats 12 --reference-rays 4096 --reference-surfaces 64 --no-plots";
    folder.succeed(format!("{command} -o whole"));
    let line = format!("{command} -o parts");
    let mut codes = Vec::new();
    while codes.last() != Some(&Some(0)) {
        let after = Duration::from_millis(250 * (codes.len() as u64 + 1));
        let (code, errors) = interrupted(&folder, &line, after, 1);
        let words = match code {
            Some(3) => " of 2 cases ",
            Some(1) => "interrupted: stopped before the first surface was finished",
            _ => "",
        };
        errors.must_contain(words);
        codes.push(code);
    }
    assert!(codes.contains(&Some(3)), "{codes:?}");
    let read = |out: &str| ResultSet::read(folder.join(out)).unwrap();
    let [whole, parts] = ["whole", "parts"].map(|out| read(out).comparable_bytes().unwrap());
    assert!(whole == parts);
    for case in ["s3_n1.5_theta0", "s3_n1.5_theta40"] {
        let table = |out: &str| {
            let table = Table::read(&folder.join(out).join(case).join("convergence.csv"));
            let lasting = |name: &&str| !name.starts_with("seconds");
            let names: Vec<&str> = table.names().filter(lasting).collect();
            let row = |row| {
                names
                    .iter()
                    .map(|name| table.text(row, name).to_owned())
                    .collect()
            };
            (0..table.rows.len()).map(row).collect::<Vec<Vec<String>>>()
        };
        assert_eq!(table("whole"), table("parts"), "{case}");
    }
}

#[test]
fn an_interrupted_attenuation_resumes_to_the_tables_of_a_whole_run() {
    let folder = Folder::new();
    let line = |out: &str| {
        format!(
            "attenuation --tau 4 --spacing 1 --size 64 --sigma 2,1 --theta 30,70 --heights --demarcation --realisations 80 --no-plots --quiet -o {out}"
        )
    };
    let began = Instant::now();
    folder.succeed(line("whole"));
    let whole = began.elapsed();
    // A run that is sooner done than the first one is interrupted earlier.
    let is_cut_short = [2, 4, 8, 3].into_iter().any(|part| {
        let (code, errors) = interrupted(&folder, &line("out"), whole / part, 1);
        if code == Some(3) {
            errors.must_contain("the same command resumes");
            return true;
        }
        let _ = fs::remove_dir_all(folder.join("out"));
        false
    });
    assert!(is_cut_short);
    let read = |out: &str, name: &str| folder.join(out).text(name);
    let so_far = json(&read("out", "summary.json"))["work"]["realisations"].clone();
    assert!((1..80).contains(&so_far.as_u64().unwrap()), "{so_far}");
    folder.succeed(line("out"));
    for name in "attenuation.csv demarcation.csv visibility.csv report.txt".split(' ') {
        assert!(read("out", name) == read("whole", name), "{name} differs");
    }
    let [resumed, whole] = ["out", "whole"].map(|out| {
        let mut summary = json(&read(out, "summary.json"));
        summary["work"]["seconds"] = 0.into();
        summary
    });
    assert_eq!(resumed, whole);
    assert_eq!(json(&read("out", "manifest.json"))["complete"], true);
    // Other settings are other results; a complete folder may be written again.
    folder.succeed(format!("{} --seed 2", line("out")));
    assert!(read("out", "attenuation.csv") != read("whole", "attenuation.csv"));
}

#[test]
fn other_signals_that_end_a_program_are_interrupts_too() {
    let folder = with_surface();
    for signal in ["-TERM", "-HUP"] {
        let program = folder.begin("trace h.exr --theta 30 --rays 1e10 --json");
        sleep(Duration::from_millis(300));
        send(signal, &program);
        let (code, errors) = ended(program);
        assert_eq!(code, Some(3), "{signal}: {errors}");
        let said =
            "interrupted; these are the results so far, and the same command with -o resumes\n";
        assert_eq!(errors, said);
    }
}

/// A run that its own time limit ended is no interrupted run, even if an interrupt comes while it writes its results.
#[test]
fn an_interrupt_after_the_time_limit_changes_nothing() {
    let folder = with_surface();
    let line = "gonio --tau 4 --size 64 --theta 0,30,60 --smoothness 2 --rays 1e9 --realisations 1000 --max-time 3 --no-plots -o g";
    let program = folder.begin(line);
    let began = Instant::now();
    // The folder in which tables wait until all are written
    let is_part = |name: &String| name.ends_with(".part");
    while !folder.join("g").exists() || !files(&folder.join("g")).iter().any(is_part) {
        assert!(began.elapsed() < Duration::from_secs(60), "never written");
        sleep(Duration::from_millis(1));
    }
    send("-INT", &program);
    let (code, errors) = ended(program);
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.starts_with("the time is over; "), "{errors}");
}

#[test]
fn a_second_interrupt_ends_the_program_at_once() {
    let folder = with_surface();
    // A block of rays that try every facet does not end soon.
    let endless = "trace h.exr --theta 30 --accelerator brute-force --rays 1e10 --no-plots -o none";
    let (code, errors) = interrupted(&folder, endless, Duration::from_millis(700), 2);
    assert_eq!(code, Some(130), "{errors}");
    assert!(
        errors.is_empty() && !folder.join("none").exists(),
        "{errors}"
    );
}

#[test]
fn an_interrupt_in_the_middle_of_a_file_leaves_the_old_one_and_nothing_else() {
    let folder = with_surface();
    folder.write("h.obj", "old");
    let line = "mesh h.exr --cells smooth --subdivide 16 -o h.obj";
    for signal in ["-INT", "-TERM"] {
        let program = folder.begin(line);
        let began = Instant::now();
        let is_large = |name: &String| {
            let size = fs::metadata(folder.join(name)).map_or(0, |found| found.len());
            name.ends_with(".part") && size > 0
        };
        while !files(&folder).iter().any(is_large) {
            assert!(began.elapsed() < Duration::from_secs(60), "never written");
        }
        send(signal, &program);
        let (code, errors) = ended(program);
        assert_eq!(code, Some(130), "{errors}");
        assert_eq!(errors, "interrupted; no incomplete file is left\n");
        assert_eq!(files(&folder), ["h.exr", "h.obj"]);
        let old = folder.text("h.obj");
        assert_eq!(old, "old");
    }
}

/// Interrupts at any time, of runs that write many files: nothing temporary is left.
#[test]
fn no_interrupt_leaves_temporary_files() {
    let folder = with_surface();
    let line = "trace h.exr --theta 30 --rays 1e3 -o out --quiet";
    let began = Instant::now();
    folder.succeed(line);
    let whole = began.elapsed();
    let mut interrupted = 0;
    for step in 0..8 {
        let program = folder.begin(line);
        sleep(whole * step / 8);
        for _ in 0..2 {
            send("-INT", &program);
        }
        let output = program.wait_with_output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        let is_said = match output.status.code() {
            // It had ended before, or both signals came as one.
            Some(0) => errors.is_empty(),
            Some(1) => errors.starts_with("asperity: interrupted: stopped before"),
            Some(3) => errors.starts_with("interrupted; the results so far are written"),
            Some(130) => errors.lines().all(|line| line.starts_with("interrupted; ")),
            Some(_) => false,
            // It did not handle signals yet.
            None => output.status.signal() == Some(2) && errors.is_empty(),
        };
        assert!(is_said, "{}: {errors}", output.status);
        interrupted += u32::from(output.status.code().is_some_and(|code| code > 0));
        for place in [folder.join("."), folder.join("out")] {
            let names = files(&place);
            assert!(!names.iter().any(|n| n.ends_with(".part")), "{names:?}");
        }
    }
    assert!(interrupted >= 2, "most came before the run or after it");
}

#[test]
fn a_model_that_takes_long_ends_at_the_first_interrupt() {
    let folder = Folder::new();
    let line = "model xu-sun-mc --smoothness 0.3 --rays 1e10 --json";
    let began = Instant::now();
    let after = Duration::from_millis(500);
    let (code, errors) = interrupted(&folder, line, after, 1);
    assert_eq!(code, Some(130), "{errors}");
    assert!(began.elapsed() < Duration::from_secs(10));
}

/// Quadrature does not ask whether it should stop, so it must be short: of the smoothest surfaces, whose lobes are the
/// narrowest, it takes a second or two.
#[test]
fn quadrature_of_the_narrowest_lobes_takes_seconds() {
    let folder = Folder::new();
    for line in [
        "verify --smoothness 1e6 --theta 60 --rays 1e3 --realisations 2 --models smith,heitz --no-plots --quiet -o v",
        "gonio --smoothness 1e6 --theta 0,89 --rays 1e3 --realisations 2 --no-plots --quiet -o g",
        "model heitz --smoothness 1e6 --theta 89 --json",
        "model xu-sun --smoothness 1e6 --theta 89 --json",
        "model v-cavity --smoothness 1e6 --theta 60 --json",
    ] {
        let began = Instant::now();
        folder.succeed(line);
        let seconds = began.elapsed().as_secs_f64();
        assert!(seconds < 30.0, "{line}: {seconds} s");
    }
}
