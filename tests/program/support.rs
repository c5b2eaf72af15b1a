//! Running the program in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use asperity_results::ResultSet;
use serde_json::Value;
use tempfile::TempDir;

pub(crate) fn asperity(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_asperity"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// The arguments of a command line, none of which holds a blank.
pub(crate) fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

/// Runs a command that must succeed, and returns its standard output.
pub(crate) fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = asperity(folder, arguments);
    let errors = errors_of(&output);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    assert!(errors.is_empty(), "{arguments:?} on a pipe: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command that must be refused with `code` and one sentence, and returns that.
pub(crate) fn refused(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = asperity(folder, arguments);
    let errors = errors_of(&output);
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

/// Standard error without lines of progress, for which a slow machine takes long enough.
pub(crate) fn errors_of(output: &Output) -> String {
    without_progress(&String::from_utf8_lossy(&output.stderr))
}

/// Text without its line breaks, which depend on how long names are.
pub(crate) fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn without_progress(errors: &str) -> String {
    let lines = errors.lines();
    let others = lines.filter(|line| !line.starts_with("progress: "));
    others.map(|line| format!("{line}\n")).collect()
}

pub(crate) fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

pub(crate) fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// A folder with one small generated surface.
pub(crate) fn with_surface() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let arguments = words("generate --tau 8 --smoothness 2 --size 64 --seed 7");
    succeed(folder.path(), &[&arguments[..], &["-o", "h.exr"]].concat());
    let path = folder.path().to_owned();
    (folder, path)
}

/// A table by the names of its columns.
pub(crate) struct Table {
    header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let split = |line: &str| line.split(',').map(str::to_owned).collect();
        let mut lines = text.lines();
        Self {
            header: split(lines.next().unwrap()),
            rows: lines.map(split).collect(),
        }
    }

    /// Names of the columns.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.header.iter().map(String::as_str)
    }

    pub(crate) fn text(&self, row: usize, name: &str) -> &str {
        let column = self.header.iter().position(|c| c == name);
        &self.rows[row][column.unwrap_or_else(|| panic!("no column {name}"))]
    }

    pub(crate) fn number(&self, row: usize, name: &str) -> f64 {
        self.text(row, name).parse().unwrap()
    }
}

/// Asserts that two folders hold the same files of the same bytes, and the same results of whatever machine.
pub(crate) fn assert_same_bytes(a: &Path, b: &Path) {
    assert_eq!(files(a), files(b));
    let comparable = |path: &Path| ResultSet::read(path).unwrap().comparable_bytes().unwrap();
    for name in files(a) {
        let (a, b) = (a.join(&name), b.join(&name));
        if a.is_dir() {
            assert_same_bytes(&a, &b);
        } else if name == "results.npz" {
            assert!(comparable(&a) == comparable(&b), "{name}");
        } else {
            assert!(fs::read(&a).unwrap() == fs::read(&b).unwrap(), "{name}");
        }
    }
}
