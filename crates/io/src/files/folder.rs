//! Folders: makes, checks and lists them.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use super::atomic::parent;
use super::parts::{make_folders, remove_stale_parts, temporary_folder_in, temporary_in};
use crate::error::{WriteError, WriteProblem};

/// Returns `true` if anything exists under the name `path`, dangling links included.
#[must_use]
pub fn exists(path: impl AsRef<Path>) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// The names of the files and folders in `folder`, sorted; none if it does not exist or cannot be
/// read. Names that are not UTF-8 are left out.
#[must_use]
pub fn names_in(folder: impl AsRef<Path>) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    names.sort_unstable();
    names
}

/// Makes the folder `path` and those above it, unless it is there.
///
/// # Errors
/// [`WriteProblem::FolderIsFile`] if `path` or a part of it is a file, [`WriteProblem::Folder`] if the
/// operating system refuses.
pub fn create_output_folder(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    refuse_files(path)?;
    make_folders(path).map_err(|error| WriteProblem::Folder(error).at(path))
}

/// Checks that files can be made in the folder `path`, or that such a folder can be made, and leaves
/// nothing behind: a long run must not fail at its end because its results have no place, and a refused
/// run must not leave an empty folder. What killed runs have left there is removed.
///
/// # Errors
/// [`WriteError`] for the reasons of [`create_output_folder`].
pub fn check_output_folder(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    refuse_files(path)?;
    // The part that exists, even as a dangling link, and the part to be made within it.
    let is_there = |part: &&Path| fs::symlink_metadata(part).is_ok();
    let there = path.ancestors().find(is_there).unwrap_or(Path::new(""));
    let missing = path.strip_prefix(there).unwrap_or(path);
    let rehearse = || -> io::Result<()> {
        let place = if there.as_os_str().is_empty() {
            Path::new(".")
        } else {
            there
        };
        remove_stale_parts(place);
        if missing.as_os_str().is_empty() {
            return temporary_in(place).map(drop);
        }
        let stage = temporary_folder_in(place)?;
        // A way up again would lead out of the stage.
        let parts = missing.components();
        let down = parts.filter(|part| matches!(part, Component::Normal(_)));
        let rehearsed = stage.path().join(down.collect::<PathBuf>());
        make_folders(&rehearsed)?;
        temporary_in(&rehearsed).map(drop)
    };
    rehearse().map_err(|error| WriteProblem::Folder(error).at(path))
}

/// Checks, without leaving a trace, that the file `path` can be written, so that a long run does not fail at its
/// end; removes what killed runs have left in its folder.
///
/// # Errors
/// [`WriteError`] if `path` is a folder, or its folder cannot be made or lets no file in.
pub fn check_output_file(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    // A link is followed when the file is written.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let found = fs::metadata(&target);
    if target.as_os_str().is_empty() || found.as_ref().is_ok_and(fs::Metadata::is_dir) {
        return Err(WriteProblem::IsFolder.at(path));
    }
    if found.is_ok_and(|found| !found.is_file()) {
        // A device or pipe is written straight, and opened once.
        return Ok(());
    }
    let folder = parent(&target);
    if !folder.is_dir() {
        // It is made when the file is written.
        return check_output_folder(&folder);
    }
    remove_stale_parts(&folder);
    temporary_in(&folder)
        .map(drop)
        .map_err(WriteError::io(path))
}

/// Refuses a folder whose name, or that of a folder above it, belongs to a file.
fn refuse_files(path: &Path) -> Result<(), WriteError> {
    if let Some(file) = path
        .ancestors()
        .find(|part| fs::metadata(part).is_ok_and(|meta| !meta.is_dir()))
    {
        return Err(WriteProblem::FolderIsFile(file.to_owned()).at(path));
    }
    Ok(())
}
