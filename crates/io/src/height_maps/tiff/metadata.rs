//! Scale, offset and unit of heights in the XML metadata of GDAL:
//! ```text
//! <GDALMetadata>
//!   <Item name="OFFSET" sample="0" role="offset">100</Item>
//!   <Item name="SCALE" sample="0" role="scale">0.1</Item>
//!   <Item name="UNITTYPE" sample="0" role="unittype">ft</Item>
//! </GDALMetadata>
//! ```

use asperity_surface::LengthUnit;
use roxmltree::{Document, ParsingOptions};

use super::units::NamedUnit;
use crate::error::ReadProblem;
use crate::text_lines::short;

/// Longest metadata that are parsed, bytes; most of their nodes.
const MAX_LENGTH: usize = 1 << 16;
const MAX_NODES: u32 = 1 << 12;

/// Heights as GDAL describes them.
pub(super) struct Metadata {
    /// Heights are `offset + scale` times the samples.
    pub(super) scale: f64,
    pub(super) offset: f64,
    /// Metres in their unit.
    pub(super) metres: Option<f64>,
}

impl Metadata {
    /// Finds the items of the roles `scale`, `offset` and `unittype`, of the first sample; empty text has none.
    pub(super) fn parse(xml: &str) -> Result<Self, ReadProblem> {
        let mut found = Self {
            scale: 1.0,
            offset: 0.0,
            metres: None,
        };
        if xml.is_empty() {
            return Ok(found);
        }
        if xml.len() > MAX_LENGTH {
            let what = format!("its metadata have more than {MAX_LENGTH} bytes");
            return Err(ReadProblem::unsupported(what));
        }
        let options = ParsingOptions {
            nodes_limit: MAX_NODES,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(xml, options)
            .map_err(|error| ReadProblem::malformed(format_args!("its metadata: {error}")))?;
        let items = document.descendants().filter(|node| {
            node.has_tag_name("Item") && matches!(node.attribute("sample"), None | Some("0"))
        });
        for item in items {
            let text = item.text().unwrap_or_default().trim();
            let (name, target) = match item.attribute("role") {
                Some("scale") => ("scale", &mut found.scale),
                Some("offset") => ("offset", &mut found.offset),
                Some("unittype") if !text.is_empty() => {
                    let unit = NamedUnit::parse(text).ok_or_else(|| {
                        ReadProblem::unsupported(format_args!(
                            "the unit of its heights is `{}`, but a unit of length is needed",
                            short(text)
                        ))
                    })?;
                    found.metres = Some(unit.convert(1.0, LengthUnit::Metre));
                    continue;
                }
                _ => continue,
            };
            *target = text
                .parse()
                .ok()
                .filter(|number: &f64| number.is_finite())
                .ok_or_else(|| {
                    ReadProblem::malformed(format_args!(
                        "the {name} of its heights is `{}`, but a number is needed",
                        short(text)
                    ))
                })?;
        }
        Ok(found)
    }
}
