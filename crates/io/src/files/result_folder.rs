//! Result folder: replaces only the files that an earlier run of the same command wrote.
//!
//! A file is *listed* if the manifest names it. The rules:
//! - What exists and is not listed belongs to the user. It is neither replaced nor removed, and a run
//!   that would write a file of that name is refused.
//! - Results are written aside, in a temporary folder inside, and put in place together at the end of the run. A listed
//!   file that the run did not write again is removed then. An input of the run is never touched.
//! - A listed file whose content is not what was written belongs to the user: runs are refused until it is moved or
//!   deleted. The manifest keeps a fingerprint of each result. Before new ones are put in place it lists these as well, so
//!   that after a kill at any moment each file has one of two known contents.
//! - Checkpoints have no fingerprint. One is listed before it is written.
//! - One run at a time uses a folder: it is locked ([`FolderLock`]).
//! - Symbolic links and folders are never listed files, and no listed file lies behind a link.

mod listed;
#[cfg(test)]
mod tests;
mod unlisted;

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use md5::{Digest, Md5};

use super::atomic::sync_folder;
use super::fingerprint::{Fingerprint, hex};
use super::folder::create_output_folder;
use super::lock::FolderLock;
use super::manifest::{ListedFiles, Manifest, is_inside};
use super::parts::{remove_stale_parts, temporary_folder_in};
use super::same_file::is_same_file;
use crate::error::{ResultFolderError, WriteError, WriteProblem};
use listed::{Files, Role};
use unlisted::{has_unlisted_results, unlisted_results};

/// A folder that takes the files of one run.
///
/// [`open`](Self::open) it and [`check`](Self::check) the names before the work begins,
/// [`claim`](Self::claim) the path of each file when it is written, and [`finish`](Self::finish) at the
/// end, which puts the results in place. Until the first claim nothing is created or changed but the folder itself, which is
/// removed if it stays empty. All methods but `finish` may be called from several threads.
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
    /// Command line without the name of the program; none of a library.
    arguments: Vec<String>,
    /// Inputs of the run that exist.
    inputs: Vec<PathBuf>,
    files: Mutex<Files>,
    // Dropped last, since a folder that is empty then is removed
    _lock: FolderLock,
}

impl ResultFolder {
    /// Locks and opens the folder `path`, which need not exist, for a run of `command`.
    ///
    /// `inputs`: files that the run reads, which it must not replace or remove.
    ///
    /// # Errors
    /// [`ResultFolderError`] if another run uses the folder, it holds results of another command or results that its manifest
    /// does not list, its manifest is invalid or cannot be read, or the folder can neither be made nor written to.
    pub fn open(
        path: impl AsRef<Path>,
        command: &str,
        inputs: &[&Path],
    ) -> Result<Self, ResultFolderError> {
        let root = path.as_ref().to_owned();
        let lock = FolderLock::new(&root)?;
        let (earlier, identity) = match Manifest::read(&root)? {
            None if has_unlisted_results(&root) => {
                return Err(unlisted_results(root));
            }
            None => (ListedFiles::new(), None),
            Some(manifest) if manifest.command != command => {
                let found = manifest.command;
                return Err(ResultFolderError::OtherResults {
                    folder: root,
                    holds: format!("results of `{found}`, which `{command}` does not replace"),
                });
            }
            Some(mut manifest) => {
                let identity = manifest.identity.take();
                (settled(&root, manifest)?, identity)
            }
        };
        Ok(Self {
            root,
            command: command.to_owned(),
            arguments: Vec::new(),
            inputs: inputs.iter().map(|input| (*input).to_owned()).collect(),
            files: Mutex::new(Files {
                earlier,
                earlier_identity: identity,
                ..Files::default()
            }),
            _lock: lock,
        })
    }

    /// Sets the command line, without the name of the program, which the manifest lists.
    #[must_use]
    pub fn with_arguments(mut self, arguments: Vec<String>) -> Self {
        self.arguments = arguments;
        self
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.root
    }

    /// Checks, without leaving a trace, that files of these names can be written, and that the files of earlier runs
    /// are as they were written; removes what killed runs have left of incomplete files.
    ///
    /// # Errors
    /// [`ResultFolderError`] if something is in the way of one of them, one is an input, or a file of an earlier run was
    /// changed.
    ///
    /// # Panics
    /// If a name is not a relative path inside the folder.
    pub fn check(
        &self,
        names: impl IntoIterator<Item = impl AsRef<str>>,
    ) -> Result<(), ResultFolderError> {
        let files = self.files();
        self.sweep(&files);
        names
            .into_iter()
            .try_for_each(|name| self.refuse_unlisted(&files, checked(name.as_ref())))?;
        let mut earlier = files.earlier.keys();
        earlier.try_for_each(|name| self.refuse_changed(&files, name))
    }

    /// Lists `name` as a file of this run and returns the path to write it to, whose folder exists: aside, until
    /// [`finish`](Self::finish) puts it in place.
    ///
    /// # Errors
    /// [`ResultFolderError`] for the reasons of [`check`](Self::check), or if no file can be made in the folder.
    ///
    /// # Panics
    /// If `name` is not a relative path inside the folder.
    pub fn claim(&self, name: &str) -> Result<PathBuf, ResultFolderError> {
        self.list(Role::Result, [name])?;
        let mut files = self.files();
        let staged = match &mut files.staged {
            Some(staged) => staged,
            none => {
                let made = temporary_folder_in(&self.root);
                none.insert(made.map_err(|error| WriteProblem::Folder(error).at(&self.root))?)
            }
        };
        let path = staged.path().join(name);
        drop(files);
        made_for(path)
    }

    /// Lists `name` as a file that later runs extend or replace, and whose content they check themselves. Returns the path
    /// to write it to, in its place: it is to be written by one of the functions that write aside and rename, such as
    /// [`write_bytes`](crate::write_bytes).
    ///
    /// # Errors
    /// [`ResultFolderError`] for the reasons of [`claim`](Self::claim).
    ///
    /// # Panics
    /// If a name is not a relative path inside the folder.
    pub fn claim_checkpoint(&self, name: &str) -> Result<PathBuf, ResultFolderError> {
        self.list(Role::Checkpoint, [name])?;
        made_for(self.root.join(name))
    }

    fn list<'a>(
        &self,
        role: Role,
        names: impl IntoIterator<Item = &'a str>,
    ) -> Result<(), ResultFolderError> {
        let mut files = self.files();
        let mut claimed = Vec::new();
        for name in names {
            self.refuse_unlisted(&files, checked(name))?;
            self.refuse_changed(&files, name)?;
            claimed.push((name.to_owned(), role));
        }
        if !files.begun {
            create_output_folder(&self.root)?;
            self.sweep(&files);
        }
        let listed = files.in_place();
        for (name, role) in claimed {
            files.current.entry(name).or_insert(role);
        }
        let in_place = files.in_place();
        // Results wait elsewhere: until one is in place, a folder without any needs no list.
        if in_place != listed || !files.begun && !in_place.is_empty() {
            let identity = files.identity_in_place();
            self.manifest(false, in_place, identity).write(&self.root)?;
        }
        files.begun = true;
        Ok(())
    }

    /// Keeps a file of an earlier run, such as a checkpoint, as one of this run.
    ///
    /// A file that is not listed remains the user's.
    pub fn keep(&self, name: &str) {
        let mut files = self.files();
        let role = match files.earlier.get(name) {
            None => return,
            Some(None) => Role::Checkpoint,
            Some(Some(_)) => Role::Result,
        };
        files.current.entry(name.to_owned()).or_insert(role);
    }

    /// Removes a listed file now, such as a checkpoint that has served; does nothing if it is not
    /// listed or does not exist.
    ///
    /// # Errors
    /// [`ResultFolderError`] if the operating system refuses.
    pub fn discard(&self, name: &str) -> Result<(), ResultFolderError> {
        let mut files = self.files();
        if files.lists(name) {
            self.remove_unchanged(&files, name)?;
            files.current.remove(name);
        }
        Ok(())
    }

    /// Takes over the files that an earlier run with these `settings` and inputs has finished, and returns the names of `names` that are
    /// among them. Such a run calls [`finish`](Self::finish) after each of its files. Those of other settings are replaced.
    ///
    /// # Errors
    /// [`ResultFolderError`] if an input cannot be read.
    pub fn resume(
        &self,
        settings: &str,
        names: &[String],
    ) -> Result<BTreeSet<String>, ResultFolderError> {
        let mut digest = Md5::new();
        digest.update(settings);
        for input in &self.inputs {
            digest.update(format!("{:?}", Fingerprint::of(input)?));
        }
        let mut files = self.files();
        files.identity = Some(hex(digest));
        let is_finished = |name: &&String| {
            files.identity_in_place().is_some()
                && files.earlier.get(*name).is_some_and(Option::is_some)
                && self.is_ours(name)
        };
        let finished: BTreeSet<String> = names.iter().filter(is_finished).cloned().collect();
        let kept = finished.iter().map(|name| (name.clone(), Role::Result));
        files.current.extend(kept);
        Ok(finished)
    }

    /// Ends the run, or a part of it: puts its results in place, removes the files that only earlier runs wrote, unless they were changed
    /// meanwhile, and the folders that become empty by that. `is_complete`: `false` if a time limit or an interrupt stopped the run.
    ///
    /// Without this call, as after an error, the results of the run are lost, and those of earlier runs and checkpoints stay.
    ///
    /// # Errors
    /// [`ResultFolderError`] for the reasons of [`claim`](Self::claim), or if a file cannot be read or removed, or the manifest
    /// not written.
    pub fn finish(&self, is_complete: bool) -> Result<(), ResultFolderError> {
        self.list(Role::Result, [])?;
        let mut files = self.files();
        let written = files.written();
        let mut replacing = ListedFiles::new();
        for (name, path) in &written {
            self.refuse_unlisted(&files, name)?;
            self.refuse_changed(&files, name)?;
            replacing.insert(name.clone(), Some(Fingerprint::of(path)?));
        }
        let in_place = files.in_place();
        let identity = files.identity_in_place();
        let mut manifest = self.manifest(false, in_place, identity);
        manifest.replacing = replacing;
        manifest.write(&self.root)?;
        let mut folders = BTreeSet::new();
        for (name, path) in written {
            let place = made_for(self.root.join(name))?;
            put_in_place(&path, &place).map_err(WriteError::io(&place))?;
            folders.extend(place.parent().map(Path::to_owned));
        }
        folders.iter().for_each(|folder| sync_folder(folder));
        files.staged = None;
        for name in files.only_earlier() {
            self.remove_unchanged(&files, name)?;
        }
        let mut all = manifest.files;
        all.extend(manifest.replacing);
        all.retain(|name, _| files.current.contains_key(name) && self.root.join(name).is_file());
        files.earlier_identity = files.identity.clone();
        files.earlier = all.clone();
        let identity = files.identity.as_ref();
        self.manifest(is_complete, all, identity).write(&self.root)
    }

    fn manifest(&self, complete: bool, files: ListedFiles, identity: Option<&String>) -> Manifest {
        Manifest::new(&self.command, &self.arguments, complete, files, identity)
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

    /// Refuses a file of an earlier run that was changed since.
    fn refuse_changed(&self, files: &Files, name: &str) -> Result<(), ResultFolderError> {
        match self.is_changed(files, name)? {
            true => Err(ResultFolderError::Changed {
                path: self.root.join(name),
                command: self.command.clone(),
            }),
            false => Ok(()),
        }
    }

    /// Returns `true` if a file that an earlier run wrote, and this one did not claim, was changed since.
    fn is_changed(&self, files: &Files, name: &str) -> Result<bool, ResultFolderError> {
        match files.fingerprint(name) {
            Some(fingerprint) if self.is_ours(name) => {
                Ok(!fingerprint.is_of(&self.root.join(name))?)
            }
            _ => Ok(false),
        }
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
        self.inputs.iter().any(|input| is_same_file(input, path))
    }

    /// Returns `true` if there is a file at the path of a listed one, neither behind a link nor an input.
    fn is_ours(&self, name: &str) -> bool {
        let path = self.root.join(name);
        let is_file = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file());
        is_file && self.linked_folder(name).is_none() && !self.is_input(&path)
    }

    /// Removes a listed file unless it is an input or has been replaced by something else, then the
    /// folders above it that are empty.
    fn remove_unchanged(&self, files: &Files, name: &str) -> Result<(), ResultFolderError> {
        if !self.is_ours(name) || self.is_changed(files, name)? {
            return Ok(());
        }
        let path = self.root.join(name);
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
            .keys()
            .filter(|name| self.linked_folder(name).is_none())
            .filter_map(|name| Some(self.root.join(name).parent()?.to_owned()))
            .chain([self.root.clone()])
            .collect();
        for folder in folders {
            remove_stale_parts(&folder);
        }
    }
}

/// The files that a manifest lists. A run that was killed while it put new ones in place has replaced some of the old.
fn settled(root: &Path, manifest: Manifest) -> Result<ListedFiles, ResultFolderError> {
    let mut files = manifest.files;
    for (name, new) in manifest.replacing {
        let path = root.join(&name);
        let is_new = match &new {
            Some(new) if path.is_file() => new.is_of(&path)?,
            _ => false,
        };
        if is_new || !files.contains_key(&name) {
            files.insert(name, new);
        }
    }
    Ok(files)
}

/// The path, once its folder is made.
fn made_for(path: PathBuf) -> Result<PathBuf, ResultFolderError> {
    if let Some(folder) = path.parent() {
        create_output_folder(folder)?;
    }
    Ok(path)
}

/// Moves a complete file to its place. One that it replaces leaves it its mode.
fn put_in_place(path: &Path, place: &Path) -> io::Result<()> {
    if let Ok(old) = fs::metadata(place) {
        fs::set_permissions(path, old.permissions())?;
    }
    fs::rename(path, place)
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
