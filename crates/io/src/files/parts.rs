//! Temporary files: incomplete parts of files, and the removal of those that killed runs left.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::time::Duration;

/// How the names of temporary files and folders begin and end.
const PREFIX: &str = ".asperity-";
const SUFFIX: &str = ".part";

/// Age below which a temporary file is never stale: it may not be locked yet.
const MIN_AGE: Duration = Duration::from_secs(2);

/// A temporary file in `folder` with the mode of an ordinary new file, gone when dropped.
///
/// It is locked as long as it is open, which tells it from what a killed run has left.
pub(super) fn temporary_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Set at creation, hence reduced by the umask.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder)?;
    // Where the file system has no locks, stale parts stay.
    let _ = file.as_file().try_lock();
    Ok(file)
}

/// A temporary folder in `folder`, gone with its content when dropped.
pub(super) fn temporary_folder_in(folder: &Path) -> io::Result<tempfile::TempDir> {
    tempfile::Builder::new()
        .prefix(PREFIX)
        .suffix(SUFFIX)
        .tempdir_in(folder)
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
