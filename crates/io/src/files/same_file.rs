//! Same file: two paths that name one file.

use std::path::{Path, PathBuf};

/// `true` if both paths name one file, which need not exist.
#[must_use]
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || resolved(a).is_some_and(|file| Some(file) == resolved(b))
}

/// The file without links, or the name that a new one has in its folder; `None` if there is no such folder.
fn resolved(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let path = std::path::absolute(path).ok()?;
        let folder = path.parent()?.canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    })
}
