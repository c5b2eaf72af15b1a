//! Directories of a TIFF file: tags and their values, in files of either byte order, BigTIFF too.
//!
//! Every claim is checked against the length of the file before memory is taken for it.

use std::io::{Read, Seek, SeekFrom};

use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;
use crate::limits::room;

/// Tags of TIFF 6.0, GeoTIFF and GDAL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum Tag {
    NewSubfileType = 254,
    ImageWidth = 256,
    ImageLength = 257,
    BitsPerSample = 258,
    Compression = 259,
    PhotometricInterpretation = 262,
    FillOrder = 266,
    ImageDescription = 270,
    StripOffsets = 273,
    Orientation = 274,
    SamplesPerPixel = 277,
    RowsPerStrip = 278,
    StripByteCounts = 279,
    XResolution = 282,
    YResolution = 283,
    ResolutionUnit = 296,
    Predictor = 317,
    TileWidth = 322,
    TileLength = 323,
    TileOffsets = 324,
    TileByteCounts = 325,
    SampleFormat = 339,
    ModelPixelScale = 33550,
    ModelTransformation = 34264,
    GeoKeyDirectory = 34735,
    GeoDoubleParams = 34736,
    GeoAsciiParams = 34737,
    GdalMetadata = 42112,
    GdalNodata = 42113,
}

/// A TIFF file.
pub(super) struct File<R> {
    reader: R,
    pub(super) length: u64,
    pub(super) is_big_endian: bool,
    /// BigTIFF: offsets of eight bytes.
    is_big: bool,
}

impl<R: Read + Seek> File<R> {
    /// Opens a file of `length` bytes. Returns it with the offset of its first directory.
    pub(super) fn open(reader: R, length: u64) -> Result<(Self, u64), ReadProblem> {
        let mut file = Self {
            reader,
            length,
            is_big_endian: false,
            is_big: false,
        };
        file.is_big_endian = file.bytes(0, 2)? == b"MM";
        file.is_big = file.number(2, SampleKind::U16)? == 43;
        let at = if file.is_big { 8 } else { 4 };
        let first = file.number(at, file.offset_kind())?;
        Ok((file, first))
    }

    fn offset_kind(&self) -> SampleKind {
        match self.is_big {
            true => SampleKind::U64,
            false => SampleKind::U32,
        }
    }

    /// The `count` bytes from `at` on.
    pub(super) fn bytes(&mut self, at: u64, count: u64) -> Result<Vec<u8>, ReadProblem> {
        let mut bytes = Vec::new();
        if at.checked_add(count).is_some_and(|end| end <= self.length) {
            bytes = room(count, 1)?;
            self.reader.seek(SeekFrom::Start(at))?;
            self.reader.by_ref().take(count).read_to_end(&mut bytes)?;
        }
        match bytes.len() as u64 == count {
            true => Ok(bytes),
            false => Err(ReadProblem::truncated(format_args!(
                "{count} bytes from byte {at} on are needed, but it has {}",
                self.length
            ))),
        }
    }

    fn numbers(&mut self, at: u64, count: u64, kind: SampleKind) -> Result<Vec<f64>, ReadProblem> {
        let bytes = self.bytes(at, count.saturating_mul(kind.bytes() as u64))?;
        let mut numbers = room(count, 1)?;
        kind.decode(&bytes, self.is_big_endian, &mut numbers);
        Ok(numbers)
    }

    /// A whole number; offsets are exact up to 2^53.
    fn number(&mut self, at: u64, kind: SampleKind) -> Result<u64, ReadProblem> {
        Ok(self.numbers(at, 1, kind)?[0] as u64)
    }

    /// The directory at an offset.
    pub(super) fn directory(&mut self, at: u64) -> Result<Directory, ReadProblem> {
        let (count_kind, entry_size) = match self.is_big {
            true => (SampleKind::U64, 20),
            false => (SampleKind::U16, 12),
        };
        let count = self.number(at, count_kind)?;
        let first = at + count_kind.bytes() as u64;
        let entries = self.bytes(first, count.saturating_mul(entry_size))?;
        let (short, wide) = (SampleKind::U16, self.offset_kind());
        let field = |bytes: &[u8], kind: SampleKind| {
            let mut one = Vec::with_capacity(1);
            kind.decode(&bytes[..kind.bytes()], self.is_big_endian, &mut one);
            one[0] as u64
        };
        let width = wide.bytes();
        let entries = entries
            .chunks_exact(entry_size as usize)
            .zip(0..)
            .map(|(bytes, k)| {
                let (kind, count) = (field(&bytes[2..], short), field(&bytes[4..], wide));
                let is_inside = count.saturating_mul(size_of_kind(kind)) <= width as u64;
                Entry {
                    tag: field(bytes, short),
                    kind,
                    count,
                    at: match is_inside {
                        true => first + k * entry_size + 4 + width as u64,
                        false => field(&bytes[4 + width..], wide),
                    },
                }
            })
            .collect();
        let next = self.number(first + count * entry_size, wide)?;
        Ok(Directory { entries, next })
    }
}

/// Bytes of a value of a field type; 0 of an unknown one.
fn size_of_kind(kind: u64) -> u64 {
    match kind {
        1 | 2 | 6 | 7 => 1,
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16..=18 => 8,
        _ => 0,
    }
}

struct Entry {
    tag: u64,
    /// Field type.
    kind: u64,
    count: u64,
    /// Offset of the values.
    at: u64,
}

/// The tags of one page.
pub(super) struct Directory {
    entries: Vec<Entry>,
    /// Offset of the next directory; 0 if this is the last.
    pub(super) next: u64,
}

impl Directory {
    fn entry(&self, tag: Tag) -> Option<&Entry> {
        self.entries
            .iter()
            .find(|entry| entry.tag == u64::from(tag as u16))
    }

    /// Tags that their programs alone know.
    pub(super) fn private_tags(&self) -> impl Iterator<Item = u64> {
        let tags = self.entries.iter().map(|entry| entry.tag);
        tags.filter(|tag| *tag >= 32768)
    }

    /// Numbers of any type; rational ones as quotients.
    pub(super) fn numbers<R: Read + Seek>(
        &self,
        file: &mut File<R>,
        tag: Tag,
    ) -> Result<Option<Vec<f64>>, ReadProblem> {
        let Some(entry) = self.entry(tag) else {
            return Ok(None);
        };
        let (kind, each) = match entry.kind {
            1 => (SampleKind::U8, 1),
            3 => (SampleKind::U16, 1),
            4 | 13 => (SampleKind::U32, 1),
            5 => (SampleKind::U32, 2),
            6 => (SampleKind::I8, 1),
            8 => (SampleKind::I16, 1),
            9 => (SampleKind::I32, 1),
            10 => (SampleKind::I32, 2),
            11 => (SampleKind::F32, 1),
            12 => (SampleKind::F64, 1),
            16 | 18 => (SampleKind::U64, 1),
            17 => (SampleKind::I64, 1),
            other => {
                return Err(ReadProblem::malformed(format_args!(
                    "its tag {tag:?} has the field type {other}, but numbers are needed"
                )));
            }
        };
        let mut numbers = file.numbers(entry.at, entry.count.saturating_mul(each), kind)?;
        if each == 2 {
            numbers = numbers.chunks_exact(2).map(|n| n[0] / n[1]).collect();
        }
        match numbers.is_empty() {
            true => Err(ReadProblem::malformed(format_args!(
                "its tag {tag:?} has no value"
            ))),
            false => Ok(Some(numbers)),
        }
    }

    /// The first of the whole numbers of a tag.
    pub(super) fn whole<R: Read + Seek>(
        &self,
        file: &mut File<R>,
        tag: Tag,
    ) -> Result<Option<u64>, ReadProblem> {
        Ok(self.numbers(file, tag)?.map(|numbers| numbers[0] as u64))
    }

    /// Text up to its first NUL byte, in UTF-8 or else ISO 8859-1.
    pub(super) fn text<R: Read + Seek>(
        &self,
        file: &mut File<R>,
        tag: Tag,
    ) -> Result<Option<String>, ReadProblem> {
        let Some(entry) = self.entry(tag) else {
            return Ok(None);
        };
        let mut bytes = file.bytes(entry.at, entry.count)?;
        bytes.truncate(bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len()));
        let text = String::from_utf8(bytes)
            .unwrap_or_else(|error| error.as_bytes().iter().map(|b| char::from(*b)).collect());
        Ok(Some(text))
    }
}
