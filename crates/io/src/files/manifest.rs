//! Manifest: reads and writes `manifest.json`, the list of the files that a run wrote.

use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path};

use serde::{Deserialize, Deserializer, Serialize};

use super::atomic::write_json;
use super::fingerprint::Fingerprint;
use super::text::read_json;
use crate::build::Build;
use crate::error::{ReadProblem, ResultFolderError};

/// Name of the manifest in its folder.
pub(super) const MANIFEST: &str = "manifest.json";

/// Form of the file; another number is another form.
const SCHEMA: u32 = 2;

/// The form before, whose files are a list of names.
const SCHEMA_OF_NAMES: u32 = 1;

/// Files by their path relative to the folder, separated by `/`. A checkpoint, which has a checksum of its own, has no
/// fingerprint.
pub(super) type ListedFiles = BTreeMap<String, Option<Fingerprint>>;

/// The files that a run wrote into a folder, and what wrote them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Manifest {
    schema: u32,
    /// Command that wrote the files, as in `verify`.
    pub(super) command: String,
    /// Arguments of the program that wrote them; none of a library.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) arguments: Vec<String>,
    #[serde(flatten)]
    pub(super) build: Build,
    /// `true` if the run came to its end. The list of a run that did not may name files that do not
    /// exist.
    pub(super) complete: bool,
    #[serde(deserialize_with = "files_of_any_schema")]
    pub(super) files: ListedFiles,
    /// Identity of the run whose files these are, where a later one may go on with them: see [`resume`](super::ResultFolder::resume).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) identity: Option<String>,
    /// Files whose new content a run that was killed was putting in place.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) replacing: ListedFiles,
}

impl Manifest {
    pub(super) fn new(
        command: &str,
        arguments: &[String],
        complete: bool,
        files: ListedFiles,
        identity: Option<&String>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            command: command.to_owned(),
            arguments: arguments.to_owned(),
            build: Build::current(),
            complete,
            files,
            identity: identity.cloned(),
            replacing: ListedFiles::new(),
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
            Err(error) => match error.problem {
                ReadProblem::NotFound => return Ok(None),
                ReadProblem::Io(error) if error.kind() == io::ErrorKind::NotADirectory => {
                    return Ok(None);
                }
                ReadProblem::Malformed(reason) => return Err(invalid(reason)),
                _ => return Err(error.into()),
            },
        };
        if ![SCHEMA, SCHEMA_OF_NAMES].contains(&manifest.schema) {
            return Err(invalid(format!(
                "its schema is {}, this program knows {SCHEMA}",
                manifest.schema
            )));
        }
        let mut names = manifest.files.keys().chain(manifest.replacing.keys());
        if let Some(name) = names.find(|name| !is_inside(name)) {
            return Err(invalid(format!(
                "it lists `{name}`, which is not in the folder"
            )));
        }
        Ok(Some(manifest))
    }

    /// The nearest manifest above the folder `path`, which has no links, that lists files inside; with its folder.
    pub(super) fn above(path: &Path) -> Option<(&Path, Self)> {
        path.ancestors().skip(1).find_map(|above| {
            let manifest = Self::read(above).ok()??;
            let inside = path.strip_prefix(above).ok()?;
            let mut names = manifest.files.keys().chain(manifest.replacing.keys());
            let lists = names.any(|name| Path::new(name).starts_with(inside));
            lists.then_some((above, manifest))
        })
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), ResultFolderError> {
        Ok(write_json(folder.join(MANIFEST), self)?)
    }
}

/// Reads files with their fingerprints, or a list of their names.
fn files_of_any_schema<'de, D: Deserializer<'de>>(source: D) -> Result<ListedFiles, D::Error> {
    #[derive(Deserialize)]
    #[serde(
        untagged,
        expecting = "`files` must map names to their length and MD5, or list names"
    )]
    enum Files {
        Listed(ListedFiles),
        Names(Vec<String>),
    }
    Ok(match Files::deserialize(source)? {
        Files::Listed(files) => files,
        Files::Names(names) => names.into_iter().map(|name| (name, None)).collect(),
    })
}

/// Returns `true` if `name` is a relative path of plain components that stays inside its folder and is not the
/// manifest itself.
pub(super) fn is_inside(name: &str) -> bool {
    let mut components = Path::new(name).components();
    let is_plain = components.all(|part| matches!(part, Component::Normal(_)));
    is_plain && !name.is_empty() && !name.ends_with('/') && name != MANIFEST
}
