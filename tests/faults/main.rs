//! Faults: runs that are killed, interrupted, or left without disk space or memory at any moment, and the same command run again.
//!
//! After each fault every file of the result folder is whole, and the same command gives the files of an undisturbed run. A few moments
//! of each command and fault are tested; `ASPERITY_FAULTS=100` tests 100 moments of each and prints the table of `docs/how_it_works/faults.md`.

#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests fail as their helpers do, and say what they skip"
)]

mod files;
mod inject;

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use files::{contents, differences, half_written, make_old, temporary};
use inject::{Ended, Fault, SmallDisk, program, run_with};

/// A command whose runs are disturbed.
struct Disturbed {
    name: &'static str,
    /// Files that the command reads, made once in the folder that it runs in.
    prepare: &'static [&'static str],
    /// Its line without `-o`.
    line: &'static str,
}

const COMMANDS: [Disturbed; 5] = [
    Disturbed {
        name: "verify",
        prepare: &[],
        line: "verify --tau 4 --size 32 --insist --smoothness 2 --theta 30 --models smith --rays 4e5 --realisations 8 --bins 6x12",
    },
    Disturbed {
        name: "trace",
        prepare: &["generate --tau 8 --smoothness 2 --size 64 --seed 7 -o h.exr"],
        line: "trace h.exr --theta 30 --rays 4e5 --bins 6x12",
    },
    Disturbed {
        name: "map",
        prepare: &[],
        line: "map --tau 4 --size 32 --insist --smoothness 2,4 --theta 0,30 --models smith --rays 1e5 --realisations 8 --bins 6x12",
    },
    Disturbed {
        name: "gonio",
        prepare: &[],
        line: "gonio --tau 4 --size 32 --insist --smoothness 2 --theta 0,40 --rays 1e5 --realisations 4 --bins 6x12 --no-plots",
    },
    Disturbed {
        name: "merge",
        prepare: &[
            "verify --tau 4 --size 32 --insist --smoothness 2 --theta 30 --models smith,heitz --rays 4e4 --realisations 8 --bins 6x12 --shard 1/2 -o shards/1",
            "verify --tau 4 --size 32 --insist --smoothness 2 --theta 30 --models smith,heitz --rays 4e4 --realisations 8 --bins 6x12 --shard 2/2 -o shards/2",
        ],
        line: "merge shards/1 shards/2",
    },
];

/// Counts of one command and fault.
#[derive(Default)]
struct Counts {
    runs: u32,
    /// Runs that the fault ended.
    ended: u32,
    /// Of these, runs without results.
    without_results: u32,
    half_written: u32,
    temporary: u32,
    differing: u32,
    wrong_ends: u32,
}

/// Name of a user's own file in the result folder.
const OWN_FILE: &str = "notes.txt";
const OWN_TEXT: &str = "my own\n";

/// The moments of faults, as parts of a run: evenly spread, and other ones for each seed.
fn moments(seed: f64) -> impl Iterator<Item = f64> {
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    (1..).map(move |k| (seed + f64::from(k) * golden).fract())
}

#[test]
fn after_any_fault_files_are_whole_and_the_same_command_gives_the_same_results() {
    let full: Option<u32> = std::env::var("ASPERITY_FAULTS")
        .ok()
        .map(|n| n.parse().unwrap());
    let mut problems = Vec::new();
    println!(
        "{:<8}{:<10}{:>6}{:>8}{:>17}{:>14}{:>16}{:>19}{:>12}",
        "command",
        "fault",
        "runs",
        "ended",
        "without results",
        "half-written",
        "temporary left",
        "resumes that differ",
        "wrong ends"
    );
    for (number, command) in COMMANDS.iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        for line in command.prepare {
            assert!(program(folder, line).output().unwrap().status.success());
        }
        let began = Instant::now();
        let whole = run_with(folder, command.line, "whole", &Fault::None);
        assert!(whole.is_complete(), "{}: {}", command.name, whole.said);
        let time = began.elapsed();
        let expected = contents(&folder.join("whole"));
        assert_eq!(half_written(&folder.join("whole")), Vec::<String>::new());
        let bytes: u64 = expected.values().map(|file| file.len() as u64).sum();
        let kinds = ["SIGKILL", "SIGTERM", "SIGINT", "disk", "memory"];
        for (k, kind) in kinds.into_iter().enumerate() {
            let mut counts = Counts::default();
            let seed = (number * kinds.len() + k) as f64 * 0.137;
            let few = if kind.starts_with("SIG") { 2 } else { 1 };
            for part in moments(seed).take(full.unwrap_or(few) as usize) {
                let fault = match kind {
                    "disk" => Fault::Disk((part * bytes as f64) as u64),
                    "memory" => Fault::Memory((50e3 + part * 150e3) as u64),
                    "SIGKILL" => Fault::Signal(kind, time.mul_f64(1.1 * part)),
                    // A run that is interrupted as it draws its figures ends as usual.
                    signal => Fault::Signal(signal, time.mul_f64(0.5 * part)),
                };
                let disk = SmallDisk::of(&fault, folder);
                if disk.is_none() && kind == "disk" {
                    println!("skipped: no small disk can be mounted here (that takes root)");
                    break;
                }
                for problem in disturb(folder, command, &fault, disk, &expected, &mut counts) {
                    problems.push(format!("{} {kind} at {part:.4}: {problem}", command.name));
                }
            }
            println!(
                "{:<8}{:<10}{:>6}{:>8}{:>17}{:>14}{:>16}{:>19}{:>12}",
                command.name,
                kind,
                counts.runs,
                counts.ended,
                counts.without_results,
                counts.half_written,
                counts.temporary,
                counts.differing,
                counts.wrong_ends
            );
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Runs a command with a fault, then without one, and returns what is wrong.
fn disturb(
    folder: &Path,
    command: &Disturbed,
    fault: &Fault,
    disk: Option<SmallDisk>,
    expected: &files::Contents,
    counts: &mut Counts,
) -> Vec<String> {
    let mut problems = Vec::new();
    // A small disk is mounted at that place.
    let place = folder.join("place");
    fs::create_dir_all(place.join("out")).unwrap();
    let own = place.join("out").join(OWN_FILE);
    fs::write(&own, OWN_TEXT).unwrap();
    let Ended { code, said } = run_with(folder, command.line, "place/out", fault);
    let out = place.join("out");
    counts.runs += 1;
    if code != Some(0) {
        counts.ended += 1;
        counts.without_results += u32::from(!out.join("summary.json").exists());
    }
    if !fault.allows(code, &said) {
        counts.wrong_ends += 1;
        problems.push(format!("ended with {code:?}: {said}"));
    }
    let broken = half_written(&out);
    counts.half_written += u32::from(!broken.is_empty());
    problems.extend(broken);
    // The next run takes young temporary files for those of a running one.
    let left = temporary(&out);
    if !left.is_empty() && !fault.may_leave_temporary_files() && code.is_some() {
        problems.push(format!("temporary files are left: {left:?}"));
    }
    make_old(&out);

    if let Some(disk) = &disk {
        disk.grow();
    }
    let again = run_with(folder, command.line, "place/out", &Fault::None);
    if !again.is_complete() {
        counts.wrong_ends += 1;
        problems.push(format!(
            "run again, it ended with {:?}: {}",
            again.code, again.said
        ));
    }
    let left = temporary(&out);
    counts.temporary += u32::from(!left.is_empty());
    problems.extend(left.iter().map(|name| format!("{name} is left")));
    let own_text = fs::read_to_string(&own).unwrap_or_default();
    if own_text != OWN_TEXT {
        problems.push(format!("the user's own file is now {own_text:?}"));
    }
    let _ = fs::remove_file(&own);
    let differing = differences(expected, &contents(&out));
    counts.differing += u32::from(!differing.is_empty());
    problems.extend(differing);
    drop(disk);
    fs::remove_dir_all(&place).unwrap();
    problems
}

#[test]
fn moments_are_spread_evenly() {
    for seed in [0.0, 0.3] {
        let mut tenths = [0; 10];
        for part in moments(seed).take(100) {
            tenths[(part * 10.0) as usize] += 1;
        }
        assert!(tenths.iter().all(|n| (8..=12).contains(n)), "{tenths:?}");
    }
    assert!(Duration::from_secs(1).mul_f64(moments(0.0).next().unwrap()) < Duration::from_secs(1));
}
