//! Parts of the archive: reads them within limits and verifies their checksums.

use std::io::{Read, Seek};
use std::path::Path;

use md5::{Digest, Md5};
use roxmltree::Node;
use zip::ZipArchive;
use zip::result::ZipError;

use super::grid::Grid;
use super::xml::{Xml, malformed};
use crate::error::ReadError;
use crate::files::hex;
use crate::limits::{COMPRESSION_LIMIT, check_packed_claim, room};

/// Refuses a part whose MD5 checksum is not the stated one.
pub(super) fn verify_checksum(
    path: &Path,
    part: &str,
    found: Md5,
    stated: &str,
) -> Result<(), ReadError> {
    let found = hex(found);
    if found.eq_ignore_ascii_case(stated.trim()) {
        return Ok(());
    }
    Err(ReadError::Checksum {
        path: path.to_owned(),
        part: part.to_owned(),
        found,
        stated: stated.trim().chars().take(40).collect(),
    })
}

/// The parts of the archive.
pub(super) struct Parts<'a, R> {
    path: &'a Path,
    archive: ZipArchive<R>,
    length: u64,
}

impl<'a, R: Read + Seek> Parts<'a, R> {
    /// Opens the archive in a file of `length` bytes.
    pub(super) fn open(path: &'a Path, reader: R, length: u64) -> Result<Self, ReadError> {
        let archive = ZipArchive::new(reader).map_err(|e| {
            malformed(
                path,
                format_args!("it is not a complete ZIP archive ({e}); it may be cut short"),
            )
        })?;
        Ok(Self {
            path,
            archive,
            length,
        })
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.archive.index_for_name(name).is_some()
    }

    /// Reads a whole part whose claimed length `allowed` accepts.
    pub(super) fn read(
        &mut self,
        name: &str,
        allowed: impl Fn(u64) -> bool,
    ) -> Result<Vec<u8>, ReadError> {
        let path = self.path;
        self.take(name, allowed, |size, reader| {
            let mut bytes: Vec<u8> = room(path, size, 1)?;
            bytes.resize(size as usize, 0);
            reader
                .read_exact(&mut bytes)
                .map_err(|e| unpacking(path, name, e))?;
            Ok(bytes)
        })
    }

    /// Reads a part with `take`, and checks that all of it is taken.
    fn take<T>(
        &mut self,
        name: &str,
        allowed: impl Fn(u64) -> bool,
        take: impl FnOnce(u64, &mut dyn Read) -> Result<T, ReadError>,
    ) -> Result<T, ReadError> {
        let path = self.path;
        let mut part = self.archive.by_name(name).map_err(|error| match error {
            ZipError::FileNotFound => malformed(path, format_args!("it has no part `{name}`")),
            ZipError::Io(error) => unpacking(path, name, error),
            other => malformed(
                path,
                format_args!("its part `{name}` cannot be read ({other})"),
            ),
        })?;
        let size = part.size();
        let packed = part.compressed_size().min(self.length);
        if size > packed.saturating_mul(COMPRESSION_LIMIT) || !allowed(size) {
            return Err(malformed(
                path,
                format_args!(
                    "its part `{name}` claims {size} bytes, which is more than it can hold or not what its grid needs"
                ),
            ));
        }
        let taken = take(size, &mut part)?;
        // The end of a part is where its own checksum is verified.
        match part.read(&mut [0]) {
            Ok(0) => Ok(taken),
            Ok(_) => Err(malformed(
                path,
                format_args!("its part `{name}` is longer than the {size} bytes it claims"),
            )),
            Err(error) => Err(unpacking(path, name, error)),
        }
    }

    /// Heights, before scaling, from the binary part that `link` names.
    pub(super) fn linked(
        &mut self,
        xml: &Xml<'_>,
        link: Node<'_, '_>,
        grid: &Grid,
    ) -> Result<Vec<f64>, ReadError> {
        let path = self.path;
        let [nx, ny] = [grid.columns as u64, grid.rows as u64];
        let width = grid.kind.bytes() as u64;
        check_packed_claim(path, [ny, nx], width, self.length)?;
        let count = grid.columns * grid.rows;
        let name = self.resolve(xml.text(xml.child(link, "PointDataLink")?));
        let mut digest = Md5::new();
        let mut heights = self.take(
            &name,
            |size| size == count as u64 * width,
            |_, mut reader| {
                let mut heights = room(path, nx, ny)?;
                grid.kind
                    .read(&mut reader, count, false, &mut heights, |bytes| {
                        digest.update(bytes)
                    })
                    .map_err(|e| unpacking(path, &name, e))?;
                Ok(heights)
            },
        )?;
        if let Some(stated) = xml.optional(link, "MD5ChecksumPointData")? {
            verify_checksum(path, &name, digest, xml.text(stated))?;
        }
        if let Some(valid) = xml.optional(link, "ValidPointsLink")? {
            let name = self.resolve(xml.text(valid));
            let mask = self.read(&name, |size| size == count.div_ceil(8) as u64)?;
            if let Some(stated) = xml.optional(link, "MD5ChecksumValidPoints")? {
                verify_checksum(path, &name, Md5::new_with_prefix(&mask), xml.text(stated))?;
            }
            for (i, height) in heights.iter_mut().enumerate() {
                if mask[i / 8] >> (i % 8) & 1 == 0 {
                    *height = f64::NAN;
                }
            }
        }
        Ok(heights)
    }

    /// The name of a part as the archive spells it: some programs write `\` into one of the two.
    fn resolve(&self, name: &str) -> String {
        let name = name.trim_start_matches("./");
        [name.replace('\\', "/"), name.replace('/', "\\")]
            .into_iter()
            .find(|other| self.has(other))
            .unwrap_or_else(|| name.to_owned())
    }
}

fn unpacking(path: &Path, name: &str, error: std::io::Error) -> ReadError {
    match error.kind() {
        std::io::ErrorKind::UnexpectedEof => {
            ReadError::truncated(path, format_args!("its part `{name}` stops in its middle"))
        }
        std::io::ErrorKind::InvalidData
        | std::io::ErrorKind::InvalidInput
        | std::io::ErrorKind::Other => {
            malformed(path, format_args!("its part `{name}` is damaged ({error})"))
        }
        _ => ReadError::io(path, error),
    }
}
