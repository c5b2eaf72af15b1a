//! Folder lock: one run at a time writes into a folder, the folders inside, and those above.
//!
//! The folder itself is locked, so that no file is left: for writing, and each folder above it for reading. The system
//! releases the locks when the process ends, however it ends. Where folders cannot be locked (on Windows, and on some network
//! file systems), runs are not kept apart.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use super::folder::{check_output_folder, create_output_folder, exists};
use super::made_folders::MadeFolders;
use super::same_file::same_inode;
use crate::error::ResultFolderError;

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
    /// [`ResultFolderError`] if a run writes into it, inside or above it, or it can neither be made nor written to.
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
        let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !exists(folder);
        let missing = path.ancestors().take_while(is_missing);
        let mut made: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        made.reverse();
        let lock = Self {
            locked: Vec::new(),
            _made: MadeFolders::new(made),
        };
        create_output_folder(path)?;
        Ok(lock)
    }

    /// Returns `false` if the folder was removed before it was locked, by the run that had made it.
    fn lock(&mut self, path: &Path) -> Result<bool, ResultFolderError> {
        let Ok(whole) = fs::canonicalize(path) else {
            return Ok(false);
        };
        for (level, folder) in whole.ancestors().enumerate() {
            // A folder that lets no one look inside cannot be locked.
            let Ok(open) = File::open(folder) else {
                continue;
            };
            let locked = match level {
                0 => open.try_lock(),
                _ => open.try_lock_shared(),
            };
            if matches!(locked, Err(TryLockError::WouldBlock)) {
                return Err(in_use(if level == 0 { path } else { folder }));
            }
            if level == 0 && !same_inode(open.metadata().ok(), fs::metadata(folder).ok()) {
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

    #[test]
    fn a_folder_is_locked_by_whatever_name_with_those_inside_and_above() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let first = FolderLock::new(at("out/cells")).unwrap();
        std::os::unix::fs::symlink(at("out/cells"), at("link")).unwrap();
        for name in [
            "out/cells",
            "link",
            "out/../out/cells/.",
            "out",
            "out/cells/a",
        ] {
            let refused = FolderLock::new(at(name)).unwrap_err().to_string();
            assert!(refused.contains("another run"), "{name}: {refused}");
        }
        drop(FolderLock::new(at("out/others")).unwrap());
        assert!(!exists(at("out/others")) && exists(at("out/cells")));
        drop(first);
        assert!(!exists(at("out")));
        drop(FolderLock::new(at("out")).unwrap());
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
