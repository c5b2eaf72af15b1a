//! Result folder: replaces only the files that an earlier run of the same command wrote.
//!
//! A file is *listed* if the manifest names it. The rules:
//! - What exists and is not listed belongs to the user. It is neither replaced nor removed, and a run
//!   that would write a file of that name is refused.
//! - A listed file is replaced by a complete new one, or, once the run has come to its end, removed if
//!   the run did not write it again. An input of the run is never touched.
//! - A name is listed before its file is written, so that an interrupted run leaves no file that a
//!   later run would take for the user's. The manifest of a complete run is written last.
//! - Symbolic links and folders are never listed files, and no listed file lies behind a link.

#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::Value;

use super::folder::{check_output_folder, create_output_folder};
use super::manifest::{Manifest, is_inside};
use super::parts::remove_stale_parts;
use super::text::read_json;
use crate::error::{ResultFolderError, WriteError};

/// A folder that takes the files of one run.
///
/// [`open`](Self::open) it and [`check`](Self::check) the names before the work begins,
/// [`claim`](Self::claim) the path of each file when it is written, and [`finish`](Self::finish) at the
/// end. Until the first claim nothing is created or changed. All methods but `finish` may be called
/// from several threads.
///
/// Names are relative to the folder and separated by `/`; sub-folders are made as needed.
///
/// # Examples
/// ```
/// use asperity_io::{ResultFolder, write_bytes, write_json};
///
/// let place = tempfile::tempdir()?;
/// let folder = ResultFolder::open(place.path().join("out"), "verify", &[])?;
/// folder.check(["summary.json", "cases/theta30.csv"])?;
/// // ... the work ...
/// write_bytes(folder.claim("cases/theta30.csv")?, b"flux\n0.5\n")?;
/// write_json(folder.claim("summary.json")?, &0.5)?;
/// folder.finish(true)?;
/// assert!(place.path().join("out/manifest.json").exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ResultFolder {
    root: PathBuf,
    command: String,
    /// Inputs of the run, without links.
    inputs: BTreeSet<PathBuf>,
    files: Mutex<Files>,
}

/// The names of files by who wrote them.
#[derive(Debug, Default)]
struct Files {
    /// Listed by the manifest of an earlier run.
    earlier: BTreeSet<String>,
    /// Claimed or kept by this run.
    current: BTreeSet<String>,
    /// Whether the manifest on disk is that of this run.
    begun: bool,
}

impl Files {
    fn lists(&self, name: &str) -> bool {
        self.earlier.contains(name) || self.current.contains(name)
    }

    fn all(&self) -> BTreeSet<String> {
        self.earlier.union(&self.current).cloned().collect()
    }
}

impl ResultFolder {
    /// Opens the folder `path`, which need not exist, for a run of `command`.
    ///
    /// `inputs`: files that the run reads, which it must not replace or remove.
    ///
    /// # Errors
    /// [`ResultFolderError`] if the folder holds results of another command or results that its manifest
    /// does not list, or its manifest is invalid or cannot be read.
    pub fn open(
        path: impl AsRef<Path>,
        command: &str,
        inputs: &[&Path],
    ) -> Result<Self, ResultFolderError> {
        let root = path.as_ref().to_owned();
        let earlier = match Manifest::read(&root)? {
            None if has_unlisted_results(&root) => {
                return Err(unlisted_results(root));
            }
            None => BTreeSet::new(),
            Some(manifest) if manifest.command != command => {
                return Err(ResultFolderError::OtherCommand {
                    folder: root,
                    found: manifest.command,
                    command: command.to_owned(),
                });
            }
            Some(manifest) => manifest.files,
        };
        Ok(Self {
            root,
            command: command.to_owned(),
            inputs: inputs
                .iter()
                .filter_map(|input| fs::canonicalize(input).ok())
                .collect(),
            files: Mutex::new(Files {
                earlier,
                ..Files::default()
            }),
        })
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.root
    }

    /// Checks, without leaving a trace, that files of these names can be written; removes what killed runs have left
    /// of incomplete files.
    ///
    /// # Errors
    /// [`ResultFolderError`] if something is in the way of one of them, one is an input, or the folder
    /// can neither be made nor written to.
    ///
    /// # Panics
    /// If a name is not a relative path inside the folder.
    pub fn check(
        &self,
        names: impl IntoIterator<Item = impl AsRef<str>>,
    ) -> Result<(), ResultFolderError> {
        check_output_folder(&self.root)?;
        let files = self.files();
        self.sweep(&files);
        names
            .into_iter()
            .try_for_each(|name| self.refuse_unlisted(&files, checked(name.as_ref())))
    }

    /// Lists `name` as a file of this run and returns the path to write it to, whose folder exists.
    ///
    /// The file is to be written by one of the functions that write aside and rename, such as
    /// [`write_bytes`](crate::write_bytes).
    ///
    /// # Errors
    /// As [`check`](Self::check), or if the manifest cannot be written.
    ///
    /// # Panics
    /// If `name` is not a relative path inside the folder.
    pub fn claim(&self, name: &str) -> Result<PathBuf, ResultFolderError> {
        self.claim_all([name])?;
        let path = self.root.join(name);
        if let Some(folder) = path.parent() {
            create_output_folder(folder)?;
        }
        Ok(path)
    }

    /// Lists several names at once, which writes the manifest once instead of once per name.
    ///
    /// # Errors
    /// As [`claim`](Self::claim).
    ///
    /// # Panics
    /// As [`claim`](Self::claim).
    pub fn claim_all<'a>(
        &self,
        names: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ResultFolderError> {
        let mut files = self.files();
        let mut is_listed = files.begun;
        let mut claimed = Vec::new();
        for name in names {
            self.refuse_unlisted(&files, checked(name))?;
            is_listed &= files.lists(name);
            claimed.push(name.to_owned());
        }
        if !files.begun {
            create_output_folder(&self.root)?;
            self.sweep(&files);
        }
        files.current.extend(claimed);
        if !is_listed {
            Manifest::new(&self.command, false, files.all()).write(&self.root)?;
            files.begun = true;
        }
        Ok(())
    }

    /// Keeps a file of an earlier run, such as a checkpoint, as one of this run.
    ///
    /// A file that is not listed remains the user's.
    pub fn keep(&self, name: &str) {
        let mut files = self.files();
        if files.earlier.contains(name) {
            files.current.insert(name.to_owned());
        }
    }

    /// Removes a listed file now, such as a checkpoint that has served; does nothing if it is not
    /// listed or does not exist.
    ///
    /// # Errors
    /// [`WriteError`] if the operating system refuses.
    pub fn discard(&self, name: &str) -> Result<(), ResultFolderError> {
        let mut files = self.files();
        if files.lists(name) {
            self.remove(name)?;
            files.current.remove(name);
        }
        Ok(())
    }

    /// Ends the run: removes the files that only earlier runs wrote, and the folders that become empty
    /// by that, then writes the manifest. `is_complete`: whether all of the run is done, and not stopped by a time
    /// limit or an interrupt.
    ///
    /// Without this call, as after an error, everything stays, listed in an incomplete manifest.
    ///
    /// # Errors
    /// [`WriteError`] if a file cannot be removed or the manifest not written.
    pub fn finish(self, is_complete: bool) -> Result<(), ResultFolderError> {
        self.claim_all([])?;
        let files = self.files();
        for name in files.earlier.difference(&files.current) {
            self.remove(name)?;
        }
        let exists = |name: &&String| self.root.join(name).exists();
        let written = files.current.iter().filter(exists).cloned().collect();
        Manifest::new(&self.command, is_complete, written).write(&self.root)
    }

    fn files(&self) -> MutexGuard<'_, Files> {
        // A name is inserted in one step, so a panic of another thread leaves the lists whole.
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Refuses a name under which there is something that is not ours to replace.
    fn refuse_unlisted(&self, files: &Files, name: &str) -> Result<(), ResultFolderError> {
        let path = self.root.join(name);
        if let Some((obstacle, kind)) = self.linked_folder(name) {
            return Err(self.in_the_way(obstacle, kind));
        }
        let Ok(found) = fs::symlink_metadata(&path) else {
            return Ok(());
        };
        if self.is_input(&path) {
            return Err(ResultFolderError::Input { path });
        }
        if found.is_file() && files.lists(name) {
            return Ok(());
        }
        Err(self.in_the_way(path, kind_of(found.file_type())))
    }

    fn in_the_way(&self, path: PathBuf, kind: &'static str) -> ResultFolderError {
        ResultFolderError::InTheWay {
            path,
            kind,
            command: self.command.clone(),
        }
    }

    /// The first folder on the way to `name`, below the root, that exists and is not a real folder.
    fn linked_folder(&self, name: &str) -> Option<(PathBuf, &'static str)> {
        let mut path = self.root.clone();
        for part in Path::new(name).parent()?.components() {
            path.push(part);
            let found = fs::symlink_metadata(&path).ok()?.file_type();
            if !found.is_dir() {
                return Some((path, kind_of(found)));
            }
        }
        None
    }

    fn is_input(&self, path: &Path) -> bool {
        fs::canonicalize(path).is_ok_and(|path| self.inputs.contains(&path))
    }

    /// Removes a listed file unless it is an input or has been replaced by something else, then the
    /// folders above it that are empty.
    fn remove(&self, name: &str) -> Result<(), ResultFolderError> {
        let path = self.root.join(name);
        let is_file = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file());
        if !is_file || self.linked_folder(name).is_some() || self.is_input(&path) {
            return Ok(());
        }
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(WriteError::io(&path)(error).into());
            }
            _ => {}
        }
        let mut folders = path.ancestors().skip(1);
        // A folder that is not empty refuses to be removed.
        while folders
            .next()
            .is_some_and(|folder| folder != self.root && fs::remove_dir(folder).is_ok())
        {}
        Ok(())
    }

    /// Removes what killed runs have left of incomplete files.
    fn sweep(&self, files: &Files) {
        let folders: BTreeSet<PathBuf> = files
            .earlier
            .iter()
            .filter(|name| self.linked_folder(name).is_none())
            .filter_map(|name| Some(self.root.join(name).parent()?.to_owned()))
            .chain([self.root.clone()])
            .collect();
        for folder in folders {
            remove_stale_parts(&folder);
        }
    }
}

fn kind_of(found: fs::FileType) -> &'static str {
    if found.is_dir() {
        "folder"
    } else if found.is_symlink() {
        "symbolic link"
    } else {
        "file"
    }
}

fn checked(name: &str) -> &str {
    assert!(
        is_inside(name),
        "`{name}` is not a name inside a result folder"
    );
    name
}

/// Why a folder with results and without a manifest is refused: they may be a part of those in a folder above.
fn unlisted_results(folder: PathBuf) -> ResultFolderError {
    let path = fs::canonicalize(&folder).unwrap_or_else(|_| folder.clone());
    for above in path.ancestors().skip(1) {
        let inside = path.strip_prefix(above).unwrap_or(&path);
        if let Ok(Some(manifest)) = Manifest::read(above)
            && manifest
                .files
                .iter()
                .any(|name| Path::new(name).starts_with(inside))
        {
            return ResultFolderError::PartOfResults {
                folder,
                found: manifest.command,
                results: above.to_owned(),
            };
        }
    }
    ResultFolderError::NoManifest { folder }
}

/// Whether `folder` holds a `summary.json` of this program.
fn has_unlisted_results(folder: &Path) -> bool {
    let Ok(summary) = read_json::<Value>(folder.join("summary.json")) else {
        return false;
    };
    let has = |key: &str, is: fn(&Value) -> bool| summary.get(key).is_some_and(is);
    has("schema", Value::is_u64)
        && has("command", Value::is_string)
        && has("version", Value::is_string)
}
