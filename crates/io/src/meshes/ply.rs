//! Stanford polygon files (.ply): text, and binary in either byte order, by ply-rs-bw.
//!
//! Elements are read one by one, so that a count in the header takes no memory. Vertices have the
//! properties `x`, `y` and `z` of any type, faces a list `vertex_indices` or `vertex_index` of whole
//! numbers, and so have strips of triangles (`tristrips`), which -1 parts; all other properties and elements are skipped.

use std::io::{self, BufRead, ErrorKind, Read, Write};

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};

use super::build::Builder;
use super::mesh::{MeshData, MeshView};
use crate::error::ReadProblem;
use crate::text_lines::{Line, read_line, short};

/// Longest header that is read.
const HEADER_LIMIT: u64 = 1 << 20;

pub(super) fn read<R: BufRead>(mut reader: R, length: u64) -> Result<MeshData, ReadProblem> {
    let mut mesh = Builder::default();
    let mut head = Reader::new((&mut reader).take(HEADER_LIMIT));
    let header = match Parser::<Skipped>::new().read_header(&mut head) {
        Ok(header) => header,
        Err(_) if head.get_ref().limit() == 0 => {
            let what = format_args!("its header does not end within {HEADER_LIMIT} bytes");
            return Err(ReadProblem::malformed(what));
        }
        Err(error) => return Err(header_error(&error)),
    };
    let line = head.line();
    check(&header, length)?;
    let mut elements = Elements {
        reader,
        encoding: header.encoding,
        line: line.saturating_sub(1),
        bytes: Vec::new(),
    };
    for element in header.elements.values() {
        let name = element.name.as_str();
        for i in 0..element.count {
            let taken = match name {
                "vertex" => {
                    let Vertex(vertex) = elements.next(element, i)?;
                    mesh.vertex(vertex).map_err(|what| ("is", what))
                }
                "face" => {
                    let Corners(corners) = elements.next(element, i)?;
                    mesh.polygon(&corners).map_err(|what| ("has", what))
                }
                "tristrips" => {
                    let Corners(corners) = elements.next(element, i)?;
                    mesh.strips(&corners).map_err(|what| ("has", what))
                }
                _ => elements.next(element, i).map(|Skipped| Ok(()))?,
            };
            taken.map_err(|(verb, what)| {
                ReadProblem::malformed(format_args!(
                    "its {name} {i}, counted from zero, {verb} {what}"
                ))
            })?;
        }
    }
    elements.end()?;
    mesh.finish()
}

/// The elements of a file, in their order.
struct Elements<R> {
    reader: R,
    encoding: Encoding,
    /// Last line read, counted from one.
    line: usize,
    bytes: Vec<u8>,
}

impl<R: BufRead> Elements<R> {
    /// Element number `i` of a kind.
    fn next<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        i: usize,
    ) -> Result<E, ReadProblem> {
        let parser = Parser::<E>::new();
        let parsed = match self.encoding {
            Encoding::Ascii => {
                if !self.next_line()? {
                    return Err(self.cut(element, i));
                }
                let text = String::from_utf8_lossy(&self.bytes);
                let line = Line {
                    number: self.line,
                    text: &text,
                };
                return parser.read_ascii_element(&text, element).map_err(|_| {
                    line.refuse(
                        line.text,
                        format_args!(
                            "`{}` is not a {} as the header declares it: {}",
                            short(&text),
                            short(&element.name),
                            properties(element)
                        ),
                    )
                });
            }
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.reader, element),
            Encoding::BinaryLittleEndian => {
                parser.read_little_endian_element(&mut self.reader, element)
            }
        };
        parsed.map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => self.cut(element, i),
            ErrorKind::InvalidInput => ReadProblem::malformed(format_args!(
                "the list of its {} {i}, counted from zero, has a negative length",
                short(&element.name)
            )),
            _ => io::Error::from(error).into(),
        })
    }

    /// Reads the next line that is not blank; false if there is none.
    fn next_line(&mut self) -> Result<bool, ReadProblem> {
        while read_line(&mut self.reader, &mut self.bytes)? {
            self.line += 1;
            if !self.bytes.trim_ascii().is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn cut(&self, element: &ElementDef, i: usize) -> ReadProblem {
        let ElementDef { name, count, .. } = element;
        ReadProblem::truncated(format_args!(
            "{count} elements `{}` were expected, but only {i} are there",
            short(name)
        ))
    }

    /// Refuses what follows the last element.
    fn end(&mut self) -> Result<(), ReadProblem> {
        let more = match self.encoding {
            Encoding::Ascii => self.next_line()?,
            _ => !self.reader.fill_buf()?.is_empty(),
        };
        if more {
            let what = "more data follow its last element";
            return Err(ReadProblem::malformed(what));
        }
        Ok(())
    }
}

fn header_error(error: &ParseError) -> ReadProblem {
    if error.kind() == ErrorKind::UnexpectedEof {
        return ReadProblem::truncated("its header has no line `end_header`");
    }
    match error.line() {
        Some(1) => ReadProblem::malformed("its first line is not `ply`"),
        Some(line) => ReadProblem::malformed(format_args!(
            "line {line} is not valid in the header of a PLY file, version 1.0"
        )),
        None => ReadProblem::malformed(
            "its header is not text with a line `format ascii 1.0`, `format binary_little_endian 1.0` or `format binary_big_endian 1.0`",
        ),
    }
}

/// Checks the header before anything is read by it.
fn check(header: &Header, length: u64) -> Result<(), ReadProblem> {
    let place = |name: &str| header.elements.keys().position(|own| own == name);
    let Some(vertices) = place("vertex") else {
        return Err(ReadProblem::malformed("it has no element `vertex`"));
    };
    check_vertices(header)?;
    let mut has_faces = false;
    for (name, what) in FACES {
        match place(name) {
            None => continue,
            Some(faces) if faces < vertices => {
                let what = format_args!("its {what} come before its vertices");
                return Err(ReadProblem::malformed(what));
            }
            Some(_) => check_corners(&header.elements[name], what)?,
        }
        has_faces = true;
    }
    if !has_faces {
        return Err(ReadProblem::malformed(
            "it has no element `face`, nor strips of triangles, `tristrips`",
        ));
    }
    check_size(header, length)
}

/// Elements with lists of corners, and their names in messages.
const FACES: [(&str, &str); 2] = [("face", "faces"), ("tristrips", "strips of triangles")];

/// Checks that vertices have three coordinates.
fn check_vertices(header: &Header) -> Result<(), ReadProblem> {
    let vertex = &header.elements["vertex"];
    for name in ["x", "y", "z"] {
        match vertex.properties.get(name).map(|p| &p.data_type) {
            Some(PropertyType::Scalar(_)) => {}
            Some(PropertyType::List(..)) => {
                return Err(ReadProblem::malformed(format_args!(
                    "the property {name} of its vertices is a list, but a number is needed"
                )));
            }
            None => {
                let what = format_args!("its vertices have no property {name}");
                return Err(ReadProblem::malformed(what));
            }
        }
    }
    Ok(())
}

/// Checks that elements have one list of corners; `what` are they in messages.
fn check_corners(element: &ElementDef, what: &str) -> Result<(), ReadProblem> {
    let lists = element.properties.values();
    let lists: Vec<_> = lists
        .filter(|p| CORNERS.contains(&p.name.as_str()))
        .collect();
    match *lists {
        [] => Err(ReadProblem::malformed(format_args!(
            "its {what} have no list `vertex_indices` or `vertex_index`"
        ))),
        [list] => match &list.data_type {
            PropertyType::List(_, item) if is_whole(item) => Ok(()),
            _ => Err(ReadProblem::malformed(format_args!(
                "the {} of its {what} are not a list of whole numbers",
                list.name
            ))),
        },
        _ => Err(ReadProblem::malformed(format_args!(
            "its {what} have two lists of corners"
        ))),
    }
}

/// Checks that the file can hold the elements that its header claims.
fn check_size(header: &Header, length: u64) -> Result<(), ReadProblem> {
    // The least size of the elements: no header may claim more than its file holds.
    let mut least = 0_u64;
    for element in header.elements.values() {
        let mut bytes = 0;
        for p in element.properties.values() {
            if let PropertyType::List(count, _) = &p.data_type
                && !is_whole(count)
            {
                return Err(ReadProblem::malformed(format_args!(
                    "the length of the list `{}` is not of a whole type",
                    short(&p.name)
                )));
            }
            bytes += match (&header.encoding, &p.data_type) {
                // A digit and a separator.
                (Encoding::Ascii, _) => 2,
                (_, PropertyType::Scalar(kind) | PropertyType::List(kind, _)) => width(kind),
            };
        }
        if bytes == 0 && element.count > 0 {
            return Err(ReadProblem::malformed(format_args!(
                "its elements `{}` have no properties",
                short(&element.name)
            )));
        }
        least = least.saturating_add(bytes.saturating_mul(element.count as u64));
    }
    // The last separator may be missing.
    if least > length.saturating_add(1) {
        let counts: Vec<String> = header
            .elements
            .values()
            .map(|e| format!("{} of `{}`", e.count, short(&e.name)))
            .collect();
        return Err(ReadProblem::truncated(format_args!(
            "its header declares {}, which take {least} bytes or more, but the whole file has {length}",
            counts.join(", ")
        )));
    }
    Ok(())
}

/// Returns `true` if numbers of this type are whole.
const fn is_whole(kind: &ScalarType) -> bool {
    !matches!(kind, ScalarType::Float | ScalarType::Double)
}

/// Names of a list of corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Bytes of a number.
const fn width(kind: &ScalarType) -> u64 {
    match kind {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// The names of an element's properties, for messages.
fn properties(element: &ElementDef) -> String {
    let names: Vec<&str> = element.properties.keys().map(String::as_str).collect();
    short(&names.join(" "))
}

/// A vertex, of which three properties are kept.
struct Vertex([f64; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; 3])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = match property {
            Property::Char(x) => x.into(),
            Property::UChar(x) => x.into(),
            Property::Short(x) => x.into(),
            Property::UShort(x) => x.into(),
            Property::Int(x) => x.into(),
            Property::UInt(x) => x.into(),
            Property::Float(x) => x.into(),
            Property::Double(x) => x,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// A face or strips of triangles, of which the corners are kept.
struct Corners(Vec<i64>);

impl PropertyAccess for Corners {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        fn widen<N: Into<i64>>(list: Vec<N>) -> Vec<i64> {
            list.into_iter().map(Into::into).collect()
        }
        self.0 = match property {
            Property::ListChar(list) => widen(list),
            Property::ListUChar(list) => widen(list),
            Property::ListShort(list) => widen(list),
            Property::ListUShort(list) => widen(list),
            Property::ListInt(list) => widen(list),
            Property::ListUInt(list) => widen(list),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An element of which nothing is kept.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

pub(super) fn write(mesh: &MeshView<'_>, out: &mut impl Write) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\n")?;
    if !mesh.comment.is_empty() {
        writeln!(out, "comment {}", mesh.comment)?;
    }
    write!(
        out,
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices.len(),
        mesh.triangles.len()
    )?;
    for vertex in mesh.vertices {
        for x in vertex {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    for triangle in mesh.triangles {
        out.write_all(&[3])?;
        for k in triangle {
            out.write_all(&k.to_le_bytes())?;
        }
    }
    Ok(())
}
