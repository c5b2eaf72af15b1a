//! Validity map: distance of models over roughness and angle, one panel per model and material.

use crate::elements::axis::Axis;
use crate::elements::colour_scale::{ColourScale, draw_bar, that_fits};
use crate::elements::geometry::Rect;
use crate::elements::legend::{Entry, Key};
use crate::elements::matrix::{ColumnName, draw_column_texts, draw_row_texts, stacked_at_bottom};
use crate::elements::numbers::{decimals, fixed, three_digits};
use crate::elements::page::Page;
use crate::elements::panel::X_AXIS_DEPTH;
use crate::elements::scene::{Align, Level, Pen, Scene, TextStyle};
use crate::elements::text::{text_width, widest, wrap};
use crate::elements::theme;
use crate::elements::verdict::{MapVerdict, draw_sign, draw_swatch, draw_tolerance_mark};
use crate::error::{Valid, check_length};
use crate::{Figure, PlotError};

/// One cell of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappedCell {
    /// Total variation distance, 0 or more: the colour, on a logarithmic scale.
    pub distance: f64,
    /// The sign in the cell.
    pub verdict: MapVerdict,
}

/// Total variation between models and explicit surfaces over roughness and angle, with a verdict per cell.
///
/// Panels stand side by side by model and below each other by material. Rows of a panel are values of the
/// roughness, the smoothest on top, columns are angles; both are spaced evenly, as they are listed. The colours
/// are *viridis* on a logarithmic scale of four decades at most, below which all cells have the same colour. Verdicts
/// differ by shape, so that they read in grey.
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
///     roughness_label: "smoothness s".into(),
///     roughness: vec![1.0, 3.0],
///     theta_deg: vec![0.0, 60.0],
///     tolerance: 0.01,
///     cells: vec![
///         cell(0.03, MapVerdict::Beyond),
///         cell(0.2, MapVerdict::Beyond),
///         cell(0.001, MapVerdict::Within),
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
    /// Label of the axis of roughness, as in "smoothness s".
    pub roughness_label: String,
    /// Values of the roughness, rough to smooth.
    pub roughness: Vec<f64>,
    /// Angles of incidence, degrees, ascending.
    pub theta_deg: Vec<f64>,
    /// The total variation that is tolerated, above 0: marked at the colour bar.
    pub tolerance: f64,
    /// The cells, by material, model, smoothness and angle, in that order of nesting; `None` for a cell
    /// without result.
    pub cells: Vec<Option<MappedCell>>,
}

/// Width that panels are made to fit into, as far as their cells stay large enough.
const WIDTH: f64 = 1000.0;
const CELL_WIDTH: (f64, f64) = (16.0, 56.0);
const CELL_HEIGHT: f64 = 23.0;
/// Panels are at least so high, with cells twice as high at most.
const PANEL_HEIGHT: f64 = 120.0;
const PANEL_GAP: f64 = 12.0;
/// Between rows of panels.
const ROW_GAP: f64 = 20.0;
/// Between neighbouring cells.
const CELL_GAP: f64 = 0.6;
const BAR_WIDTH: f64 = 18.0;
const BAR_GAP: f64 = 22.0;
/// Right of the panels.
const BAR_ROOM: f64 = 104.0;
const MIN_BAR_HEIGHT: f64 = 100.0;
const MOST_DECADES: i32 = 4;

/// Places of the panels; the label of the roughness is at `axis_label_x`.
struct Layout {
    left: f64,
    axis_label_x: f64,
    right: f64,
    width: f64,
    height: f64,
}

impl ValidityMap {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without panels or cells, [`PlotError::MismatchedLengths`] if cells are not
    /// as many as panels hold, [`PlotError::OutOfRange`] for numbers without
    /// meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let (rows_of, columns_of) = (numbers(&self.roughness), numbers(&self.theta_deg));
        let layout = self.layout(&rows_of)?;
        let Layout {
            left,
            axis_label_x,
            right,
            width,
            height,
        } = layout;
        let figure_width = (right + BAR_ROOM).max(0.6 * WIDTH);
        let mut page = Page::new(&self.title, &self.subtitle, figure_width)?;
        page.y += 10.0;
        let names = (0..self.models.len()).map(|model| {
            let lines = broken_at_hyphens(&self.models[model], width + PANEL_GAP - 4.0)?;
            let x = layout.panel_left(model) + 0.5 * width;
            Ok(ColumnName { x, lines })
        });
        let names = names.collect::<Result<Vec<_>, PlotError>>()?;
        page.y += stacked_at_bottom(&mut page.scene, page.y, &names, theme::LEGEND_SIZE) + 3.0;

        let (top, scale) = (page.y, self.scale());
        for (row, material) in self.materials.iter().enumerate() {
            let y = page.y;
            for model in 0..self.models.len() {
                let frame = Rect::at((layout.panel_left(model), y), width, height);
                self.draw_cells(&mut page.scene, frame, [row, model], &scale);
                if row + 1 == self.materials.len() {
                    draw_column_texts(&mut page.scene, frame, &columns_of)?;
                }
            }
            let first = Rect::at((left, y), width, height);
            draw_row_texts(&mut page.scene, first, &rows_of);
            let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Baseline);
            let middle = y + 0.5 * height;
            let axis = that_fits(
                &[&self.roughness_label, self.roughness_symbol()],
                height + ROW_GAP,
            )?;
            let scene = &mut page.scene;
            scene.text_upwards(axis, (axis_label_x, middle), style.muted());
            let material_x = axis_label_x - theme::LABEL_SIZE - 6.0;
            scene.text_upwards(material, (material_x, middle), style);
            page.y += height + ROW_GAP;
        }
        page.y -= ROW_GAP;
        let label_right = self.draw_angle_label(&mut page, &layout)?;
        let bar_height = (page.y - top).max(MIN_BAR_HEIGHT);
        let bar = Rect::at(
            (right.max(label_right) + BAR_GAP, top),
            BAR_WIDTH,
            bar_height,
        );
        self.draw_colour_bar(&mut page.scene, bar, &scale)?;
        page.y = (page.y + X_AXIS_DEPTH).max(bar.bottom) + 8.0;
        page.legend(self.entries())?;
        let bottom = page.y;
        Ok(page.finish(bottom))
    }

    fn check(&self) -> Result<(), PlotError> {
        let panels = self.models.len() * self.materials.len();
        let expected = panels * self.roughness.len() * self.theta_deg.len();
        if expected == 0 {
            let what = "a map without models, materials, roughness or angles";
            return Err(PlotError::nothing_to_draw(what));
        }
        check_length("validity map", self.cells.len(), expected)?;
        Valid::Finite.check_all("roughness", self.roughness.iter().copied())?;
        Valid::Finite.check_all("angle", self.theta_deg.iter().copied())?;
        Valid::Positive.check("tolerance", 0, self.tolerance)?;
        for (index, cell) in self.cells.iter().enumerate() {
            let distance = cell.map_or(0.0, |cell| cell.distance);
            Valid::NotNegative.check("distance", index, distance)?;
        }
        Ok(())
    }

    fn layout(&self, rows: &[String]) -> Result<Layout, PlotError> {
        let columns = self.theta_deg.len() as f64;
        let panels = self.models.len() as f64;
        let texts = widest(rows, theme::TICK_SIZE)?;
        let left = theme::MARGIN + 2.0 * (theme::LABEL_SIZE + 7.0) + texts + 6.0;
        let free = WIDTH - left - BAR_ROOM - (panels - 1.0) * PANEL_GAP;
        let cell_width = (free / (panels * columns)).floor();
        let width = columns * cell_width.clamp(CELL_WIDTH.0, CELL_WIDTH.1);
        let rows = self.roughness.len() as f64;
        let cell_height = (PANEL_HEIGHT / rows).clamp(CELL_HEIGHT, 2.0 * CELL_HEIGHT);
        // The name of a row stands beside it, upwards
        let names = widest(&self.materials, theme::LABEL_SIZE)?;
        Ok(Layout {
            left,
            axis_label_x: left - texts - 16.0,
            right: left + panels * (width + PANEL_GAP) - PANEL_GAP,
            width,
            height: (rows * cell_height).max(names),
        })
    }

    /// Range of the colours: whole decades that hold all distances and the tolerance, four at most.
    fn scale(&self) -> ColourScale {
        let distances = || self.cells.iter().flatten().map(|cell| cell.distance);
        let largest = distances().fold(self.tolerance, f64::max);
        let positive = distances().filter(|d| *d > 0.0);
        let least = positive.fold(self.tolerance, f64::min);
        ColourScale::decades(least, largest, MOST_DECADES)
    }

    fn draw_cells(
        &self,
        scene: &mut Scene,
        frame: Rect,
        [material, model]: [usize; 2],
        scale: &ColourScale,
    ) {
        let (rows, columns) = (self.roughness.len(), self.theta_deg.len());
        let (w, h) = (frame.width() / columns as f64, frame.height() / rows as f64);
        for row in 0..rows {
            for column in 0..columns {
                // The smoothest on top.
                let x = frame.left + (column as f64 + 0.5) * w;
                let y = frame.bottom - (row as f64 + 0.5) * h;
                let rect = Rect::around((x, y), 0.5 * w - CELL_GAP, 0.5 * h - CELL_GAP);
                if let Some(cell) = self.cell([material, model, row, column]) {
                    scene.rect(rect, scale.colour(cell.distance));
                    draw_sign(scene, rect.centre(), cell.verdict);
                } else {
                    let pen = Pen::solid(theme::FAINT, theme::GRID_WIDTH);
                    scene.line(&[(rect.left, rect.bottom), (rect.right, rect.top)], pen);
                }
                scene.tooltip(rect, &self.description([material, model, row, column]));
            }
        }
        scene.rect_outline(frame, Pen::solid(theme::INK, theme::FRAME_WIDTH));
    }

    fn cell(&self, [material, model, row, column]: [usize; 4]) -> Option<MappedCell> {
        let panel = material * self.models.len() + model;
        self.cells[(panel * self.roughness.len() + row) * self.theta_deg.len() + column]
    }

    /// A cell in words, as in "smith, n = 1.5, s = 3, 60°: total variation 0.0210, beyond tolerance".
    fn description(&self, at: [usize; 4]) -> String {
        let [material, model, row, column] = at;
        let found = match self.cell(at) {
            Some(MappedCell { distance, verdict }) => {
                let distance = three_digits(distance);
                format!("total variation {distance}, {}", verdict.words())
            }
            None => "not traced yet".to_owned(),
        };
        format!(
            "{}, {}, {} = {}, {}°: {found}",
            self.models[model],
            self.materials[material],
            self.roughness_symbol(),
            number(self.roughness[row]),
            number(self.theta_deg[column]),
        )
    }

    /// The last word of the label: what is left of it where there is little room.
    fn roughness_symbol(&self) -> &str {
        self.roughness_label.rsplit(' ').next().unwrap_or_default()
    }

    /// The label of the angles, below all panels and not beyond the margin; returns its right end.
    fn draw_angle_label(&self, page: &mut Page, layout: &Layout) -> Result<f64, PlotError> {
        let label = "angle of incidence θᵢ (°)";
        let half = 0.5 * text_width(label, theme::LABEL_SIZE)?;
        let x = (0.5 * (layout.left + layout.right)).max(theme::MARGIN + half);
        let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Top).muted();
        let below = page.y + theme::TICK_SIZE + 14.0;
        page.scene.text(label, (x, below), style);
        Ok(x + half)
    }

    /// The bar, with a mark at the tolerance.
    fn draw_colour_bar(
        &self,
        scene: &mut Scene,
        bar: Rect,
        scale: &ColourScale,
    ) -> Result<(), PlotError> {
        let axis = Axis::log10(scale.lo, scale.hi);
        draw_bar(scene, bar, scale.colours, &axis, &["total variation", "TV"])?;
        let y = bar.bottom - scale.fraction(self.tolerance) * bar.height();
        for (colour, width) in [(theme::WHITE, 3.4), (theme::INK, 1.6)] {
            let pen = Pen::solid(colour, width);
            scene.line(&[(bar.left, y), (bar.right, y)], pen);
        }
        draw_tolerance_mark(scene, (bar.left, y));
        Ok(())
    }

    /// Entries that explain the signs.
    fn entries(&self) -> Vec<Entry> {
        let tolerance = number(self.tolerance);
        let mut entries = vec![
            Entry::new(
                Key::Sign(|scene, at| draw_swatch(scene, at, MapVerdict::Within)),
                MapVerdict::Within.words(),
            ),
            Entry::new(
                Key::Sign(|scene, at| draw_swatch(scene, at, MapVerdict::Beyond)),
                MapVerdict::Beyond.words(),
            ),
            Entry::new(
                Key::Sign(|scene, at| draw_swatch(scene, at, MapVerdict::NotResolved)),
                MapVerdict::NotResolved.words(),
            ),
            Entry::new(
                Key::Sign(|scene, at| draw_tolerance_mark(scene, (at.0 + 4.0, at.1))),
                format!("tolerance of the total variation: {tolerance} of the incident flux"),
            ),
        ];
        if self.cells.iter().any(Option::is_none) {
            entries.push(Entry::note("hatched cells: not traced yet"));
        }
        entries
    }
}

impl Layout {
    fn panel_left(&self, model: usize) -> f64 {
        self.left + model as f64 * (self.width + PANEL_GAP)
    }
}

fn number(value: f64) -> String {
    fixed(value, decimals(value))
}

fn numbers(values: &[f64]) -> Vec<String> {
    values.iter().copied().map(number).collect()
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
            roughness_label: "smoothness s".into(),
            roughness: vec![0.5, 1.0],
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
            let found = map(distances.map(cell).to_vec()).scale();
            assert!((found.lo / lo).ln().abs() < 1e-9, "{distances:?} {found:?}");
            assert!((found.hi / hi).ln().abs() < 1e-9, "{distances:?} {found:?}");
        }
    }

    #[test]
    fn every_verdict_has_a_sign_of_its_own_and_cells_may_be_missing() {
        let mut cells = vec![cell(0.01); 12];
        cells[3] = None;
        let all_open = map(cells.clone()).draw().unwrap().svg().unwrap();
        // One in each cell, one in the legend.
        assert_eq!(all_open.matches(">?<").count(), 12);
        assert!(all_open.contains("not traced yet"));
        for verdict in [MapVerdict::Within, MapVerdict::Beyond] {
            let mut one = cells.clone();
            one[0] = Some(MappedCell {
                distance: 0.01,
                verdict,
            });
            let svg = map(one).draw().unwrap().svg().unwrap();
            assert_eq!(svg.matches(">?<").count(), 11);
        }
    }

    #[test]
    fn cells_have_tooltips_in_the_svg_alone() {
        let mut cells = vec![cell(0.021); 12];
        cells[11] = None;
        let figure = map(cells).draw().unwrap();
        let svg = figure.svg().unwrap();
        for tooltip in [
            "<title>xu-sun, n = 1.5, s = 0.5, 0°: total variation 0.0210, not resolved at this budget</title>",
            "<title>smith, n = 1.5, s = 1, 75°: not traced yet</title>",
        ] {
            assert_eq!(svg.matches(tooltip).count(), 1, "{tooltip}");
        }
        assert_eq!(svg.matches("<title>").count(), 13);
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
