//! Same file: two paths that name one file.

use std::fs::Metadata;
use std::path::{Path, PathBuf};

/// `true` if both paths name one file, which need not exist: by links, hard ones included, or other spellings.
#[must_use]
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b
        || resolved(a).is_some_and(|file| Some(file) == resolved(b))
        || same_inode(a.metadata().ok(), b.metadata().ok())
}

/// `true` if both are of one file or folder of the file system, where the system tells.
#[cfg(unix)]
pub(super) fn same_inode(a: Option<Metadata>, b: Option<Metadata>) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |found: Metadata| [found.dev(), found.ino()];
    a.zip(b).is_some_and(|(a, b)| identity(a) == identity(b))
}

#[cfg(not(unix))]
pub(super) fn same_inode(_: Option<Metadata>, _: Option<Metadata>) -> bool {
    false
}

/// The file without links, or the name that a new one has in its folder; `None` if there is no such folder.
fn resolved(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let path = std::path::absolute(path).ok()?;
        let folder = path.parent()?.canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    })
}

#[cfg(all(test, unix))]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn links_and_other_spellings_are_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a.npy"), "1").unwrap();
        fs::write(at("b.npy"), "1").unwrap();
        fs::create_dir(at("sub")).unwrap();
        fs::hard_link(at("a.npy"), at("hard.npy")).unwrap();
        std::os::unix::fs::symlink("a.npy", at("soft.npy")).unwrap();
        std::os::unix::fs::symlink(".", at("dir")).unwrap();
        for same in [
            "a.npy",
            "./a.npy",
            "sub/../a.npy",
            "hard.npy",
            "soft.npy",
            "dir/a.npy",
        ] {
            assert!(is_same_file(&at("a.npy"), &at(same)), "{same}");
        }
        for other in ["b.npy", "none.npy", "sub"] {
            assert!(!is_same_file(&at("a.npy"), &at(other)), "{other}");
        }
        assert!(is_same_file(&at("new.npy"), &at("sub/../new.npy")));
    }
}
