//! Manifest: reads and writes `manifest.json`, the list of the files that a run wrote.

use std::collections::BTreeSet;
use std::io;
use std::path::{Component, Path};

use serde::{Deserialize, Serialize};

use super::atomic::write_json;
use super::text::read_json;
use crate::build::Build;
use crate::error::{ReadError, ResultFolderError};

/// Name of the manifest in its folder.
pub(super) const MANIFEST: &str = "manifest.json";

/// Form of the file; another number is another form.
const SCHEMA: u32 = 1;

/// The files that a run wrote into a folder, and what wrote them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Manifest {
    schema: u32,
    /// Command that wrote the files, as in `verify`.
    pub(super) command: String,
    #[serde(flatten)]
    pub(super) build: Build,
    /// Whether the run came to its end. The list of a run that did not may name files that do not
    /// exist.
    pub(super) complete: bool,
    /// Paths relative to the folder, separated by `/`.
    pub(super) files: BTreeSet<String>,
}

impl Manifest {
    pub(super) fn new(command: &str, complete: bool, files: BTreeSet<String>) -> Self {
        Self {
            schema: SCHEMA,
            command: command.to_owned(),
            build: Build::current(),
            complete,
            files,
        }
    }

    /// The manifest of `folder`, or `None` if the folder has no manifest.
    pub(super) fn read(folder: &Path) -> Result<Option<Self>, ResultFolderError> {
        let path = folder.join(MANIFEST);
        let invalid = |reason: String| ResultFolderError::InvalidManifest {
            path: path.clone(),
            reason,
        };
        if path.is_symlink() {
            return Err(invalid("it is a symbolic link".to_owned()));
        }
        let manifest: Self = match read_json(&path) {
            Ok(manifest) => manifest,
            Err(ReadError::NotFound { .. }) => return Ok(None),
            Err(ReadError::Io { source, .. }) if source.kind() == io::ErrorKind::NotADirectory => {
                return Ok(None);
            }
            Err(ReadError::Json { source, .. }) => return Err(invalid(source.to_string())),
            Err(error) => return Err(error.into()),
        };
        if manifest.schema != SCHEMA {
            return Err(invalid(format!(
                "its schema is {}, this program knows {SCHEMA}",
                manifest.schema
            )));
        }
        if let Some(name) = manifest.files.iter().find(|name| !is_inside(name)) {
            return Err(invalid(format!(
                "it lists `{name}`, which is not in the folder"
            )));
        }
        Ok(Some(manifest))
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), ResultFolderError> {
        Ok(write_json(folder.join(MANIFEST), self)?)
    }
}

/// Whether `name` is a relative path of plain components that stays inside its folder and is not the
/// manifest itself.
pub(super) fn is_inside(name: &str) -> bool {
    let mut components = Path::new(name).components();
    let is_plain = components.all(|part| matches!(part, Component::Normal(_)));
    is_plain && !name.is_empty() && !name.ends_with('/') && name != MANIFEST
}
