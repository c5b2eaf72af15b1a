//! The embedded font, and widths of texts.

use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};

use super::theme;
use crate::PlotError;

/// Ascent plus descent of DejaVu Sans over its em: what the rasteriser calls the size of a font.
pub(crate) const LINE_HEIGHT_PER_EM: f64 = (1901.0 + 483.0) / 2048.0;

/// Makes the embedded font known to the drawing library, once in a process.
pub(crate) fn ensure_font() -> Result<(), PlotError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered = REGISTERED.get_or_init(|| {
        register_font(
            theme::FONT_FAMILY,
            FontStyle::Normal,
            dejavu::sans::regular(),
        )
        .is_ok()
    });
    if *registered {
        Ok(())
    } else {
        Err(PlotError::Backend("the embedded font is damaged".into()))
    }
}

/// The embedded font, `size` as the respective renderer understands it.
pub(crate) fn font(size: f64) -> FontDesc<'static> {
    FontDesc::new(
        FontFamily::Name(theme::FONT_FAMILY),
        size,
        FontStyle::Normal,
    )
}

/// Width in points of `text` set at `size` points.
pub(crate) fn text_width(text: &str, size: f64) -> Result<f64, PlotError> {
    ensure_font()?;
    // Measured large, because the library rounds to whole pixels.
    const EM: f64 = 1000.0;
    let ((left, _), (right, _)) = font(EM * LINE_HEIGHT_PER_EM)
        .layout_box(text)
        .map_err(|e| PlotError::Backend(e.to_string()))?;
    Ok(f64::from(right - left) * size / EM)
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
}
