//! Axes with round ticks, and the panel they frame.

use crate::PlotError;
use crate::elements::scene::{Align, Level, Pen, Rect, Scene, TextLook, Xy};
use crate::elements::text::{exponent10, fixed, power_of_ten, text_width};
use crate::elements::theme;

/// How a value becomes a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Linear,
    Log10,
}

/// A range of values with ticks.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    lo: f64,
    hi: f64,
    scale: Scale,
    /// Values and their texts, ascending.
    pub(crate) major: Vec<(f64, String)>,
    minor: Vec<f64>,
    label: String,
}

impl Axis {
    /// About `count` ticks at round values. `exponent`: tick texts show value / 10^exponent.
    pub(crate) fn linear(lo: f64, hi: f64, count: usize, exponent: i32) -> Self {
        let (step, decimals) = round_step((hi - lo) / count.max(1) as f64, exponent);
        let first = (lo / step - 1e-9).ceil();
        // A broken step would make the range of ticks endless; twice the wish is always enough.
        let major = (0..2 * count + 4)
            .map(|i| (first + i as f64) * step)
            .take_while(|v| *v <= hi + 1e-9 * step)
            .filter(|v| v.is_finite())
            .map(|v| (v, fixed(scale_down(v, exponent), decimals)))
            .collect();
        Axis {
            lo,
            hi,
            scale: Scale::Linear,
            major,
            minor: Vec::new(),
            label: String::new(),
        }
    }

    /// Signed angles in degrees from `lo` to `hi`.
    pub(crate) fn degrees(lo: f64, hi: f64) -> Self {
        let span = hi - lo;
        let (step, minor) = [
            (30.0, 10.0),
            (15.0, 5.0),
            (10.0, 2.0),
            (5.0, 1.0),
            (2.0, 0.5),
            (1.0, 0.2),
        ]
        .into_iter()
        .find(|(step, _)| span / step >= 4.0)
        .unwrap_or((0.5, 0.1));
        let grid = |step: f64| {
            let first = (lo / step - 1e-9).ceil() as i64;
            let last = (hi / step + 1e-9).floor() as i64;
            (first..=last).map(move |i| i as f64 * step)
        };
        Axis {
            lo,
            hi,
            scale: Scale::Linear,
            major: grid(step)
                .map(|v| (v, fixed(v, usize::from(step < 1.0))))
                .collect(),
            minor: grid(minor).collect(),
            label: String::new(),
        }
    }

    /// Decades, from `lo` > 0 to `hi`.
    pub(crate) fn log10(lo: f64, hi: f64) -> Self {
        let (first, last) = (exponent10(lo), exponent10(hi));
        let decades = || (first..=last).map(|e| (e, 10f64.powi(e)));
        let every = usize::try_from(last - first).unwrap_or(0) / 8 + 1;
        Axis {
            lo,
            hi,
            scale: Scale::Log10,
            major: decades()
                .filter(|(_, v)| *v >= lo * (1.0 - 1e-9))
                .step_by(every)
                .map(|(e, v)| (v, power_of_ten(e)))
                .collect(),
            minor: decades()
                .flat_map(|(_, v)| (2..10).map(move |i| f64::from(i) * v))
                .filter(|v| *v >= lo && *v <= hi)
                .collect(),
            label: String::new(),
        }
    }

    pub(crate) fn with_label(mut self, label: &str) -> Self {
        self.label = label.to_owned();
        self
    }

    /// Without tick texts, for a panel above another one of the same axis.
    pub(crate) fn without_texts(mut self) -> Self {
        for (_, text) in &mut self.major {
            text.clear();
        }
        self.label.clear();
        self
    }

    pub(crate) fn lo(&self) -> f64 {
        self.lo
    }

    pub(crate) fn hi(&self) -> f64 {
        self.hi
    }

    /// Place of `value`, 0 at the low end and 1 at the high end; none for zero and below on a log axis.
    pub(crate) fn fraction(&self, value: f64) -> Option<f64> {
        let t = match self.scale {
            Scale::Linear => (value - self.lo) / (self.hi - self.lo),
            Scale::Log10 if value > 0.0 => (value / self.lo).log10() / (self.hi / self.lo).log10(),
            Scale::Log10 => return None,
        };
        t.is_finite().then_some(t)
    }

    /// Width of the widest tick text.
    pub(crate) fn text_width(&self) -> Result<f64, PlotError> {
        let mut width = 0.0_f64;
        for (_, text) in &self.major {
            width = width.max(text_width(text, theme::TICK_SIZE)?);
        }
        Ok(width)
    }
}

/// The exponent to take out of tick texts for values up to `max_abs`: zero for values that read well as they are.
pub(crate) fn display_exponent(max_abs: f64) -> i32 {
    let exponent = exponent10(max_abs);
    if (-2..4).contains(&exponent) {
        0
    } else {
        exponent
    }
}

/// "(1/sr)" with the power of ten that [`display_exponent`] took out.
pub(crate) fn per_steradian(exponent: i32) -> String {
    match exponent {
        0 => "(1/sr)".into(),
        e => format!("({}/sr)", power_of_ten(e)),
    }
}

/// `value` / 10^`exponent`, in two steps because either power alone may be out of range.
pub(crate) fn scale_down(value: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    value / 10f64.powi(half) / 10f64.powi(exponent - half)
}

/// The round step 1, 2 or 5 times a power of ten at or above `raw`, and the decimals its multiples need after
/// division by 10^`exponent`.
pub(crate) fn round_step(raw: f64, exponent: i32) -> (f64, usize) {
    if !raw.is_normal() || raw < 0.0 {
        return (1.0, 0);
    }
    let power = exponent10(raw);
    let mantissa = scale_down(raw, power);
    let (factor, carry) = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|f| mantissa <= f * (1.0 + 1e-9))
        .map_or((1.0, 1), |f| (f, 0));
    let power = power + carry;
    let decimals = usize::try_from(exponent - power).unwrap_or(0).min(12);
    // Parsed, so that a step of 0.1 is the number a reader would write.
    let step = format!("{factor}e{power}").parse().unwrap_or(raw);
    (step, decimals)
}

/// The largest of 1, 2 or 5 times a power of ten that is at most `raw`; `raw` itself if that is out of range.
pub(crate) fn round_step_below(raw: f64) -> f64 {
    if !raw.is_normal() {
        return raw;
    }
    let power = exponent10(raw);
    let mantissa = scale_down(raw, power) * (1.0 + 1e-9);
    let factor = [5.0, 2.0]
        .into_iter()
        .find(|f| *f <= mantissa)
        .unwrap_or(1.0);
    format!("{factor}e{power}").parse().unwrap_or(raw)
}

/// Decimals that show multiples of `step` without loss, six at most.
pub(crate) fn decimals(step: f64) -> usize {
    let exact = |n: &usize| {
        let scaled = step.abs() * 10f64.powi(*n as i32);
        (scaled - scaled.round()).abs() <= 1e-6 * scaled
    };
    (0..6).find(exact).unwrap_or(6)
}

/// Two axes around a rectangle.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) frame: Rect,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Room for the tick texts between the y axis and its label.
    y_texts: f64,
}

impl Panel {
    pub(crate) fn new(frame: Rect, x: Axis, y: Axis) -> Result<Self, PlotError> {
        let y_texts = y.text_width()?;
        Ok(Panel {
            frame,
            x,
            y,
            y_texts,
        })
    }

    /// Puts the y labels of two panels, one above the other, on one line.
    pub(crate) fn align_labels(a: &mut Panel, b: &mut Panel) {
        let widest = a.y_texts.max(b.y_texts);
        (a.y_texts, b.y_texts) = (widest, widest);
    }

    /// Place of a pair of values; none where a log axis has no place. May lie outside the frame.
    pub(crate) fn at(&self, x: f64, y: f64) -> Option<Xy> {
        let (u, v) = (self.x.fraction(x)?, self.y.fraction(y)?);
        Some((
            self.frame.left + u * self.frame.width(),
            self.frame.bottom - v * self.frame.height(),
        ))
    }

    /// Whether a place lies in the frame, its border included.
    pub(crate) fn contains(&self, (x, y): Xy) -> bool {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        (left - 0.01..=right + 0.01).contains(&x) && (top - 0.01..=bottom + 0.01).contains(&y)
    }

    /// Grid lines, beneath the data.
    pub(crate) fn draw_grid(&self, scene: &mut Scene) {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        let pen = Pen::solid(theme::GRID, theme::GRID_WIDTH);
        for (value, _) in &self.x.major {
            if let Some(t) = self.x.fraction(*value) {
                let x = left + t * self.frame.width();
                scene.line(&[(x, top), (x, bottom)], pen);
            }
        }
        for (value, _) in &self.y.major {
            if let Some(t) = self.y.fraction(*value) {
                let y = bottom - t * self.frame.height();
                scene.line(&[(left, y), (right, y)], pen);
            }
        }
    }

    /// Frame, ticks and texts, above the data.
    pub(crate) fn draw_frame(&self, scene: &mut Scene) {
        let Rect { left, bottom, .. } = self.frame;
        let (middle_x, middle_y) = self.frame.centre();
        let pen = Pen::solid(theme::INK, theme::FRAME_WIDTH);
        scene.rect_outline(self.frame, pen);

        // Ticks point outwards, so that no point hides them.
        let x_of = |v: f64| self.x.fraction(v).map(|t| left + t * self.frame.width());
        let y_of = |v: f64| self.y.fraction(v).map(|t| bottom - t * self.frame.height());
        for x in self.x.minor.iter().filter_map(|v| x_of(*v)) {
            scene.line(&[(x, bottom), (x, bottom + 0.6 * theme::TICK_LENGTH)], pen);
        }
        for y in self.y.minor.iter().filter_map(|v| y_of(*v)) {
            scene.line(&[(left - 0.6 * theme::TICK_LENGTH, y), (left, y)], pen);
        }
        let below = TextLook::new(theme::TICK_SIZE, Align::Centre, Level::Top);
        for (value, text) in &self.x.major {
            if let Some(x) = x_of(*value) {
                scene.line(&[(x, bottom), (x, bottom + theme::TICK_LENGTH)], pen);
                if !text.is_empty() {
                    scene.text(text, (x, bottom + theme::TICK_LENGTH + 5.0), below);
                }
            }
        }
        let beside = TextLook::new(theme::TICK_SIZE, Align::Right, Level::Middle);
        for (value, text) in &self.y.major {
            if let Some(y) = y_of(*value) {
                scene.line(&[(left - theme::TICK_LENGTH, y), (left, y)], pen);
                scene.text(text, (left - theme::TICK_LENGTH - 4.0, y), beside);
            }
        }

        if !self.x.label.is_empty() {
            let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Top);
            scene.text(&self.x.label, (middle_x, bottom + X_LABEL_DEPTH), look);
        }
        if !self.y.label.is_empty() {
            let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Baseline);
            let x = left - theme::TICK_LENGTH - 4.0 - self.y_texts - 10.0;
            scene.text_upwards(&self.y.label, (x, middle_y), look);
        }
    }
}

/// From the bottom of a panel to the top of the label of its x axis.
const X_LABEL_DEPTH: f64 = theme::TICK_LENGTH + 5.0 + theme::TICK_SIZE + 8.0;

/// Room below a panel for ticks and label.
pub(crate) const X_AXIS_DEPTH: f64 = X_LABEL_DEPTH + theme::LABEL_SIZE + 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<&str> {
        axis.major.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_at_every_magnitude() {
        assert_eq!(texts(&Axis::linear(0.0, 1.05, 5, 0)), ["0.0", "0.5", "1.0"]);
        assert_eq!(
            texts(&Axis::linear(-3.0e-12, 4.0e-12, 7, -12)),
            ["−3", "−2", "−1", "0", "1", "2", "3", "4"]
        );
        assert_eq!(
            texts(&Axis::linear(0.0, 1.3e9, 7, 9)),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0", "1.2"]
        );
    }

    #[test]
    fn steps_below_are_round_and_keep_their_decimals() {
        for (raw, step) in [(3.3, 2.0), (0.05, 0.05), (0.99e-12, 5e-13), (1e9, 1e9)] {
            assert_eq!(round_step_below(raw), step);
        }
        for (step, n) in [(0.25, 2), (5.0, 0), (0.0008, 4), (2.5, 1)] {
            assert_eq!(decimals(step), n);
        }
    }

    #[test]
    fn degenerate_ranges_have_finitely_many_ticks() {
        for (lo, hi) in [
            (1.0, 1.0),
            (0.0, 5e-324),
            (f64::MIN, f64::MAX),
            (1e16, 1e16 + 2.0),
        ] {
            assert!(Axis::linear(lo, hi, 6, 0).major.len() <= 20);
        }
    }

    #[test]
    fn log_axis_shows_decades_and_has_no_place_for_zero() {
        let axis = Axis::log10(3e-4, 2.0);
        assert_eq!(texts(&axis), ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(axis.fraction(0.0), None);
        assert_eq!(axis.fraction(-1.0), None);
        assert!((axis.fraction(2.0).unwrap() - 1.0).abs() < 1e-12);
    }
}
