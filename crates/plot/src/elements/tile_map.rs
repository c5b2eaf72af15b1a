//! Tile map: values on the grid of one tile, seen from above, in colour, with a colour bar.

use super::axis::Axis;
use super::colour_scale::{ColourScale, Colours, bar_ticks, draw_bar};
use super::geometry::Rect;
use super::page::Page;
use super::panel::{Panel, X_AXIS_DEPTH, y_axis_room};
use super::scene::{Align, Level, Picture, TextStyle};
use super::theme;
use super::units::LengthUnit;
use crate::error::{Valid, check_length};
use crate::{Figure, PlotError};

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

/// Values on the grid of one tile, row-major. Value (ix, iy) fills the cell from (ix dx, iy dy) to ((ix + 1) dx, (iy + 1) dy).
#[derive(Debug, Clone, Copy)]
pub(crate) struct TileMap<'a> {
    pub(crate) values: &'a [f64],
    /// `[ny, nx]`.
    pub(crate) shape: [usize; 2],
    /// `[dy, dx]` in `unit`, > 0.
    pub(crate) spacing: [f64; 2],
    /// Symbol of the length unit.
    pub(crate) unit: &'a str,
    /// `true` if the first row is at the bottom instead of on top.
    pub(crate) y_up: bool,
}

/// Lines above a map.
pub(crate) struct MapText<'a> {
    pub(crate) title: &'a str,
    pub(crate) subtitle: &'a str,
    /// Facts on the values, below the subtitle.
    pub(crate) facts: String,
}

/// Colour scale of a map, with the title of its bar and the axis of the bar, a function of the desired number of ticks.
pub(crate) struct MapColours<F> {
    pub(crate) scale: ColourScale,
    pub(crate) axis: F,
    pub(crate) title: String,
}

impl TileMap<'_> {
    /// Refuses no values at all, values that do not fill the grid or are out of range, and spacings without meaning. `field` and `value`
    /// name the values together and each.
    pub(crate) fn check(&self, field: &str, value: &str, valid: Valid) -> Result<(), PlotError> {
        let [ny, nx] = self.shape;
        if nx == 0 || ny == 0 {
            let what = format!("a {field} of {ny} rows and {nx} columns");
            return Err(PlotError::nothing_to_draw(what));
        }
        check_length(field, self.values.len(), nx.saturating_mul(ny))?;
        valid.check_all(value, self.values.iter().copied())?;
        Valid::Positive.check_all("spacing", self.spacing)?;
        Valid::Finite.check_all("extent", self.extent())
    }

    /// Along x and y.
    fn extent(&self) -> [f64; 2] {
        let ([ny, nx], [dy, dx]) = (self.shape, self.spacing);
        [nx as f64 * dx, ny as f64 * dy]
    }

    /// The unit in which x and y are shown.
    pub(crate) fn lateral(&self) -> LengthUnit {
        let [x, y] = self.extent();
        LengthUnit::choose(self.unit, x.max(y))
    }

    /// Number of values, and where the first row is: "96 × 64 samples, first row on top".
    pub(crate) fn size_text(&self, noun: &str) -> String {
        let [ny, nx] = self.shape;
        let first = if self.y_up { "at the bottom" } else { "on top" };
        format!("{nx} × {ny} {noun}, first row {first}")
    }

    /// Lays the map out. `colours` gives the colours of the values that are shown, which are averages of those of a large grid.
    pub(crate) fn draw<F: Fn(usize) -> Axis>(
        &self,
        mut text: MapText<'_>,
        colours: impl FnOnce(&[f64]) -> MapColours<F>,
    ) -> Result<Figure, PlotError> {
        let (extent, lateral) = (self.extent(), self.lateral());

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

        let mut page = Page::new(text.title, text.subtitle, figure_width)?;
        if aspect != true_aspect {
            text.facts.push_str("; axes not to the same scale");
        }
        let style = TextStyle::new(theme::SUBTITLE_SIZE, Align::Left, Level::Top);
        page.lines(&text.facts, style.muted())?;

        // The colour bar is at least tall enough to be read.
        let (top, band) = (page.y + 16.0, height.max(MIN_BAR_HEIGHT));
        let map = Rect::at((left, top + 0.5 * (band - height)), width, height);
        let [ny, nx] = self.shape;
        let (columns, rows) = (shown_cells(nx), shown_cells(ny));
        let mut means = self.block_means(columns, rows);
        if self.y_up {
            means = means.chunks(columns).rev().flatten().copied().collect();
        }
        let MapColours { scale, axis, title } = colours(&means);
        page.scene.pictures.push(Picture {
            frame: map,
            columns,
            pixels: means.iter().map(|value| scale.index(*value, 256)).collect(),
            palette: Colours::Viridis.palette(256).collect(),
        });
        Panel::new(map, x_axis, y_axis)?.draw_frame(&mut page.scene);
        let bar = Rect::at((map.right + BAR_GAP, top), BAR_WIDTH, band);
        let axis = bar_ticks(band, axis);
        draw_bar(&mut page.scene, bar, Colours::Viridis, &axis, &[&title])?;
        Ok(page.finish((map.bottom + X_AXIS_DEPTH).max(bar.bottom)))
    }

    /// The field averaged over equal cells, first row first.
    pub(crate) fn block_means(&self, columns: usize, rows: usize) -> Vec<f64> {
        let [ny, nx] = self.shape;
        let (wx, wy) = (weights(nx, columns), weights(ny, rows));
        let mut means = Vec::with_capacity(columns * rows);
        for (first_y, weights_y) in &wy {
            for (first_x, weights_x) in &wx {
                let mut mean = 0.0;
                for (i, weight_y) in weights_y.iter().enumerate() {
                    let start = (first_y + i) * nx + first_x;
                    for (value, weight_x) in self.values[start..].iter().zip(weights_x) {
                        mean += weight_y * weight_x * value;
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
}
