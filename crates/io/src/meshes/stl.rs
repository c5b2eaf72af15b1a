//! Stereolithography files (.stl), binary and text.
//!
//! A file is binary if it is as long as the count of triangles at its byte 80 says, whatever its
//! title is: many binary files begin with `solid`, which announces text. Normals are skipped: the
//! order of the corners says where a triangle faces.

use std::io::{BufRead, Read, Seek, Write};

use super::build::{Builder, coordinates};
use super::mesh::{MeshData, MeshView};
use crate::encoding::single;
use crate::error::{ReadProblem, WriteProblem};
use crate::text_lines::{Line, read_line, short};

/// Title and count.
const HEADER: u64 = 84;

/// Normal, three corners, and two bytes without meaning.
const TRIANGLE: u64 = 50;

pub(super) fn read<R: BufRead + Seek>(mut reader: R, length: u64) -> Result<MeshData, ReadProblem> {
    let mut header = Vec::new();
    (&mut reader).take(HEADER).read_to_end(&mut header)?;
    let count = header.last_chunk().map(|bytes| u32::from_le_bytes(*bytes));
    let expected = count
        .filter(|_| header.len() as u64 == HEADER)
        .map(|count| HEADER + TRIANGLE * u64::from(count));
    if expected == Some(length) {
        return read_binary(reader, count.unwrap_or(0));
    }
    if header.trim_ascii_start().starts_with(b"solid") {
        reader.rewind()?;
        return read_text(reader);
    }
    Err(match expected {
        None => ReadProblem::truncated(format_args!(
            "its {length} bytes are less than the header of a binary STL file"
        )),
        Some(expected) if expected > length => ReadProblem::truncated(format_args!(
            "{} triangles of {TRIANGLE} bytes were expected, but only {} bytes are there",
            count.unwrap_or(0),
            length - HEADER
        )),
        Some(expected) => ReadProblem::malformed(format_args!(
            "{} bytes follow its {} triangles",
            length - expected,
            count.unwrap_or(0)
        )),
    })
}

fn read_binary<R: BufRead>(mut reader: R, count: u32) -> Result<MeshData, ReadProblem> {
    let mut mesh = Builder::default();
    let mut bytes = [0; TRIANGLE as usize];
    for i in 0..count {
        reader.read_exact(&mut bytes)?;
        let (words, _) = bytes[12..48].as_chunks::<4>();
        let x = |k: usize| f64::from(f32::from_le_bytes(words[k]));
        let corners = [0, 3, 6].map(|k| [x(k), x(k + 1), x(k + 2)]);
        mesh.triangle(corners).map_err(|what| {
            ReadProblem::malformed(format_args!("a corner of its triangle {i} is {what}"))
        })?;
    }
    mesh.finish()
}

fn read_text<R: BufRead>(mut reader: R) -> Result<MeshData, ReadProblem> {
    let mut mesh = Builder::default();
    let mut bytes = Vec::new();
    let mut number = 0;
    let mut corners = Vec::new();
    let mut ended = false;
    while read_line(&mut reader, &mut bytes)? {
        number += 1;
        // Names may be in any encoding.
        let text = String::from_utf8_lossy(&bytes);
        let line = Line {
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
                    let what = "this loop has a fourth vertex, but only triangles are allowed";
                    return Err(line.refuse(word, what));
                }
                corners.push(coordinates(line, &mut words)?);
            }
            "endloop" => {
                let triangle = corners.as_slice().try_into().map_err(|_| {
                    let what = format_args!("a triangle has 3 vertices, not {}", corners.len());
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
                        "`{}` is not a statement of an STL file; allowed are solid, facet, outer loop, vertex, endloop, endfacet and endsolid",
                        short(word)
                    ),
                ));
            }
        }
    }
    if !ended {
        let what = format_args!("it has no `endsolid` after its line {number}");
        return Err(ReadProblem::truncated(what));
    }
    mesh.finish()
}

pub(super) fn write(mesh: &MeshView<'_>, out: &mut impl Write) -> Result<(), WriteProblem> {
    // A header must not begin with "solid", which would announce the text form.
    let mut header = [b' '; 80];
    let title = match mesh.comment {
        "" => "Binary STL, corners counter-clockwise seen from outside".to_owned(),
        comment => format!("STL, {comment}"),
    };
    for (byte, character) in header.iter_mut().zip(title.bytes()) {
        *byte = character;
    }
    out.write_all(&header)?;
    let count = mesh.triangles.len() as u32;
    out.write_all(&count.to_le_bytes())?;
    for triangle in mesh.triangles {
        let corners = triangle.map(|k| mesh.vertices[k as usize]);
        let normal = unit_normal(corners);
        for vector in [normal, corners[0], corners[1], corners[2]] {
            for x in vector {
                let x = single("a coordinate", x)?;
                out.write_all(&x.to_le_bytes())?;
            }
        }
        out.write_all(&[0, 0])?;
    }
    Ok(())
}

/// The unit normal of a triangle by the right-hand rule; zero if it has no area.
pub(super) fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    // Edges are scaled first: their products must neither vanish nor overflow.
    let (u, v) = (scaled(minus(b, a)), scaled(minus(c, a)));
    let n = scaled([
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]);
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        n.map(|x| x / length)
    } else {
        [0.0; 3]
    }
}

/// The vector with its largest component scaled to 1, or as it is if it has none.
fn scaled(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest > 0.0 {
        v.map(|x| x / largest)
    } else {
        v
    }
}
