//! Nanoscope of Digital Instruments, Veeco and Bruker (.spm, .di, .000 to .999): atomic force microscopes.
//!
//! A header of text lists sections of `\name: value` lines; each `image list` describes a channel of whole numbers of
//! 16 or 32 bits, little endian, row by row from the bottom. Heights are `number * Z scale / 2^(8 bytes)` volts,
//! times the sensitivity that the scale names. The first channel whose heights are lengths is read. Files of
//! version 4.3 and later.

mod header;
mod scale;

use self::header::{Header, Section};
use self::scale::HeightScale;
use super::bytes::{Bytes, Raster};
use super::measured::{Length, Measured, length_unit, unit_of_length};
use crate::error::ReadProblem;
use crate::height_maps::channels::note_on_channels;
use crate::height_maps::samples::{SampleKind, reverse_rows};
use crate::text_lines::short;

/// From this version on numbers have 32 bits, and `Bytes/pixel` is of the scale alone.
const VERSION_OF_32_BITS: u32 = 0x0920_0000;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let header = Header::read(file)?;
    let channels: Vec<&Section> = header.channels().collect();
    let names: Vec<String> = channels
        .iter()
        .map(|channel| channel.channel_name())
        .collect();
    let mut found = None;
    for (k, channel) in channels.iter().enumerate() {
        if let Some(scale) = HeightScale::of(&header, channel)? {
            found = Some((k, scale));
            break;
        }
    }
    let Some((chosen, scale)) = found else {
        let listed: Vec<String> = names.iter().map(|name| short(name)).collect();
        return Err(ReadProblem::unsupported(format_args!(
            "none of its channels ({}) holds heights in a unit of length",
            listed.join(", ")
        )));
    };
    let Layout {
        shape,
        spacing,
        kind,
        at,
    } = Layout::of(&header, channels[chosen])?;
    let mut heights = file.samples(&Raster { shape, kind, at })?;
    for height in &mut heights {
        *height *= scale.step;
    }
    reverse_rows(&mut heights, shape[1] as usize);
    Ok(Measured {
        heights,
        height_unit: scale.unit,
        shape,
        spacing: Some(spacing),
        notes: note_on_channels(chosen, &names)
            .into_iter()
            .chain(file.note_on_end(header.end_of_channels()))
            .collect(),
    })
}

/// Place of the numbers of a channel in the file, and their spacing on the surface.
struct Layout {
    shape: [u64; 2],
    spacing: [Length; 2],
    kind: SampleKind,
    at: usize,
}

impl Layout {
    fn of(header: &Header, channel: &Section) -> Result<Self, ReadProblem> {
        let fields = &channel.fields;
        let own = [
            fields.whole("Number of lines")?,
            fields.whole("Samps/line")?,
        ];
        let length = fields.whole("Data length")?;
        let at = fields.whole("Data offset")?;
        let bytes_of =
            |shape: [u64; 2], each: u64| shape[0].checked_mul(shape[1])?.checked_mul(each);
        let mut width = scale::bytes_per_pixel(channel)?;
        if header.version >= VERSION_OF_32_BITS && bytes_of(own, 4).is_some_and(|n| length >= n) {
            width = 4;
        }
        // Some files state wrong counts with the channel, and the right ones with the scan
        let of_scan = match [header.scan("Lines"), header.scan("Samps/line")] {
            [Some(rows), Some(columns)] => match [rows.parse(), columns.parse()] {
                [Ok(rows), Ok(columns)] => Some([rows, columns]),
                _ => None,
            },
            _ => None,
        };
        let fits = |shape| bytes_of(shape, width) == Some(length);
        let shape = of_scan
            .filter(|shape| !fits(own) && fits(*shape))
            .unwrap_or(own);
        if bytes_of(shape, width).is_none_or(|needed| needed > length) {
            return Err(ReadProblem::malformed(format_args!(
                "its channel `{}` has {length} bytes, but {} x {} numbers of {width} bytes are needed",
                short(&channel.channel_name()),
                shape[1],
                shape[0]
            )));
        }
        let [size_x, size_y] = scan_size(fields.text("Scan size")?)?;
        let mut spacing = [size_x.over(own[1]), size_y.over(own[0])];
        // The size along the slow axis, where stated, is that of the whole scan, which may have been stopped
        if let (Some(fast), Some(slow)) = (header.scan("Scan size"), header.scan("Slow axis size"))
        {
            let [fast, _] = scan_size(fast)?;
            let [slow, _] = scan_size(slow)?;
            let whole = of_scan.map_or(shape[0], |of_scan| of_scan[0].max(shape[0]));
            spacing = [fast.over(shape[1]), slow.over(whole)];
        }
        Ok(Self {
            shape,
            spacing,
            kind: if width == 4 {
                SampleKind::I32
            } else {
                SampleKind::I16
            },
            at: usize::try_from(at).unwrap_or(usize::MAX),
        })
    }
}

impl Length {
    fn over(self, count: u64) -> Self {
        Self {
            value: self.value / count as f64,
            ..self
        }
    }
}

/// `500 500 nm` or, of a square, `500 nm`.
fn scan_size(text: &str) -> Result<[Length; 2], ReadProblem> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let number = |word: &str| word.parse::<f64>().ok();
    let (sizes, unit) = match words[..] {
        [x, y, unit] => ([number(x), number(y)], unit),
        [x, unit] => ([number(x); 2], unit),
        _ => ([None; 2], ""),
    };
    let [Some(x), Some(y)] = sizes else {
        return Err(ReadProblem::malformed(format_args!(
            "its scan size is `{}`, but one or two numbers and a unit are needed",
            short(text)
        )));
    };
    let unit = match length_unit(unit) {
        Some(unit) => unit,
        None => unit_of_length("the scan size", unit)?,
    };
    Ok([x, y].map(|value| Length { value, unit }))
}
