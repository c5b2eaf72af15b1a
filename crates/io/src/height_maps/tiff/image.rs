//! Samples of a TIFF page: strips or tiles, some of which may not be in the file.

use std::io::{Read, Seek};

use super::compression::Compression;
use super::directory::{Directory, File, Tag};
use super::numbers::Numbers;
use crate::error::ReadProblem;
use crate::limits::room;

/// Most samples of an image with strips or tiles that are not in the file, beyond what its bytes can hold.
const MAX_SPARSE: u64 = 1 << 27;

/// Names of values of `PhotometricInterpretation`; 0 and 1 are grey, white or black at zero.
const INTERPRETATIONS: [(u64, &str); 9] = [
    (2, "an RGB image"),
    (3, "a palette image, whose samples are numbers of colours"),
    (4, "a transparency mask"),
    (5, "a CMYK image"),
    (6, "a YCbCr image"),
    (8, "a CIE L*a*b* image"),
    (32803, "the raw image of a colour filter array"),
    (32844, "a LogL image"),
    (32845, "a LogLuv image"),
];

/// Layout of the samples of a page.
pub(super) struct Image {
    pub(super) columns: u64,
    pub(super) rows: u64,
    pub(super) numbers: Numbers,
    compression: Compression,
    predictor: u64,
    /// Bits of a byte are stored the lowest first.
    is_reversed: bool,
    /// `tile` or `strip`.
    part: &'static str,
    /// Columns and rows of a tile or strip.
    part_size: [u64; 2],
    offsets: Vec<f64>,
    /// Lengths in the file; `None` if not stated, for parts that are not compressed.
    lengths: Option<Vec<f64>>,
}

/// One strip or tile.
struct Part {
    /// Column and row of its first sample.
    at: [u64; 2],
    /// Columns and rows within the image.
    size: [u64; 2],
    offset: u64,
    length: u64,
    row_bytes: u64,
}

impl Part {
    /// Bytes of its rows, once unpacked.
    fn bytes(&self) -> u64 {
        self.row_bytes.saturating_mul(self.size[1])
    }

    fn is_missing(&self) -> bool {
        self.offset == 0 && self.length == 0
    }
}

impl Image {
    pub(super) fn read<R: Read + Seek>(
        file: &mut File<R>,
        page: &Directory,
    ) -> Result<Self, ReadProblem> {
        let mut whole = |tag| page.whole(file, tag);
        let lacks = |tag: Tag| ReadProblem::malformed(format_args!("it lacks the tag {tag:?}"));
        let columns = whole(Tag::ImageWidth)?.ok_or_else(|| lacks(Tag::ImageWidth))?;
        let rows = whole(Tag::ImageLength)?.ok_or_else(|| lacks(Tag::ImageLength))?;
        let interpretation = whole(Tag::PhotometricInterpretation)?.unwrap_or(1);
        if interpretation > 1 {
            let name = INTERPRETATIONS
                .iter()
                .find(|(value, _)| *value == interpretation);
            let name = name.map_or("an image of an unknown kind", |(_, name)| name);
            return Err(ReadProblem::unsupported(format_args!(
                "it is {name} (photometric interpretation {interpretation}), but one channel of heights is needed"
            )));
        }
        let channels = whole(Tag::SamplesPerPixel)?.unwrap_or(1);
        if channels != 1 {
            return Err(ReadProblem::unsupported(format_args!(
                "it has {channels} channels, but one channel of heights is needed"
            )));
        }
        let format = whole(Tag::SampleFormat)?.unwrap_or(1);
        let bits = whole(Tag::BitsPerSample)?.unwrap_or(1);
        let compression = Compression::of(whole(Tag::Compression)?.unwrap_or(1))?;
        let predictor = whole(Tag::Predictor)?.unwrap_or(1);
        let is_reversed = whole(Tag::FillOrder)? == Some(2);
        let width = whole(Tag::TileWidth)?;
        let (part, part_size, [offsets, lengths]) = match width {
            Some(width) => {
                let length = whole(Tag::TileLength)?.ok_or_else(|| lacks(Tag::TileLength))?;
                let tags = [Tag::TileOffsets, Tag::TileByteCounts];
                ("tile", [width, length], tags)
            }
            None => {
                let length = whole(Tag::RowsPerStrip)?.unwrap_or(rows).min(rows);
                let tags = [Tag::StripOffsets, Tag::StripByteCounts];
                ("strip", [columns, length], tags)
            }
        };
        if part_size.contains(&0) {
            return Err(ReadProblem::malformed(format_args!(
                "its {part}s have no samples"
            )));
        }
        let numbers = Numbers::new(format, bits, file.is_big_endian)?;
        numbers.check_predictor(predictor)?;
        let is_predictable = matches!(compression, Compression::Lzw | Compression::Deflate);
        if predictor != 1 && !is_predictable {
            return Err(ReadProblem::unsupported(format_args!(
                "it has the predictor {predictor}, which LZW and deflate alone have, without either"
            )));
        }
        let image = Self {
            columns,
            rows,
            numbers,
            compression,
            predictor,
            is_reversed,
            part,
            part_size,
            offsets: page.numbers(file, offsets)?.ok_or_else(|| lacks(offsets))?,
            lengths: page.numbers(file, lengths)?,
        };
        if image.lengths.is_none() && compression != Compression::None {
            return Err(lacks(lengths));
        }
        Ok(image)
    }

    /// Checks that the file can hold what it claims, before memory is taken.
    pub(super) fn check(&self, length: u64) -> Result<(), ReadProblem> {
        let [columns, rows] = [self.columns, self.rows];
        let too_large = || ReadProblem::TooLarge {
            nx: columns,
            ny: rows,
            length,
        };
        let [width, height] = self.part_size;
        let needed = columns
            .div_ceil(width)
            .checked_mul(rows.div_ceil(height))
            .ok_or_else(too_large)?;
        for (list, what) in [
            (Some(&self.offsets), "offsets"),
            (self.lengths.as_ref(), "lengths"),
        ] {
            if let Some(list) = list
                && (list.len() as u64) < needed
            {
                return Err(ReadProblem::malformed(format_args!(
                    "it has {} {what} of {}s, but {needed} are needed",
                    list.len(),
                    self.part
                )));
            }
        }
        let samples = columns.checked_mul(rows).ok_or_else(too_large)?;
        let held = length.saturating_mul(8 * self.compression.limit());
        let is_held = samples
            .checked_mul(self.numbers.bits)
            .is_some_and(|bits| bits <= held);
        let is_sparse = samples <= MAX_SPARSE && self.parts().any(|part| part.is_missing());
        match is_held || is_sparse {
            true => Ok(()),
            false => Err(too_large()),
        }
    }

    fn parts(&self) -> impl Iterator<Item = Part> {
        let [width, height] = self.part_size;
        let across = self.columns.div_ceil(width);
        let count = across * self.rows.div_ceil(height);
        (0..count).zip(&self.offsets).map(move |(k, offset)| {
            let at = [k % across * width, k / across * height];
            let size = [
                width.min(self.columns - at[0]),
                height.min(self.rows - at[1]),
            ];
            let row_bytes = width.saturating_mul(self.numbers.bits).div_ceil(8);
            let length = match &self.lengths {
                Some(lengths) => lengths[k as usize] as u64,
                None => row_bytes.saturating_mul(size[1]),
            };
            Part {
                at,
                size,
                offset: *offset as u64,
                length,
                row_bytes,
            }
        })
    }

    /// Reads the samples, row by row; `absent` for those that are not in the file. Returns a note on these.
    pub(super) fn samples<R: Read + Seek>(
        &self,
        file: &mut File<R>,
        absent: f64,
    ) -> Result<(Vec<f64>, Option<String>), ReadProblem> {
        let mut samples = room(self.columns, self.rows)?;
        samples.resize((self.columns * self.rows) as usize, absent);
        let (mut missing, mut all) = (0, 0);
        for part in self.parts() {
            all += 1;
            if part.is_missing() {
                missing += 1;
                continue;
            }
            let (bytes, numbers) = self.unpacked(file, &part)?;
            for (row, y) in bytes
                .chunks_exact(part.row_bytes as usize)
                .zip(part.at[1]..)
            {
                let first = (y * self.columns + part.at[0]) as usize;
                numbers.decode(row, &mut samples[first..first + part.size[0] as usize]);
            }
        }
        let note = (missing > 0).then(|| {
            let name = self.part;
            let taken = match absent.is_nan() {
                true => "points are missing".to_owned(),
                false => format!("samples are {absent}"),
            };
            format!("{missing} of {all} {name}s are not in the file: their {taken}")
        });
        Ok((samples, note))
    }

    /// The rows of a strip or tile, with its predictor undone, and the kind of their samples.
    fn unpacked<R: Read + Seek>(
        &self,
        file: &mut File<R>,
        part: &Part,
    ) -> Result<(Vec<u8>, Numbers), ReadProblem> {
        let [x, y] = part.at;
        let name = format!("the {} at column {x}, row {y}", self.part);
        let (stored, count) = (part.length, part.bytes());
        if part.offset == 0 || stored == 0 {
            return Err(ReadProblem::malformed(format_args!(
                "{name} has the offset {} and the length {stored}; both are 0 where it is not in the file",
                part.offset
            )));
        }
        if count > stored.saturating_mul(self.compression.limit()) {
            return Err(ReadProblem::malformed(format_args!(
                "{name} has {stored} bytes, which cannot hold its {count} bytes of samples"
            )));
        }
        // No method needs more than one and a half bytes for one
        let stored = stored.min(count.saturating_mul(2).saturating_add(1 << 12));
        let mut packed = file.bytes(part.offset, stored)?;
        if self.is_reversed {
            for byte in &mut packed {
                *byte = byte.reverse_bits();
            }
        }
        let mut bytes = self.compression.unpack(&packed, count as usize)?;
        if (bytes.len() as u64) < count {
            return Err(ReadProblem::truncated(format_args!(
                "{name} ends after {} of {count} bytes",
                bytes.len()
            )));
        }
        let numbers = self
            .numbers
            .undo(self.predictor, &mut bytes, part.row_bytes as usize);
        Ok((bytes, numbers))
    }
}
