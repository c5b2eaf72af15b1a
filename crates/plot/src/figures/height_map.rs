//! A surface seen from above.

use crate::elements::axis::extent;
use crate::elements::colour_scale::ColourScale;
use crate::elements::tile_map::{MapColours, MapText, TileMap};
use crate::elements::units::LengthUnit;
use crate::error::Valid;
use crate::{Figure, PlotError};

/// Heights of one periodic tile, in colour, with a colour bar.
///
/// The colours are *viridis*: equal steps of height appear equally large, also in grey. The subtitle gains the
/// root mean square height about the mean and the extremes, taken from the samples as given. A field of more
/// than 512 samples per side is averaged over blocks for display; the colours then span the averages, which are
/// flatter than the samples.
///
/// Sample (ix, iy) fills the cell from (ix dx, iy dy) to ((ix + 1) dx, (iy + 1) dy); row 0 is on top unless `y_up`.
/// Both axes have the same scale. Only a field more than 16 times longer than wide is stretched, and says so.
///
/// ```
/// use asperity_plot::HeightMapFigure;
///
/// let heights: Vec<f64> = (0..32 * 48)
///     .map(|i| 2e-6 * (0.3 * f64::from(i % 48)).sin())
///     .collect();
/// let figure = HeightMapFigure {
///     title: "A corrugated surface".into(),
///     subtitle: "period 21 samples".into(),
///     heights: &heights,
///     shape: [32, 48],
///     spacing: [1e-6, 1e-6],
///     unit: "m".into(),
///     y_up: false,
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("height (µm)"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMapFigure<'a> {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// Heights in `unit`, row-major, `ny` rows of `nx`.
    pub heights: &'a [f64],
    /// `[ny, nx]`.
    pub shape: [usize; 2],
    /// `[dy, dx]` in `unit`, > 0.
    pub spacing: [f64; 2],
    /// Symbol of the length unit: `m`, `cm`, `mm`, `um` or `µm`, `nm` (shown with the prefix that suits the
    /// numbers), `1` for arbitrary units, or any other symbol, shown as it is.
    pub unit: String,
    /// `true` if the first row is at the bottom, so that y points up, instead of on top.
    pub y_up: bool,
}

impl HeightMapFigure<'_> {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] for an empty field, [`PlotError::MismatchedLengths`] if `heights` does not
    /// fill `shape`, [`PlotError::OutOfRange`] for heights or spacings without
    /// meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        let map = self.map();
        map.check("height field", "height", Valid::Finite)?;
        let statistics = Statistics::of(self.heights);
        let vertical = &match statistics.min.abs().max(statistics.max.abs()) {
            0.0 => map.lateral(),
            height => LengthUnit::choose(&self.unit, height),
        };
        let text = MapText {
            title: &self.title,
            subtitle: &self.subtitle,
            facts: facts(&map, &statistics, vertical),
        };
        let colours = |means: &[f64]| {
            let scale = colour_scale(means, vertical.unit_size);
            let axis = move |n| vertical.axis(scale.lo, scale.hi, n);
            MapColours {
                scale,
                axis,
                title: vertical.label("height"),
            }
        };
        map.draw(text, colours)
    }

    fn map(&self) -> TileMap<'_> {
        TileMap {
            values: self.heights,
            shape: self.shape,
            spacing: self.spacing,
            unit: &self.unit,
            y_up: self.y_up,
        }
    }
}

fn facts(map: &TileMap<'_>, statistics: &Statistics, unit: &LengthUnit) -> String {
    let [rms, lowest, highest] =
        [statistics.rms, statistics.min, statistics.max].map(|h| unit.number(h));
    let (size, suffix) = (map.size_text("samples"), unit.suffix());
    format!("{size}; rms height {rms}, lowest {lowest}, highest {highest}{suffix}")
}

/// Range of the colours; a flat field gets one around its height, of two shown units if that is zero.
fn colour_scale(heights: &[f64], unit_size: f64) -> ColourScale {
    let [min, max] = extent(heights.iter().copied()).unwrap_or([0.0, 0.0]);
    // Differences below rounding would give ticks that all read the same.
    let scale = min.abs().max(max.abs());
    if 0.5 * max - 0.5 * min > 1e-9 * scale {
        ColourScale::linear(min, max)
    } else if scale == 0.0 {
        ColourScale::linear(-unit_size, unit_size)
    } else {
        ColourScale::linear(min - 0.1 * scale, max + 0.1 * scale)
    }
}

/// Moments of a field, without overflow.
struct Statistics {
    min: f64,
    max: f64,
    /// Root mean square about the mean.
    rms: f64,
}

impl Statistics {
    fn of(heights: &[f64]) -> Self {
        let [min, max] = extent(heights.iter().copied()).unwrap_or([0.0, 0.0]);
        let scale = min.abs().max(max.abs());
        if scale == 0.0 {
            return Statistics { min, max, rms: 0.0 };
        }
        let n = heights.len() as f64;
        let mean = heights.iter().map(|h| h / scale).sum::<f64>() / n;
        let squares = heights.iter().map(|h| (h / scale - mean).powi(2));
        let variance = squares.sum::<f64>() / n;
        Statistics {
            min,
            max,
            rms: scale * variance.sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_zero_is_on_top() {
        let figure = HeightMapFigure {
            title: String::new(),
            subtitle: String::new(),
            heights: &[0.0, 0.0, 1.0, 1.0],
            shape: [2, 2],
            spacing: [1.0, 1.0],
            unit: "1".into(),
            y_up: false,
        };
        let means = figure.map().block_means(2, 2);
        assert_eq!(
            means
                .iter()
                .map(|h| colour_scale(&means, 1.0).index(*h, 256))
                .collect::<Vec<_>>(),
            [0, 0, 255, 255]
        );
    }
}
