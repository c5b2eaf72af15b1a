//! Errors of reading and writing files.

mod read;
mod result_folder;
mod write;

use std::path::Path;

use crate::shown::shown_path;

pub use read::{ReadError, ReadProblem};
pub use result_folder::ResultFolderError;
pub use write::{WriteError, WriteProblem};

/// "the unknown ending `.foo`" or "no ending".
fn ending_found(path: &Path) -> String {
    match path.extension() {
        Some(ending) if ending == "toml" => "the ending `.toml` of a configuration".to_owned(),
        Some(ending) => format!("the unknown ending `.{}`", shown_path(ending.as_ref())),
        None => "no ending to tell its format".to_owned(),
    }
}
