//! OpenEXR (.exr).
//!
//! Written: one channel `height` in single precision (EXR knows no double), so that each height
//! is rounded by at most 6e-8 of itself (2^-24); ZIP compression, lossless, where it saves a fifth of some rows, else
//! none, since the last digits of rough surfaces are noise; row 0 of the heights is the first scan line, which viewers show on top. Attributes of the header: `spacing_x`,
//! `spacing_y` (double), `unit`, `border` (text) and, of a generated surface, `sigma`, `tau_x`,
//! `tau_y`, `azimuth` (double), `autocorrelation`, the convention in words, of a Gaussian spectrum, or else `recipe`
//! (text, JSON), and `seed` and `realisation` (text, since EXR has no 64-bit integers). Beside it, of a structure, a channel of the
//! [turned cells](asperity_surface::TurnedCells).
//!
//! Read: the channel `height`, `Z` or `Y`, the first of all parts, else the only channel, of half or single precision
//! or of 32-bit whole numbers; a note names the channel if there are others. Scan lines or tiles, of which the finest
//! level counts; compression that loses no digits of the channel; NaN marks missing points. Absent attributes mean spacing 1, arbitrary unit, unknown border, not generated.

use std::io::{Read, Seek, Write};
use std::sync::Arc;

use ::exr::block::reader::ChunksReader;
use ::exr::compression::Compression;
use ::exr::error::Error;
use ::exr::math::Vec2;
use ::exr::meta::attribute::{AttributeValue, ChannelDescription, SampleType, Text};
use ::exr::meta::header::{Header, LayerAttributes};
use ::exr::prelude::f16;
use asperity_surface::{HeightField, RawHeightMap, TurnedCells, check_grid};
use asperity_synthesis::{Provenance, Psd, StructureSynthesis, SurfaceRecipe};

use super::cells;
use super::channels::note_on_channels;
use crate::encoding::{encode_exr, single};
use crate::error::{ReadProblem, WriteProblem};
use crate::limits::{check_packed_claim, read_guarded, room};
use crate::text_lines::short;

/// Names under which a channel is taken for the heights, the best first.
const CHANNEL_NAMES: [&str; 3] = ["height", "Z", "Y"];

const CONVENTION: &str = "Gaussian: C(u, v) = sigma^2 exp(-u^2 / tau_x^2 - v^2 / tau_y^2), u and v along axes \
     turned by azimuth (radians) from x and y; tau is the 1/e length";

/// The attribute that holds what a surface was drawn by, unless it is a Gaussian spectrum.
const RECIPE: &str = "recipe";

/// Largest block, in bytes, that is allowed beyond the size of the image.
const BLOCK_LIMIT: u64 = 1 << 24;

pub(crate) fn read<R: Read + Seek>(reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    read_guarded(|| decode(reader, length))
}

fn decode<R: Read + Seek>(reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    let reader = ::exr::block::read(reader, false)?;
    let (layer, channel, note) = find_channel(reader.headers())?;
    let header = reader.headers()[layer].clone();
    let Vec2(columns, rows) = header.layer_size;
    let spacing = [
        number(&header, "spacing_x")?.unwrap_or(1.0),
        number(&header, "spacing_y")?.unwrap_or(1.0),
    ];
    check_size(reader.headers(), &header, length)?;
    check_grid([rows, columns], spacing)?;

    let [nx, ny] = [columns as u64, rows as u64];
    let mut heights: Vec<f64> = room(nx, ny)?;
    heights.resize(columns * rows, f64::NAN);
    let mut found = vec![0_usize; rows];
    let list = &header.channels.list;
    let kind = list[channel].sample_type;
    let turned_channel = list.iter().position(are_turned_cells);
    let mut turned = vec![false; turned_channel.map_or(0, |_| columns * rows)];
    reader
        .filter_chunks(false, |_, _, block| {
            block.layer == layer && block.level == Vec2(0, 0)
        })?
        .decompress_sequential(false, |_, block| {
            for line in block.lines(&header.channels) {
                let Vec2(x, y) = line.location.position;
                let place = y * columns + x..y * columns + x + line.location.sample_count;
                let outside = || Error::Invalid("a block lies outside the image".into());
                if Some(line.location.channel) == turned_channel {
                    let target = turned.get_mut(place).ok_or_else(outside)?;
                    fill(target, line.read_samples::<f32>(), |sample| sample > 0.0)?;
                    continue;
                }
                if line.location.channel != channel {
                    continue;
                }
                let target = heights.get_mut(place).ok_or_else(outside)?;
                found[y] += target.len();
                match kind {
                    SampleType::F16 => fill(target, line.read_samples::<f16>(), f16::to_f64)?,
                    SampleType::F32 => fill(target, line.read_samples::<f32>(), f64::from)?,
                    SampleType::U32 => fill(target, line.read_samples::<u32>(), f64::from)?,
                }
            }
            Ok(())
        })?;
    if let Some(iy) = found.iter().position(|n| *n != columns) {
        let n = found[iy];
        return Err(ReadProblem::malformed(format_args!(
            "row {iy} has {n} samples, but {columns} are needed"
        )));
    }

    let mut map = RawHeightMap::new(heights, [rows, columns], spacing)?;
    if number(&header, "spacing_x")?.is_none() {
        map = map.with_assumed_spacing();
    }
    map.notes.extend(note);
    if let Some(unit) = words(&header, "unit")? {
        map.unit = unit.parse()?;
    }
    if let Some(border) = words(&header, "border")? {
        map.border = Some(border.parse()?);
    }
    let shape = [rows, columns];
    map.turned_cells =
        turned_channel.map(|_| TurnedCells::new(shape, |ix, iy| turned[iy * columns + ix]));
    if let Some(provenance) = provenance(&header)? {
        if let Some(surface) = provenance.recipe.structured() {
            let planned = StructureSynthesis::new(*surface.structure(), shape, spacing, true);
            planned.map_err(|error| {
                ReadProblem::malformed(format_args!(
                    "the surface cannot be what its record says: {error}"
                ))
            })?;
            if turned_channel.is_none() {
                map.notes.push(cells::LOST.to_owned());
            }
        }
        map.provenance = Some(Arc::new(provenance));
    }
    Ok(map)
}

/// Returns `true` for the channel of turned cells.
fn are_turned_cells(channel: &ChannelDescription) -> bool {
    channel.name.eq(cells::CHANNEL) && channel.sample_type == SampleType::F32
}

fn fill<S, T>(
    target: &mut [T],
    samples: impl Iterator<Item = ::exr::error::Result<S>>,
    convert: fn(S) -> T,
) -> ::exr::error::UnitResult {
    for (target, sample) in target.iter_mut().zip(samples) {
        *target = convert(sample?);
    }
    Ok(())
}

impl From<Error> for ReadProblem {
    fn from(error: Error) -> Self {
        match error {
            Error::Io(error) => error.into(),
            Error::NotSupported(what) => Self::unsupported(what),
            Error::Invalid(what) if what == "reference to missing bytes" => {
                Self::truncated("bytes that its header promises are missing")
            }
            Error::Invalid(what) => Self::malformed(what),
            Error::Aborted => Self::malformed("its content is damaged"),
        }
    }
}

/// Layer and channel that hold the heights, and a note that names the channel if there are others.
fn find_channel(headers: &[Header]) -> Result<(usize, usize, Option<String>), ReadProblem> {
    let mut channels = Vec::new();
    let mut names = Vec::new();
    for (layer, header) in headers.iter().enumerate() {
        if header.deep {
            return Err(ReadProblem::unsupported(
                "it holds deep data, but flat images are needed",
            ));
        }
        let all = header.channels.list.iter().enumerate();
        for (channel, description) in all.filter(|(_, channel)| !are_turned_cells(channel)) {
            channels.push((layer, channel, description));
            let part = header.own_attributes.layer_name.as_ref();
            names.push(match part {
                Some(part) if headers.len() > 1 => format!("{part}.{}", description.name),
                _ => description.name.to_string(),
            });
        }
    }
    let named = CHANNEL_NAMES
        .iter()
        .find_map(|name| channels.iter().position(|(_, _, c)| c.name.eq(name)));
    let chosen = named.or((channels.len() == 1).then_some(0)).ok_or_else(|| {
        let names: Vec<String> = names.iter().map(|name| short(name)).collect();
        ReadProblem::unsupported(format_args!(
            "it has the channels {}, but one named height, Z or Y is needed, or a single channel",
            names.join(", ")
        ))
    })?;
    let (layer, channel, description) = channels[chosen];
    check_compression(headers[layer].compression, description.sample_type)?;
    // The decoder takes every channel of a layer as full.
    if headers[layer]
        .channels
        .list
        .iter()
        .any(|c| c.sampling != Vec2(1, 1))
    {
        return Err(ReadProblem::unsupported(format_args!(
            "channels next to or under `{}` are subsampled, but one sample per pixel is needed",
            description.name
        )));
    }
    Ok((layer, channel, note_on_channels(chosen, &names)))
}

/// Refuses compression that loses digits of samples, or has no decoder.
fn check_compression(method: Compression, samples: SampleType) -> Result<(), ReadProblem> {
    let name = match method {
        Compression::B44 => "B44",
        Compression::B44A => "B44A",
        Compression::DWAA(_) => "DWAA",
        Compression::DWAB(_) => "DWAB",
        // Whole and half numbers keep all of their bits
        Compression::PXR24 if samples == SampleType::F32 => "PXR24",
        Compression::HTJ2K32 | Compression::HTJ2K256 => {
            return Err(ReadProblem::unsupported(
                "it is compressed by HTJ2K, which is not supported; ZIP, PIZ, RLE or none are read",
            ));
        }
        _ => return Ok(()),
    };
    Err(ReadProblem::unsupported(format_args!(
        "it is compressed by {name}, which loses digits; ZIP, PIZ, RLE or none keep heights"
    )))
}

/// Compares what the headers claim with the length of the file, before the decoder allocates it.
fn check_size(headers: &[Header], header: &Header, length: u64) -> Result<(), ReadProblem> {
    let [nx, ny] = [header.layer_size.0 as u64, header.layer_size.1 as u64];
    let each = header.channels.bytes_per_pixel as u64;
    check_packed_claim([ny, nx], each, length)?;
    let bytes = nx * ny * each;
    // Each block has an entry of eight bytes in the offset table.
    let blocks: u64 = headers.iter().map(|h| h.chunk_count as u64).sum();
    if blocks.saturating_mul(8) > length {
        return Err(ReadProblem::malformed(format_args!(
            "it claims {blocks} blocks, more than its {length} bytes can hold"
        )));
    }
    let Vec2(width, height) = header.max_block_pixel_size();
    let block = (width as u64)
        .checked_mul(height as u64)
        .and_then(|n| n.checked_mul(each));
    if block.is_none_or(|block| block > bytes.saturating_add(BLOCK_LIMIT)) {
        return Err(ReadProblem::malformed(format_args!(
            "its blocks of {width} x {height} samples are out of proportion to {nx} x {ny}"
        )));
    }
    Ok(())
}

fn attribute<'a>(header: &'a Header, name: &str) -> Option<&'a AttributeValue> {
    let name = Text::new_or_none(name)?;
    header
        .own_attributes
        .other
        .get(&name)
        .or_else(|| header.shared_attributes.other.get(&name))
}

fn number(header: &Header, name: &str) -> Result<Option<f64>, ReadProblem> {
    match attribute(header, name) {
        None => Ok(None),
        Some(AttributeValue::F64(value)) => Ok(Some(*value)),
        Some(AttributeValue::F32(value)) => Ok(Some((*value).into())),
        Some(AttributeValue::I32(value)) => Ok(Some((*value).into())),
        Some(_) => Err(ReadProblem::malformed(format_args!(
            "its attribute {name} is not a number"
        ))),
    }
}

fn words(header: &Header, name: &str) -> Result<Option<String>, ReadProblem> {
    match attribute(header, name) {
        None => Ok(None),
        Some(AttributeValue::Text(text)) => Ok(Some(text.to_string())),
        Some(_) => Err(ReadProblem::malformed(format_args!(
            "its attribute {name} is not text"
        ))),
    }
}

/// Origin of a generated surface, if all attributes of it are there.
fn provenance(header: &Header) -> Result<Option<Provenance>, ReadProblem> {
    let number = |name| number(header, name);
    let whole = |name| {
        let text = words(header, name)?;
        text.map(|text| {
            text.parse::<u64>().map_err(|_| {
                ReadProblem::malformed(format_args!(
                    "its attribute {name} is `{text}`, but a whole number is needed"
                ))
            })
        })
        .transpose()
    };
    let (Some(seed), Some(realisation)) = (whole("seed")?, whole("realisation")?) else {
        return Ok(None);
    };
    if let Some(text) = words(header, RECIPE)? {
        let recipe = serde_json::from_str(&text).ok();
        let recipe = recipe.filter(SurfaceRecipe::is_valid).ok_or_else(|| {
            ReadProblem::malformed("its attribute recipe is no description of random surfaces")
        })?;
        return Ok(Some(Provenance {
            recipe,
            seed,
            realisation,
        }));
    }
    let (Some(sigma), Some(tau_x), Some(tau_y)) =
        (number("sigma")?, number("tau_x")?, number("tau_y")?)
    else {
        return Ok(None);
    };
    let azimuth = number("azimuth")?.unwrap_or(0.0);
    let psd =
        Psd::anisotropic_gaussian(sigma, tau_x, tau_y, azimuth).map_err(ReadProblem::malformed)?;
    Ok(Some(Provenance {
        recipe: psd.into(),
        seed,
        realisation,
    }))
}

pub(crate) fn write<W: Write>(field: &HeightField, out: &mut W) -> Result<(), WriteProblem> {
    let samples = field
        .heights()
        .iter()
        .map(|height| single("a height", *height))
        .collect::<Result<Vec<f32>, _>>()?;
    let (nx, ny) = (field.nx(), field.ny());
    let compression = compression_of(&samples, nx)?;
    let mut attributes = LayerAttributes::default();
    for (name, value) in header_attributes(field) {
        attributes
            .other
            .insert(Text::from_slice_unchecked(name.as_bytes()), value);
    }
    let mut channels = vec![("height", samples)];
    // Structures without turned cells say so
    let cells = field.turned_cells();
    let is_structure = |one: &Provenance| one.recipe.structured().is_some();
    if cells.is_some() || Provenance::of(field.provenance()).is_some_and(is_structure) {
        let contains = |k| cells.is_some_and(|cells| cells.contains(k % nx, k / nx));
        let is_turned = |k| f32::from(u8::from(contains(k)));
        channels.push((cells::CHANNEL, (0..nx * ny).map(is_turned).collect()));
    }
    let file = encode_exr([nx, ny], compression, attributes, channels);
    Ok(out.write_all(&file?)?)
}

/// The compression of heights, `nx` to a row: ZIP if it saves a fifth of the rows in the middle, as many as it packs together.
fn compression_of(samples: &[f32], nx: usize) -> Result<Compression, WriteProblem> {
    let ny = samples.len() / nx;
    let rows = ny.min(16);
    let middle = &samples[(ny - rows) / 2 * nx..][..rows * nx];
    let channels = vec![("height", middle.to_vec())];
    let method = Compression::ZIP16;
    let packed = encode_exr([nx, rows], method, LayerAttributes::default(), channels)?;
    Ok(match packed.len() < size_of_val(middle) / 5 * 4 {
        true => method,
        false => Compression::Uncompressed,
    })
}

fn header_attributes(field: &HeightField) -> Vec<(&'static str, AttributeValue)> {
    let text = |text: &str| AttributeValue::Text(Text::from_slice_unchecked(text.as_bytes()));
    let [dx, dy] = field.spacing();
    let mut attributes = vec![
        ("spacing_x", AttributeValue::F64(dx)),
        ("spacing_y", AttributeValue::F64(dy)),
        ("unit", text(field.unit().symbol())),
        ("border", text(&field.border().to_string())),
    ];
    if let Some(Provenance {
        recipe,
        seed,
        realisation,
    }) = Provenance::of(field.provenance())
    {
        match recipe {
            SurfaceRecipe::Gaussian(Psd::Gaussian(gaussian)) => attributes.extend([
                ("sigma", AttributeValue::F64(gaussian.sigma)),
                ("tau_x", AttributeValue::F64(gaussian.tau_x)),
                ("tau_y", AttributeValue::F64(gaussian.tau_y)),
                ("azimuth", AttributeValue::F64(gaussian.azimuth)),
                ("autocorrelation", text(CONVENTION)),
            ]),
            recipe => {
                let json = serde_json::to_string(recipe);
                attributes.extend(json.ok().map(|json| (RECIPE, text(&json))));
            }
        }
        attributes.extend([
            ("seed", text(&seed.to_string())),
            ("realisation", text(&realisation.to_string())),
        ]);
    }
    attributes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_packed_where_that_makes_them_small() {
        let n = 64;
        let bytes = |height: fn(u32) -> f64| {
            let field = HeightField::new((0..n * n).map(height).collect(), [64; 2], [1.0; 2]);
            let mut out = Vec::new();
            write(&field.unwrap(), &mut out).unwrap();
            out.len()
        };
        let samples = (n * n * 4) as usize;
        assert!(bytes(|i| f64::from(i % 64)) < samples / 4);
        let noise = bytes(|i| f64::from(i.wrapping_mul(i ^ 0x9e37_79b9).wrapping_mul(0x85eb_ca6b)));
        assert!((samples..samples + 2000).contains(&noise), "{noise}");
    }
}
