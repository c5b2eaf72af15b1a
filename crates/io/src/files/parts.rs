//! Temporary files: incomplete parts of files, and the removal of those that ended runs left.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::Duration;

use tempfile::{Builder, NamedTempFile};

use super::made_folders::remove_made_folders;
use crate::part_names::{PREFIX, RANDOM_LENGTH, SUFFIX, is_part};

/// Name of the file in a temporary folder that is locked as long as the folder is used.
const LOCK: &str = ".asperity-lock";

/// Age below which a temporary file is never stale: it may not be locked yet.
const MIN_AGE: Duration = Duration::from_secs(2);

/// Least age of a folder without a file to lock, on whatever clock its disk has.
const MIN_AGE_WITHOUT_LOCK: Duration = Duration::from_secs(24 * 3600);

/// Time between two tries to lock the list of temporary files.
const MOMENT: Duration = Duration::from_millis(10);

/// The temporary files and folders of this process that exist.
static OWN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Locks the list. Temporary files and folders, and folders inside those, are made, renamed and removed under this lock alone.
fn own() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    // A path is inserted in one step, so a panic of another thread leaves the list whole.
    OWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of this process, and the folders that it has made and left empty, for a process that exits at once: from then on any thread that
/// makes, renames or drops one, or makes a folder, waits forever.
///
/// Files that were renamed are complete and stay. What cannot be removed stays too, for a later run to remove.
///
/// # Examples
/// ```no_run
/// // In the handler of a signal that ends the program
/// asperity_io::remove_temporary_files();
/// std::process::exit(130);
/// ```
pub fn remove_temporary_files() {
    // The thread that calls this may hold the list itself, where it is out of memory.
    let mut tries = 0..500;
    let own = loop {
        match OWN.try_lock() {
            Ok(own) => break own,
            Err(TryLockError::Poisoned(own)) => break own.into_inner(),
            Err(TryLockError::WouldBlock) if tries.next().is_some() => sleep(MOMENT),
            Err(TryLockError::WouldBlock) => return,
        }
    };
    for path in own.iter() {
        let _ = match path.is_dir() {
            true => fs::remove_dir_all(path),
            false => fs::remove_file(path),
        };
    }
    remove_made_folders();
    std::mem::forget(own);
}

/// An entry of the list of temporary files, gone when dropped.
#[derive(Debug)]
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        let mut own = own();
        if self.0.is_dir() {
            let _ = fs::remove_dir_all(&self.0);
        }
        own.remove(&self.0);
    }
}

/// Makes the folder `path` and those above it, which may be inside of a temporary folder: one that was removed as the program ends is not made again.
pub(super) fn make_folders(path: &Path) -> io::Result<()> {
    let _own = own();
    fs::create_dir_all(path)
}

/// A temporary file, gone when dropped.
pub(super) struct TemporaryFile {
    // Dropped before its entry
    file: NamedTempFile,
    listed: Listed,
}

impl TemporaryFile {
    pub(super) fn path(&self) -> &Path {
        self.file.path()
    }

    pub(super) fn as_file(&self) -> &File {
        self.file.as_file()
    }

    /// Gives the file its name, in place of an older one.
    pub(super) fn persist(self, name: &Path) -> io::Result<()> {
        let Self { file, listed } = self;
        let own = own();
        let persisted = file.persist(name);
        drop(own);
        drop(listed);
        persisted.map(drop).map_err(|error| error.error)
    }
}

/// A temporary folder, gone with its content when dropped.
#[derive(Debug)]
pub(super) struct TemporaryFolder {
    // Dropped before the folder, since some systems remove no open files
    _lock: File,
    listed: Listed,
}

impl TemporaryFolder {
    pub(super) fn path(&self) -> &Path {
        &self.listed.0
    }
}

fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    builder.rand_bytes(RANDOM_LENGTH);
    builder
}

/// A temporary file in `folder` with the mode of an ordinary new file. Errors are those of the operating system,
/// without the name of the temporary file, which means nothing to users.
///
/// It is locked as long as it is open, which tells it from what a killed run has left.
pub(super) fn temporary_in(folder: &Path) -> io::Result<TemporaryFile> {
    let mut own = own();
    let file = builder().make_in(folder, new_file)?;
    own.insert(file.path().to_owned());
    drop(own);
    // Where the file system has no locks, stale parts stay.
    let _ = file.as_file().try_lock();
    Ok(TemporaryFile {
        listed: Listed(file.path().to_owned()),
        file,
    })
}

fn new_file(path: &Path) -> io::Result<File> {
    let mut new = File::options();
    new.read(true).write(true).create_new(true).open(path)
}

/// A temporary folder in `folder`, with a locked file inside.
pub(super) fn temporary_folder_in(folder: &Path) -> io::Result<TemporaryFolder> {
    // Refused in the words of the operating system alone
    drop(temporary_in(folder)?);
    let mut own = own();
    let folder = builder().tempdir_in(folder)?;
    let lock = new_file(&folder.path().join(LOCK))?;
    let path = folder.keep();
    own.insert(path.clone());
    drop(own);
    let _ = lock.try_lock();
    Ok(TemporaryFolder {
        _lock: lock,
        listed: Listed(path),
    })
}

/// Removes the temporary files and folders in `folder` that no running process uses.
///
/// A file that cannot be removed stays: this is housekeeping, whose failure harms no result.
pub(crate) fn remove_stale_parts(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        if !name.to_str().is_some_and(is_part) {
            continue;
        }
        let Ok(kind) = entry.file_type() else {
            continue;
        };
        let path = entry.path();
        let _ = if kind.is_dir() && is_stale_folder(&path) {
            fs::remove_dir_all(path)
        } else if kind.is_file() && is_stale_file(&path) {
            fs::remove_file(path)
        } else {
            Ok(())
        };
    }
}

fn is_stale_file(path: &Path) -> bool {
    is_older(path, MIN_AGE) && is_unlocked(path)
}

/// The folder of a process that was killed before it made the file to lock has to be old.
fn is_stale_folder(path: &Path) -> bool {
    let lock = path.join(LOCK);
    match fs::symlink_metadata(&lock) {
        Ok(found) => found.is_file() && is_stale_file(&lock),
        Err(_) => is_older(path, MIN_AGE_WITHOUT_LOCK),
    }
}

fn is_older(path: &Path, least: Duration) -> bool {
    let modified = fs::symlink_metadata(path).and_then(|found| found.modified());
    let age = modified.ok().and_then(|time| time.elapsed().ok());
    age.is_some_and(|age| age >= least)
}

/// Returns `true` if no process holds the lock of a file.
fn is_unlocked(path: &Path) -> bool {
    // Locking for writing needs an open file that may be written on some systems.
    let file = File::options().read(true).write(true).open(path);
    file.is_ok_and(|file| file.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    const HOUR: Duration = Duration::from_secs(3600);

    fn make_old(file: &File, age: Duration) {
        file.set_modified(SystemTime::now() - age).unwrap();
    }

    #[test]
    fn refusals_do_not_name_temporary_files() {
        let missing = Path::new("no/such/folder");
        let errors = [
            temporary_in(missing).err(),
            temporary_folder_in(missing).err(),
        ];
        for error in errors.map(Option::unwrap) {
            assert_eq!(error.kind(), io::ErrorKind::NotFound);
            assert!(!error.to_string().contains(PREFIX), "{error}");
        }
    }

    #[test]
    fn parts_of_dead_runs_are_removed_and_all_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let [dead, young] = [".asperity-0123456789ab.part", ".asperity-0123456789ac.part"];
        let others = [
            ".asperity-mine",
            "asperity.part",
            ".asperity-d.part",
            ".asperity-0123456789abc.part",
            ".asperity-01234 6789ab.part",
        ];
        for name in [dead].iter().chain(&others) {
            make_old(&File::create(at(name)).unwrap(), 48 * HOUR);
        }
        fs::write(at(young), "x").unwrap();
        let running = temporary_in(folder.path()).unwrap();
        make_old(running.as_file(), 48 * HOUR);

        remove_stale_parts(folder.path());
        assert!(running.path().exists());
        assert!(!at(dead).exists());
        for name in [young].iter().chain(&others) {
            assert!(at(name).exists(), "{name}");
        }
    }

    #[test]
    fn temporary_folders_are_removed_once_no_process_holds_their_lock() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let make = |name: &str, age| {
            fs::create_dir(at(name)).unwrap();
            make_old(&File::open(at(name)).unwrap(), age);
        };
        let [dead, killed_early, recent] = [
            ".asperity-0123456789ab.part",
            ".asperity-0123456789ac.part",
            ".asperity-0123456789ad.part",
        ];
        // The folder of a user
        make(".asperity-d.part", 48 * HOUR);
        make(killed_early, 48 * HOUR);
        make(recent, HOUR);
        make(dead, HOUR);
        make_old(&new_file(&at(dead).join(LOCK)).unwrap(), HOUR);
        let running = temporary_folder_in(folder.path()).unwrap();
        let lock = File::options().write(true).open(running.path().join(LOCK));
        make_old(&lock.unwrap(), 48 * HOUR);

        remove_stale_parts(folder.path());
        assert!(running.path().exists());
        for (name, stays) in [
            (".asperity-d.part", true),
            (killed_early, false),
            (recent, true),
            (dead, false),
        ] {
            assert_eq!(at(name).exists(), stays, "{name}");
        }
        let own = running.path().to_owned();
        drop(running);
        assert!(!own.exists());
    }
}
