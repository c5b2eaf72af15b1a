//! Unlisted results: results in a folder without a manifest.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::ResultFolderError;
use crate::files::manifest::Manifest;
use crate::files::text::read_json;
use crate::shown::shown_path;

/// The refusal of a folder with results and without a manifest: they may be a part of those in a folder above.
pub(super) fn unlisted_results(folder: PathBuf) -> ResultFolderError {
    let path = fs::canonicalize(&folder).unwrap_or_else(|_| folder.clone());
    if let Some((above, manifest)) = Manifest::above(&path) {
        let (found, results) = (manifest.command, shown_path(above));
        let holds = format!("a part of the results of `{found}` in `{results}`");
        return ResultFolderError::OtherResults { folder, holds };
    }
    let holds =
        "the summary.json of a run without the manifest.json that lists its files".to_owned();
    ResultFolderError::OtherResults { folder, holds }
}

/// Returns `true` if `folder` holds a `summary.json` of this program.
pub(super) fn has_unlisted_results(folder: &Path) -> bool {
    let Ok(summary) = read_json::<Value>(folder.join("summary.json")) else {
        return false;
    };
    let has = |key: &str, is: fn(&Value) -> bool| summary.get(key).is_some_and(is);
    has("schema", Value::is_u64)
        && has("command", Value::is_string)
        && has("version", Value::is_string)
}
