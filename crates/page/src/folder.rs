//! Folder: the files of one result folder.

use std::path::{Component, Path, PathBuf};

use asperity_io::{RESULTS_EPOCH, exists, read_text, shown_path};
use serde_json::{Map, Value};

use crate::error::PageError;
use crate::rows::Rows;

/// Commands whose results have a page.
const COMMANDS: [&str; 8] = [
    "verify",
    "trace",
    "gonio",
    "map",
    "converge",
    "attenuation",
    "albedo",
    "inspect",
];

/// A result folder with its manifest and summary.
pub(crate) struct Folder {
    pub(crate) path: PathBuf,
    pub(crate) manifest: Value,
    pub(crate) summary: Value,
    /// Names of its files, sorted, relative to the folder.
    pub(crate) files: Vec<String>,
}

impl Folder {
    /// Opens the folder of a study.
    ///
    /// # Errors
    /// [`PageError`] if it holds no results, or those of another command or results epoch.
    pub(crate) fn open(path: &Path) -> Result<Self, PageError> {
        if !exists(path) {
            return Err(PageError::Missing(path.to_owned()));
        }
        let manifest = json(path, "manifest.json")?;
        let command = manifest["command"].as_str().unwrap_or_default();
        if !COMMANDS.contains(&command) {
            return Err(PageError::OtherCommand {
                path: path.to_owned(),
                command: command.to_owned(),
            });
        }
        let epoch = &manifest["results_epoch"];
        if epoch.as_u64() != Some(RESULTS_EPOCH.into()) {
            return Err(PageError::OtherEpoch {
                path: path.to_owned(),
                found: epoch.to_string(),
                expected: RESULTS_EPOCH,
            });
        }
        let files = manifest["files"].as_object();
        let files = files.into_iter().flat_map(|files| files.keys());
        // A manifest of foreign origin names no file outside its folder.
        let is_inside = |name: &&String| {
            let mut parts = Path::new(name.as_str()).components();
            parts.all(|part| matches!(part, Component::Normal(_)))
        };
        Ok(Self {
            path: path.to_owned(),
            files: files.filter(is_inside).cloned().collect(),
            summary: json(path, "summary.json")?,
            manifest,
        })
    }

    /// Command that wrote the results.
    pub(crate) fn command(&self) -> &str {
        self.manifest["command"].as_str().unwrap_or_default()
    }

    /// Name for people: the last part of its path.
    pub(crate) fn name(&self) -> String {
        let name = self.path.file_name().map(Path::new);
        shown_path(name.unwrap_or(&self.path))
    }

    /// Returns `true` if the run came to its end.
    pub(crate) fn is_complete(&self) -> bool {
        self.manifest["complete"] == true && self.summary["complete"] != false
    }

    /// Returns `true` if it has the file of results.
    pub(crate) fn has_results(&self) -> bool {
        self.files.iter().any(|file| file == "results.npz")
    }

    /// A file as text; `None` if the manifest does not list it.
    pub(crate) fn text(&self, name: &str) -> Result<Option<String>, PageError> {
        let is_listed = self.files.iter().any(|file| file == name);
        let path = self.path.join(name);
        match is_listed && exists(&path) {
            true => Ok(Some(read_text(path)?)),
            false => Ok(None),
        }
    }

    /// Rows of a table; `None` if there is no such table.
    pub(crate) fn rows(&self, name: &str) -> Result<Option<Rows>, PageError> {
        let text = self.text(name)?;
        let read = text.map(|text| Rows::read(&text));
        let damaged = |reason| PageError::Damaged {
            path: self.path.join(name),
            reason,
        };
        read.transpose().map_err(damaged)
    }
}

/// A JSON file that every result folder has.
fn json(folder: &Path, name: &'static str) -> Result<Value, PageError> {
    let path = folder.join(name);
    if !exists(&path) {
        return Err(PageError::NoResults {
            path: folder.to_owned(),
            missing: name,
        });
    }
    let text = read_text(&path)?;
    let parsed = serde_json::from_str::<Map<String, Value>>(&text);
    parsed
        .map(Value::Object)
        .map_err(|error| PageError::Damaged {
            path,
            reason: error.to_string(),
        })
}
