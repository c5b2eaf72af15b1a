//! A panel: two axes around a rectangle.

use super::axis::Axis;
use super::curve::{Curve, Plane, draw_curves};
use super::geometry::{Rect, Xy};
use super::scene::{Align, Level, Pen, Scene, TextStyle};
use super::theme;
use crate::PlotError;

/// Two axes around a rectangle.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) frame: Rect,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Room for the tick texts between the y axis and its label.
    y_texts: f64,
}

/// Distance from the bottom of a panel to the top of the label of its x axis.
const X_LABEL_DEPTH: f64 = theme::TICK_LENGTH + 5.0 + theme::TICK_SIZE + 8.0;

/// Room below a panel for ticks and label.
pub(crate) const X_AXIS_DEPTH: f64 = X_LABEL_DEPTH + theme::LABEL_SIZE + 2.0;

/// Room left of a panel for label, tick texts and ticks of the y axis.
pub(crate) fn y_axis_room(y: &Axis) -> Result<f64, PlotError> {
    Ok(theme::LABEL_SIZE + 10.0 + y.text_width()? + 4.0 + theme::TICK_LENGTH)
}

impl Plane for Panel {
    fn at(&self, x: f64, y: f64) -> Option<Xy> {
        Some((self.x_of(x)?, self.y_of(y)?))
    }

    fn floor(&self) -> f64 {
        self.y.lo
    }

    fn clip(&self, a: Xy, b: Xy) -> Option<(Xy, Xy)> {
        self.frame.clip(a, b)
    }

    fn clip_path(&self, path: &[Xy]) -> Vec<Vec<Xy>> {
        self.frame.clip_path(path)
    }

    fn contains(&self, at: Xy) -> bool {
        self.frame.contains(at)
    }
}

impl Panel {
    pub(crate) fn new(frame: Rect, x: Axis, y: Axis) -> Result<Self, PlotError> {
        let y_texts = y.text_width()?;
        Ok(Panel {
            frame,
            x,
            y,
            y_texts,
        })
    }

    /// Puts the y labels of two panels, one above the other, on one line.
    pub(crate) fn align_labels(a: &mut Panel, b: &mut Panel) {
        let widest = a.y_texts.max(b.y_texts);
        (a.y_texts, b.y_texts) = (widest, widest);
    }

    /// Grid, curves and frame.
    pub(crate) fn draw<'a>(
        &self,
        scene: &mut Scene,
        curves: impl IntoIterator<Item = &'a Curve> + Clone,
    ) {
        self.draw_grid(scene);
        draw_curves(scene, self, curves);
        self.draw_frame(scene);
    }

    fn x_of(&self, value: f64) -> Option<f64> {
        let t = self.x.fraction(value)?;
        Some(self.frame.left + t * self.frame.width())
    }

    fn y_of(&self, value: f64) -> Option<f64> {
        let t = self.y.fraction(value)?;
        Some(self.frame.bottom - t * self.frame.height())
    }

    /// Grid lines, beneath the data.
    fn draw_grid(&self, scene: &mut Scene) {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        let pen = Pen::solid(theme::GRID, theme::GRID_WIDTH);
        for x in self.x.major.iter().filter_map(|tick| self.x_of(tick.0)) {
            scene.line(&[(x, top), (x, bottom)], pen);
        }
        for y in self.y.major.iter().filter_map(|tick| self.y_of(tick.0)) {
            scene.line(&[(left, y), (right, y)], pen);
        }
    }

    /// Frame, ticks and texts, above the data.
    pub(crate) fn draw_frame(&self, scene: &mut Scene) {
        let Rect { left, bottom, .. } = self.frame;
        let (middle_x, middle_y) = self.frame.centre();
        let pen = Pen::solid(theme::INK, theme::FRAME_WIDTH);
        scene.rect_outline(self.frame, pen);

        // Ticks point outwards, so that no point hides them.
        const MINOR: f64 = 0.6 * theme::TICK_LENGTH;
        for x in self.x.minor.iter().filter_map(|v| self.x_of(*v)) {
            scene.line(&[(x, bottom), (x, bottom + MINOR)], pen);
        }
        for y in self.y.minor.iter().filter_map(|v| self.y_of(*v)) {
            scene.line(&[(left - MINOR, y), (left, y)], pen);
        }
        let below = TextStyle::new(theme::TICK_SIZE, Align::Centre, Level::Top);
        for (value, text) in &self.x.major {
            if let Some(x) = self.x_of(*value) {
                scene.line(&[(x, bottom), (x, bottom + theme::TICK_LENGTH)], pen);
                scene.text(text, (x, bottom + theme::TICK_LENGTH + 5.0), below);
            }
        }
        let left_of_axis = TextStyle::new(theme::TICK_SIZE, Align::Right, Level::Middle);
        for (value, text) in &self.y.major {
            if let Some(y) = self.y_of(*value) {
                scene.line(&[(left - theme::TICK_LENGTH, y), (left, y)], pen);
                scene.text(text, (left - theme::TICK_LENGTH - 4.0, y), left_of_axis);
            }
        }

        let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Top);
        scene.text(&self.x.label, (middle_x, bottom + X_LABEL_DEPTH), style);
        let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Baseline);
        let x = left - theme::TICK_LENGTH - 4.0 - self.y_texts - 10.0;
        scene.text_upwards(&self.y.label, (x, middle_y), style);
    }
}
