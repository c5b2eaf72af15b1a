//! TIFF and GeoTIFF (.tif, .tiff), read only.
//!
//! One channel of grey: whole numbers of 8 to 64 bits, half, single or double precision; strips or tiles, plain or
//! compressed by deflate, LZW or PackBits; BigTIFF too. The first page is read: further pages are overviews, or are
//! named in a note. [`geo`] finds spacing, units, missing points and the scale of heights in the tags of GeoTIFF and
//! GDAL; other TIFF files state no length, so that their spacing is assumed to be 1.

mod errors;
mod geo;
mod metadata;

use std::io::{BufRead, Seek};

use ::tiff::ColorType;
use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::tags::Tag;
use asperity_surface::{RawHeightMap, check_grid};

use self::geo::Georeference;
use crate::error::ReadProblem;
use crate::limits::{check_packed_claim, read_guarded, room};

/// Most pages of a file that are looked at.
const MAX_PAGES: usize = 64;

/// Bits of the tag `NewSubfileType`: an overview, a mask of valid points.
const IS_OVERVIEW: u32 = 1;
const IS_MASK: u32 = 4;

pub(crate) fn read<R: BufRead + Seek>(reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    read_guarded(|| decode(reader, length))
}

fn decode<R: BufRead + Seek>(reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    let mut decoder = Decoder::new(reader)?;
    let (columns, rows) = decoder.dimensions()?;
    let [ny, nx] = [rows, columns].map(u64::from);
    let shape = [rows, columns].map(|n| n as usize);
    check_packed_claim([ny, nx], 1, length)?;
    let colour = decoder.colortype()?;
    let ColorType::Gray(bits) = colour else {
        let channels = colour.num_samples();
        return Err(ReadProblem::unsupported(match colour {
            ColorType::Multiband { .. } | ColorType::GrayA(_) => {
                format!("it has {channels} channels, but one channel of heights is needed")
            }
            _ => "it is a colour picture, but one channel of heights is needed".to_owned(),
        }));
    };
    let place = Georeference::read(&mut decoder)?;
    check_grid(shape, place.spacing().unwrap_or([1.0; 2]))?;

    // Room for all samples at their width, and for a strip that holds all of them
    let bytes = shape[0] * shape[1] * usize::from(bits).div_ceil(8).max(1);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = bytes.max(limits.decoding_buffer_size);
    limits.intermediate_buffer_size = bytes.max(limits.intermediate_buffer_size);
    let mut decoder = decoder.with_limits(limits);
    let mut heights = room(nx, ny)?;
    let samples = decoder.read_image()?;
    let is_single = matches!(samples, DecodingResult::F32(_));
    append(samples, &mut heights);
    let note = note_on_pages(&mut decoder)?;

    place.apply(&mut heights, is_single);
    let spacing = place.spacing();
    let mut map = RawHeightMap::new(heights, shape, spacing.unwrap_or([1.0; 2]))?;
    if spacing.is_none() {
        map = map.with_assumed_spacing();
    }
    map.unit = place.unit();
    map.notes.extend(place.notes().into_iter().chain(note));
    Ok(map)
}

/// Appends the samples to `heights`; whole numbers of 64 bits beyond 2^53 are rounded to the nearest double.
fn append(samples: DecodingResult, heights: &mut Vec<f64>) {
    match samples {
        DecodingResult::U8(all) => heights.extend(all.into_iter().map(f64::from)),
        DecodingResult::U16(all) => heights.extend(all.into_iter().map(f64::from)),
        DecodingResult::U32(all) => heights.extend(all.into_iter().map(f64::from)),
        DecodingResult::U64(all) => heights.extend(all.into_iter().map(|x| x as f64)),
        DecodingResult::I8(all) => heights.extend(all.into_iter().map(f64::from)),
        DecodingResult::I16(all) => heights.extend(all.into_iter().map(f64::from)),
        DecodingResult::I32(all) => heights.extend(all.into_iter().map(f64::from)),
        DecodingResult::I64(all) => heights.extend(all.into_iter().map(|x| x as f64)),
        DecodingResult::F16(all) => heights.extend(all.into_iter().map(|x| x.to_f64())),
        DecodingResult::F32(all) => heights.extend(all.into_iter().map(f64::from)),
        DecodingResult::F64(all) => heights.extend(all),
    }
}

/// Note on further pages of the file, unless they are overviews; a mask of missing points is refused.
fn note_on_pages<R: BufRead + Seek>(
    decoder: &mut Decoder<R>,
) -> Result<Option<String>, ReadProblem> {
    let mut others = 0;
    for _ in 1..MAX_PAGES {
        if !decoder.more_images() {
            break;
        }
        decoder.next_image()?;
        let kind = decoder
            .find_tag_unsigned::<u32>(Tag::NewSubfileType)?
            .unwrap_or(0);
        if kind & IS_MASK != 0 {
            return Err(ReadProblem::unsupported(
                "a page of its own marks missing points, but a number for them (GDAL_NODATA) is needed",
            ));
        }
        others += usize::from(kind & IS_OVERVIEW == 0);
    }
    Ok((others > 0).then(|| format!("the first of {} pages is read", others + 1)))
}
