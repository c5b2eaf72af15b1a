//! Mounts: whether a folder lies on a file system that several machines share.

use std::fs;
use std::path::{Path, PathBuf};

/// File systems of networks and clusters, by the beginning of their names.
const NETWORK: [&str; 12] = [
    "nfs", "cifs", "smb", "lustre", "beegfs", "gpfs", "ceph", "gfs2", "ocfs2", "orangefs", "9p",
    "fuse.",
];

/// Returns `true` if the folder, which exists and is spelled without links, lies on a file system that several machines may share; `false`
/// where the system does not tell.
pub(super) fn is_on_network(folder: &Path) -> bool {
    let mounts = fs::read_to_string("/proc/self/mounts").unwrap_or_default();
    let kind = file_system_of(folder, &mounts);
    kind.is_some_and(|kind| NETWORK.iter().any(|name| kind.starts_with(name)))
}

/// Name of the file system of a folder by a list of mounts: device, place, file system and more in a line each.
fn file_system_of<'a>(folder: &Path, mounts: &'a str) -> Option<&'a str> {
    let mount = |line: &'a str| {
        let mut words = line.split(' ');
        let place = PathBuf::from(words.nth(1)?.replace("\\040", " "));
        let kind = words.next()?;
        folder
            .starts_with(&place)
            .then(|| (place.components().count(), kind))
    };
    // The last of several at one place is on top.
    let innermost = mounts
        .lines()
        .filter_map(mount)
        .max_by_key(|(depth, _)| *depth);
    innermost.map(|(_, kind)| kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_innermost_mount_has_the_folder() {
        let mounts = "/dev/vda / ext4 rw 0 0\nserver:/home /home nfs4 rw 0 0\n\
            tmpfs /home/me/fast tmpfs rw 0 0\nx /a\\040b lustre rw,flock 0 0\n\
            y /twice ext4 rw 0 0\nz /twice fuse.sshfs rw 0 0\n";
        for (folder, kind) in [
            ("/srv/out", "ext4"),
            ("/home/me/out", "nfs4"),
            ("/home/me/fast/out", "tmpfs"),
            ("/homes/out", "ext4"),
            ("/a b/out", "lustre"),
            ("/twice", "fuse.sshfs"),
        ] {
            assert_eq!(
                file_system_of(Path::new(folder), mounts),
                Some(kind),
                "{folder}"
            );
        }
        assert_eq!(file_system_of(Path::new("/"), ""), None);
    }
}
