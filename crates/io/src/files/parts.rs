//! Temporary files: incomplete parts of files, and the removal of those that ended runs left.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tempfile::{Builder, NamedTempFile, TempDir};

/// How the names of temporary files and folders begin and end.
const PREFIX: &str = ".asperity-";
const SUFFIX: &str = ".part";

/// Age below which a temporary file is never stale: it may not be locked yet.
const MIN_AGE: Duration = Duration::from_secs(2);

/// The temporary files and folders of this process that exist.
static OWN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Locks the list. One is made, renamed or removed under this lock alone.
fn own() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    // A path is inserted in one step, so a panic of another thread leaves the list whole.
    OWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of this process, for a process that exits at once: from then on any thread that
/// makes, renames or drops one waits forever.
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
    let own = own();
    for path in own.iter() {
        let _ = match path.is_dir() {
            true => fs::remove_dir_all(path),
            false => fs::remove_file(path),
        };
    }
    std::mem::forget(own);
}

/// An entry of the list of temporary files, gone when dropped.
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        own().remove(&self.0);
    }
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
pub(super) struct TemporaryFolder {
    // Dropped before its entry
    folder: TempDir,
    _listed: Listed,
}

impl TemporaryFolder {
    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }
}

fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    builder
}

/// A temporary file in `folder` with the mode of an ordinary new file. Errors are those of the operating system,
/// without the name of the temporary file, which means nothing to users.
///
/// It is locked as long as it is open, which tells it from what a killed run has left.
pub(super) fn temporary_in(folder: &Path) -> io::Result<TemporaryFile> {
    let mut new = File::options();
    new.read(true).write(true).create_new(true);
    let mut own = own();
    let file = builder().make_in(folder, |path| new.open(path))?;
    own.insert(file.path().to_owned());
    drop(own);
    // Where the file system has no locks, stale parts stay.
    let _ = file.as_file().try_lock();
    Ok(TemporaryFile {
        listed: Listed(file.path().to_owned()),
        file,
    })
}

/// A temporary folder in `folder`.
pub(super) fn temporary_folder_in(folder: &Path) -> io::Result<TemporaryFolder> {
    // Refused in the words of the operating system alone
    drop(temporary_in(folder)?);
    let mut own = own();
    let folder = builder().tempdir_in(folder)?;
    own.insert(folder.path().to_owned());
    drop(own);
    Ok(TemporaryFolder {
        _listed: Listed(folder.path().to_owned()),
        folder,
    })
}

/// Removes the temporary files and folders in `folder` that no running process uses.
///
/// What cannot be removed stays: this is housekeeping, whose failure harms no result.
pub(crate) fn remove_stale_parts(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_part = name
            .to_str()
            .is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        let Ok(found) = entry.metadata() else {
            continue;
        };
        let age = found.modified().ok().and_then(|time| time.elapsed().ok());
        if !is_part || age.is_none_or(|age| age < MIN_AGE) {
            continue;
        }
        let path = entry.path();
        let _ = if found.is_dir() {
            fs::remove_dir_all(path)
        } else if found.is_file() && is_unlocked(&path) {
            fs::remove_file(path)
        } else {
            Ok(())
        };
    }
}

/// Whether no process holds the lock of a file.
fn is_unlocked(path: &Path) -> bool {
    // Locking for writing needs an open file that may be written on some systems.
    let file = File::options().read(true).write(true).open(path);
    file.is_ok_and(|file| file.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    fn make_old(file: &File) {
        let hour = Duration::from_secs(3600);
        file.set_modified(SystemTime::now() - hour).unwrap();
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
        for name in [".asperity-dead.part", ".asperity-mine", "asperity.part"] {
            make_old(&File::create(at(name)).unwrap());
        }
        fs::write(at(".asperity-young.part"), "x").unwrap();
        fs::create_dir(at(".asperity-stage.part")).unwrap();
        make_old(&File::open(at(".asperity-stage.part")).unwrap());
        let running = temporary_in(folder.path()).unwrap();
        make_old(running.as_file());

        remove_stale_parts(folder.path());
        assert!(running.path().exists());
        for (name, stays) in [
            (".asperity-dead.part", false),
            (".asperity-stage.part", false),
            (".asperity-young.part", true),
            (".asperity-mine", true),
            ("asperity.part", true),
        ] {
            assert_eq!(at(name).exists(), stays, "{name}");
        }
    }
}
