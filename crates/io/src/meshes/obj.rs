//! Wavefront objects (.obj), the polygons of them.
//!
//! `v` gives a vertex (what follows its three coordinates, a weight or a colour, is ignored), `f`
//! a polygon of vertices counted from one, or from the last one backwards if negative; texture
//! coordinates and normals after a slash, and all other statements, are skipped. A backslash at its
//! end joins a line with the next.

use std::io::BufRead;
use std::path::Path;

use super::MeshData;
use super::build::{Builder, Line, short};
use crate::error::ReadError;
use crate::formats::MeshFormat;

pub(super) fn read<R: BufRead>(path: &Path, mut reader: R) -> Result<MeshData, ReadError> {
    let mut mesh = Builder::new(path, MeshFormat::Obj);
    let mut bytes = Vec::new();
    let mut corners = Vec::new();
    let mut number = 0;
    loop {
        let first = number + 1;
        bytes.clear();
        loop {
            let read = reader.read_until(b'\n', &mut bytes);
            if read.map_err(|e| ReadError::io(path, e))? == 0 {
                break;
            }
            number += 1;
            let end = bytes.trim_ascii_end().len();
            if !bytes[..end].ends_with(b"\\") {
                break;
            }
            bytes.truncate(end - 1);
            bytes.push(b' ');
        }
        if bytes.is_empty() {
            return mesh.finish();
        }
        // Names and comments may be in any encoding.
        let text = String::from_utf8_lossy(&bytes);
        let line = Line {
            path,
            number: first,
            text: &text,
        };
        let mut words = line.words();
        match words.next() {
            Some("v") => {
                let vertex = line.coordinates(&mut words)?;
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

/// The vertex of a corner as in `7`, `7/1`, `7//3`, `7/1/3` or `-1`, counted from zero.
fn corner(line: Line<'_>, word: &str, vertices: usize) -> Result<i64, ReadError> {
    let (vertex, _) = word.split_once('/').unwrap_or((word, ""));
    let there = vertices as i64;
    match vertex.parse::<i64>() {
        Ok(k) if (1..=there).contains(&k) => Ok(k - 1),
        Ok(k) if (-there..0).contains(&k) => Ok(there + k),
        Ok(k) => Err(line.refuse(
            word,
            format_args!(
                "this face has the vertex number {k}, where {there} vertices stand before it, counted from 1, or backwards from -1"
            ),
        )),
        Err(_) => Err(line.refuse(
            word,
            format_args!(
                "`{}` is no corner of a face; a vertex number is needed",
                short(word)
            ),
        )),
    }
}
