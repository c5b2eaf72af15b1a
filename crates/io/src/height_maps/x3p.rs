//! ISO 25178-72 (.x3p): a ZIP archive of `main.xml`, `bindata/data.bin` and MD5 checksums.
//!
//! Lengths are metres. Read: surfaces on a regular grid (CX and CY incremental, CZ absolute), of
//! numbers of type I (16 bits), L (32 bits), F or D, in a binary part or in the XML text; heights
//! are `Offset + Increment * number`. Points are missing where the number is NaN, the datum empty,
//! or their bit in the mask of valid points is 0 (one bit a point, the lowest first). MD5
//! checksums are verified where they are given. A rotation of the frame is ignored.
//!
//! Written: type D, not compressed (roughness hardly is compressible), converted to metres, with
//! all checksums; the border in the comment of Record2, as `border=periodic`. The date is fixed,
//! so that equal surfaces give equal bytes.

use std::io::{Cursor, Read, Seek, Write};
use std::path::Path;

use asperity_surface::{Border, HeightField, LengthUnit, RawHeightMap, check_grid};
use md5::{Digest, Md5};
use roxmltree::{Document, Node, ParsingOptions};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::samples::SampleKind;
use super::unit::power_of;
use crate::error::{ReadError, WriteError};
use crate::formats::HeightMapFormat;
use crate::limits::{COMPRESSION_LIMIT, check_packed_claim, room};

const MAIN: &str = "main.xml";
const DATA: &str = "bindata/data.bin";
const CHECKSUM: &str = "md5checksum.hex";
const NAMESPACE: &str = "http://www.opengps.eu/2008/ISO5436_2";

/// Longest main.xml that is read; data inside it take some 20 bytes a point.
const XML_LIMIT: u64 = 1 << 26;
/// Longest md5checksum.hex that is read.
const CHECKSUM_LIMIT: u64 = 1 << 12;
pub(crate) fn read<R: Read + Seek>(
    path: &Path,
    reader: R,
    length: u64,
) -> Result<RawHeightMap, ReadError> {
    let archive = ZipArchive::new(reader).map_err(|e| {
        malformed(
            path,
            format_args!("it is no complete ZIP archive ({e}); it may be cut short"),
        )
    })?;
    let mut parts = Parts {
        path,
        archive,
        length,
    };
    let xml = parts.read(MAIN, |size| size <= XML_LIMIT)?;
    if parts.has(CHECKSUM) {
        let stated = parts.read(CHECKSUM, |size| size <= CHECKSUM_LIMIT)?;
        let stated = String::from_utf8_lossy(&stated);
        let stated = stated.split_whitespace().next().unwrap_or_default();
        compare(path, MAIN, Md5::new_with_prefix(&xml), stated)?;
    }
    let xml = String::from_utf8(xml).map_err(|_| malformed(path, "its main.xml is not UTF-8"))?;
    let options = ParsingOptions {
        allow_dtd: false,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&xml, options)
        .map_err(|e| malformed(path, format_args!("its main.xml cannot be parsed ({e})")))?;
    let xml = Xml { path };
    let root = document.root_element();
    let grid = Grid::parse(&xml, root)?;
    let claim = [grid.rows as u64, grid.columns as u64];
    check_packed_claim(path, claim, 1, length)?;
    check_grid([grid.rows, grid.columns], grid.spacing).map_err(ReadError::surface(path))?;

    let record = xml.child(root, "Record3")?;
    let mut heights = match xml.optional(record, "DataLink")? {
        Some(link) => parts.linked(&xml, link, &grid)?,
        None => inline(&xml, xml.child(record, "DataList")?, &grid)?,
    };
    if grid.increment != 1.0 || grid.offset != 0.0 {
        for height in &mut heights {
            *height = *height * grid.increment + grid.offset;
        }
    }
    let mut map = RawHeightMap::new(heights, [grid.rows, grid.columns], grid.spacing)
        .map_err(ReadError::surface(path))?;
    map.unit = LengthUnit::Metre;
    map.border = border(&xml, root)?;
    Ok(map)
}

fn malformed(path: &Path, what: impl std::fmt::Display) -> ReadError {
    ReadError::malformed(path, HeightMapFormat::X3p, what)
}

/// Refuses a part whose MD5 checksum is not the stated one.
fn compare(path: &Path, part: &str, found: Md5, stated: &str) -> Result<(), ReadError> {
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

fn hex(digest: Md5) -> String {
    use std::fmt::Write;
    digest
        .finalize()
        .iter()
        .fold(String::new(), |mut text, byte| {
            // Writing to a string cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// The parts of the archive.
struct Parts<'a, R> {
    path: &'a Path,
    archive: ZipArchive<R>,
    length: u64,
}

impl<R: Read + Seek> Parts<'_, R> {
    fn has(&self, name: &str) -> bool {
        self.archive.index_for_name(name).is_some()
    }

    /// Reads a whole part whose claimed length `allowed` accepts.
    fn read(&mut self, name: &str, allowed: impl Fn(u64) -> bool) -> Result<Vec<u8>, ReadError> {
        let path = self.path;
        self.open(name, allowed, |size, reader| {
            let mut bytes: Vec<u8> = room(path, size, 1)?;
            bytes.resize(size as usize, 0);
            reader
                .read_exact(&mut bytes)
                .map_err(|e| unpacking(path, name, e))?;
            Ok(bytes)
        })
    }

    /// Lets `take` read a part, and sees that it takes all of it.
    fn open<T>(
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
                    "its part `{name}` claims {size} bytes, which is not what it can or should hold"
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
    fn linked(
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
        let mut heights = self.open(
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
            compare(path, &name, digest, xml.text(stated))?;
        }
        if let Some(valid) = xml.optional(link, "ValidPointsLink")? {
            let name = self.resolve(xml.text(valid));
            let mask = self.read(&name, |size| size == count.div_ceil(8) as u64)?;
            if let Some(stated) = xml.optional(link, "MD5ChecksumValidPoints")? {
                compare(path, &name, Md5::new_with_prefix(&mask), xml.text(stated))?;
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

/// Heights, before scaling, from the XML text: `x;y;z` or `z` in each `Datum`.
fn inline(xml: &Xml<'_>, list: Node<'_, '_>, grid: &Grid) -> Result<Vec<f64>, ReadError> {
    let [nx, ny] = [grid.columns as u64, grid.rows as u64];
    let data = || list.children().filter(|node| node.has_tag_name("Datum"));
    let count = data().count();
    if nx.checked_mul(ny) != Some(count as u64) {
        return Err(malformed(
            xml.path,
            format_args!("{count} data stand in its DataList, where {nx} x {ny} are needed"),
        ));
    }
    let mut heights = room(xml.path, nx, ny)?;
    for datum in data() {
        let text = xml.text(datum);
        let z = text.rsplit(';').next().unwrap_or_default().trim();
        heights.push(if z.is_empty() {
            f64::NAN
        } else {
            xml.number("Datum", z)?
        });
    }
    Ok(heights)
}

/// What main.xml says of the axes.
struct Grid {
    columns: usize,
    rows: usize,
    spacing: [f64; 2],
    kind: SampleKind,
    increment: f64,
    offset: f64,
}

impl Grid {
    fn parse(xml: &Xml<'_>, root: Node<'_, '_>) -> Result<Self, ReadError> {
        if root.tag_name().name() != "ISO5436_2" {
            return Err(malformed(
                xml.path,
                format_args!(
                    "the root of its main.xml is `{}`, where ISO5436_2 is needed",
                    root.tag_name().name()
                ),
            ));
        }
        let first = xml.child(root, "Record1")?;
        if let Some(feature) = xml.optional(first, "FeatureType")?
            && xml.text(feature) != "SUR"
        {
            return Err(ReadError::unsupported(
                xml.path,
                format_args!(
                    "its feature type is `{}`, but only surfaces on a grid (SUR) are read",
                    xml.text(feature)
                ),
            ));
        }
        let axes = xml.child(first, "Axes")?;
        let mut spacing = [0.0; 2];
        for (name, spacing) in ["CX", "CY"].into_iter().zip(&mut spacing) {
            let axis = xml.child(axes, name)?;
            let kind = xml.text(xml.child(axis, "AxisType")?);
            if kind != "I" {
                return Err(ReadError::unsupported(
                    xml.path,
                    format_args!(
                        "its axis {name} is of type `{kind}`, with a coordinate for each point, but only regular grids (type I, incremental) are read"
                    ),
                ));
            }
            let increment = xml.child(axis, "Increment")?;
            *spacing = xml.number("Increment", xml.text(increment))?;
        }

        let axis = xml.child(axes, "CZ")?;
        if let Some(kind) = xml.optional(axis, "AxisType")?
            && xml.text(kind) != "A"
        {
            return Err(ReadError::unsupported(
                xml.path,
                format_args!(
                    "its axis CZ is of type `{}`, but heights must be absolute (type A)",
                    xml.text(kind)
                ),
            ));
        }
        let kind = match xml.text(xml.child(axis, "DataType")?) {
            "I" => SampleKind::I16,
            "L" => SampleKind::I32,
            "F" => SampleKind::F32,
            "D" => SampleKind::F64,
            other => {
                return Err(malformed(
                    xml.path,
                    format_args!("the data type of CZ is `{other}`, but allowed are I, L, F and D"),
                ));
            }
        };
        let number = |name| {
            xml.optional(axis, name)?
                .map(|node| xml.number(name, xml.text(node)))
                .transpose()
        };
        let increment = number("Increment")?;
        let whole = matches!(kind, SampleKind::I16 | SampleKind::I32);
        if whole && increment.is_none() {
            return Err(malformed(
                xml.path,
                "its heights are whole numbers, but CZ has no Increment to make metres of them",
            ));
        }
        let (increment, offset) = (increment.unwrap_or(1.0), number("Offset")?.unwrap_or(0.0));
        if !(increment.is_finite() && increment != 0.0 && offset.is_finite()) {
            return Err(malformed(
                xml.path,
                format_args!(
                    "CZ has Increment {increment} and Offset {offset}, which must be finite, the first not zero"
                ),
            ));
        }

        let third = xml.child(root, "Record3")?;
        let Some(size) = xml.optional(third, "MatrixDimension")? else {
            return Err(ReadError::unsupported(
                xml.path,
                "it has no MatrixDimension and so is a list of points, but only regular grids are read",
            ));
        };
        let length = |name| {
            let text = xml.text(xml.child(size, name)?);
            text.parse::<u64>().map_err(|_| {
                malformed(
                    xml.path,
                    format_args!("{name} is `{text}`, where a positive whole number is needed"),
                )
            })
        };
        let layers = length("SizeZ")?;
        if layers != 1 {
            return Err(ReadError::unsupported(
                xml.path,
                format_args!("it has {layers} layers (SizeZ), but one is needed"),
            ));
        }
        let [columns, rows] =
            [length("SizeX")?, length("SizeY")?].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        Ok(Self {
            columns,
            rows,
            spacing,
            kind,
            increment,
            offset,
        })
    }
}

/// Looks into main.xml.
struct Xml<'a> {
    path: &'a Path,
}

impl Xml<'_> {
    fn optional<'n, 'i>(
        &self,
        parent: Node<'n, 'i>,
        name: &str,
    ) -> Result<Option<Node<'n, 'i>>, ReadError> {
        let mut found = parent
            .children()
            .filter(|node| node.is_element() && node.tag_name().name() == name);
        let first = found.next();
        if found.next().is_some() {
            return Err(malformed(
                self.path,
                format_args!("its {} has {name} twice", parent.tag_name().name()),
            ));
        }
        Ok(first)
    }

    fn child<'n, 'i>(&self, parent: Node<'n, 'i>, name: &str) -> Result<Node<'n, 'i>, ReadError> {
        self.optional(parent, name)?.ok_or_else(|| {
            malformed(
                self.path,
                format_args!("its {} lacks {name}", parent.tag_name().name()),
            )
        })
    }

    fn text<'n>(&self, node: Node<'n, '_>) -> &'n str {
        node.text().unwrap_or_default().trim()
    }

    fn number(&self, name: &str, text: &str) -> Result<f64, ReadError> {
        text.parse().map_err(|_| {
            malformed(
                self.path,
                format_args!(
                    "{name} is `{}`, where a number is needed",
                    text.chars().take(40).collect::<String>()
                ),
            )
        })
    }
}

/// The border that our own comment names.
fn border(xml: &Xml<'_>, root: Node<'_, '_>) -> Result<Option<Border>, ReadError> {
    let Some(record) = xml.optional(root, "Record2")? else {
        return Ok(None);
    };
    let Some(comment) = xml.optional(record, "Comment")? else {
        return Ok(None);
    };
    // A comment is free text: what is no border there is no error.
    Ok(xml
        .text(comment)
        .split_whitespace()
        .find_map(|word| word.strip_prefix("border=")?.parse().ok()))
}

pub(crate) fn write<W: Write>(
    path: &Path,
    field: &HeightField,
    out: &mut W,
) -> Result<(), WriteError> {
    let io = WriteError::io(path);
    let to_metres = power_of(field.unit())
        .and_then(|unit| unit.convert(LengthUnit::Metre))
        .ok_or_else(|| WriteError::NoUnit {
            path: path.to_owned(),
        })?;
    let samples = || field.heights().iter().map(|h| to_metres(*h).to_le_bytes());
    let mut digest = Md5::new();
    for sample in samples() {
        digest.update(sample);
    }
    let xml = main_xml(field, field.spacing().map(to_metres), &hex(digest));

    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(zip::DateTime::default())
        .unix_permissions(0o644);
    // Only parts beyond 4 GiB need the longer form, which not every reader knows.
    let long = size_of_val(field.heights()) >= u32::MAX as usize;
    let fail = |error: ZipError| io(error.into());
    // In memory, since the archive writer, when dropped after an error of the disk, would try once
    // more and print its failure.
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    archive.start_file(MAIN, options).map_err(fail)?;
    archive.write_all(xml.as_bytes()).map_err(&io)?;
    archive
        .start_file(DATA, options.large_file(long))
        .map_err(fail)?;
    for sample in samples() {
        archive.write_all(&sample).map_err(&io)?;
    }
    archive.start_file(CHECKSUM, options).map_err(fail)?;
    let checksum = hex(Md5::new_with_prefix(xml.as_bytes()));
    writeln!(archive, "{checksum} *{MAIN}").map_err(&io)?;
    let bytes = archive.finish().map_err(fail)?.into_inner();
    out.write_all(&bytes).map_err(&io)
}

fn main_xml(field: &HeightField, [dx, dy]: [f64; 2], checksum: &str) -> String {
    let [ny, nx] = field.shape();
    let border = field.border();
    let version = env!("CARGO_PKG_VERSION");
    format!(
        r#"<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<p:ISO5436_2 xmlns:p="{NAMESPACE}">
  <Record1>
    <Revision>ISO5436 - 2000</Revision>
    <FeatureType>SUR</FeatureType>
    <Axes>
      <CX>
        <AxisType>I</AxisType>
        <DataType>D</DataType>
        <Increment>{dx:e}</Increment>
        <Offset>0</Offset>
      </CX>
      <CY>
        <AxisType>I</AxisType>
        <DataType>D</DataType>
        <Increment>{dy:e}</Increment>
        <Offset>0</Offset>
      </CY>
      <CZ>
        <AxisType>A</AxisType>
        <DataType>D</DataType>
        <Increment>1</Increment>
        <Offset>0</Offset>
      </CZ>
    </Axes>
  </Record1>
  <Record2>
    <Date>1970-01-01T00:00:00</Date>
    <Instrument>
      <Manufacturer>asperity</Manufacturer>
      <Model>simulated surface</Model>
      <Serial>not available</Serial>
      <Version>{version}</Version>
    </Instrument>
    <CalibrationDate>1970-01-01T00:00:00</CalibrationDate>
    <ProbingSystem>
      <Type>Software</Type>
      <Identification>not available</Identification>
    </ProbingSystem>
    <Comment>border={border}</Comment>
  </Record2>
  <Record3>
    <MatrixDimension>
      <SizeX>{nx}</SizeX>
      <SizeY>{ny}</SizeY>
      <SizeZ>1</SizeZ>
    </MatrixDimension>
    <DataLink>
      <PointDataLink>{DATA}</PointDataLink>
      <MD5ChecksumPointData>{checksum}</MD5ChecksumPointData>
    </DataLink>
  </Record3>
  <Record4>
    <ChecksumFile>{CHECKSUM}</ChecksumFile>
  </Record4>
</p:ISO5436_2>
"#
    )
}
