//! Diagrams: lines, arrows and labels, drawn to scale and without axes.

use crate::elements::geometry::Xy;
use crate::elements::page::Page;
use crate::elements::scene::{ARROW_HEAD, Align, Level, Pen, Scene, TextStyle};
use crate::elements::theme;
use crate::error::Valid;
use crate::{Colour, Figure, PlotError};

/// Stroke of a path of a diagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    Line,
    /// A line whose last point is the tip of an arrow; one that is shorter than the head is a line.
    Arrow,
    /// A thin dashed line in grey, whatever the colour.
    Guide,
}

/// A path through points of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramPath {
    /// Its stroke.
    pub stroke: Stroke,
    /// Its colour.
    pub colour: Colour,
    /// Its points, x to the right and y up; two at least.
    pub points: Vec<[f64; 2]>,
}

/// Words in a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramLabel {
    /// One line.
    pub text: String,
    /// Its colour.
    pub colour: Colour,
    /// The point on which it is centred.
    pub at: [f64; 2],
}

/// One drawing of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagramPanel {
    /// Words above it.
    pub caption: String,
    /// Its paths, later ones above earlier ones.
    pub paths: Vec<DiagramPath>,
    /// Its labels, above all paths.
    pub labels: Vec<DiagramLabel>,
}

/// Panels of lines, arrows and labels, side by side. Each shows the square from -1 to 1 in x and y.
///
/// ```
/// use asperity_plot::{Colour, Diagram, DiagramLabel, DiagramPanel, DiagramPath, Stroke};
///
/// let colour = Colour::Nth(0);
/// let points = vec![[-0.5, 0.5], [0.0, 0.0]];
/// let figure = Diagram {
///     title: "A ray".into(),
///     subtitle: String::new(),
///     panels: vec![DiagramPanel {
///         caption: "seen from the side".into(),
///         paths: vec![DiagramPath { stroke: Stroke::Arrow, colour, points }],
///         labels: vec![DiagramLabel { text: "k".into(), colour, at: [-0.2, 0.35] }],
///     }],
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("seen from the side"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Diagram {
    /// First line of the figure.
    pub title: String,
    /// Second line. May be empty.
    pub subtitle: String,
    /// The panels, left to right.
    pub panels: Vec<DiagramPanel>,
}

/// Side of a panel, points.
const SIDE: f64 = 330.0;
const GAP: f64 = 30.0;
const CAPTION_DEPTH: f64 = theme::LABEL_SIZE + 12.0;

impl Diagram {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without panels or with a path of fewer than two points, [`PlotError::OutOfRange`] for
    /// coordinates without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        if self.panels.is_empty() {
            return Err(PlotError::nothing_to_draw("no panel"));
        }
        let columns = self.panels.len() as f64;
        let width = columns * SIDE + (columns - 1.0) * GAP + 2.0 * theme::MARGIN;
        let mut page = Page::new(&self.title, &self.subtitle, width)?;
        let top = page.y + 10.0;
        for (column, panel) in self.panels.iter().enumerate() {
            let left = theme::MARGIN + column as f64 * (SIDE + GAP);
            panel.draw(&mut page.scene, (left, top))?;
        }
        Ok(page.finish(top + CAPTION_DEPTH + SIDE))
    }
}

impl DiagramPanel {
    fn draw(&self, scene: &mut Scene, (left, top): Xy) -> Result<(), PlotError> {
        let style = |size| TextStyle::new(size, Align::Centre, Level::Middle);
        let middle = left + 0.5 * SIDE;
        let caption = (middle, top + 0.5 * theme::LABEL_SIZE);
        scene.text(&self.caption, caption, style(theme::LABEL_SIZE).muted());
        let at = |[x, y]: [f64; 2]| {
            let half = 0.5 * SIDE;
            (middle + half * x, top + CAPTION_DEPTH + half * (1.0 - y))
        };
        for path in &self.paths {
            Valid::Finite.check_all("points of a path", path.points.iter().copied().flatten())?;
            let points: Vec<Xy> = path.points.iter().copied().map(at).collect();
            let [_, .., tip] = points[..] else {
                return Err(PlotError::nothing_to_draw(
                    "a path of fewer than two points",
                ));
            };
            let pen = match path.stroke {
                Stroke::Line | Stroke::Arrow => Pen::solid(path.colour.rgb(), theme::CURVE_WIDTH),
                Stroke::Guide => Pen::guide(),
            };
            // The head of an arrow begins at the last point that is far enough from the tip.
            let is_before_head = |p: &Xy| (p.0 - tip.0).hypot(p.1 - tip.1) >= ARROW_HEAD;
            match points.iter().rposition(is_before_head) {
                Some(last) if path.stroke == Stroke::Arrow => {
                    scene.line(&points[..=last], pen);
                    scene.arrow(points[last], tip, pen);
                }
                _ => scene.line(&points, pen),
            }
        }
        for label in &self.labels {
            Valid::Finite.check_all("place of a label", label.at)?;
            let style = TextStyle {
                colour: label.colour.rgb(),
                ..style(theme::LABEL_SIZE)
            };
            scene.text(&label.text, at(label.at), style);
        }
        Ok(())
    }
}
