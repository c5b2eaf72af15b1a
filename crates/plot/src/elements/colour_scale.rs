//! Values as colours, and the bar that says what the colours mean.

use super::axis::Axis;
use super::geometry::Rect;
use super::rgb::{Rgb, VIRIDIS};
use super::scene::{Align, Level, Pen, Picture, Scene, TextStyle};
use super::text::text_width;
use super::theme;
use crate::PlotError;

/// The colours of a scale, from its low end to its high end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Colours {
    /// *viridis*: equal steps appear equally large, also in grey.
    Viridis,
    /// Blue, grey in the middle, orange: values to either side of zero. Lightness rises over the whole scale, so that the sign is seen in
    /// grey too, and blue against orange is told apart by the common kinds of colour vision. The bright end is darker than white, which is
    /// no value.
    Diverging,
}

/// Colours at equal steps along [`Colours::Diverging`].
const DIVERGING: [Rgb; 5] = [
    Rgb(0, 24, 84),
    Rgb(30, 92, 166),
    Rgb(158, 158, 158),
    Rgb(240, 164, 60),
    Rgb(255, 228, 128),
];

impl Colours {
    /// The colour at a place from 0, the low end, to 1, the high end.
    fn at(self, place: f64) -> Rgb {
        match self {
            Colours::Viridis => Rgb::along(&VIRIDIS, place),
            Colours::Diverging => Rgb::along(&DIVERGING, place),
        }
    }

    /// `n` colours from the low end of a scale to the high end.
    pub(crate) fn palette(self, n: usize) -> impl Iterator<Item = Rgb> {
        (0..n).map(move |i| self.at(i as f64 / (n - 1) as f64))
    }
}

/// A range of values, linear or logarithmic, in colours. Values beyond an end have its colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ColourScale {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    pub(crate) log: bool,
    pub(crate) colours: Colours,
}

impl ColourScale {
    pub(crate) fn linear(lo: f64, hi: f64) -> Self {
        ColourScale {
            lo,
            hi,
            log: false,
            colours: Colours::Viridis,
        }
    }

    /// From -1 to 1, on both sides of zero.
    pub(crate) const RATIOS: ColourScale = ColourScale {
        lo: -1.0,
        hi: 1.0,
        log: false,
        colours: Colours::Diverging,
    };

    /// Whole decades, one at least and `most` at most, that hold `least` > 0 if they can, and `largest`.
    pub(crate) fn decades(least: f64, largest: f64, most: i32) -> Self {
        let last = (largest.log10() - 1e-9).ceil() as i32;
        let first = ((least.log10() + 1e-9).floor() as i32).clamp(last - most, last - 1);
        ColourScale {
            lo: 10.0_f64.powi(first),
            hi: 10.0_f64.powi(last),
            log: true,
            colours: Colours::Viridis,
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

    pub(crate) fn colour(&self, value: f64) -> Rgb {
        self.colours.at(self.fraction(value))
    }

    /// Index of a value in a palette of `n` colours.
    pub(crate) fn index(&self, value: f64, n: usize) -> u8 {
        ((n - 1) as f64 * self.fraction(value)).round() as u8
    }
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

/// Draws a bar of `colours` with ticks at its right; its axis has the ends of the scale. The title is the first of
/// `titles` that fits.
pub(crate) fn draw_bar(
    scene: &mut Scene,
    bar: Rect,
    colours: Colours,
    axis: &Axis,
    titles: &[&str],
) -> Result<(), PlotError> {
    scene.pictures.push(Picture {
        frame: bar,
        columns: 1,
        pixels: (0..=255).rev().collect(),
        palette: colours.palette(256).collect(),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Luminance of sRGB (IEC 61966-2-1), 0 to 1.
    fn luminance(Rgb(r, g, b): Rgb) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
    }

    #[test]
    fn diverging_colours_lighten_over_the_whole_scale_and_are_neutral_in_the_middle() {
        let colours: Vec<Rgb> = Colours::Diverging.palette(255).collect();
        let light: Vec<f64> = colours.iter().map(|c| luminance(*c)).collect();
        assert!(light.is_sorted_by(|a, b| a <= b));
        let steps = light.windows(64).step_by(63).map(|part| part[63] - part[0]);
        assert!(steps.into_iter().all(|step| step > 0.05) && light[254] < 0.9);
        let Rgb(r, g, b) = ColourScale::RATIOS.colour(0.0);
        assert!(r == g && g == b);
        assert_eq!(ColourScale::RATIOS.colour(-1.0), DIVERGING[0]);
        assert_eq!(ColourScale::RATIOS.colour(7.0), DIVERGING[4]);
    }
}
