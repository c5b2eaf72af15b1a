//! The embedded font, and widths of texts.

use ttf_parser::{Face, GlyphId};

use crate::PlotError;

/// Font units per em of DejaVu Sans.
pub(crate) const UNITS_PER_EM: f64 = 2048.0;

/// The embedded font.
pub(crate) fn font() -> Result<Face<'static>, PlotError> {
    Face::parse(dejavu::sans::regular(), 0).map_err(PlotError::backend)
}

/// A line of text in font units.
pub(crate) struct TextLine {
    /// Glyphs and their left ends.
    pub(crate) glyphs: Vec<(GlyphId, i32)>,
    pub(crate) width: i32,
}

impl TextLine {
    /// Sets `text` with kerning.
    pub(crate) fn new(text: &str) -> Result<Self, PlotError> {
        let font = font()?;
        let kerning = |left: GlyphId, right: GlyphId| {
            let tables = font.tables().kern?.subtables.into_iter();
            let mut tables = tables.filter(|table| table.horizontal && !table.variable);
            tables.find_map(|table| table.glyphs_kerning(left, right))
        };
        let (mut glyphs, mut width, mut last) = (Vec::new(), 0, None);
        for c in text.chars() {
            // The first glyph of a font stands for missing ones.
            let glyph = font.glyph_index(c).unwrap_or_default();
            width += i32::from(last.and_then(|last| kerning(last, glyph)).unwrap_or(0));
            glyphs.push((glyph, width));
            width += i32::from(font.glyph_hor_advance(glyph).unwrap_or(0));
            last = Some(glyph);
        }
        Ok(TextLine { glyphs, width })
    }
}

/// Width in points of `text` set at `size` points.
pub(crate) fn text_width(text: &str, size: f64) -> Result<f64, PlotError> {
    Ok(f64::from(TextLine::new(text)?.width) * size / UNITS_PER_EM)
}

/// Breaks `text` at spaces so that lines are at most `width` points wide; a longer word stays whole.
pub(crate) fn wrap(text: &str, size: f64, width: f64) -> Result<Vec<String>, PlotError> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if text_width(&longer, size)? <= width {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    Ok(lines)
}

/// Width of the widest text.
pub(crate) fn widest(texts: &[String], size: f64) -> Result<f64, PlotError> {
    let mut widest = 0.0_f64;
    for text in texts {
        widest = widest.max(text_width(text, size)?);
    }
    Ok(widest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_lines_fit() {
        let text = "Smith, height-correlated, with exact masking and a rather long explanation";
        let lines = wrap(text, 13.0, 150.0).unwrap();
        assert!(lines.len() > 2);
        assert_eq!(lines.join(" "), text);
        for line in lines {
            assert!(text_width(&line, 13.0).unwrap() <= 150.0);
        }
    }

    /// Advances of A and V in the font are 1401 units each, and 131 less together.
    #[test]
    fn widths_are_those_of_the_font_with_kerning() {
        let width = |text| text_width(text, UNITS_PER_EM).unwrap();
        assert_eq!(
            [width("A"), width("V"), width("AV")],
            [1401.0, 1401.0, 2671.0]
        );
        // What the font lacks has a box.
        assert!(width("\u{8868}") > 0.0);
        assert_eq!(f64::from(font().unwrap().units_per_em()), UNITS_PER_EM);
    }
}
