//! XML descriptions inside of archives: bounds them before they are parsed, and gives access to their elements with
//! errors that name them.

mod tags;

use std::fmt::Display;
use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use crate::error::ReadError;
use crate::formats::HeightMapFormat;

pub(super) use self::tags::{Split, for_each_datum, split};

/// Access to the elements of a part that holds XML.
#[derive(Clone, Copy)]
pub(super) struct Xml<'a> {
    pub(super) path: &'a Path,
    pub(super) format: HeightMapFormat,
    /// The name of the part.
    pub(super) part: &'static str,
}

impl Xml<'_> {
    pub(super) fn malformed(&self, what: impl Display) -> ReadError {
        ReadError::malformed(self.path, self.format, what)
    }

    /// Parses a description that [`split`] has bounded.
    pub(super) fn parse<'t>(&self, description: &'t str) -> Result<Document<'t>, ReadError> {
        let options = ParsingOptions {
            allow_dtd: false,
            ..ParsingOptions::default()
        };
        Document::parse_with_options(description, options)
            .map_err(|e| self.malformed(format_args!("its {} cannot be parsed ({e})", self.part)))
    }

    pub(super) fn optional<'n, 'i>(
        &self,
        parent: Node<'n, 'i>,
        name: &str,
    ) -> Result<Option<Node<'n, 'i>>, ReadError> {
        let mut found = parent
            .children()
            .filter(|node| node.is_element() && node.tag_name().name() == name);
        let first = found.next();
        if found.next().is_some() {
            return Err(self.malformed(format_args!(
                "its {} has {name} twice",
                parent.tag_name().name()
            )));
        }
        Ok(first)
    }

    pub(super) fn child<'n, 'i>(
        &self,
        parent: Node<'n, 'i>,
        name: &str,
    ) -> Result<Node<'n, 'i>, ReadError> {
        self.optional(parent, name)?.ok_or_else(|| {
            self.malformed(format_args!(
                "its {} lacks {name}",
                parent.tag_name().name()
            ))
        })
    }

    pub(super) fn text<'n>(&self, node: Node<'n, '_>) -> &'n str {
        node.text().unwrap_or_default().trim()
    }

    pub(super) fn number(&self, name: &str, text: &str) -> Result<f64, ReadError> {
        text.parse().map_err(|_| {
            self.malformed(format_args!(
                "{name} is `{}`, but a number is needed",
                text.chars().take(40).collect::<String>()
            ))
        })
    }
}
