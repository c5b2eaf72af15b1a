//! XML descriptions inside of archives: bounds them before they are parsed, and gives access to their elements with
//! errors that name them.

mod tags;

use roxmltree::{Document, Node, ParsingOptions};

use crate::error::ReadProblem;

pub(super) use self::tags::{Split, for_each_datum, split};

/// Parses a description that [`split`] has bounded.
pub(super) fn parse<'t>(part: &str, description: &'t str) -> Result<Document<'t>, ReadProblem> {
    let options = ParsingOptions {
        allow_dtd: false,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(description, options)
        .map_err(|e| ReadProblem::malformed(format_args!("its {part} cannot be parsed ({e})")))
}

/// The only element `name` in `parent`, or `None`.
pub(super) fn optional<'n, 'i>(
    parent: Node<'n, 'i>,
    name: &str,
) -> Result<Option<Node<'n, 'i>>, ReadProblem> {
    let mut found = parent
        .children()
        .filter(|node| node.is_element() && node.tag_name().name() == name);
    let first = found.next();
    if found.next().is_some() {
        return Err(ReadProblem::malformed(format_args!(
            "its {} has {name} twice",
            parent.tag_name().name()
        )));
    }
    Ok(first)
}

/// The element `name` in `parent`.
pub(super) fn child<'n, 'i>(parent: Node<'n, 'i>, name: &str) -> Result<Node<'n, 'i>, ReadProblem> {
    optional(parent, name)?.ok_or_else(|| {
        ReadProblem::malformed(format_args!(
            "its {} lacks {name}",
            parent.tag_name().name()
        ))
    })
}

/// The text of an element, without white space around it.
pub(super) fn text<'n>(node: Node<'n, '_>) -> &'n str {
    node.text().unwrap_or_default().trim()
}

/// The number that `text` states, as the value of `name`.
pub(super) fn number(name: &str, text: &str) -> Result<f64, ReadProblem> {
    text.parse().map_err(|_| {
        ReadProblem::malformed(format_args!(
            "{name} is `{}`, but a number is needed",
            text.chars().take(40).collect::<String>()
        ))
    })
}

/// The text of the element `name` in `parent`.
pub(super) fn child_text<'n>(parent: Node<'n, '_>, name: &str) -> Result<&'n str, ReadProblem> {
    child(parent, name).map(text)
}
