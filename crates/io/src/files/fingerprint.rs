//! Fingerprint: tells whether a file still has the content that was written.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use md5::{Digest, Md5};
use serde::{Deserialize, Serialize};

use crate::error::ReadError;

/// Length and MD5 of the content of a file. MD5 notices every accident; it is no protection against forgery.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Fingerprint {
    /// Number of bytes.
    bytes: u64,
    /// Digits in hexadecimal.
    md5: String,
}

impl Fingerprint {
    /// Fingerprint of the file `path`.
    pub(super) fn of(path: &Path) -> Result<Self, ReadError> {
        Self::read(path).map_err(ReadError::io(path))
    }

    fn read(path: &Path) -> io::Result<Self> {
        let mut file = BufReader::with_capacity(1 << 16, File::open(path)?);
        let (mut bytes, mut digest) = (0, Md5::new());
        loop {
            let part = file.fill_buf()?;
            if part.is_empty() {
                break;
            }
            let length = part.len();
            digest.update(part);
            bytes += length as u64;
            file.consume(length);
        }
        let md5 = hex(digest);
        Ok(Self { bytes, md5 })
    }

    /// Returns `true` if the file `path` has that content. Reads it only if its length is the same.
    pub(super) fn is_of(&self, path: &Path) -> Result<bool, ReadError> {
        let found = path.metadata().map_err(ReadError::io(path))?;
        Ok(found.len() == self.bytes && Self::of(path)? == *self)
    }
}

/// A digest in hexadecimal.
pub(crate) fn hex(digest: Md5) -> String {
    use std::fmt::Write;
    digest
        .finalize()
        .iter()
        .fold(String::new(), |mut text, byte| {
            // Writing to a string cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_fingerprint_is_that_of_the_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "abc").unwrap();
        let fingerprint = Fingerprint::of(&path).unwrap();
        // RFC 1321, A.5
        assert_eq!(fingerprint.md5, "900150983cd24fb0d6963f7d28e17f72");
        assert_eq!(fingerprint.bytes, 3);
        assert!(fingerprint.is_of(&path).unwrap());
        for other in ["abd", "ab", "abcd", ""] {
            fs::write(&path, other).unwrap();
            assert!(!fingerprint.is_of(&path).unwrap(), "{other}");
        }
    }
}
