//! TIFF and GeoTIFF (.tif, .tiff), read only.
//!
//! One channel of grey: whole numbers of 1 to 64 bits, half, single or double precision; strips or tiles, plain or
//! compressed by deflate, LZW or PackBits; BigTIFF too. Samples are heights as they are stored, whether 0 is shown
//! black or white. The first page is read: further pages are overviews, or are named in a note. [`geo`] finds
//! spacing and units in the tags of GeoTIFF, [`metadata`] the scale of heights in those of GDAL, and [`description`]
//! the scale of ImageJ and OME; other TIFF files state no length, so that their spacing is assumed to be 1.

mod compression;
mod description;
mod directory;
mod epsg;
mod geo;
mod image;
mod lengths;
mod metadata;
mod numbers;
mod units;

use std::io::{BufRead, Read, Seek};

use asperity_surface::{LengthUnit, RawHeightMap, check_grid};

use self::directory::{Directory, File, Tag};
use self::image::Image;
use self::metadata::Metadata;
use super::mark::Mark;
use super::samples::reverse_rows;
use crate::error::ReadProblem;
use crate::limits::read_guarded;
use crate::text_lines::short;

/// Most pages of a file that are looked at.
const MAX_PAGES: usize = 64;

/// Bits of the tag `NewSubfileType`: an overview, a mask of valid points.
const IS_OVERVIEW: u64 = 1;
const IS_MASK: u64 = 4;

pub(crate) fn read<R: BufRead + Seek>(reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    read_guarded(|| decode(reader, length))
}

fn decode<R: BufRead + Seek>(reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    let (mut file, first) = File::open(reader, length)?;
    let page = file.directory(first)?;
    let image = Image::read(&mut file, &page)?;
    let text = page.text(&mut file, Tag::GdalMetadata)?;
    let metadata = Metadata::parse(text.unwrap_or_default().trim())?;
    let mut lengths = match geo::lengths(&mut file, &page, metadata.metres)? {
        Some(lengths) => lengths,
        None => description::lengths(&mut file, &page)?,
    };
    if let (None, Some(metres)) = (lengths.spacing, metadata.metres) {
        lengths.unit = LengthUnit::Metre;
        lengths.heights.factor = metres;
    }
    lengths.heights.offset = metadata.offset + metadata.scale * lengths.heights.offset;
    lengths.heights.scale *= metadata.scale;
    let spacing = lengths.spacing.unwrap_or([1.0; 2]);
    let shape = [image.rows, image.columns].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
    check_grid(shape, spacing)?;
    image.check(length)?;

    let nodata = nodata(&mut file, &page)?;
    let absent = if nodata.is_some() { f64::NAN } else { 0.0 };
    let (mut heights, note) = image.samples(&mut file, absent)?;
    lengths.notes.extend(note);
    lengths.notes.extend(note_on_pages(&mut file, page.next)?);
    if !matches!(page.whole(&mut file, Tag::Orientation)?, None | Some(0 | 1)) {
        let note =
            "the tag Orientation is ignored: the first row and column are those stored first";
        lengths.notes.push(note.to_owned());
    }
    let [rows, columns] = lengths.turned_back;
    if columns {
        heights
            .chunks_exact_mut(shape[1])
            .for_each(<[f64]>::reverse);
    }
    if rows {
        reverse_rows(&mut heights, shape[1]);
    }
    for height in &mut heights {
        let is_missing = |(number, mark): &(f64, Mark)| {
            image.numbers.rounded(*number) == *height || mark.is_rounded(*height)
        };
        *height = match nodata.as_ref().is_some_and(is_missing) {
            true => f64::NAN,
            false => lengths.heights.of(*height),
        };
    }
    let mut map = RawHeightMap::new(heights, shape, spacing)?;
    if lengths.spacing.is_none() {
        map = map.with_assumed_spacing();
    }
    map.unit = lengths.unit;
    map.notes = lengths.notes;
    Ok(map)
}

/// The number that marks missing points, and its text.
fn nodata<R: Read + Seek>(
    file: &mut File<R>,
    page: &Directory,
) -> Result<Option<(f64, Mark)>, ReadProblem> {
    let text = page.text(file, Tag::GdalNodata)?.unwrap_or_default();
    let text = text.trim();
    if text.is_empty() {
        return Ok(None);
    }
    let number = text.parse().map_err(|_| {
        ReadProblem::malformed(format_args!("GDAL_NODATA is `{}`, no number", short(text)))
    });
    Ok(Some((number?, Mark::new(text))))
}

/// Note on further pages of the file, unless they are overviews; a mask of missing points is refused.
fn note_on_pages<R: Read + Seek>(
    file: &mut File<R>,
    mut next: u64,
) -> Result<Option<String>, ReadProblem> {
    let mut others = 0;
    for _ in 1..MAX_PAGES {
        if next == 0 {
            break;
        }
        let page = file.directory(next)?;
        let kind = page.whole(file, Tag::NewSubfileType)?.unwrap_or(0);
        if kind & IS_MASK != 0 {
            return Err(ReadProblem::unsupported(
                "a page of its own marks missing points, but a number for them (GDAL_NODATA) is needed",
            ));
        }
        others += usize::from(kind & IS_OVERVIEW == 0);
        next = page.next;
    }
    Ok((others > 0).then(|| format!("the first of {} pages is read", others + 1)))
}
