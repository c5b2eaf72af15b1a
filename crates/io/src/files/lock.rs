//! Folder lock: one run at a time writes into a folder.
//!
//! The folder itself is locked, so that no file is left: for writing. Where results in it belong to those of a folder above, as
//! its manifest tells, that one is locked for reading, so that no run replaces them in the meantime. The system releases the locks
//! when the process ends, however it ends. Where folders cannot be locked (on Windows, and on some network file systems), runs are not
//! kept apart.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;

use super::folder::{check_output_folder, create_output_folder};
use super::made_folders::MadeFolders;
use super::manifest::Manifest;
use super::same_file::same_inode;
use crate::error::{ResultFolderError, WriteProblem};

/// Times that a folder is locked again which was replaced in the meantime.
const MAX_TRIES: u32 = 8;

/// Lock of a folder, held until it is dropped. A folder that it has made and that stayed empty is removed again.
#[derive(Debug)]
pub struct FolderLock {
    /// Open folders, whose locks end with them.
    locked: Vec<File>,
    // Dropped last
    _made: MadeFolders,
}

impl FolderLock {
    /// Locks the folder `path`, and creates it if it does not exist.
    ///
    /// # Errors
    /// [`ResultFolderError`] if a run writes into it, or replaces the results that it is a part of, or it can neither be made nor written to.
    pub fn new(path: impl AsRef<Path>) -> Result<Self, ResultFolderError> {
        let path = path.as_ref();
        check_output_folder(path)?;
        for _ in 0..MAX_TRIES {
            let mut lock = Self::of_made(path)?;
            if lock.lock(path)? {
                return Ok(lock);
            }
        }
        Err(in_use(path))
    }

    /// The lock before anything is locked: the folder is made.
    fn of_made(path: &Path) -> Result<Self, ResultFolderError> {
        let lock = Self {
            locked: Vec::new(),
            _made: MadeFolders::missing_of(path),
        };
        create_output_folder(path)?;
        Ok(lock)
    }

    /// Returns `false` if the folder was removed before it was locked, by the run that had made it.
    fn lock(&mut self, path: &Path) -> Result<bool, ResultFolderError> {
        let whole = match fs::canonicalize(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            whole => whole.map_err(|error| WriteProblem::Folder(error).at(path))?,
        };
        let above = Manifest::above(&whole).map(|(above, _)| above);
        let folders = [(whole.as_path(), true)].into_iter();
        for (folder, is_own) in folders.chain(above.map(|above| (above, false))) {
            // A folder that lets no one look inside cannot be locked.
            let Ok(open) = File::open(folder) else {
                continue;
            };
            let locked = match is_own {
                true => open.try_lock(),
                false => open.try_lock_shared(),
            };
            if matches!(locked, Err(TryLockError::WouldBlock)) {
                return Err(in_use(if is_own { path } else { folder }));
            }
            if is_own && !same_inode(open.metadata().ok(), fs::metadata(folder).ok()) {
                return Ok(false);
            }
            self.locked.push(open);
        }
        Ok(true)
    }
}

fn in_use(folder: &Path) -> ResultFolderError {
    ResultFolderError::InUse {
        folder: folder.to_owned(),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::files::folder::exists;

    #[test]
    fn a_folder_is_locked_by_whatever_name() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let first = FolderLock::new(at("out/cells")).unwrap();
        std::os::unix::fs::symlink(at("out/cells"), at("link")).unwrap();
        for name in ["out/cells", "link", "out/../out/cells/."] {
            let refused = FolderLock::new(at(name)).unwrap_err().to_string();
            assert!(refused.contains("another run"), "{name}: {refused}");
        }
        for name in ["out", ".", "out/others", "out/cells/deep"] {
            drop(FolderLock::new(at(name)).unwrap());
        }
        assert!(!exists(at("out/others")) && exists(at("out/cells")));
        drop(first);
        assert!(!exists(at("out")));
        drop(FolderLock::new(at("out")).unwrap());
    }

    #[test]
    fn a_folder_above_is_locked_only_if_results_inside_belong_to_it() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let mut whole = FolderLock::new(at("out")).unwrap();
        let listed = |name: &str| {
            let files = [(name.to_owned(), None)].into();
            Manifest::new("map", &[], true, files, None)
                .write(&at("out"))
                .unwrap();
        };
        listed("cells/deep/a.csv");
        fs::create_dir_all(at("out/cells/deep")).unwrap();
        for part in ["out/cells", "out/cells/deep"] {
            let refused = FolderLock::new(at(part)).unwrap_err().to_string();
            assert!(refused.contains("out` is being written"), "{refused}");
        }
        drop(FolderLock::new(at("out/mine")).unwrap());
        whole.locked.clear();
        let part = FolderLock::new(at("out/cells")).unwrap();
        assert!(FolderLock::new(at("out")).is_err());
        drop(part);
        FolderLock::new(at("out")).unwrap();
    }

    #[test]
    fn folders_that_were_there_or_hold_files_stay() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        fs::create_dir(at("mine")).unwrap();
        drop(FolderLock::new(at("mine")).unwrap());
        let lock = FolderLock::new(at("new/deep")).unwrap();
        fs::write(at("new/a.csv"), "a").unwrap();
        drop(lock);
        assert!(exists(at("mine")) && exists(at("new/a.csv")) && !exists(at("new/deep")));
    }
}
