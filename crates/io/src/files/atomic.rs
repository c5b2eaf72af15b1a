//! Files that are either complete or not there.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Component, Path, PathBuf};

use serde::Serialize;

use crate::error::WriteError;

/// Writes a file through `write`, aside in the same folder, and renames it once it is complete.
///
/// On any error, or a panic of `write`, an older file of that name is left as it was, and no
/// temporary one is left behind. A new file gets the mode 0666 less the umask, as any program
/// would give it; a file that is replaced keeps its mode; a symbolic link is followed. A device
/// or pipe (`/dev/stdout`) has no content to protect and is written straight.
///
/// # Errors
/// [`WriteError`] if `write` fails, `path` is a folder, its folder does not exist or lets no file
/// in, or the disk is full.
pub fn write_atomically(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    replace(path, |out| write(out).map_err(WriteError::io(path)))
}

/// Writes `bytes` as the whole content of a file, as [`write_atomically`] does.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, |out| out.write_all(bytes))
}

/// Writes `value` as indented JSON with a final line break, as [`write_atomically`] does.
///
/// Numbers have as many digits as give the same double back; NaN and infinity become `null`.
///
/// # Errors
/// As [`write_atomically`], and [`WriteError::Json`] if `value` cannot be expressed.
pub fn write_json(
    path: impl AsRef<Path>,
    value: &(impl Serialize + ?Sized),
) -> Result<(), WriteError> {
    let path = path.as_ref();
    replace(path, |out| {
        serde_json::to_writer_pretty(&mut *out, value).map_err(|source| {
            if source.is_io() {
                WriteError::io(path)(source.into())
            } else {
                WriteError::Json {
                    path: path.to_owned(),
                    source,
                }
            }
        })?;
        out.write_all(b"\n").map_err(WriteError::io(path))
    })
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
/// nothing behind: a long run should not learn at its end that its results have no place, and one
/// that is refused should not leave an empty folder.
///
/// # Errors
/// As [`create_output_folder`].
pub fn check_output_folder(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    refuse_files(path)?;
    // What is there already, be it a link that leads nowhere, and what is to be made within it.
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
        let stage = tempfile::Builder::new()
            .prefix(TEMPORARY_PREFIX)
            .tempdir_in(place)?;
        // A way up again would lead out of the stage.
        let parts = missing.components();
        let down = parts.filter(|part| matches!(part, Component::Normal(_)));
        let rehearsed = stage.path().join(down.collect::<PathBuf>());
        fs::create_dir_all(&rehearsed)?;
        temporary_in(&rehearsed).map(drop)
    };
    rehearse().map_err(WriteError::folder(path))
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

/// Removes those files of `names` that are in `folder`: what an earlier run left and this one will not
/// replace.
///
/// # Errors
/// [`WriteError`] if a file is there and cannot be removed.
pub fn remove_files(folder: impl AsRef<Path>, names: &[&str]) -> Result<(), WriteError> {
    for name in names {
        let path = folder.as_ref().join(name);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(WriteError::io(&path)(error));
            }
            _ => {}
        }
    }
    Ok(())
}

/// [`write_atomically`] for writers that seek and have errors of their own.
pub(crate) fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let io = WriteError::io(path);
    // A link that leads nowhere is itself replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let old = fs::metadata(&target).ok();
    if old.as_ref().is_some_and(fs::Metadata::is_dir) {
        return Err(WriteError::IsFolder {
            path: path.to_owned(),
        });
    }
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        let device = fs::OpenOptions::new()
            .write(true)
            .open(&target)
            .map_err(&io)?;
        return fill(path, &device, write);
    }

    let folder = parent(&target);
    let temporary = temporary_in(&folder).map_err(|source| {
        if source.kind() == io::ErrorKind::NotFound {
            WriteError::NoFolder {
                path: path.to_owned(),
                folder: folder.clone(),
            }
        } else {
            io(source)
        }
    })?;
    fill(path, temporary.as_file(), write)?;
    if let Some(old) = old {
        fs::set_permissions(temporary.path(), old.permissions()).map_err(&io)?;
    }
    temporary.as_file().sync_all().map_err(&io)?;
    temporary.persist(&target).map_err(|e| io(e.error))?;
    // The new name lives in the folder. Not every file system can sync one, and the file itself
    // is safe already, so a refusal is no failure.
    if let Ok(folder) = File::open(&folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// Runs `write` through a buffer, then flushes that.
fn fill(
    path: &Path,
    file: &File,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    let written = write(&mut out);
    if let Err(error) = written {
        // What is left in the buffer belongs to a file that nobody will see.
        let _ = out.into_parts();
        return Err(error);
    }
    out.flush().map_err(WriteError::io(path))
}

fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// How the names of temporary files and folders begin.
const TEMPORARY_PREFIX: &str = ".asperity-";

/// A temporary file in `folder` with the mode of an ordinary new file, gone when dropped.
fn temporary_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY_PREFIX).suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Asked for at creation, hence reduced by the umask.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
