//! Place: the folder of one case within a result folder, or the result folder itself.

use std::path::PathBuf;

use asperity_io::{ResultFolder, ResultFolderError};

/// Folder of the files of a case.
#[derive(Clone, Debug)]
pub(crate) struct Place<'a> {
    folder: &'a ResultFolder,
    /// Path of the case within the folder, with a slash at its end; empty for the folder itself.
    within: String,
}

impl<'a> Place<'a> {
    /// The result folder itself.
    pub(crate) const fn root(folder: &'a ResultFolder) -> Self {
        Self {
            folder,
            within: String::new(),
        }
    }

    /// The folder `name` within this one, where `name` ends with a slash or is empty.
    pub(crate) fn join(&self, name: &str) -> Self {
        Self {
            folder: self.folder,
            within: format!("{}{name}", self.within),
        }
    }

    /// Lists a file of this place as one of the run, and returns the path to write it to.
    pub(crate) fn claim(&self, name: &str) -> Result<PathBuf, ResultFolderError> {
        self.folder.claim(&format!("{}{name}", self.within))
    }
}

/// Names of the files of one figure.
pub(crate) fn figure_files(name: &str) -> [String; 2] {
    ["svg", "png"].map(|ending| format!("{name}.{ending}"))
}
