//! Stereolithography files (.stl), binary and text.
//!
//! A file is binary if it is as long as the count of triangles at its byte 80 says, whatever its
//! title is: many binary files begin with `solid`, which announces text. Normals are skipped: the
//! order of the corners says where a triangle faces.

use std::io::{BufRead, Read, Seek};
use std::path::Path;

use super::MeshData;
use super::build::{Builder, Line, short};
use crate::error::ReadError;
use crate::formats::MeshFormat;

/// Title and count.
const HEADER: u64 = 84;

/// Normal, three corners, and two bytes without meaning.
const TRIANGLE: u64 = 50;

pub(super) fn read<R: BufRead + Seek>(
    path: &Path,
    mut reader: R,
    length: u64,
) -> Result<MeshData, ReadError> {
    let io = |e| ReadError::io(path, e);
    let mut header = Vec::new();
    (&mut reader)
        .take(HEADER)
        .read_to_end(&mut header)
        .map_err(io)?;
    let count = header.last_chunk().map(|bytes| u32::from_le_bytes(*bytes));
    let expected = count
        .filter(|_| header.len() as u64 == HEADER)
        .map(|count| HEADER + TRIANGLE * u64::from(count));
    if expected == Some(length) {
        return read_binary(path, reader, count.unwrap_or(0));
    }
    if header.trim_ascii_start().starts_with(b"solid") {
        reader.rewind().map_err(io)?;
        return read_text(path, reader);
    }
    let mesh = Builder::new(path, MeshFormat::Stl);
    Err(match expected {
        None => ReadError::truncated(
            path,
            format_args!("its {length} bytes are less than the header of a binary STL file"),
        ),
        Some(expected) if expected > length => ReadError::truncated(
            path,
            format_args!(
                "{} triangles of {TRIANGLE} bytes were expected, but only {} bytes are there",
                count.unwrap_or(0),
                length - HEADER
            ),
        ),
        Some(expected) => mesh.malformed(format_args!(
            "{} bytes follow its {} triangles, where the file should end",
            length - expected,
            count.unwrap_or(0)
        )),
    })
}

fn read_binary<R: BufRead>(path: &Path, mut reader: R, count: u32) -> Result<MeshData, ReadError> {
    let mut mesh = Builder::new(path, MeshFormat::Stl);
    let mut bytes = [0; TRIANGLE as usize];
    for i in 0..count {
        reader
            .read_exact(&mut bytes)
            .map_err(|e| ReadError::io(path, e))?;
        let (words, _) = bytes[12..48].as_chunks::<4>();
        let x = |k: usize| f64::from(f32::from_le_bytes(words[k]));
        let corners = [0, 3, 6].map(|k| [x(k), x(k + 1), x(k + 2)]);
        mesh.triangle(corners).map_err(|what| {
            mesh.malformed(format_args!("a corner of its triangle {i} is {what}"))
        })?;
    }
    mesh.finish()
}

fn read_text<R: BufRead>(path: &Path, mut reader: R) -> Result<MeshData, ReadError> {
    let mut mesh = Builder::new(path, MeshFormat::Stl);
    let mut bytes = Vec::new();
    let mut number = 0;
    let mut corners = Vec::new();
    let mut ended = false;
    loop {
        bytes.clear();
        let read = reader.read_until(b'\n', &mut bytes);
        if read.map_err(|e| ReadError::io(path, e))? == 0 {
            break;
        }
        number += 1;
        // Names may be in any encoding.
        let text = String::from_utf8_lossy(&bytes);
        let line = Line {
            path,
            number,
            text: &text,
        };
        let mut words = line.words();
        let Some(word) = words.next() else {
            continue;
        };
        ended = false;
        match word.to_ascii_lowercase().as_str() {
            "solid" | "facet" | "endfacet" => {}
            "outer" => corners.clear(),
            "vertex" => {
                if corners.len() == 3 {
                    let what = "this loop has a fourth vertex, where triangles are needed";
                    return Err(line.refuse(word, what));
                }
                corners.push(line.coordinates(&mut words)?);
            }
            "endloop" => {
                let triangle = corners.as_slice().try_into().map_err(|_| {
                    let what = format_args!("{} vertices make no triangle", corners.len());
                    line.refuse(word, what)
                })?;
                mesh.triangle(triangle)
                    .map_err(|what| line.refuse(word, format_args!("a corner is {what}")))?;
                corners.clear();
            }
            "endsolid" => ended = true,
            _ => {
                return Err(line.refuse(
                    word,
                    format_args!(
                        "`{}` is no statement of an STL file; allowed are solid, facet, outer loop, vertex, endloop, endfacet and endsolid",
                        short(word)
                    ),
                ));
            }
        }
    }
    if !ended {
        let what = format_args!("it has no `endsolid` after its line {number}");
        return Err(ReadError::truncated(path, what));
    }
    mesh.finish()
}
