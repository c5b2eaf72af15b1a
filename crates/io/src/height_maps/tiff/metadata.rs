//! Scale and offset of heights in the XML metadata of GDAL:
//! ```text
//! <GDALMetadata>
//!   <Item name="OFFSET" sample="0" role="offset">100</Item>
//!   <Item name="SCALE" sample="0" role="scale">0.1</Item>
//! </GDALMetadata>
//! ```

use roxmltree::{Document, ParsingOptions};

use crate::error::ReadProblem;

/// Longest metadata that are parsed, bytes; most of their nodes.
const MAX_LENGTH: usize = 1 << 16;
const MAX_NODES: u32 = 1 << 12;

/// Heights are `offset + scale` times the samples.
pub(super) struct HeightScale {
    scale: f64,
    offset: f64,
}

impl Default for HeightScale {
    fn default() -> Self {
        Self {
            scale: 1.0,
            offset: 0.0,
        }
    }
}

impl HeightScale {
    /// Finds the items of the roles `scale` and `offset`, of the first sample.
    pub(super) fn parse(xml: &str) -> Result<Self, ReadProblem> {
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
        let mut found = Self::default();
        let items = document.descendants().filter(|node| {
            node.has_tag_name("Item") && matches!(node.attribute("sample"), None | Some("0"))
        });
        for item in items {
            let (name, target) = match item.attribute("role") {
                Some("scale") => ("scale", &mut found.scale),
                Some("offset") => ("offset", &mut found.offset),
                _ => continue,
            };
            let text = item.text().unwrap_or_default().trim();
            *target = text
                .parse()
                .ok()
                .filter(|number: &f64| number.is_finite())
                .ok_or_else(|| {
                    ReadProblem::malformed(format_args!(
                        "the {name} of its heights is `{text}`, but a number is needed"
                    ))
                })?;
        }
        Ok(found)
    }

    pub(super) fn of(&self, sample: f64) -> f64 {
        self.offset + self.scale * sample
    }
}
