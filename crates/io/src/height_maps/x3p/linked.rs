//! The binary parts that main.xml names, with their checksums.

use std::io::{Read, Seek};

use md5::{Digest, Md5};
use roxmltree::Node;

use super::grid::Grid;
use crate::error::ReadProblem;
use crate::files::hex;
use crate::height_maps::archive::{Parts, unpacking};
use crate::height_maps::xml;
use crate::limits::{check_packed_claim, room};

/// Refuses a part whose MD5 checksum is not the stated one.
pub(super) fn verify_checksum(part: &str, found: Md5, stated: &str) -> Result<(), ReadProblem> {
    let found = hex(found);
    if found.eq_ignore_ascii_case(stated.trim()) {
        return Ok(());
    }
    Err(ReadProblem::Checksum {
        part: part.to_owned(),
        found,
        stated: stated.trim().chars().take(40).collect(),
    })
}

/// Heights, before scaling, from the binary part that `link` names.
pub(super) fn linked<R: Read + Seek>(
    parts: &mut Parts<R>,
    link: Node<'_, '_>,
    grid: &Grid,
) -> Result<Vec<f64>, ReadProblem> {
    let [nx, ny] = [grid.columns as u64, grid.rows as u64];
    let width = grid.kind.bytes() as u64;
    check_packed_claim([ny, nx], width, parts.length)?;
    let count = grid.columns * grid.rows;
    let name = parts.resolve(xml::child_text(link, "PointDataLink")?);
    let mut digest = Md5::new();
    let mut heights = parts.take(
        &name,
        |size| size == count as u64 * width,
        |_, mut reader| {
            let mut heights = room(nx, ny)?;
            grid.kind
                .read(&mut reader, count, false, &mut heights, |bytes| {
                    digest.update(bytes)
                })
                .map_err(|e| unpacking(&name, e))?;
            Ok(heights)
        },
    )?;
    if let Some(stated) = xml::optional(link, "MD5ChecksumPointData")? {
        verify_checksum(&name, digest, xml::text(stated))?;
    }
    if let Some(valid) = xml::optional(link, "ValidPointsLink")? {
        let name = parts.resolve(xml::text(valid));
        let mask = parts.read(&name, |size| size == count.div_ceil(8) as u64)?;
        if let Some(stated) = xml::optional(link, "MD5ChecksumValidPoints")? {
            verify_checksum(&name, Md5::new_with_prefix(&mask), xml::text(stated))?;
        }
        for (i, height) in heights.iter_mut().enumerate() {
            if mask[i / 8] >> (i % 8) & 1 == 0 {
                *height = f64::NAN;
            }
        }
    }
    Ok(heights)
}
