//! Running the program in a folder of its own.

use std::fs;
use std::ops::Deref;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use asperity_results::ResultSet;
use serde_json::Value;
use tempfile::TempDir;

/// A folder of its own, removed at the end of a test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        self.0.path()
    }
}

/// Commands run in a folder, and its files.
pub(crate) trait InFolder {
    /// The program with the arguments of a line, none of which holds a blank.
    fn command(&self, line: impl AsRef<str>) -> Command;

    /// Runs the program to its end.
    fn run(&self, line: impl AsRef<str>) -> Output {
        self.command(line).output().unwrap()
    }

    /// Starts the program, with no one to read its standard output.
    fn begin(&self, line: impl AsRef<str>) -> Child {
        let mut command = self.command(line);
        let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().unwrap()
    }

    /// Runs a command that must succeed, and returns its standard output.
    fn succeed(&self, line: impl AsRef<str>) -> String;

    /// Runs a command that must end with `code` and one sentence, and returns that.
    fn stopped(&self, line: impl AsRef<str>, code: i32) -> String;

    /// Runs a command of wrong usage, and returns its sentence.
    fn refused(&self, line: impl AsRef<str>) -> String {
        self.stopped(line, 2)
    }

    /// Runs a command that must fail, and returns its sentence.
    fn failed(&self, line: impl AsRef<str>) -> String {
        self.stopped(line, 1)
    }

    /// Runs commands of wrong usage, a row of [`rows`] each: the line, and words of its sentence.
    fn refuses(&self, cases: &str) {
        for [line, expected] in rows(cases) {
            self.refused(line).must_contain(expected);
        }
    }

    /// The text of a file.
    fn text(&self, name: impl AsRef<Path>) -> String;

    /// The JSON of a file.
    fn json(&self, name: impl AsRef<Path>) -> Value {
        json(&self.text(name))
    }

    /// Writes a file.
    fn write(&self, name: impl AsRef<Path>, contents: impl AsRef<[u8]>);
}

impl InFolder for Path {
    fn command(&self, line: impl AsRef<str>) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_asperity"));
        let words = line.as_ref().split_whitespace();
        command.current_dir(self).args(words);
        command
    }

    fn succeed(&self, line: impl AsRef<str>) -> String {
        let line = line.as_ref();
        let output = self.run(line);
        let errors = errors_of(&output);
        assert!(output.status.success(), "{line}: {errors}");
        assert!(errors.is_empty(), "{line} on a pipe: {errors}");
        String::from_utf8(output.stdout).unwrap()
    }

    fn stopped(&self, line: impl AsRef<str>, code: i32) -> String {
        let line = line.as_ref();
        let output = self.run(line);
        let errors = errors_of(&output);
        assert_eq!(output.status.code(), Some(code), "{line}: {errors}");
        assert!(!errors.contains("panicked"), "{line}: {errors}");
        assert!(errors.starts_with("asperity: "), "{errors}");
        let lines = errors.trim_end().lines();
        assert_eq!(lines.count(), 1, "one sentence: {errors}");
        errors
    }

    fn text(&self, name: impl AsRef<Path>) -> String {
        fs::read_to_string(self.join(name)).unwrap()
    }

    fn write(&self, name: impl AsRef<Path>, contents: impl AsRef<[u8]>) {
        fs::write(self.join(name), contents).unwrap();
    }
}

/// The rows of a table in text, whose columns are parted by ` => `.
pub(crate) fn rows<const N: usize>(table: &str) -> impl Iterator<Item = [&str; N]> {
    let rows = table.trim().lines();
    let rows = rows.map(|row| row.trim().split(" => ").collect::<Vec<_>>());
    rows.map(|columns| columns.try_into().unwrap())
}

/// MustContain of a text.
pub(crate) trait MustContain {
    /// Asserts that the text contains a part.
    fn must_contain(&self, part: impl AsRef<str>);
}

impl MustContain for str {
    #[track_caller]
    fn must_contain(&self, part: impl AsRef<str>) {
        let part = part.as_ref();
        assert!(self.contains(part), "`{part}` is missing in {self}");
    }
}

/// Standard error without lines of progress, for which a slow machine takes long enough.
pub(crate) fn errors_of(output: &Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr);
    let lines = errors.lines();
    let others = lines.filter(|line| !line.starts_with("progress: "));
    others.map(|line| format!("{line}\n")).collect()
}

/// Text without its line breaks, which depend on how long names are.
pub(crate) fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
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
pub(crate) fn with_surface() -> Folder {
    let folder = Folder::new();
    folder.succeed("generate --tau 8 --smoothness 2 --size 64 --seed 7 -o h.exr");
    folder
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

/// Asserts that two folders hold the same files of the same bytes, and the same results of whatever machine and command line.
pub(crate) fn assert_same_bytes(a: &Path, b: &Path) {
    assert_eq!(files(a), files(b));
    let comparable = |path: &Path| ResultSet::read(path).unwrap().comparable_bytes().unwrap();
    for name in files(a) {
        let (a, b) = (a.join(&name), b.join(&name));
        if a.is_dir() {
            assert_same_bytes(&a, &b);
        } else if name == "results.npz" {
            assert!(comparable(&a) == comparable(&b), "{name}");
        } else if name == "manifest.json" {
            let [a, b] = [a, b].map(|path| {
                let mut manifest = json(&fs::read_to_string(path).unwrap());
                manifest["arguments"] = Value::Null;
                manifest
            });
            assert_eq!(a, b);
        } else {
            assert!(fs::read(&a).unwrap() == fs::read(&b).unwrap(), "{name}");
        }
    }
}
