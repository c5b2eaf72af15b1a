//! Made folders: those that this process has made for results, removed again where they stay empty.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The folders that were made, the outermost of each first.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn made() -> MutexGuard<'static, Vec<PathBuf>> {
    // A path is added in one step, so a panic of another thread leaves the list whole.
    MADE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Folders that are removed when dropped, where they are empty.
#[derive(Debug)]
pub(super) struct MadeFolders(Vec<PathBuf>);

impl MadeFolders {
    /// The folder `path` and those above it that do not exist, which are about to be made.
    pub(super) fn missing_of(path: &Path) -> Self {
        let is_missing = |folder: &&Path| {
            !folder.as_os_str().is_empty() && fs::symlink_metadata(folder).is_err()
        };
        let missing = path.ancestors().take_while(is_missing);
        let mut folders: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        folders.reverse();
        made().extend(folders.iter().cloned());
        Self(folders)
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        remove_empty(&self.0);
        made().retain(|folder| !self.0.contains(folder));
    }
}

/// Removes the folders that stayed empty of a process that exits at once. A list that is in use is left: the thread that calls this may
/// hold it.
pub(super) fn remove_made_folders() {
    if let Ok(folders) = MADE.try_lock() {
        remove_empty(&folders);
    }
}

/// Removes folders, each after those inside. A folder that is not empty refuses to be removed.
fn remove_empty(folders: &[PathBuf]) {
    for folder in folders.iter().rev() {
        let _ = fs::remove_dir(folder);
    }
}
