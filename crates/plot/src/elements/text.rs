//! The embedded font, widths of texts, and numbers as text.

use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};

use crate::PlotError;
use crate::elements::scene::{Align, Level, Scene, TextLook};
use crate::elements::theme;

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

/// Title and subtitle at the top left; returns the y below them.
pub(crate) fn header(
    scene: &mut Scene,
    subtitle: &str,
    figure_width: f64,
) -> Result<f64, PlotError> {
    let width = figure_width - 2.0 * theme::MARGIN;
    let title = scene.title.clone();
    let mut y = theme::MARGIN;
    for (text, size, muted) in [
        (title.as_str(), theme::TITLE_SIZE, false),
        (subtitle, theme::SUBTITLE_SIZE, true),
    ] {
        for line in wrap(text, size, width)? {
            let look = TextLook::new(size, Align::Left, Level::Top);
            let look = if muted { look.muted() } else { look };
            scene.text(&line, (theme::MARGIN, y), look);
            y += 1.45 * size;
        }
    }
    Ok(y)
}

/// `value` with `decimals` decimals and a true minus sign; never "-0".
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().any(|b| (b'1'..=b'9').contains(&b)) => format!("−{digits}"),
        Some(digits) => digits.to_owned(),
        None => text,
    }
}

/// `value` with three significant digits.
pub(crate) fn three_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = exponent10(value);
    if (-3..6).contains(&exponent) {
        fixed(value, usize::try_from(2 - exponent).unwrap_or(0))
    } else {
        // In two steps: ten to a large power is out of range before the quotient is.
        let half = exponent / 2;
        let mantissa = value / 10f64.powi(half) / 10f64.powi(exponent - half);
        format!("{} × {}", fixed(mantissa, 2), power_of_ten(exponent))
    }
}

/// The decimal exponent of |`value`|; zero for zero.
pub(crate) fn exponent10(value: f64) -> i32 {
    if value == 0.0 {
        0
    } else {
        // The library rounds correctly, a logarithm would not at exact powers.
        format!("{:e}", value.abs())
            .split_once('e')
            .and_then(|(_, e)| e.parse().ok())
            .unwrap_or(0)
    }
}

/// "10⁻³" for -3.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    let digits = exponent.to_string();
    let superscript = digits.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    });
    "10".chars().chain(superscript).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(fixed(-1.5, 1), "−1.5");
        assert_eq!(three_digits(0.0123456), "0.0123");
        assert_eq!(three_digits(240.0), "240");
        assert_eq!(three_digits(-1.5e-9), "−1.50 × 10⁻⁹");
        assert_eq!(three_digits(1e300), "1.00 × 10³⁰⁰");
        assert_eq!(three_digits(1e-320), "1.00 × 10⁻³²⁰");
        assert_eq!(power_of_ten(-12), "10⁻¹²");
    }

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
