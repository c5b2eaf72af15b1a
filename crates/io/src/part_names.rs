//! Names of temporary files and folders.

use std::path::{Component, Path, PathBuf};

/// Beginning and end of the names, with random letters and digits between.
pub(crate) const PREFIX: &str = ".asperity-";
pub(crate) const SUFFIX: &str = ".part";
pub(crate) const RANDOM_LENGTH: usize = 12;

/// Returns `true` if this program makes temporary files of that name.
pub(crate) fn is_part(name: &str) -> bool {
    let inner = name.strip_prefix(PREFIX);
    let random = inner.and_then(|inner| inner.strip_suffix(SUFFIX));
    random.is_some_and(|random| {
        random.len() == RANDOM_LENGTH && random.bytes().all(|b| b.is_ascii_alphanumeric())
    })
}

/// The path of a file as users know it: without a temporary folder in which it waits.
pub(crate) fn without_parts(path: &Path) -> PathBuf {
    let is_ours = |part: &Component<'_>| part.as_os_str().to_str().is_some_and(is_part);
    match path.components().any(|part| is_ours(&part)) {
        true => path.components().filter(|part| !is_ours(part)).collect(),
        false => path.to_owned(),
    }
}
