//! Where models hold: distance over smoothness and angle, a panel a model and material.

use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

use crate::elements::axis::{Axis, X_AXIS_DEPTH, decimals};
use crate::elements::scene::{Align, Level, Pen, Picture, Rect, Scene, TextLook, Xy};
use crate::elements::series::check_finite;
use crate::elements::text::{fixed, header, text_width, wrap};
use crate::elements::theme;
use crate::{Figure, PlotError};

/// What is said of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapVerdict {
    /// A white disc.
    Holds,
    /// A cross.
    Fails,
    /// A question mark.
    NotResolved,
}

/// One cell of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappedCell {
    /// Total variation distance, 0 or more: the colour, on a logarithmic scale.
    pub distance: f64,
    /// The sign in the cell.
    pub verdict: MapVerdict,
}

/// Total variation between models and explicit surfaces over smoothness and angle, with a verdict in each
/// cell.
///
/// Panels stand side by side by model and below each other by material. Rows of a panel are smoothness
/// values, the smoothest on top, columns are angles; both are spaced evenly, as they are listed. The colours
/// are *viridis* on a logarithmic scale of four decades at most, below which all cells look alike. Verdicts
/// are told by shape, so that they read in grey.
///
/// ```
/// use asperity_plot::{MapVerdict, MappedCell, ValidityMap};
///
/// let cell = |distance, verdict| Some(MappedCell { distance, verdict });
/// let figure = ValidityMap {
///     title: "Where it holds".into(),
///     subtitle: "glass".into(),
///     models: vec!["smith".into()],
///     materials: vec!["n = 1.5".into()],
///     smoothness: vec![1.0, 3.0],
///     theta_deg: vec![0.0, 60.0],
///     tolerance: 0.01,
///     cells: vec![
///         cell(0.03, MapVerdict::Fails),
///         cell(0.2, MapVerdict::Fails),
///         cell(0.001, MapVerdict::Holds),
///         None,
///     ],
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("angle of incidence"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ValidityMap {
    /// First line of the figure.
    pub title: String,
    /// Second line: what is compared, and by which test. May be empty.
    pub subtitle: String,
    /// Names of the columns of panels.
    pub models: Vec<String>,
    /// Names of the rows of panels.
    pub materials: Vec<String>,
    /// Smoothness values, rough to smooth.
    pub smoothness: Vec<f64>,
    /// Angles of incidence, degrees, ascending.
    pub theta_deg: Vec<f64>,
    /// The total variation that is tolerated, above 0: marked at the colour bar.
    pub tolerance: f64,
    /// The cells, by material, model, smoothness and angle, in that order of nesting; `None` where nothing
    /// was found yet.
    pub cells: Vec<Option<MappedCell>>,
}

/// Width that panels are made to fit into, as far as their cells stay large enough.
const WIDTH: f64 = 1000.0;
const CELL_WIDTH: (f64, f64) = (16.0, 40.0);
const CELL_HEIGHT: f64 = 23.0;
const PANEL_GAP: f64 = 12.0;
/// Between rows of panels.
const ROW_GAP: f64 = 20.0;
/// Between neighbouring cells.
const CELL_GAP: f64 = 0.6;
const BAR_WIDTH: f64 = 18.0;
const BAR_GAP: f64 = 22.0;
/// Right of the panels.
const BAR_ROOM: f64 = 104.0;
const MOST_DECADES: i32 = 4;
const SIGN: f64 = 4.4;

impl ValidityMap {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without panels or cells, [`PlotError::MismatchedLengths`] if cells are not
    /// as many as panels hold, [`PlotError::NonFinite`] and [`PlotError::OutOfRange`] for numbers without
    /// meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let columns = self.theta_deg.len() as f64;
        let panels = self.models.len() as f64;
        let numbers = |values: &[f64]| -> Vec<String> {
            values.iter().map(|v| fixed(*v, decimals(*v))).collect()
        };
        let (rows_of, columns_of) = (numbers(&self.smoothness), numbers(&self.theta_deg));
        let mut widest = 0.0_f64;
        for text in &rows_of {
            widest = widest.max(text_width(text, theme::TICK_SIZE)?);
        }
        let left = theme::MARGIN + 2.0 * (theme::LABEL_SIZE + 7.0) + widest + 6.0;
        let free = WIDTH - left - BAR_ROOM - (panels - 1.0) * PANEL_GAP;
        let cell_width = (free / (panels * columns))
            .floor()
            .clamp(CELL_WIDTH.0, CELL_WIDTH.1);
        let (width, height) = (
            columns * cell_width,
            self.smoothness.len() as f64 * CELL_HEIGHT,
        );
        let right = left + panels * (width + PANEL_GAP) - PANEL_GAP;
        let figure_width = (right + BAR_ROOM).max(0.6 * WIDTH).round();

        let mut scene = Scene::new(&self.title);
        let mut y = header(&mut scene, &self.subtitle, figure_width)? + 10.0;
        // Names of models, the shorter ones at the bottom of their line.
        let look = TextLook::new(theme::LEGEND_SIZE, Align::Centre, Level::Top);
        let line = 1.3 * theme::LEGEND_SIZE;
        let names = self
            .models
            .iter()
            .map(|name| broken_at_hyphens(name, width + PANEL_GAP - 4.0))
            .collect::<Result<Vec<_>, _>>()?;
        let most = names.iter().map(Vec::len).max().unwrap_or(1);
        for (i, lines) in names.iter().enumerate() {
            let x = left + i as f64 * (width + PANEL_GAP) + 0.5 * width;
            for (k, text) in lines.iter().enumerate() {
                let above = (most - lines.len() + k) as f64;
                scene.text(text, (x, y + above * line), look);
            }
        }
        y += most as f64 * line + 3.0;

        let top = y;
        let (lo, hi) = self.decades();
        for (row, material) in self.materials.iter().enumerate() {
            for column in 0..self.models.len() {
                let x = left + column as f64 * (width + PANEL_GAP);
                let frame = Rect {
                    left: x,
                    top: y,
                    right: x + width,
                    bottom: y + height,
                };
                self.draw_cells(&mut scene, frame, (row, column), (lo, hi));
                let last = row + 1 == self.materials.len();
                draw_ticks(
                    &mut scene,
                    frame,
                    if last { &columns_of } else { &[] },
                    if column == 0 { &rows_of } else { &[] },
                )?;
            }
            let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Baseline);
            let middle = y + 0.5 * height;
            let beside = left - widest - 16.0;
            let axis = that_fits(["smoothness s", "s"], height + ROW_GAP)?;
            scene.text_upwards(axis, (beside, middle), look.muted());
            scene.text_upwards(material, (beside - theme::LABEL_SIZE - 6.0, middle), look);
            y += height + ROW_GAP;
        }
        y -= ROW_GAP;
        let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Top).muted();
        let below = y + theme::TICK_SIZE + 14.0;
        scene.text(
            "angle of incidence θᵢ (°)",
            (0.5 * (left + right), below),
            look,
        );
        let bar = Rect {
            left: right + BAR_GAP,
            top,
            right: right + BAR_GAP + BAR_WIDTH,
            bottom: y,
        };
        self.draw_colour_bar(&mut scene, bar, (lo, hi))?;
        y = self.draw_legend(&mut scene, y + X_AXIS_DEPTH + 8.0, figure_width)?;
        scene.width = figure_width as u32;
        scene.height = (y + theme::MARGIN).round() as u32;
        Ok(Figure::new(scene))
    }

    fn check(&self) -> Result<(), PlotError> {
        let panels = self.models.len() * self.materials.len();
        let expected = panels * self.smoothness.len() * self.theta_deg.len();
        if expected == 0 {
            return Err(PlotError::NothingToDraw {
                what: "a map without models, materials, smoothness or angles".into(),
            });
        }
        if self.cells.len() != expected {
            return Err(PlotError::MismatchedLengths {
                what: "validity map".into(),
                found: self.cells.len(),
                expected,
            });
        }
        for (what, values) in [("smoothness", &self.smoothness), ("angle", &self.theta_deg)] {
            for (index, value) in values.iter().enumerate() {
                check_finite(what, index, *value)?;
            }
        }
        check_finite("tolerance", 0, self.tolerance)?;
        let out_of_range = |what: &str, range, index, value| PlotError::OutOfRange {
            what: what.into(),
            range,
            index,
            value,
        };
        if self.tolerance <= 0.0 {
            return Err(out_of_range("tolerance", "above zero", 0, self.tolerance));
        }
        for (index, cell) in self.cells.iter().enumerate() {
            let Some(cell) = cell else { continue };
            check_finite("distance", index, cell.distance)?;
            if cell.distance < 0.0 {
                return Err(out_of_range(
                    "distance",
                    "zero or more",
                    index,
                    cell.distance,
                ));
            }
        }
        Ok(())
    }

    /// Range of the colours: whole decades that hold all distances and the tolerance, four at most.
    fn decades(&self) -> (f64, f64) {
        let distances = || self.cells.iter().flatten().map(|cell| cell.distance);
        let largest = distances().fold(self.tolerance, f64::max);
        let least = distances()
            .filter(|d| *d > 0.0)
            .fold(self.tolerance, f64::min);
        let last = (largest.log10() - 1e-9).ceil() as i32;
        let first = ((least.log10() + 1e-9).floor() as i32).clamp(last - MOST_DECADES, last - 1);
        (10.0_f64.powi(first), 10.0_f64.powi(last))
    }

    fn draw_cells(
        &self,
        scene: &mut Scene,
        frame: Rect,
        (material, model): (usize, usize),
        (lo, hi): (f64, f64),
    ) {
        let (rows, columns) = (self.smoothness.len(), self.theta_deg.len());
        let panel = material * self.models.len() + model;
        let (w, h) = (frame.width() / columns as f64, frame.height() / rows as f64);
        let mut missing = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                // The smoothest on top.
                let x = frame.left + column as f64 * w;
                let y = frame.bottom - (row + 1) as f64 * h;
                let rect = Rect {
                    left: x + CELL_GAP,
                    top: y + CELL_GAP,
                    right: x + w - CELL_GAP,
                    bottom: y + h - CELL_GAP,
                };
                let Some(cell) = self.cells[(panel * rows + row) * columns + column] else {
                    missing.push(rect);
                    continue;
                };
                let t = (cell.distance.max(lo) / lo).log10() / (hi / lo).log10();
                scene.polygon(rect.corners().to_vec(), colour(t));
                sign(scene, rect.centre(), cell.verdict);
            }
        }
        for rect in missing {
            let pen = Pen::solid(theme::FAINT, theme::GRID_WIDTH);
            scene.line(&[(rect.left, rect.bottom), (rect.right, rect.top)], pen);
        }
        scene.rect_outline(frame, Pen::solid(theme::INK, theme::FRAME_WIDTH));
    }

    fn draw_colour_bar(
        &self,
        scene: &mut Scene,
        bar: Rect,
        (lo, hi): (f64, f64),
    ) -> Result<(), PlotError> {
        scene.pictures.push(Picture {
            frame: bar,
            columns: 1,
            pixels: (0..=255).rev().collect(),
            palette: (0..=255).map(|i| colour(f64::from(i) / 255.0)).collect(),
        });
        let pen = Pen::solid(theme::INK, theme::FRAME_WIDTH);
        scene.rect_outline(bar, pen);
        let axis = Axis::log10(lo, hi);
        let beside = TextLook::new(theme::TICK_SIZE, Align::Left, Level::Middle);
        for (value, text) in &axis.major {
            let Some(t) = axis.fraction(*value) else {
                continue;
            };
            let y = bar.bottom - t * bar.height();
            scene.line(&[(bar.right, y), (bar.right + theme::TICK_LENGTH, y)], pen);
            scene.text(text, (bar.right + theme::TICK_LENGTH + 4.0, y), beside);
        }
        if let Some(t) = axis.fraction(self.tolerance) {
            let y = bar.bottom - t * bar.height();
            let (out, half) = (7.0, 4.5);
            let halo = Pen::solid(theme::WHITE, 3.4);
            scene.line(&[(bar.left, y), (bar.right, y)], halo);
            scene.line(
                &[(bar.left, y), (bar.right, y)],
                Pen::solid(theme::INK, 1.6),
            );
            let arrow = vec![
                (bar.left, y),
                (bar.left - out, y - half),
                (bar.left - out, y + half),
            ];
            scene.polygon(arrow, theme::INK);
        }
        let x = bar.right + theme::TICK_LENGTH + 4.0 + axis.text_width()? + 9.0;
        let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Top);
        let title = that_fits(["total variation", "TV"], bar.height())?;
        scene.text_upwards(title, (x, bar.centre().1), look);
        Ok(())
    }

    /// What signs mean; returns the y below.
    fn draw_legend(&self, scene: &mut Scene, top: f64, width: f64) -> Result<f64, PlotError> {
        let tolerance = fixed(self.tolerance, decimals(self.tolerance));
        let mut entries = vec![
            (Some(MapVerdict::Holds), "holds".to_owned()),
            (Some(MapVerdict::Fails), "fails".to_owned()),
            (
                Some(MapVerdict::NotResolved),
                "not resolved at this budget".to_owned(),
            ),
            (
                None,
                format!("tolerance of the total variation: {tolerance} of the incident flux"),
            ),
        ];
        if self.cells.iter().any(Option::is_none) {
            entries.push((None, "hatched cells: not traced yet".to_owned()));
        }
        let look = TextLook::new(theme::LEGEND_SIZE, Align::Left, Level::Middle);
        let (mut x, mut y) = (theme::MARGIN, top + 0.5 * theme::LEGEND_SIZE);
        for (verdict, text) in entries {
            let needed = 22.0 + text_width(&text, theme::LEGEND_SIZE)?;
            if x > theme::MARGIN && x + needed > width - theme::MARGIN {
                x = theme::MARGIN;
                y += 1.7 * theme::LEGEND_SIZE;
            }
            let key = (x + 8.0, y);
            match verdict {
                Some(verdict) => {
                    let (w, h) = (9.0, 9.0);
                    let swatch = Rect {
                        left: key.0 - w,
                        top: key.1 - h,
                        right: key.0 + w,
                        bottom: key.1 + h,
                    };
                    scene.polygon(swatch.corners().to_vec(), colour(0.45));
                    sign(scene, key, verdict);
                }
                None if text.starts_with("tolerance") => {
                    let arrow = vec![
                        (key.0 + 4.0, key.1),
                        (key.0 - 4.0, key.1 - 5.0),
                        (key.0 - 4.0, key.1 + 5.0),
                    ];
                    scene.polygon(arrow, theme::INK);
                }
                None => {}
            }
            scene.text(&text, (x + 22.0, y), look);
            x += needed + 24.0;
        }
        Ok(y + 0.5 * theme::LEGEND_SIZE)
    }
}

fn colour(t: f64) -> RGBColor {
    ViridisRGB.get_color(t.clamp(0.0, 1.0))
}

/// The sign of a verdict, with an edge that keeps it apart from any colour beneath.
fn sign(scene: &mut Scene, (x, y): Xy, verdict: MapVerdict) {
    match verdict {
        MapVerdict::Holds => {
            disc(scene, (x, y), SIGN + 1.0, theme::INK);
            disc(scene, (x, y), SIGN, theme::WHITE);
        }
        MapVerdict::Fails => {
            for (pen, r) in [
                (Pen::solid(theme::WHITE, 4.2), SIGN + 0.9),
                (Pen::solid(theme::INK, 2.0), SIGN),
            ] {
                scene.line(&[(x - r, y - r), (x + r, y + r)], pen);
                scene.line(&[(x - r, y + r), (x + r, y - r)], pen);
            }
        }
        MapVerdict::NotResolved => {
            disc(scene, (x, y), SIGN + 3.2, theme::WHITE);
            let look = TextLook::new(theme::TICK_SIZE, Align::Centre, Level::Middle);
            scene.text("?", (x, y), look);
        }
    }
}

fn disc(scene: &mut Scene, centre: Xy, radius: f64, colour: RGBColor) {
    scene.items.push(crate::elements::scene::Item::Disc {
        centre,
        radius,
        colour,
    });
}

/// Texts below columns, as many as have room, and beside rows, the smoothest on top.
fn draw_ticks(
    scene: &mut Scene,
    frame: Rect,
    columns: &[String],
    rows: &[String],
) -> Result<(), PlotError> {
    let below = TextLook::new(theme::TICK_SIZE, Align::Centre, Level::Top);
    let w = frame.width() / columns.len().max(1) as f64;
    let mut free_from = f64::NEG_INFINITY;
    for (i, text) in columns.iter().enumerate() {
        let x = frame.left + (i as f64 + 0.5) * w;
        let half = 0.5 * text_width(text, theme::TICK_SIZE)?;
        if x - half >= free_from {
            scene.text(text, (x, frame.bottom + 6.0), below);
            free_from = x + half + 3.0;
        }
    }
    let beside = TextLook::new(theme::TICK_SIZE, Align::Right, Level::Middle);
    let h = frame.height() / rows.len().max(1) as f64;
    for (i, text) in rows.iter().enumerate() {
        let y = frame.bottom - (i as f64 + 0.5) * h;
        scene.text(text, (frame.left - 6.0, y), beside);
    }
    Ok(())
}

/// The first of the titles that fits into a length, or the last one.
fn that_fits<const N: usize>(
    titles: [&'static str; N],
    length: f64,
) -> Result<&'static str, PlotError> {
    for title in titles {
        if text_width(title, theme::LABEL_SIZE)? <= length {
            return Ok(title);
        }
    }
    Ok(titles[N - 1])
}

/// A name in lines of at most `width`, broken after hyphens.
fn broken_at_hyphens(name: &str, width: f64) -> Result<Vec<String>, PlotError> {
    let parts = name.replace('-', "-\u{1}").replace('\u{1}', " ");
    let lines = wrap(&parts, theme::LEGEND_SIZE, width)?;
    Ok(lines.iter().map(|line| line.replace("- ", "-")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(cells: Vec<Option<MappedCell>>) -> ValidityMap {
        ValidityMap {
            title: "t".into(),
            subtitle: String::new(),
            models: vec!["xu-sun".into(), "smith".into()],
            materials: vec!["n = 1.5".into()],
            smoothness: vec![0.5, 1.0],
            theta_deg: vec![0.0, 30.0, 75.0],
            tolerance: 0.01,
            cells,
        }
    }

    fn cell(distance: f64) -> Option<MappedCell> {
        Some(MappedCell {
            distance,
            verdict: MapVerdict::NotResolved,
        })
    }

    #[test]
    fn colours_span_whole_decades_and_the_tolerance() {
        for (distances, lo, hi) in [
            ([0.02, 0.3], 1e-2, 1.0),
            ([0.0, 0.5], 1e-2, 1.0),
            ([1e-3, 1e-3], 1e-3, 1e-2),
            ([1e-9, 0.1], 1e-5, 1e-1),
            ([0.01, 0.01], 1e-3, 1e-2),
        ] {
            let found = map(distances.map(cell).to_vec()).decades();
            assert!((found.0 / lo).ln().abs() < 1e-9, "{distances:?} {found:?}");
            assert!((found.1 / hi).ln().abs() < 1e-9, "{distances:?} {found:?}");
        }
    }

    #[test]
    fn every_verdict_has_a_sign_of_its_own_and_cells_may_be_missing() {
        let mut cells = vec![cell(0.01); 12];
        cells[3] = None;
        let all_open = map(cells.clone()).draw().unwrap().svg().unwrap();
        // One in each cell, one in the legend.
        assert_eq!(all_open.matches("?\n").count(), 12);
        assert!(all_open.contains("not traced yet"));
        for verdict in [MapVerdict::Holds, MapVerdict::Fails] {
            let mut one = cells.clone();
            one[0] = Some(MappedCell {
                distance: 0.01,
                verdict,
            });
            let svg = map(one).draw().unwrap().svg().unwrap();
            assert_eq!(svg.matches("?\n").count(), 11);
        }
    }

    #[test]
    fn numbers_without_meaning_are_refused() {
        for (cells, what) in [
            (vec![cell(0.1); 11], "expected 12"),
            (vec![cell(-0.1); 12], "zero or more"),
            (vec![cell(f64::NAN); 12], "finite"),
        ] {
            let error = map(cells).draw().unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
        let mut no_tolerance = map(vec![None; 12]);
        no_tolerance.tolerance = 0.0;
        assert!(no_tolerance.draw().is_err());
        let mut empty = map(Vec::new());
        empty.models.clear();
        assert!(empty.draw().is_err());
    }

    #[test]
    fn long_names_are_broken_at_hyphens() {
        let lines = broken_at_hyphens("cook-torrance-neumann-smith", 120.0).unwrap();
        assert_eq!(lines, ["cook-torrance-", "neumann-smith"]);
        assert_eq!(broken_at_hyphens("smith", 5.0).unwrap(), ["smith"]);
    }
}
