//! Axes with round ticks.

use super::numbers::{
    RoundStep, display_exponent, exponent10, fixed, per_steradian, power_of_ten, round_step,
    scale_down,
};
use super::text::text_width;
use super::theme;
use crate::PlotError;

/// Free space around the data of a logarithmic axis, in decades.
const DECADES_OF_ROOM: f64 = 0.15;

/// Scale between a value and its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Linear,
    Log10,
}

/// A range of values with ticks.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    scale: Scale,
    /// Values and their texts, ascending.
    pub(crate) major: Vec<(f64, String)>,
    pub(crate) minor: Vec<f64>,
    pub(crate) label: String,
}

impl Axis {
    /// About `count` ticks at round values. `exponent`: tick texts show value / 10^exponent.
    pub(crate) fn linear(lo: f64, hi: f64, count: usize, exponent: i32) -> Self {
        let RoundStep { step, decimals } = round_step((hi - lo) / count.max(1) as f64, exponent);
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

    /// A logarithmic axis around `lo` to `hi`, > 0, with two decades marked at least.
    pub(crate) fn decades_around([lo, hi]: [f64; 2]) -> Self {
        let margin = 10f64.powf(DECADES_OF_ROOM);
        let (lo, hi) = (
            (lo / margin).max(f64::MIN_POSITIVE),
            (hi * margin).min(f64::MAX),
        );
        let axis = Axis::log10(lo, hi);
        if axis.major.len() > 1 {
            return axis;
        }
        let power = |exponent: i32| 10f64.powi(exponent.clamp(-307, 308));
        Axis::log10(power(exponent10(lo)), power(exponent10(hi) + 1))
    }

    /// The axis with its ends exchanged.
    pub(crate) fn reversed(mut self) -> Self {
        std::mem::swap(&mut self.lo, &mut self.hi);
        self
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

    /// Place of `value`, 0 at the low end and 1 at the high end; `None` for zero and below on a log axis.
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

/// The least and the largest of some values; `None` without values.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().fold(None, |range, v| {
        let [lo, hi] = range.unwrap_or([v, v]);
        Some([v.min(lo), v.max(hi)])
    })
}

/// A linear axis of a quantity in 1/sr.
pub(crate) fn per_steradian_axis(quantity: &str, lo: f64, hi: f64, count: usize) -> Axis {
    let exponent = display_exponent(hi.max(-lo));
    let unit = per_steradian(exponent);
    Axis::linear(lo, hi, count, exponent).with_label(&format!("{quantity} {unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_mark_two_decades_whatever_the_range() {
        for (lo, hi) in [
            (2.0, 3.0),
            (1.0, 1.0),
            (9e-5, 1.1e-4),
            (1e-300, 2e-300),
            (0.03, 40.0),
        ] {
            let axis = Axis::decades_around([lo, hi]);
            assert!(axis.major.len() >= 2, "{lo} {hi}: {:?}", axis.major);
            assert!(axis.lo <= lo && axis.hi >= hi);
        }
    }

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
