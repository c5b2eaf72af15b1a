//! ISO 25178-72 (.x3p): a ZIP archive of `main.xml`, `bindata/data.bin` and MD5 checksums.
//!
//! Lengths are metres. Read: surfaces on a regular grid (CX and CY incremental, CZ absolute), of
//! numbers of type I (16 bits), L (32 bits), F or D, in a binary part or in the XML text; heights
//! are `Offset + Increment * number`. Points are missing where the number is NaN or infinite, the datum empty,
//! or their bit in the mask of valid points is 0 (one bit per point, the lowest first). MD5
//! checksums are verified where they are given. A rotation of the frame is ignored.
//!
//! Written: type D, not compressed (roughness hardly is compressible), converted to metres, with
//! all checksums; the border in the comment of Record2, as `border=periodic`, and `cells=turned` where turned cells are lost. The date is fixed,
//! so that equal surfaces give equal bytes.

mod grid;
mod linked;
mod parts;
mod write;

use std::io::{Read, Seek};

use asperity_surface::{LengthUnit, RawHeightMap, check_grid};
use md5::{Digest, Md5};
use roxmltree::Node;

use self::grid::Grid;
use self::linked::{linked, verify_checksum};
use self::parts::{CHECKSUM, MAIN};
use super::archive::Parts;
use super::cells;
use super::xml::{self, Split};
use crate::error::ReadProblem;
use crate::limits::{check_packed_claim, room};

pub(crate) use self::write::write;

/// Longest main.xml that is read; data inside it take about 20 bytes per point.
const XML_LIMIT: u64 = 1 << 26;
/// Longest md5checksum.hex that is read.
const CHECKSUM_LIMIT: u64 = 1 << 12;

pub(crate) fn read<R: Read + Seek>(reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    let mut parts = Parts::open(reader, length)?;
    let main = parts.enter(MAIN)?;
    let text = parts.read(&main, |size| size <= XML_LIMIT)?;
    let checksum = parts.resolve(CHECKSUM);
    if parts.has(&checksum) {
        let stated = parts.read(&checksum, |size| size <= CHECKSUM_LIMIT)?;
        // A line may name its part, as md5sum writes it; main.xml states the checksums of other parts itself
        for line in String::from_utf8_lossy(&stated).lines() {
            let (stated, part) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let part = part.trim().trim_start_matches('*');
            if !stated.is_empty() && (part.is_empty() || part.to_ascii_lowercase().ends_with(MAIN))
            {
                verify_checksum(MAIN, Md5::new_with_prefix(&text), stated)?;
            }
        }
    }
    let text =
        String::from_utf8(text).map_err(|_| ReadProblem::malformed("its main.xml is not UTF-8"))?;
    let Split { description, data } = xml::split(MAIN, &text)?;
    let document = xml::parse(MAIN, &description)?;
    let root = document.root_element();
    let grid = Grid::parse(root)?;
    let claim = [grid.rows as u64, grid.columns as u64];
    check_packed_claim(claim, 1, length)?;
    check_grid([grid.rows, grid.columns], grid.spacing)?;

    let record = xml::child(root, "Record3")?;
    let mut heights = match xml::optional(record, "DataLink")? {
        Some(link) => linked(&mut parts, link, &grid)?,
        None => {
            xml::child(record, "DataList")?;
            inline(data, &grid)?
        }
    };
    for height in &mut heights {
        if height.is_infinite() {
            *height = f64::NAN;
        }
    }
    if grid.increment != 1.0 || grid.offset != 0.0 {
        for height in &mut heights {
            *height = *height * grid.increment + grid.offset;
        }
    }
    let mut map = RawHeightMap::new(heights, [grid.rows, grid.columns], grid.spacing)?;
    map.unit = LengthUnit::Metre;
    let comment = comment(root)?;
    // A comment is free text: what is no border there is no error.
    let mut words = comment.split_whitespace();
    map.border = words.find_map(|word| word.strip_prefix("border=")?.parse().ok());
    if words.next() == Some("cells=turned") {
        map.notes.push(cells::LOST.to_owned());
    }
    Ok(map)
}

/// Heights, before scaling, from the XML text: `x;y;z` or `z` in each `Datum`.
fn inline(data: &str, grid: &Grid) -> Result<Vec<f64>, ReadProblem> {
    let [nx, ny] = [grid.columns as u64, grid.rows as u64];
    let needed = grid.columns * grid.rows;
    let mut heights = room(nx, ny)?;
    let mut count = 0;
    xml::for_each_datum(MAIN, data, |text| {
        count += 1;
        let z = text.rsplit(';').next().unwrap_or_default().trim();
        if count <= needed {
            heights.push(if z.is_empty() {
                f64::NAN
            } else {
                xml::number("Datum", z)?
            });
        }
        Ok(())
    })?;
    if count != needed {
        return Err(ReadProblem::malformed(format_args!(
            "its DataList has {count} data, but {nx} x {ny} are needed"
        )));
    }
    Ok(heights)
}

/// The comment of Record2.
fn comment<'a>(root: Node<'a, '_>) -> Result<&'a str, ReadProblem> {
    let Some(record) = xml::optional(root, "Record2")? else {
        return Ok("");
    };
    let comment = xml::optional(record, "Comment")?;
    Ok(comment.map_or("", xml::text))
}
