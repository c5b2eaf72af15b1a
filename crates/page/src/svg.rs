//! SVG of foreign origin: what may stand in a page.

use std::fmt::Write;

use asperity_io::within;
use roxmltree::{Document, Node};

/// Elements of the figures of this program.
const ELEMENTS: [&str; 8] = [
    "svg", "g", "title", "path", "rect", "circle", "text", "image",
];

/// A figure, written anew: an HTML parser reads comments and character data otherwise than an XML parser does, so none is copied.
///
/// # Errors
/// A sentence, if it holds more than shapes, text and embedded pictures.
pub(crate) fn sanitized(text: &str) -> Result<String, String> {
    let document = Document::parse(text).map_err(|error| error.to_string())?;
    let mut out = String::with_capacity(text.len());
    write_element(document.root_element(), &mut out)?;
    Ok(out)
}

fn write_element(element: Node<'_, '_>, out: &mut String) -> Result<(), String> {
    let name = element.tag_name().name();
    if !ELEMENTS.contains(&name) {
        return Err(format!("it has the element {}", within(name, 40)));
    }
    out.push('<');
    out.push_str(name);
    for attribute in element.attributes() {
        let (name, value) = (attribute.name(), attribute.value());
        let is_picture = value.starts_with("data:image/png;base64,");
        let is_reference = name == "href" && !is_picture || value.contains("url(");
        let is_plain = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
        if name.starts_with("on") || name == "style" || is_reference || !is_plain {
            return Err(format!("it has the attribute {}", within(name, 40)));
        }
        // Writing to a string does not fail.
        let _ = write!(out, " {name}=\"{}\"", escaped(value));
    }
    if !element.has_children() {
        out.push_str("/>");
        return Ok(());
    }
    out.push('>');
    for child in element.children() {
        if child.is_element() {
            write_element(child, out)?;
        } else if let Some(text) = child.text().filter(|_| child.is_text()) {
            out.push_str(&escaped(text));
        }
    }
    let _ = write!(out, "</{name}>");
    Ok(())
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(inner: &str) -> String {
        format!("<svg xmlns=\"http://www.w3.org/2000/svg\">{inner}</svg>")
    }

    #[test]
    fn figures_keep_shapes_texts_and_pictures() {
        let inner = "<g fill=\"#191919\"><path d=\"M0 0l1 1\"/></g><text>a &lt; b</text>\
            <image href=\"data:image/png;base64,AA==\"/>";
        let prologue = format!("<?xml version=\"1.0\"?>\n{}", figure(inner));
        assert_eq!(sanitized(&prologue), Ok(format!("<svg>{inner}</svg>")));
    }

    #[test]
    fn figures_that_run_or_load_something_are_refused_or_made_harmless() {
        for bad in [
            "<script>alert(1)</script>",
            "<rect onload=\"alert(1)\"/>",
            "<image href=\"https://example.org/a.png\"/>",
            "<rect fill=\"url(https://example.org)\"/>",
            "<foreignObject/>",
            "<rect",
        ] {
            assert!(sanitized(&figure(bad)).is_err(), "{bad}");
        }
        // What HTML parsers take for elements.
        for hidden in [
            "<!--><img src=x onerror=alert(1)>-->",
            "<?x ><img src=x onerror=alert(1)>?>",
            "<title><![CDATA[><img src=x onerror=alert(1)>]]></title>",
        ] {
            let found = sanitized(&figure(hidden)).unwrap();
            assert!(!found.contains("<img"), "{found}");
        }
    }
}
