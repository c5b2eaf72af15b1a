//! The program: a short run of all targets, the same counts for the same seed, and the failures that it must find.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use std::process::{Command, Output};

fn fuzz(line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_asperity-fuzz"));
    command.args(line.split_whitespace()).output().unwrap()
}

/// Rows of the table without the longest times.
fn rows(output: &Output) -> Vec<String> {
    let text = String::from_utf8_lossy(&output.stdout);
    let counts = |line: &str| line.get(..69).unwrap_or(line).to_owned();
    text.lines().map(counts).collect()
}

#[test]
fn no_reader_fails_and_equal_seeds_give_equal_counts() {
    let [first, second] = [(); 2].map(|()| fuzz("--inputs 150 --seed 3"));
    let errors = String::from_utf8_lossy(&first.stderr);
    assert_eq!(first.status.code(), Some(0), "{errors}");
    let table = rows(&first);
    assert_eq!(table, rows(&second));
    for target in asperity_fuzz::targets() {
        let row = table.iter().find(|row| row.starts_with(target.name));
        let counts: Vec<u64> = row.unwrap()[13..]
            .split_whitespace()
            .map(|count| count.parse().unwrap())
            .collect();
        // The seeds themselves, and most damage
        assert!(
            counts[0] == 150 && counts[1] > 0 && counts[2] > 20,
            "{row:?}"
        );
    }
}

#[test]
fn every_kind_of_failure_is_found_and_its_input_is_kept() {
    for (target, words) in [
        ("broken-panic", "a nine"),
        ("broken-text", "not one line"),
        ("broken-memory", "signal: 6"),
        ("broken-hang", "over 5 s"),
    ] {
        let output = fuzz(&format!("--inputs 500 {target}"));
        let text = [output.stdout, output.stderr].concat();
        let text = String::from_utf8_lossy(&text);
        assert_eq!(output.status.code(), Some(1), "{target}: {text}");
        assert!(text.contains(words), "{target}: {text}");
        let file = text
            .split_whitespace()
            .find(|word| word.ends_with("-in.csv"));
        let file = file.unwrap();
        if target == "broken-panic" {
            let replayed = fuzz(&format!("--replay {file} {target}"));
            assert_eq!(replayed.status.code(), Some(101));
        }
        std::fs::remove_file(file).unwrap();
    }
}

#[test]
fn wrong_usage_is_told() {
    for line in ["--inputs", "--unknown", "none", "--replay x"] {
        assert_eq!(fuzz(line).status.code(), Some(2), "{line}");
    }
}
