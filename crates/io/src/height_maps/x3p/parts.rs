//! Names of the parts of an X3P archive.

/// The XML document.
pub(super) const MAIN: &str = "main.xml";
/// The MD5 checksum of the XML document.
pub(super) const CHECKSUM: &str = "md5checksum.hex";
