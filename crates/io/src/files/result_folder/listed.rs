//! Listed files of a result folder, by the run that wrote them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::files::fingerprint::Fingerprint;
use crate::files::manifest::ListedFiles;
use crate::files::parts::TemporaryFolder;

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
    /// Identity of that run, if it can be resumed.
    pub(super) earlier_identity: Option<String>,
    /// Identity of this run, if it can be resumed.
    pub(super) identity: Option<String>,
    /// Claimed or kept by this run.
    pub(super) current: BTreeMap<String, Role>,
    /// Results of this run, until all of them are put in place.
    pub(super) staged: Option<TemporaryFolder>,
    /// `true` if the manifest on disk is that of this run.
    pub(super) begun: bool,
}

impl Files {
    pub(super) fn lists(&self, name: &str) -> bool {
        self.earlier.contains_key(name) || self.current.contains_key(name)
    }

    /// The fingerprint of a file that an earlier run wrote; `None` of a checkpoint, or where it is not known.
    pub(super) fn fingerprint(&self, name: &str) -> Option<&Fingerprint> {
        match self.current.get(name) {
            Some(Role::Checkpoint) => None,
            _ => self.earlier.get(name)?.as_ref(),
        }
    }

    /// Identity of the files in place before this run has put its own there: none where these are of another run.
    pub(super) fn identity_in_place(&self) -> Option<&String> {
        let earlier = self.earlier_identity.as_ref();
        earlier.filter(|_| self.earlier_identity == self.identity)
    }

    /// Files that this run has neither claimed nor kept.
    pub(super) fn only_earlier(&self) -> impl Iterator<Item = &String> {
        let names = self.earlier.keys();
        names.filter(|name| !self.current.contains_key(*name))
    }

    /// The files that are in place while this run goes on: those of earlier runs, and its checkpoints.
    pub(super) fn in_place(&self) -> ListedFiles {
        let mut all = self.earlier.clone();
        let claimed = self.current.iter();
        let checkpoints = claimed.filter(|(_, role)| **role == Role::Checkpoint);
        all.extend(checkpoints.map(|(name, _)| (name.clone(), None)));
        all
    }

    /// The results that this run has written, with the paths at which they wait.
    pub(super) fn written(&self) -> Vec<(String, PathBuf)> {
        let Some(staged) = &self.staged else {
            return Vec::new();
        };
        let paths = self.current.keys();
        let paths = paths.map(|name| (name.clone(), staged.path().join(name)));
        paths.filter(|(_, path)| path.is_file()).collect()
    }
}
