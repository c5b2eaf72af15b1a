//! Access to the elements of main.xml, with errors that name them.

use std::path::Path;

use roxmltree::Node;

use crate::error::ReadError;
use crate::formats::HeightMapFormat;

pub(super) fn malformed(path: &Path, what: impl std::fmt::Display) -> ReadError {
    ReadError::malformed(path, HeightMapFormat::X3p, what)
}

/// Access to the elements of main.xml.
pub(super) struct Xml<'a> {
    pub(super) path: &'a Path,
}

impl Xml<'_> {
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
            return Err(malformed(
                self.path,
                format_args!("its {} has {name} twice", parent.tag_name().name()),
            ));
        }
        Ok(first)
    }

    pub(super) fn child<'n, 'i>(
        &self,
        parent: Node<'n, 'i>,
        name: &str,
    ) -> Result<Node<'n, 'i>, ReadError> {
        self.optional(parent, name)?.ok_or_else(|| {
            malformed(
                self.path,
                format_args!("its {} lacks {name}", parent.tag_name().name()),
            )
        })
    }

    pub(super) fn text<'n>(&self, node: Node<'n, '_>) -> &'n str {
        node.text().unwrap_or_default().trim()
    }

    pub(super) fn number(&self, name: &str, text: &str) -> Result<f64, ReadError> {
        text.parse().map_err(|_| {
            malformed(
                self.path,
                format_args!(
                    "{name} is `{}`, but a number is needed",
                    text.chars().take(40).collect::<String>()
                ),
            )
        })
    }
}
