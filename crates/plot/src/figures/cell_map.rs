//! A quantity by cell of a surface, seen from above.

use crate::elements::axis::{Axis, extent};
use crate::elements::colour_scale::ColourScale;
use crate::elements::numbers::{display_exponent, power_of_ten, three_digits};
use crate::elements::tile_map::{MapColours, MapText, TileMap};
use crate::error::Valid;
use crate::{Figure, PlotError};

/// A quantity by cell of one tile, zero or more and without a unit, in colour, with a colour bar that begins at zero, or a logarithmic one.
///
/// The colours are *viridis*: equal steps appear equally large, also in grey. The subtitle gains the mean and the extremes of the cells. A tile
/// of more than 512 cells per side is averaged over blocks for display; the colours then span the averages.
///
/// Cell (ix, iy) lies between (ix dx, iy dy) and ((ix + 1) dx, (iy + 1) dy); row 0 is on top unless `y_up`.
///
/// ```
/// use asperity_plot::CellMapFigure;
///
/// let values: Vec<f64> = (0..32 * 48)
///     .map(|i| 0.2 + 0.1 * (0.3 * f64::from(i % 48)).sin())
///     .collect();
/// let figure = CellMapFigure {
///     title: "Absorbed light".into(),
///     subtitle: "period 21 cells".into(),
///     quantity: "absorbed / incident flux".into(),
///     values: &values,
///     shape: [32, 48],
///     spacing: [1e-6, 1e-6],
///     unit: "m".into(),
///     y_up: false,
///     noun: "cells",
///     decades: false,
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("mean 0.2"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CellMapFigure<'a> {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// Title of the colour bar.
    pub quantity: String,
    /// The quantity by cell, zero or more, row-major, `ny` rows of `nx`.
    pub values: &'a [f64],
    /// `[ny, nx]`.
    pub shape: [usize; 2],
    /// `[dy, dx]` in `unit`, > 0.
    pub spacing: [f64; 2],
    /// Symbol of the length unit, as of [`HeightMapFigure`](crate::HeightMapFigure).
    pub unit: String,
    /// `true` if the first row is at the bottom, so that y points up, instead of on top.
    pub y_up: bool,
    /// Plural noun for the cells, such as `cells` or `pixels`.
    pub noun: &'a str,
    /// `true` for logarithmic colours, over three decades at most; smaller values have the colour of the lower end.
    pub decades: bool,
}

/// Most decades of logarithmic colours.
const MAX_DECADES: i32 = 3;

impl CellMapFigure<'_> {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without cells, [`PlotError::MismatchedLengths`] if `values` does not fill `shape`,
    /// [`PlotError::OutOfRange`] for values below zero or spacings without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        let map = TileMap {
            values: self.values,
            shape: self.shape,
            spacing: self.spacing,
            unit: &self.unit,
            y_up: self.y_up,
        };
        map.check("map of cells", "value of a cell", Valid::NotNegative)?;
        let [lowest, highest] = extent(self.values.iter().copied()).unwrap_or([0.0; 2]);
        let mean = self.values.iter().sum::<f64>() / self.values.len() as f64;
        let [mean, lowest, highest] = [mean, lowest, highest].map(three_digits);
        let text = MapText {
            title: &self.title,
            subtitle: &self.subtitle,
            facts: format!(
                "{}; mean {mean}, lowest {lowest}, highest {highest}",
                map.size_text(self.noun)
            ),
        };
        let colours = |means: &[f64]| {
            let lit = extent(means.iter().copied().filter(|value| *value > 0.0));
            let scale = match lit {
                Some([least, largest]) if self.decades => {
                    ColourScale::decades(least, largest, MAX_DECADES)
                }
                lit => ColourScale::linear(0.0, lit.map_or(1.0, |[_, largest]| largest)),
            };
            let exponent = match scale.log {
                true => 0,
                false => display_exponent(scale.hi),
            };
            MapColours {
                scale,
                axis: move |n| match scale.log {
                    true => Axis::log10(scale.lo, scale.hi),
                    false => Axis::linear(scale.lo, scale.hi, n, exponent),
                },
                title: match exponent {
                    0 => self.quantity.clone(),
                    exponent => format!("{} ({})", self.quantity, power_of_ten(exponent)),
                },
            }
        };
        map.draw(text, colours)
    }
}
