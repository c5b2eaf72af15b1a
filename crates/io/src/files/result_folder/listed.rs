//! Listed files of a result folder, by the run that wrote them.

use std::collections::BTreeMap;

use crate::files::fingerprint::Fingerprint;
use crate::files::manifest::ListedFiles;

/// Purpose of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A result, which nothing changes once its run has ended.
    Result,
    /// A checkpoint, which later runs extend or replace.
    Checkpoint,
}

/// The names of files by who wrote them.
#[derive(Debug, Default)]
pub(super) struct Files {
    /// Listed by the manifest of an earlier run.
    pub(super) earlier: ListedFiles,
    /// Claimed or kept by this run.
    pub(super) current: BTreeMap<String, Role>,
    /// `true` if the manifest on disk is that of this run.
    pub(super) begun: bool,
}

impl Files {
    pub(super) fn lists(&self, name: &str) -> bool {
        self.earlier.contains_key(name) || self.current.contains_key(name)
    }

    /// The fingerprint of a file that an earlier run wrote and this one has not claimed.
    pub(super) fn fingerprint(&self, name: &str) -> Option<&Fingerprint> {
        match self.current.contains_key(name) {
            true => None,
            false => self.earlier.get(name)?.as_ref(),
        }
    }

    /// Returns `true` if the manifest lists a file as one that may be written at any time.
    pub(super) fn lists_without_fingerprint(&self, name: &str) -> bool {
        self.lists(name) && self.fingerprint(name).is_none()
    }

    /// Files that this run has neither claimed nor kept.
    pub(super) fn only_earlier(&self) -> impl Iterator<Item = &String> {
        let names = self.earlier.keys();
        names.filter(|name| !self.current.contains_key(*name))
    }

    /// All files, without fingerprints where this run may write them.
    pub(super) fn all(&self) -> ListedFiles {
        let mut all = self.earlier.clone();
        all.extend(self.current.keys().map(|name| (name.clone(), None)));
        all
    }
}
