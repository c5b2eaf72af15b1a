//! Files that are either complete or not there.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::made_folders::MadeFolders;
use super::parts::{make_folders, remove_stale_parts, temporary_in};
use crate::error::{WriteError, WriteProblem};
use crate::shown::json_text;

/// Writes a file through `write`, aside in the same folder, and renames it once it is complete.
///
/// On any error, or a panic of `write`, an older file of that name is left as it was, and no
/// temporary one is left behind. A new file gets the mode 0666 less the umask, as any program
/// would give it; a file that is replaced keeps its mode; a symbolic link is followed. A device
/// or pipe (`/dev/stdout`) has no content to protect and is written straight.
///
/// # Errors
/// [`WriteError`] if `write` fails, `path` is a folder, its folder cannot be made or lets no file
/// in, or the disk is full.
pub fn write_atomically(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    replace(path, |out| Ok(write(out)?))
}

/// Writes `bytes` as the whole content of a file, as [`write_atomically`] does.
///
/// # Errors
/// [`WriteError`] for the reasons of [`write_atomically`].
pub fn write_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, |out| out.write_all(bytes))
}

/// Writes `value` as indented JSON with a final line break, as [`write_atomically`] does.
///
/// Numbers have as many digits as give the same double back; NaN and infinity become `null`.
///
/// # Errors
/// [`WriteProblem::Io`] if `value` cannot be expressed; otherwise for the reasons of [`write_atomically`].
pub fn write_json(
    path: impl AsRef<Path>,
    value: &(impl Serialize + ?Sized),
) -> Result<(), WriteError> {
    let path = path.as_ref();
    replace(path, |out| {
        let text = json_text(value).map_err(io::Error::from)?;
        Ok(writeln!(out, "{text}")?)
    })
}

/// [`write_atomically`] for writers that seek and have errors of their own.
pub(crate) fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), WriteProblem>,
) -> Result<(), WriteError> {
    replace_file(path, write).map_err(|problem| problem.at(path))
}

fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), WriteProblem>,
) -> Result<(), WriteProblem> {
    // A dangling link is itself replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let old = fs::metadata(&target).ok();
    if old.as_ref().is_some_and(fs::Metadata::is_dir) {
        return Err(WriteProblem::IsFolder);
    }
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        let device = fs::OpenOptions::new().write(true).open(&target)?;
        return fill(&device, write);
    }

    let folder = parent(&target);
    // Removed again if nothing is written
    let _made = MadeFolders::missing_of(&folder);
    if !folder.is_dir() {
        make_folders(&folder)?;
    }
    let temporary = temporary_in(&folder)?;
    fill(temporary.as_file(), write)?;
    if let Some(old) = old {
        fs::set_permissions(temporary.path(), old.permissions())?;
    }
    temporary.as_file().sync_all()?;
    temporary.persist(&target)?;
    sync_folder(&folder);
    Ok(())
}

/// Has the system write the names of new files in a folder to the disk. Not every file system can do that, and the files
/// themselves are safe already, so a refusal is no failure.
pub(super) fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

/// [`replace`] for a file that stands alone, outside of a result folder: also removes what killed runs
/// have left next to it.
pub(crate) fn replace_alone(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), WriteProblem>,
) -> Result<(), WriteError> {
    remove_stale_parts(&parent(path));
    replace(path, write)
}

/// Runs `write` through a buffer, then flushes that.
fn fill(
    file: &File,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), WriteProblem>,
) -> Result<(), WriteProblem> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    let written = write(&mut out);
    if let Err(error) = written {
        // The rest of the buffer belongs to a file that is given up.
        let _ = out.into_parts();
        return Err(error);
    }
    Ok(out.flush()?)
}

/// The folder of a file.
pub(super) fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}
