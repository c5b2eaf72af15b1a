//! Names of the rows and columns of a matrix.

use super::geometry::Rect;
use super::scene::{Align, Level, Scene, TextStyle};
use super::text::text_width;
use super::theme;
use crate::PlotError;

/// A text in lines, centred about `x`.
pub(crate) struct ColumnName {
    pub(crate) x: f64,
    pub(crate) lines: Vec<String>,
}

/// Draws names so that all last lines are at one height; returns their depth.
pub(crate) fn stacked_at_bottom(
    scene: &mut Scene,
    top: f64,
    names: &[ColumnName],
    size: f64,
) -> f64 {
    let style = TextStyle::new(size, Align::Centre, Level::Top);
    let line = 1.35 * size;
    let most = names.iter().map(|name| name.lines.len()).max().unwrap_or(1);
    for ColumnName { x, lines } in names {
        for (k, text) in lines.iter().enumerate() {
            let above = (most - lines.len() + k) as f64;
            scene.text(text, (*x, top + above * line), style);
        }
    }
    most as f64 * line
}

/// Texts below columns, as many as have room.
pub(crate) fn draw_column_texts(
    scene: &mut Scene,
    frame: Rect,
    texts: &[String],
) -> Result<(), PlotError> {
    let style = TextStyle::new(theme::TICK_SIZE, Align::Centre, Level::Top);
    let w = frame.width() / texts.len() as f64;
    let mut free_from = f64::NEG_INFINITY;
    for (i, text) in texts.iter().enumerate() {
        let x = frame.left + (i as f64 + 0.5) * w;
        let half = 0.5 * text_width(text, theme::TICK_SIZE)?;
        if x - half >= free_from {
            scene.text(text, (x, frame.bottom + 6.0), style);
            free_from = x + half + 3.0;
        }
    }
    Ok(())
}

/// Texts to the left of rows, the smoothest on top.
pub(crate) fn draw_row_texts(scene: &mut Scene, frame: Rect, texts: &[String]) {
    let style = TextStyle::new(theme::TICK_SIZE, Align::Right, Level::Middle);
    let h = frame.height() / texts.len() as f64;
    for (i, text) in texts.iter().enumerate() {
        let y = frame.bottom - (i as f64 + 0.5) * h;
        scene.text(text, (frame.left - 6.0, y), style);
    }
}
