//! The scale of a picture's brightness.

use crate::elements::axis::Axis;
use crate::elements::geometry::Rect;
use crate::elements::numbers::{exponent10, power_of_ten};
use crate::elements::page::Page;
use crate::elements::panel::{Panel, X_AXIS_DEPTH};
use crate::elements::rgb::Rgb;
use crate::elements::scene::Picture;
use crate::elements::text::text_width;
use crate::elements::theme;
use crate::error::Valid;
use crate::{Figure, PlotError};

const TOP: f64 = 12.0;
const RAMP_HEIGHT: f64 = 18.0;
const MIN_TICK_GAP: f64 = 10.0;
/// Decades below white that ticks are sought in.
const DECADES: i32 = 9;

/// A ramp of stored grey levels from black to white, with ticks at round values: a strip to append below a picture.
///
/// [`Figure::rgb`] has one pixel per point, so that the strip of a picture is as many points wide as that has columns.
///
/// ```
/// use asperity_plot::BrightnessScale;
///
/// let scale = BrightnessScale {
///     title: "radiance",
///     width: 320,
///     range: [0.0, 2.0],
///     place: &|radiance: f64| (radiance / 2.0).powf(0.45),
/// };
/// assert_eq!(scale.draw()?.size().0, 320);
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
pub struct BrightnessScale<'a> {
    /// Title of the axis.
    pub title: &'a str,
    /// Width in points, [`MIN_WIDTH`](Self::MIN_WIDTH) at least.
    pub width: u32,
    /// Values of black, zero or more, and white.
    pub range: [f64; 2],
    /// Place of a value along the ramp, 0 at black and 1 at white; must not fall.
    pub place: &'a dyn Fn(f64) -> f64,
}

impl BrightnessScale<'_> {
    /// Least width, points.
    pub const MIN_WIDTH: u32 = 160;

    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::OutOfRange`] if it is too narrow, or the range is not one.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        let [black, white] = self.range;
        Valid::NotNegative.check("value of black", 0, black)?;
        Valid::Positive.check("value of white above black", 0, white - black)?;
        let beyond_least = f64::from(self.width) - f64::from(Self::MIN_WIDTH);
        Valid::NotNegative.check("width beyond the least", 0, beyond_least)?;

        let width = f64::from(self.width);
        let mut page = Page::new("", "", width)?;
        let ramp = Rect::at(
            (theme::MARGIN, TOP),
            width - 2.0 * theme::MARGIN,
            RAMP_HEIGHT,
        );
        page.scene.pictures.push(Picture {
            frame: ramp,
            columns: 256,
            pixels: (0..=255).collect(),
            palette: (0..=255).map(|grey| Rgb(grey, grey, grey)).collect(),
        });
        let mut x_axis = Axis::linear(0.0, 1.0, 1, 0).with_label(self.title);
        x_axis.major = self.ticks(ramp.width())?;
        let mut y_axis = Axis::linear(0.0, 1.0, 1, 0);
        y_axis.major.clear();
        Panel::new(ramp, x_axis, y_axis)?.draw_frame(&mut page.scene);
        Ok(page.finish(ramp.bottom + X_AXIS_DEPTH - theme::MARGIN + 8.0))
    }

    /// Places and texts of ticks at zero, powers of ten, and five and two times these: earlier ones are kept where texts would overlap.
    fn ticks(&self, length: f64) -> Result<Vec<(f64, String)>, PlotError> {
        let [black, white] = self.range;
        let last = exponent10(white);
        let decades = || (last - DECADES..=last).rev();
        let round = [1, 5, 2].into_iter().flat_map(|digit| {
            decades().filter_map(move |exponent| {
                let value = format!("{digit}e{exponent}").parse().ok()?;
                Some((value, text(digit, exponent)))
            })
        });
        let mut kept: Vec<(f64, String, f64)> = Vec::new();
        for (value, text) in std::iter::once((0.0, "0".to_owned())).chain(round) {
            if !(black..=white * (1.0 + 1e-9)).contains(&value) {
                continue;
            }
            let (place, half) = (
                (self.place)(value),
                0.5 * text_width(&text, theme::TICK_SIZE)?,
            );
            let end = (place * length).min((1.0 - place) * length);
            let is_free = end + theme::MARGIN >= half
                && kept.iter().all(|(other, _, width)| {
                    (place - other).abs() * length >= half + width + MIN_TICK_GAP
                });
            if is_free {
                kept.push((place, text, half));
            }
        }
        kept.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(kept
            .into_iter()
            .map(|(place, text, _)| (place, text))
            .collect())
    }
}

/// A digit times a power of ten, as a reader would write it.
fn text(digit: i32, exponent: i32) -> String {
    match (digit, exponent) {
        (_, -4..=3) => format!("{}", f64::from(digit) * 10f64.powi(exponent)),
        (1, _) => power_of_ten(exponent),
        _ => format!("{digit} × {}", power_of_ten(exponent)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(range: [f64; 2], place: &dyn Fn(f64) -> f64, length: f64) -> Vec<(f64, String)> {
        let scale = BrightnessScale {
            title: "radiance",
            width: 640,
            range,
            place,
        };
        scale.ticks(length).unwrap()
    }

    #[test]
    fn ticks_are_round_and_stand_where_their_value_is() {
        let place = |value: f64| (value / 3.0).sqrt();
        let found = ticks([0.0, 3.0], &place, 600.0);
        let texts: Vec<&str> = found.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["0", "0.01", "0.1", "0.2", "0.5", "1", "2"]);
        for (at, text) in &found {
            assert!((at - place(text.parse().unwrap())).abs() < 1e-12);
        }
        // Fewer where there is less room.
        assert_eq!(ticks([0.0, 3.0], &place, 120.0).len(), 4);
    }

    #[test]
    fn ticks_of_small_and_large_values_have_powers_of_ten() {
        let logarithmic = |value: f64| 1.0 + (value / 2e7).log10() / 3.0;
        let found = ticks([2e4, 2e7], &logarithmic, 300.0);
        let texts: Vec<&str> = found.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["10⁵", "10⁶", "10⁷"]);
    }
}
