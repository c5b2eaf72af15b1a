//! A surface seen from above.

use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

use crate::elements::axis::{Axis, Panel, X_AXIS_DEPTH, display_exponent, scale_down};
use crate::elements::scene::{Align, Level, Picture, Rect, Scene, TextLook};
use crate::elements::series::check_finite;
use crate::elements::text::{header, power_of_ten, text_width, three_digits, wrap};
use crate::elements::theme;
use crate::{Figure, PlotError};

/// Heights of one periodic tile, in colour, with a colour bar.
///
/// The colours are *viridis*: equal steps of height look equally large, also in grey. The subtitle gains the
/// root mean square height about the mean and the extremes, taken from the samples as given. A field of more
/// than 512 samples a side is averaged over blocks for display; the colours then span the averages, which are
/// flatter than the samples.
///
/// Sample (ix, iy) fills the cell from (ix dx, iy dy) to ((ix + 1) dx, (iy + 1) dy); row 0 is at the bottom.
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
}

/// Samples a side that are shown; more are averaged.
const MAX_CELLS: usize = 512;
/// Room for a title, whatever the shape of the map.
const MIN_FIGURE_WIDTH: f64 = 600.0;
const MAX_MAP: (f64, f64) = (640.0, 560.0);
const BAR_WIDTH: f64 = 20.0;
const BAR_GAP: f64 = 28.0;
/// Right of the map: colour bar, its texts and label, and the margin.
const BAR_ROOM: f64 = 150.0;
const MIN_BAR_HEIGHT: f64 = 150.0;
const POINTS_PER_TICK: f64 = 38.0;
const MAX_ASPECT: f64 = 16.0;

impl HeightMapFigure<'_> {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] for an empty field, [`PlotError::MismatchedLengths`] if `heights` does not
    /// fill `shape`, [`PlotError::NonFinite`] and [`PlotError::OutOfRange`] for heights or spacings without
    /// meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let [ny, nx] = self.shape;
        let [dy, dx] = self.spacing;
        let extent = (nx as f64 * dx, ny as f64 * dy);
        check_finite("extent along x", 0, extent.0)?;
        check_finite("extent along y", 0, extent.1)?;

        let statistics = Statistics::of(self.heights);
        let lateral = Display::choose(&self.unit, extent.0.max(extent.1));
        let height_span = statistics.min.abs().max(statistics.max.abs());
        let vertical = if height_span == 0.0 {
            lateral.clone()
        } else {
            Display::choose(&self.unit, height_span)
        };

        // The map, as large as fits.
        let aspect = extent.0 / extent.1;
        let stretched = !(1.0 / MAX_ASPECT..=MAX_ASPECT).contains(&aspect);
        let aspect = aspect.clamp(1.0 / MAX_ASPECT, MAX_ASPECT);
        let width = MAX_MAP.0.min(MAX_MAP.1 * aspect);
        let height = width / aspect;
        let x_axis = lateral.side_axis("x", extent.0, width);
        let y_axis = lateral.side_axis("y", extent.1, height);
        let left = theme::MARGIN
            + theme::LABEL_SIZE
            + 10.0
            + y_axis.text_width()?
            + 4.0
            + theme::TICK_LENGTH;
        let figure_width = (left + width + BAR_ROOM).max(MIN_FIGURE_WIDTH).round();

        let mut scene = Scene::new(&self.title);
        let mut y = header(&mut scene, &self.subtitle, figure_width)?;
        let number = |h: f64| vertical.number(h);
        let mut facts = format!(
            "{nx} × {ny} samples; rms height {}, lowest {}, highest {}{}",
            number(statistics.rms),
            number(statistics.min),
            number(statistics.max),
            vertical.suffix(),
        );
        if stretched {
            facts.push_str("; axes not to the same scale");
        }
        let look = TextLook::new(theme::SUBTITLE_SIZE, Align::Left, Level::Top).muted();
        for line in wrap(
            &facts,
            theme::SUBTITLE_SIZE,
            figure_width - 2.0 * theme::MARGIN,
        )? {
            scene.text(&line, (theme::MARGIN, y), look);
            y += 1.45 * theme::SUBTITLE_SIZE;
        }
        y += 16.0;

        let band = height.max(MIN_BAR_HEIGHT);
        let map = Rect {
            left,
            top: y + 0.5 * (band - height),
            right: left + width,
            bottom: y + 0.5 * (band + height),
        };
        let (columns, rows) = (shown_cells(nx), shown_cells(ny));
        let means = self.block_means(columns, rows);
        let (lo, hi) = colour_range(&means, vertical.unit_size);
        scene.pictures.push(Picture {
            frame: map,
            columns,
            pixels: palette_indices(&means, lo, hi),
            palette: palette(),
        });
        Panel::new(map, x_axis, y_axis)?.draw_frame(&mut scene);

        // The colour bar, at least tall enough to be read.
        let bar = Rect {
            left: map.right + BAR_GAP,
            top: y,
            right: map.right + BAR_GAP + BAR_WIDTH,
            bottom: y + band,
        };
        draw_colour_bar(&mut scene, bar, vertical.axis(lo, hi, 6), &vertical)?;

        scene.width = figure_width as u32;
        scene.height = (y + 0.5 * (band + height) + X_AXIS_DEPTH)
            .max(bar.bottom)
            .round() as u32
            + theme::MARGIN as u32;
        Ok(Figure::new(scene))
    }

    fn check(&self) -> Result<(), PlotError> {
        let [ny, nx] = self.shape;
        if nx == 0 || ny == 0 {
            return Err(PlotError::NothingToDraw {
                what: format!("a height field of {ny} rows and {nx} columns"),
            });
        }
        let expected = nx.saturating_mul(ny);
        if self.heights.len() != expected {
            return Err(PlotError::MismatchedLengths {
                what: "height field".into(),
                found: self.heights.len(),
                expected,
            });
        }
        for (index, height) in self.heights.iter().enumerate() {
            check_finite("height", index, *height)?;
        }
        for (index, spacing) in self.spacing.into_iter().enumerate() {
            check_finite("spacing", index, spacing)?;
            if spacing <= 0.0 {
                return Err(PlotError::OutOfRange {
                    what: "spacing".into(),
                    range: "above zero",
                    index,
                    value: spacing,
                });
            }
        }
        Ok(())
    }

    /// The field averaged over equal cells, top row first.
    fn block_means(&self, columns: usize, rows: usize) -> Vec<f64> {
        let [ny, nx] = self.shape;
        let (wx, wy) = (weights(nx, columns), weights(ny, rows));
        let mut means = Vec::with_capacity(columns * rows);
        for (first_y, weights_y) in wy.iter().rev() {
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

fn palette_indices(heights: &[f64], lo: f64, hi: f64) -> Vec<u8> {
    heights
        .iter()
        .map(|h| {
            // Halves first: the difference of two large heights may overflow.
            let t = (0.5 * h - 0.5 * lo) / (0.5 * hi - 0.5 * lo);
            (255.0 * t).round().clamp(0.0, 255.0) as u8
        })
        .collect()
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

fn palette() -> Vec<RGBColor> {
    (0..=255u8)
        .map(|i| ViridisRGB.get_color(f64::from(i) / 255.0))
        .collect()
}

/// Range of the colours; a flat field gets one around its height, of two shown units if that is zero.
fn colour_range(heights: &[f64], unit_size: f64) -> (f64, f64) {
    let min = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let max = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Differences below rounding would give ticks that all read the same.
    let scale = min.abs().max(max.abs());
    if 0.5 * max - 0.5 * min > 1e-9 * scale {
        (min, max)
    } else if scale == 0.0 {
        (-unit_size, unit_size)
    } else {
        (min - 0.1 * scale, max + 0.1 * scale)
    }
}

fn draw_colour_bar(
    scene: &mut Scene,
    bar: Rect,
    axis: Axis,
    vertical: &Display,
) -> Result<(), PlotError> {
    scene.pictures.push(Picture {
        frame: bar,
        columns: 1,
        pixels: (0..=255).rev().collect(),
        palette: palette(),
    });
    let pen = crate::elements::scene::Pen::solid(theme::INK, theme::FRAME_WIDTH);
    scene.rect_outline(bar, pen);
    let beside = TextLook::new(theme::TICK_SIZE, Align::Left, Level::Middle);
    let mut widest = 0.0_f64;
    for (value, text) in &axis.major {
        let Some(t) = axis.fraction(*value) else {
            continue;
        };
        let y = bar.bottom - t * bar.height();
        scene.line(&[(bar.right, y), (bar.right + theme::TICK_LENGTH, y)], pen);
        scene.text(text, (bar.right + theme::TICK_LENGTH + 4.0, y), beside);
        widest = widest.max(text_width(text, theme::TICK_SIZE)?);
    }
    let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Top);
    let x = bar.right + theme::TICK_LENGTH + 4.0 + widest + 12.0;
    scene.text_upwards(&vertical.label("height"), (x, bar.centre().1), look);
    Ok(())
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
        let min = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let max = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let scale = min.abs().max(max.abs());
        if scale == 0.0 {
            return Statistics { min, max, rms: 0.0 };
        }
        let n = heights.len() as f64;
        let mean = heights.iter().map(|h| h / scale).sum::<f64>() / n;
        let variance = heights
            .iter()
            .map(|h| (h / scale - mean).powi(2))
            .sum::<f64>()
            / n;
        Statistics {
            min,
            max,
            rms: scale * variance.sqrt(),
        }
    }
}

/// The unit in which lengths are shown.
#[derive(Debug, Clone)]
struct Display {
    /// Shown unit over given unit.
    unit_size: f64,
    /// "µm", "arb. units", or empty if there is none.
    symbol: String,
    /// Power of ten taken out of the numbers as well.
    exponent: i32,
}

impl Display {
    /// The unit in which `max_abs`, given in `unit`, reads best.
    fn choose(unit: &str, max_abs: f64) -> Self {
        let metres = match unit {
            "m" => Some(1.0),
            "cm" => Some(1e-2),
            "mm" => Some(1e-3),
            // Micro sign and Greek mu look alike and are both common.
            "um" | "\u{b5}m" | "\u{3bc}m" => Some(1e-6),
            "nm" => Some(1e-9),
            _ => None,
        };
        let (unit_size, symbol) = match metres {
            Some(metres) => {
                let size = max_abs * metres;
                let (shown, symbol) = [(1.0, "m"), (1e-3, "mm"), (1e-6, "µm")]
                    .into_iter()
                    // Rounding must not turn 1 mm into 1000 µm.
                    .find(|(shown, _)| size >= shown * (1.0 - 1e-9))
                    .unwrap_or((1e-9, "nm"));
                (shown / metres, symbol)
            }
            None if unit == "1" => (1.0, "arb. units"),
            None => (1.0, unit),
        };
        Display {
            unit_size,
            symbol: symbol.to_owned(),
            exponent: display_exponent(max_abs / unit_size),
        }
    }

    /// "x (µm)", "height (10⁻⁶ arb. units)".
    fn label(&self, quantity: &str) -> String {
        match (self.exponent, self.symbol.as_str()) {
            (0, "") => quantity.to_owned(),
            (0, symbol) => format!("{quantity} ({symbol})"),
            (e, symbol) => format!(
                "{quantity} ({})",
                format!("{} {symbol}", power_of_ten(e)).trim_end()
            ),
        }
    }

    /// Unit after a number.
    fn suffix(&self) -> String {
        match self.symbol.as_str() {
            "" => String::new(),
            symbol => format!(" {symbol}"),
        }
    }

    fn number(&self, value: f64) -> String {
        three_digits(value / self.unit_size)
    }

    /// The axis of a side of the map, with fewer ticks if it is short.
    fn side_axis(&self, name: &str, extent: f64, length: f64) -> Axis {
        let count = ((length / POINTS_PER_TICK) as usize).clamp(1, 6);
        self.axis(0.0, extent, count).with_label(&self.label(name))
    }

    /// An axis over lengths in the given unit: its values are in the shown unit without the power of ten.
    fn axis(&self, lo: f64, hi: f64, count: usize) -> Axis {
        let shown = |v: f64| scale_down(v / self.unit_size, self.exponent);
        Axis::linear(shown(lo), shown(hi), count, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_read_as_a_person_would_write_them() {
        for (unit, max, label) in [
            ("m", 2.4e-4, "x (µm)"),
            ("m", 1e-3, "x (mm)"),
            ("um", 240.0, "x (µm)"),
            ("um", 0.3, "x (nm)"),
            ("mm", 2500.0, "x (m)"),
            ("m", 2e-15, "x (10⁻⁶ nm)"),
            ("1", 12.8, "x (arb. units)"),
            ("1", 1e-9, "x (10⁻⁹ arb. units)"),
            ("tau", 3.0, "x (tau)"),
            ("", 3.0, "x"),
        ] {
            assert_eq!(Display::choose(unit, max).label("x"), label, "{unit} {max}");
        }
    }

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
            for share in total {
                assert!((share - 1.0 / n as f64).abs() < 1e-12, "{n}");
            }
        }
    }

    #[test]
    fn row_zero_is_at_the_bottom() {
        let figure = HeightMapFigure {
            title: String::new(),
            subtitle: String::new(),
            heights: &[0.0, 0.0, 1.0, 1.0],
            shape: [2, 2],
            spacing: [1.0, 1.0],
            unit: "1".into(),
        };
        let means = figure.block_means(2, 2);
        assert_eq!(palette_indices(&means, 0.0, 1.0), [255, 255, 0, 0]);
    }
}
