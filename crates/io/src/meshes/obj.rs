//! Wavefront objects (.obj), the polygons of them.
//!
//! `v` gives a vertex (what follows its three coordinates, a weight or a colour, is ignored), `f`
//! a polygon of vertices counted from one, or from the last one backwards if negative; texture
//! coordinates and normals after a slash, and all other statements, are skipped. A backslash at its
//! end joins a line with the next.

use std::io::{self, BufRead, Write};

use super::build::{Builder, coordinates};
use super::mesh::{MeshData, MeshView};
use crate::error::ReadProblem;
use crate::text_lines::{Line, read_line, short};

pub(super) fn read<R: BufRead>(mut reader: R) -> Result<MeshData, ReadProblem> {
    let mut mesh = Builder::default();
    let mut bytes = Vec::new();
    let mut corners = Vec::new();
    let mut number = 0;
    loop {
        let first = number + 1;
        number += read_joined_line(&mut reader, &mut bytes)?;
        if bytes.is_empty() {
            return mesh.finish();
        }
        // Names and comments may be in any encoding.
        let text = String::from_utf8_lossy(&bytes);
        let line = Line {
            number: first,
            text: &text,
        };
        let mut words = line.words();
        match words.next() {
            Some("v") => {
                let vertex = coordinates(line, &mut words)?;
                mesh.vertex(vertex).map_err(|what| {
                    line.refuse(line.text, format_args!("this vertex is {what}"))
                })?;
            }
            Some("f") => {
                corners.clear();
                for word in words {
                    corners.push(corner(line, word, mesh.vertices())?);
                }
                mesh.polygon(&corners)
                    .map_err(|what| line.refuse(line.text, format_args!("this face has {what}")))?;
            }
            _ => {}
        }
    }
}

/// Reads the next line into `bytes`, joined with those that follow a backslash at its end. Returns the
/// number of lines read.
fn read_joined_line(reader: &mut impl BufRead, bytes: &mut Vec<u8>) -> Result<usize, ReadProblem> {
    let mut count = 0;
    let mut line = Vec::new();
    bytes.clear();
    while read_line(reader, &mut line)? {
        count += 1;
        match line.trim_ascii_end().strip_suffix(b"\\") {
            Some(start) => {
                bytes.extend_from_slice(start);
                bytes.push(b' ');
            }
            None => {
                bytes.extend_from_slice(&line);
                break;
            }
        }
    }
    Ok(count)
}

/// The vertex of a corner as in `7`, `7/1`, `7//3`, `7/1/3` or `-1`, counted from zero.
fn corner(line: Line<'_>, word: &str, vertices: usize) -> Result<i64, ReadProblem> {
    let (vertex, _) = word.split_once('/').unwrap_or((word, ""));
    let there = vertices as i64;
    match vertex.parse::<i64>() {
        Ok(k) if (1..=there).contains(&k) => Ok(k - 1),
        Ok(k) if (-there..0).contains(&k) => Ok(there + k),
        Ok(k) => Err(line.refuse(
            word,
            format_args!(
                "this face has the vertex number {k}, but {there} vertices come before it, counted from 1, or backwards from -1"
            ),
        )),
        Err(_) => Err(line.refuse(
            word,
            format_args!(
                "`{}` is not a corner of a face; a vertex number is needed",
                short(word)
            ),
        )),
    }
}

pub(super) fn write(mesh: &MeshView<'_>, out: &mut impl Write) -> io::Result<()> {
    if !mesh.comment.is_empty() {
        writeln!(out, "# {}", mesh.comment)?;
    }
    for [x, y, z] in mesh.vertices {
        // Debug gives the shortest digits that are the same double, with an exponent where long.
        writeln!(out, "v {x:?} {y:?} {z:?}")?;
    }
    for triangle in mesh.triangles {
        let [a, b, c] = triangle.map(|k| u64::from(k) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}
