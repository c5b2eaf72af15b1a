//! Folder lock: one run at a time writes into a folder.
//!
//! The folder itself is locked, so that no file is left: for writing. Where results in it belong to those of a folder above, as
//! its manifest tells, that one is locked for reading, so that no run replaces them in the meantime. The system releases the locks
//! when the process ends, however it ends. On network file systems the lock of a folder holds on one machine alone; there a hidden file in
//! it is locked as well, which NFS and cluster file systems pass on to the others, and which is removed with the lock. Where neither can be
//! locked (on Windows, and on Lustre without `flock`), runs are not kept apart.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use super::folder::{check_output_folder, create_output_folder};
use super::made_folders::MadeFolders;
use super::manifest::Manifest;
use super::mounts::is_on_network;
use super::same_file::same_inode;
use crate::error::{ResultFolderError, WriteProblem};

/// Hidden file that is locked on network file systems.
const LOCK_FILE: &str = ".asperity.lock";

/// Times that a folder is locked again which was replaced in the meantime.
const MAX_TRIES: u32 = 8;

/// Lock of a folder, held until it is dropped. A folder that it has made and that stayed empty is removed again.
#[derive(Debug)]
pub struct FolderLock {
    /// The hidden file that is locked for writing, which is removed before its lock ends.
    file: Option<PathBuf>,
    /// Open folders and files, whose locks end with them.
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
            file: None,
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
            if is_on_network(folder) && !self.lock_file(folder, is_own)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Locks the hidden file of a folder, for writing if it is that of this run. Returns `false` if another run removed it before it was locked.
    fn lock_file(&mut self, folder: &Path, is_own: bool) -> Result<bool, ResultFolderError> {
        let path = folder.join(LOCK_FILE);
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        // A folder that lets no one write is locked by itself alone.
        let Ok(open) = options.open(&path) else {
            return Ok(true);
        };
        let locked = match is_own {
            true => open.try_lock(),
            false => open.try_lock_shared(),
        };
        if matches!(locked, Err(TryLockError::WouldBlock)) {
            return Err(in_use(folder));
        }
        if !same_inode(open.metadata().ok(), fs::metadata(&path).ok()) {
            return Ok(false);
        }
        if is_own {
            self.file = Some(path);
        }
        self.locked.push(open);
        Ok(true)
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if let Some(file) = &self.file {
            let _ = fs::remove_file(file);
        }
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

    /// As on a network file system, where the lock of a folder does not reach other machines.
    #[test]
    fn a_hidden_file_is_locked_and_removed_with_the_lock() {
        let place = tempfile::tempdir().unwrap();
        let out = place.path().join("out");
        fs::create_dir(&out).unwrap();
        let lock = || {
            let mut lock = FolderLock::of_made(&out)?;
            lock.lock_file(&out, true)
                .map(|is_locked| (lock, is_locked))
        };
        let (first, is_locked) = lock().unwrap();
        assert!(is_locked && exists(out.join(LOCK_FILE)));
        assert!(lock().unwrap_err().to_string().contains("another run"));
        let mut reader = FolderLock::of_made(&out).unwrap();
        assert!(reader.lock_file(&out, false).is_err());
        drop(first);
        assert!(!exists(out.join(LOCK_FILE)));
        // What a killed process has left is no lock, and those who read share it.
        fs::write(out.join(LOCK_FILE), "").unwrap();
        assert!(reader.lock_file(&out, false).unwrap());
        let mut other = FolderLock::of_made(&out).unwrap();
        assert!(other.lock_file(&out, false).unwrap() && lock().is_err());
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
