//! Tags of a description: bounds them before the text is parsed, and takes a list of data out of it.
//!
//! The time of the parser grows with the square of the attributes of an element and of the namespaces in
//! scope, and its memory is a hundred times a short element. A description of a surface is short; the one
//! long part, numbers of an inline `DataList` of X3P, is read here without a tree.

use crate::error::ReadProblem;

/// Most elements outside the list of data; a description has about 40.
const MAX_ELEMENTS: usize = 4096;
/// Most attributes of an element, and most namespaces in all.
const MAX_ATTRIBUTES: usize = 32;
/// Longest description, in bytes.
const MAX_DESCRIPTION: usize = 1 << 20;

/// A description in two parts.
pub(crate) struct Split<'a> {
    /// All but the content of `DataList`, for the parser.
    pub(crate) description: String,
    /// The content of `DataList`.
    pub(crate) data: &'a str,
}

/// Splits the text of a part, and checks that its description is bounded.
pub(crate) fn split<'a>(part: &str, xml: &'a str) -> Result<Split<'a>, ReadProblem> {
    let mut tags = Tags { xml, at: 0 };
    let mut counts = Counts::default();
    let mut list = None;
    while let Some(tag) = tags.next(part)? {
        counts.add(part, &tag)?;
        if list.is_none() && tag.opens() && tag.name() == "DataList" {
            list = Some((tags.at, data_end(part, &mut tags)?));
        }
    }
    let (start, end) = list.unwrap_or((xml.len(), xml.len()));
    let description = [&xml[..start], &xml[end..]].concat();
    if description.len() > MAX_DESCRIPTION {
        let length = description.len();
        return Err(ReadProblem::malformed(format_args!(
            "its {part} describes the surface in {length} bytes, but {MAX_DESCRIPTION} are allowed"
        )));
    }
    Ok(Split {
        description,
        data: &xml[start..end],
    })
}

/// Moves past the end of the list of data; returns where the tag begins that ends it.
fn data_end(part: &str, tags: &mut Tags<'_>) -> Result<usize, ReadProblem> {
    while let Some(tag) = tags.next(part)? {
        if tag.closes() && tag.name() == "DataList" {
            return Ok(tag.start);
        }
    }
    Err(cannot_be_parsed(part, "its DataList does not end"))
}

/// The texts of the `Datum` elements in the content of a `DataList`.
pub(crate) fn for_each_datum<'a>(
    part: &str,
    data: &'a str,
    mut take: impl FnMut(&'a str) -> Result<(), ReadProblem>,
) -> Result<(), ReadProblem> {
    let mut tags = Tags { xml: data, at: 0 };
    while let Some(tag) = tags.next(part)? {
        let is_datum = tag.name() == "Datum" && !tag.closes();
        if is_datum && !tag.opens() {
            take("")?;
            continue;
        }
        let start = tags.at;
        let end = match tags.next(part)? {
            Some(end) if is_datum && end.closes() && end.name() == "Datum" => end,
            _ => {
                return Err(ReadProblem::malformed(
                    "its DataList holds elements other than Datum with a text",
                ));
            }
        };
        take(data[start..end.start].trim())?;
    }
    Ok(())
}

/// Numbers of elements and namespaces so far.
#[derive(Default)]
struct Counts {
    elements: usize,
    namespaces: usize,
}

impl Counts {
    fn add(&mut self, part: &str, tag: &Tag<'_>) -> Result<(), ReadProblem> {
        let most = |what: &str, most: usize| {
            Err(ReadProblem::malformed(format_args!(
                "its {part} has more than {most} {what}"
            )))
        };
        self.elements += usize::from(!tag.closes());
        self.namespaces += tag.text.matches("xmlns").count();
        if self.elements > MAX_ELEMENTS {
            return most("elements beside its data", MAX_ELEMENTS);
        }
        if self.namespaces > MAX_ATTRIBUTES {
            return most("namespaces", MAX_ATTRIBUTES);
        }
        // Each value has two quotes.
        if tag.text.matches(['"', '\'']).count() > 2 * MAX_ATTRIBUTES {
            return most("attributes in one element", MAX_ATTRIBUTES);
        }
        Ok(())
    }
}

/// One tag.
struct Tag<'a> {
    /// Offset of its `<` in the text.
    start: usize,
    /// Text between `<` and `>`.
    text: &'a str,
}

impl<'a> Tag<'a> {
    /// Returns `true` for the start tag of an element that has an end tag.
    fn opens(&self) -> bool {
        !self.closes() && !self.text.ends_with('/')
    }

    /// Returns `true` for an end tag.
    fn closes(&self) -> bool {
        self.text.starts_with('/')
    }

    /// The name of the element without that of its namespace.
    fn name(&self) -> &'a str {
        let name = self.text.trim_start_matches('/');
        let end = name.find(|c: char| c.is_whitespace() || c == '/');
        let name = &name[..end.unwrap_or(name.len())];
        name.rsplit(':').next().unwrap_or(name)
    }
}

/// The tags of a text, one after the other, without comments, declarations and raw text.
struct Tags<'a> {
    xml: &'a str,
    at: usize,
}

impl<'a> Tags<'a> {
    /// The next tag; [`Self::at`] is behind it.
    fn next(&mut self, part: &str) -> Result<Option<Tag<'a>>, ReadProblem> {
        while let Some(offset) = self.xml[self.at..].find('<') {
            let start = self.at + offset;
            let rest = &self.xml[start..];
            let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
            if let Some((_, end)) = skipped.iter().find(|(mark, _)| rest.starts_with(mark)) {
                let length = rest
                    .find(end)
                    .ok_or_else(|| cannot_be_parsed(part, format_args!("`{end}` is missing")))?;
                self.at = start + length + end.len();
                continue;
            }
            let length =
                tag_length(rest).ok_or_else(|| cannot_be_parsed(part, "`>` is missing"))?;
            self.at = start + length;
            let text = &rest[1..length - 1];
            return Ok(Some(Tag { start, text }));
        }
        Ok(None)
    }
}

/// Length of the tag that `text` begins with; `>` in quotes does not end it.
fn tag_length(text: &str) -> Option<usize> {
    let mut quote = None;
    let end = text.bytes().position(|byte| match quote {
        Some(mark) => {
            if byte == mark {
                quote = None;
            }
            false
        }
        None => {
            if byte == b'"' || byte == b'\'' {
                quote = Some(byte);
            }
            byte == b'>'
        }
    })?;
    Some(end + 1)
}

fn cannot_be_parsed(part: &str, what: impl std::fmt::Display) -> ReadProblem {
    ReadProblem::malformed(format_args!("its {part} cannot be parsed ({what})"))
}
