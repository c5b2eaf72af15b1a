//! Writing of X3P files.

use std::io::{Cursor, Write};

use asperity_surface::{HeightField, LengthUnit};
use md5::{Digest, Md5};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::parts::{CHECKSUM, MAIN};
use crate::error::WriteProblem;
use crate::files::hex;
use crate::height_maps::unit::power_of;

const DATA: &str = "bindata/data.bin";
const NAMESPACE: &str = "http://www.opengps.eu/2008/ISO5436_2";

pub(crate) fn write<W: Write>(field: &HeightField, out: &mut W) -> Result<(), WriteProblem> {
    let to_metres = power_of(field.unit())
        .and_then(|unit| unit.convert(LengthUnit::Metre))
        .ok_or(WriteProblem::NoUnit)?;
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
    let fail = |error: ZipError| WriteProblem::Io(error.into());
    // In memory, since the archive writer, when dropped after an error of the disk, would try once
    // more and print its failure.
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    archive.start_file(MAIN, options).map_err(fail)?;
    archive.write_all(xml.as_bytes())?;
    archive
        .start_file(DATA, options.large_file(long))
        .map_err(fail)?;
    for sample in samples() {
        archive.write_all(&sample)?;
    }
    archive.start_file(CHECKSUM, options).map_err(fail)?;
    let checksum = hex(Md5::new_with_prefix(xml.as_bytes()));
    writeln!(archive, "{checksum} *{MAIN}")?;
    let bytes = archive.finish().map_err(fail)?.into_inner();
    Ok(out.write_all(&bytes)?)
}

fn main_xml(field: &HeightField, [dx, dy]: [f64; 2], checksum: &str) -> String {
    let [ny, nx] = field.shape();
    let border = field.border();
    let cells = field.turned_cells().map_or("", |_| " cells=turned");
    let version = env!("CARGO_PKG_VERSION");
    let model = match field.provenance() {
        Some(_) => "simulated surface",
        None => "processed surface",
    };
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
      <Model>{model}</Model>
      <Serial>not available</Serial>
      <Version>{version}</Version>
    </Instrument>
    <CalibrationDate>1970-01-01T00:00:00</CalibrationDate>
    <ProbingSystem>
      <Type>Software</Type>
      <Identification>not available</Identification>
    </ProbingSystem>
    <Comment>border={border}{cells}</Comment>
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
