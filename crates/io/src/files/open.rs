//! Opening of regular files.

use std::fs::File;
use std::path::Path;

use crate::error::ReadProblem;

/// Opens a regular file that is not empty; with its length in bytes.
pub(crate) fn open(path: &Path) -> Result<(File, u64), ReadProblem> {
    // Look before opening: to open a pipe without a writer would wait forever.
    let meta = std::fs::metadata(path)?;
    if meta.is_dir() {
        let found = "a folder; the name of a file is needed";
        return Err(ReadProblem::NotRegular(found));
    }
    if !meta.is_file() {
        let found = "a device, pipe or socket; only regular files are read";
        return Err(ReadProblem::NotRegular(found));
    }
    if meta.len() == 0 {
        return Err(ReadProblem::Empty);
    }
    Ok((File::open(path)?, meta.len()))
}
