//! Folders: makes, checks and lists them.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use super::parts::{temporary_folder_in, temporary_in};
use crate::error::WriteError;

/// Whether anything exists under the name `path`, dangling links included.
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
/// [`WriteError::FolderIsFile`] if `path` or a part of it is a file, [`WriteError::Folder`] if the
/// operating system refuses.
pub fn create_output_folder(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    refuse_files(path)?;
    fs::create_dir_all(path).map_err(WriteError::folder(path))
}

/// Checks that files can be made in the folder `path`, or that such a folder can be made, and leaves
/// nothing behind: a long run must not fail at its end because its results have no place, and a refused
/// run must not leave an empty folder.
///
/// # Errors
/// As [`create_output_folder`].
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
        if missing.as_os_str().is_empty() {
            return temporary_in(place).map(drop);
        }
        let stage = temporary_folder_in(place)?;
        // A way up again would lead out of the stage.
        let parts = missing.components();
        let down = parts.filter(|part| matches!(part, Component::Normal(_)));
        let rehearsed = stage.path().join(down.collect::<PathBuf>());
        fs::create_dir_all(&rehearsed)?;
        temporary_in(&rehearsed).map(drop)
    };
    rehearse().map_err(WriteError::folder(path))
}

/// Checks that the folder of the file `path` exists.
///
/// # Errors
/// [`WriteError::NoFolder`] if it does not.
pub fn check_folder_of(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            Err(WriteError::NoFolder {
                path: path.to_owned(),
                folder: folder.to_owned(),
            })
        }
        _ => Ok(()),
    }
}

/// Refuses a folder whose name, or that of a folder above it, belongs to a file.
fn refuse_files(path: &Path) -> Result<(), WriteError> {
    if let Some(file) = path
        .ancestors()
        .find(|part| fs::metadata(part).is_ok_and(|meta| !meta.is_dir()))
    {
        return Err(WriteError::FolderIsFile {
            path: path.to_owned(),
            file: file.to_owned(),
        });
    }
    Ok(())
}
