//! Values as colours, and the bar that says what the colours mean.

use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

use super::axis::Axis;
use super::geometry::Rect;
use super::scene::{Align, Level, Pen, Picture, Scene, TextStyle};
use super::text::text_width;
use super::theme;
use crate::PlotError;

/// A range of values, linear or logarithmic, in the colours of *viridis*: equal steps appear equally large, also in
/// grey. Values beyond an end have its colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ColourScale {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    pub(crate) log: bool,
}

impl ColourScale {
    pub(crate) fn linear(lo: f64, hi: f64) -> Self {
        ColourScale { lo, hi, log: false }
    }

    /// Whole decades, one at least and `most` at most, that hold `least` > 0 if they can, and `largest`.
    pub(crate) fn decades(least: f64, largest: f64, most: i32) -> Self {
        let last = (largest.log10() - 1e-9).ceil() as i32;
        let first = ((least.log10() + 1e-9).floor() as i32).clamp(last - most, last - 1);
        ColourScale {
            lo: 10.0_f64.powi(first),
            hi: 10.0_f64.powi(last),
            log: true,
        }
    }

    /// Place of a value, 0 at the low end and 1 at the high end.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        let t = match self.log {
            true => (value.max(self.lo) / self.lo).log10() / (self.hi / self.lo).log10(),
            // Halves first: the difference of two large values may overflow.
            false => (0.5 * value - 0.5 * self.lo) / (0.5 * self.hi - 0.5 * self.lo),
        };
        t.clamp(0.0, 1.0)
    }

    pub(crate) fn colour(&self, value: f64) -> RGBColor {
        ViridisRGB.get_color(self.fraction(value))
    }

    /// Index of a value in a palette of `n` colours.
    pub(crate) fn index(&self, value: f64, n: usize) -> u8 {
        ((n - 1) as f64 * self.fraction(value)).round() as u8
    }
}

/// `n` colours from the low end of a scale to the high end.
pub(crate) fn palette(n: usize) -> impl Iterator<Item = RGBColor> {
    (0..n).map(move |i| ViridisRGB.get_color(i as f64 / (n - 1) as f64))
}

/// The first of the titles that fits into a length, or the last one.
pub(crate) fn that_fits<'a>(titles: &[&'a str], length: f64) -> Result<&'a str, PlotError> {
    for title in titles {
        if text_width(title, theme::LABEL_SIZE)? <= length {
            return Ok(title);
        }
    }
    Ok(titles.last().unwrap_or(&""))
}

/// Ticks for a bar of this height, four or more where numbers allow it.
pub(crate) fn bar_ticks(height: f64, axis: impl Fn(usize) -> Axis) -> Axis {
    let count = (height / 34.0).floor().clamp(4.0, 8.0) as usize;
    let axes = (count..3 * count).map(&axis);
    axes.into_iter()
        .find(|axis| axis.major.len() >= 4)
        .unwrap_or_else(|| axis(count))
}

/// Draws a bar of colours with ticks at its right; its axis has the ends of the scale. The title is the first of
/// `titles` that fits.
pub(crate) fn draw_bar(
    scene: &mut Scene,
    bar: Rect,
    axis: &Axis,
    titles: &[&str],
) -> Result<(), PlotError> {
    scene.pictures.push(Picture {
        frame: bar,
        columns: 1,
        pixels: (0..=255).rev().collect(),
        palette: palette(256).collect(),
    });
    let pen = Pen::solid(theme::INK, theme::FRAME_WIDTH);
    scene.rect_outline(bar, pen);
    let style = TextStyle::new(theme::TICK_SIZE, Align::Left, Level::Middle);
    let texts = bar.right + theme::TICK_LENGTH + 4.0;
    for (value, text) in &axis.major {
        if let Some(t) = axis.fraction(*value) {
            let y = bar.bottom - t * bar.height();
            scene.line(&[(bar.right, y), (bar.right + theme::TICK_LENGTH, y)], pen);
            scene.text(text, (texts, y), style);
        }
    }
    let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Top);
    let x = texts + axis.text_width()? + 10.0;
    let title = that_fits(titles, bar.height())?;
    scene.text_upwards(title, (x, bar.centre().1), style);
    Ok(())
}
