//! Opening of regular files.

use std::fs::File;
use std::path::Path;

use crate::error::ReadError;

/// Opens a regular file that is not empty; with its length in bytes.
pub(crate) fn open(path: &Path) -> Result<(File, u64), ReadError> {
    // Look before opening: to open a pipe without a writer would wait forever.
    let meta = std::fs::metadata(path).map_err(|e| ReadError::io(path, e))?;
    let path_buf = || path.to_owned();
    if meta.is_dir() {
        return Err(ReadError::Folder { path: path_buf() });
    }
    if !meta.is_file() {
        return Err(ReadError::NotRegular { path: path_buf() });
    }
    if meta.len() == 0 {
        return Err(ReadError::Empty { path: path_buf() });
    }
    let file = File::open(path).map_err(|e| ReadError::io(path, e))?;
    Ok((file, meta.len()))
}
