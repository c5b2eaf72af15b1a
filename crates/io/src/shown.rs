//! Text of foreign origin (names, arguments, content of files), as messages, figures and files show it.
//!
//! Characters that command a terminal or hide text are shown as escapes, `\u{1b}`: controls (C0, C1), marks of
//! writing direction, and what has no width.

use std::borrow::Cow;
use std::path::Path;

/// Most characters of an item in a message.
const MAX_SHOWN: usize = 200;

/// Returns `true` if a character is shown as an escape.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
        )
}

/// A text in which `escape` gives what stands for each hidden character that `keep` does not list.
fn escaped<'t>(text: &'t str, keep: &[char], escape: impl Fn(char) -> String) -> Cow<'t, str> {
    let is_hidden = |c: char| is_hidden(c) && !keep.contains(&c);
    if !text.contains(is_hidden) {
        return text.into();
    }
    let seen = |c: char| match is_hidden(c) {
        true => escape(c),
        false => c.to_string(),
    };
    text.chars().map(seen).collect::<String>().into()
}

/// A text of which everything is seen, on one line, long text shortened in its middle.
///
/// # Examples
/// ```
/// use asperity_io::shown;
///
/// assert_eq!(shown("a\u{1b}[31m.npy"), "a\\u{1b}[31m.npy");
/// ```
#[must_use]
pub fn shown(text: &str) -> String {
    within(text, MAX_SHOWN)
}

/// The name of a file, like [`shown`].
#[must_use]
pub fn shown_path(path: &Path) -> String {
    shown(&path.to_string_lossy())
}

/// [`shown`] for texts of at most that many characters.
#[must_use]
pub fn within(text: &str, most: usize) -> String {
    let count = text.chars().count();
    let seen = |part: &str| escaped(part, &[], |c| c.escape_unicode().to_string()).into_owned();
    if count <= most {
        return seen(text);
    }
    let half = most / 2;
    let start: String = text.chars().take(half).collect();
    let end: String = text.chars().skip(count - half).collect();
    format!(
        "{} [{} characters] {}",
        seen(&start),
        count - 2 * half,
        seen(&end)
    )
}

/// A text of several lines with escapes for all characters that are not seen, but for line feeds and tabs.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, &['\n', '\t'], |c| c.escape_unicode().to_string())
}

/// Indented JSON; its strings have the escapes of JSON for all characters that are not seen.
///
/// # Errors
/// [`serde_json::Error`] if `value` cannot be expressed.
pub fn json_text(value: &(impl serde::Serialize + ?Sized)) -> serde_json::Result<String> {
    let text = serde_json::to_string_pretty(value)?;
    // Outside of its strings JSON has no such characters but line feeds.
    let escape = |c: char| {
        let units = &mut [0; 2];
        let units = c.encode_utf16(units).iter();
        units.map(|unit| format!("\\u{unit:04x}")).collect()
    };
    Ok(escaped(&text, &['\n'], escape).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HIDDEN: &str = "\u{0}\u{7}\u{1b}\u{7f}\u{85}\u{9b}\u{200b}\u{200f}\u{2028}\u{202e}\u{2066}\u{2069}\u{feff}";

    #[test]
    fn hidden_characters_are_seen_and_others_stay() {
        assert_eq!(shown("Höhe 高さ (µm).npy"), "Höhe 高さ (µm).npy");
        assert_eq!(shown("a\n\t\u{9b}b"), "a\\u{a}\\u{9}\\u{9b}b");
        assert_eq!(printable("a\n\tb\u{202e}"), "a\n\tb\\u{202e}");
        for text in [shown(HIDDEN), printable(HIDDEN).into_owned()] {
            assert!(text.is_ascii() && text.matches("\\u{").count() == HIDDEN.chars().count());
        }
        let json = json_text(&[format!("{HIDDEN}\u{e0001}ä")]).unwrap();
        assert!(
            json.chars()
                .all(|c| c == '\n' || c == 'ä' || c.is_ascii_graphic() || c == ' ')
        );
        let read: Vec<String> = serde_json::from_str(&json).unwrap();
        assert_eq!(read, [format!("{HIDDEN}\u{e0001}ä")]);
    }

    #[test]
    fn long_text_is_shortened_in_its_middle() {
        let long = format!("begin{}end", "ä".repeat(100_000));
        let text = shown(&long);
        assert!(text.starts_with("begin") && text.ends_with("end"), "{text}");
        assert!(
            text.chars().count() < 250 && text.contains("[99808 characters]"),
            "{text}"
        );
        assert_eq!(shown(&"x".repeat(200)).len(), 200);
    }
}
