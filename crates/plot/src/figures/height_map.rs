//! A surface seen from above.

use crate::elements::axis::extent;
use crate::elements::colour_scale::{ColourScale, Colours, bar_ticks, draw_bar};
use crate::elements::geometry::Rect;
use crate::elements::page::Page;
use crate::elements::panel::{Panel, X_AXIS_DEPTH, y_axis_room};
use crate::elements::scene::{Align, Level, Picture, TextStyle};
use crate::elements::theme;
use crate::elements::units::LengthUnit;
use crate::error::{Valid, check_length};
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

/// Samples per side that are shown; more are averaged.
const MAX_CELLS: usize = 512;
/// Room for a title, whatever the shape of the map.
const MIN_FIGURE_WIDTH: f64 = 600.0;
const MAX_MAP: (f64, f64) = (640.0, 560.0);
const BAR_WIDTH: f64 = 20.0;
const BAR_GAP: f64 = 28.0;
/// Right of the map: colour bar, its texts and label, and the margin.
const BAR_ROOM: f64 = 150.0;
const MIN_BAR_HEIGHT: f64 = 150.0;
const MAX_ASPECT: f64 = 16.0;

impl HeightMapFigure<'_> {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] for an empty field, [`PlotError::MismatchedLengths`] if `heights` does not
    /// fill `shape`, [`PlotError::OutOfRange`] for heights or spacings without
    /// meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let extent = self.extent();
        let lateral = LengthUnit::choose(&self.unit, extent[0].max(extent[1]));
        let statistics = Statistics::of(self.heights);
        let vertical = match statistics.min.abs().max(statistics.max.abs()) {
            0.0 => lateral.clone(),
            height => LengthUnit::choose(&self.unit, height),
        };

        // The map, as large as fits.
        let true_aspect = extent[0] / extent[1];
        let aspect = true_aspect.clamp(1.0 / MAX_ASPECT, MAX_ASPECT);
        let width = MAX_MAP.0.min(MAX_MAP.1 * aspect);
        let height = width / aspect;
        let x_axis = lateral.side_axis("x", extent[0], width);
        let y_axis = lateral.side_axis("y", extent[1], height);
        let y_axis = match self.y_up {
            true => y_axis,
            // As images show it: the first row on top, so y points down
            false => y_axis.reversed(),
        };
        let left = theme::MARGIN + y_axis_room(&y_axis)?;
        let figure_width = (left + width + BAR_ROOM).max(MIN_FIGURE_WIDTH);

        let mut page = Page::new(&self.title, &self.subtitle, figure_width)?;
        let mut facts = self.facts(&statistics, &vertical);
        if aspect != true_aspect {
            facts.push_str("; axes not to the same scale");
        }
        let style = TextStyle::new(theme::SUBTITLE_SIZE, Align::Left, Level::Top);
        page.lines(&facts, style.muted())?;

        // The colour bar is at least tall enough to be read.
        let (top, band) = (page.y + 16.0, height.max(MIN_BAR_HEIGHT));
        let map = Rect::at((left, top + 0.5 * (band - height)), width, height);
        let [ny, nx] = self.shape;
        let (columns, rows) = (shown_cells(nx), shown_cells(ny));
        let mut means = self.block_means(columns, rows);
        if self.y_up {
            means = means.chunks(columns).rev().flatten().copied().collect();
        }
        let scale = colour_scale(&means, vertical.unit_size);
        page.scene.pictures.push(Picture {
            frame: map,
            columns,
            pixels: means.iter().map(|h| scale.index(*h, 256)).collect(),
            palette: Colours::Viridis.palette(256).collect(),
        });
        Panel::new(map, x_axis, y_axis)?.draw_frame(&mut page.scene);
        let bar = Rect::at((map.right + BAR_GAP, top), BAR_WIDTH, band);
        let axis = bar_ticks(band, |n| vertical.axis(scale.lo, scale.hi, n));
        draw_bar(
            &mut page.scene,
            bar,
            Colours::Viridis,
            &axis,
            &[&vertical.label("height")],
        )?;
        Ok(page.finish((map.bottom + X_AXIS_DEPTH).max(bar.bottom)))
    }

    fn check(&self) -> Result<(), PlotError> {
        let [ny, nx] = self.shape;
        if nx == 0 || ny == 0 {
            let what = format!("a height field of {ny} rows and {nx} columns");
            return Err(PlotError::nothing_to_draw(what));
        }
        check_length("height field", self.heights.len(), nx.saturating_mul(ny))?;
        Valid::Finite.check_all("height", self.heights.iter().copied())?;
        Valid::Positive.check_all("spacing", self.spacing)?;
        let extent = self.extent();
        Valid::Finite.check_all("extent", extent)
    }

    /// Along x and y.
    fn extent(&self) -> [f64; 2] {
        let ([ny, nx], [dy, dx]) = (self.shape, self.spacing);
        [nx as f64 * dx, ny as f64 * dy]
    }

    fn facts(&self, statistics: &Statistics, unit: &LengthUnit) -> String {
        let [ny, nx] = self.shape;
        let [rms, lowest, highest] =
            [statistics.rms, statistics.min, statistics.max].map(|h| unit.number(h));
        let suffix = unit.suffix();
        let first = if self.y_up { "at the bottom" } else { "on top" };
        format!(
            "{nx} × {ny} samples, first row {first}; rms height {rms}, lowest {lowest}, highest {highest}{suffix}"
        )
    }

    /// The field averaged over equal cells, first row first.
    fn block_means(&self, columns: usize, rows: usize) -> Vec<f64> {
        let [ny, nx] = self.shape;
        let (wx, wy) = (weights(nx, columns), weights(ny, rows));
        let mut means = Vec::with_capacity(columns * rows);
        for (first_y, weights_y) in &wy {
            for (first_x, weights_x) in &wx {
                let mut mean = 0.0;
                for (i, weight_y) in weights_y.iter().enumerate() {
                    let start = (first_y + i) * nx + first_x;
                    for (height, weight_x) in self.heights[start..].iter().zip(weights_x) {
                        mean += weight_y * weight_x * height;
                    }
                }
                means.push(mean);
            }
        }
        means
    }
}

/// Cells shown for `n` samples: whole blocks of equal size as far as possible.
fn shown_cells(n: usize) -> usize {
    n.div_ceil(n.div_ceil(MAX_CELLS))
}

/// For each of `cells` equal cells over `n` samples: the first sample it overlaps and normalised overlaps.
fn weights(n: usize, cells: usize) -> Vec<(usize, Vec<f64>)> {
    (0..cells)
        .map(|cell| {
            // In units of 1 / cells of a sample, all edges are whole numbers.
            let (from, to) = (cell * n, (cell + 1) * n);
            let (first, last) = (from / cells, (to - 1) / cells);
            let overlaps = (first..=last)
                .map(|i| (to.min((i + 1) * cells) - from.max(i * cells)) as f64 / n as f64)
                .collect();
            (first, overlaps)
        })
        .collect()
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
    fn block_averages_keep_the_mean() {
        for n in [1, 2, 511, 512, 513, 650, 1025, 4000] {
            let cells = shown_cells(n);
            assert!(cells <= MAX_CELLS && cells <= n);
            let mut total = vec![0.0; n];
            for (first, overlaps) in weights(n, cells) {
                assert!((overlaps.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                for (i, overlap) in overlaps.iter().enumerate() {
                    total[first + i] += overlap / cells as f64;
                }
            }
            for fraction in total {
                assert!((fraction - 1.0 / n as f64).abs() < 1e-12, "{n}");
            }
        }
    }

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
        let means = figure.block_means(2, 2);
        assert_eq!(
            means
                .iter()
                .map(|h| colour_scale(&means, 1.0).index(*h, 256))
                .collect::<Vec<_>>(),
            [0, 0, 255, 255]
        );
    }
}
