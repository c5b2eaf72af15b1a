//! Legend: names of curves and signs, next to the data and never over them.

use super::geometry::{Rect, Xy};
use super::rgb::Rgb;
use super::scene::{Align, Level, Marker, Pen, Scene, TextStyle};
use super::text::{text_width, wrap};
use super::theme;
use crate::PlotError;

/// Symbol left of a text in the legend.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Key {
    /// A point, with its error bar if it has one.
    Point {
        marker: Marker,
        colour: Rgb,
        bar: bool,
    },
    /// A hollow point.
    Hollow { marker: Marker, colour: Rgb },
    /// A point on its line.
    Joined { marker: Marker, pen: Pen },
    /// A line.
    Line(Pen),
    /// A line that ends in an arrow head.
    Arrow(Pen),
    /// Whatever the function draws about a place.
    Sign(fn(&mut Scene, Xy)),
    /// A filled rectangle.
    Swatch(Rgb),
    /// Nothing: a remark in smaller type.
    Note,
}

/// One entry of a legend.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: Key,
    pub(crate) text: String,
}

impl Entry {
    pub(crate) fn new(key: Key, text: impl Into<String>) -> Self {
        Entry {
            key,
            text: text.into(),
        }
    }

    pub(crate) fn note(text: impl Into<String>) -> Self {
        Entry::new(Key::Note, text)
    }

    /// Size of the text, and the room to its left.
    fn layout(&self) -> (TextStyle, f64) {
        let style = |size| TextStyle::new(size, Align::Left, Level::Middle);
        match self.key {
            Key::Note => (style(theme::NOTE_SIZE).muted(), 0.0),
            _ => (style(theme::LEGEND_SIZE), KEY_WIDTH + KEY_GAP),
        }
    }
}

const KEY_WIDTH: f64 = 34.0;
const KEY_GAP: f64 = 9.0;
/// Half the height of a swatch.
const SWATCH: f64 = 8.0;
const ROW: f64 = 20.0;
const LINE: f64 = 16.0;
/// Least width of a column: that of a few words of a remark.
const LEAST_WIDTH: f64 = 130.0;
/// Between entries that stand side by side.
const ENTRY_GAP: f64 = 22.0;

/// Entries in their places, ready to be measured and drawn.
pub(crate) struct Legend {
    /// Entries with the left end and the middle of their first line, and their lines.
    placed: Vec<(Entry, Xy, Vec<String>)>,
    /// Height in points.
    pub(crate) height: f64,
}

impl Legend {
    /// Entries below each other, texts broken to fit `width` points.
    pub(crate) fn column(entries: Vec<Entry>, width: f64) -> Result<Self, PlotError> {
        let (mut placed, mut height) = (Vec::new(), 0.0);
        for entry in entries {
            let (style, room) = entry.layout();
            let lines = wrap(&entry.text, style.size, width - room)?;
            let at = (0.0, height + 0.5 * ROW);
            height += ROW + LINE * lines.len().saturating_sub(1) as f64;
            placed.push((entry, at, lines));
        }
        Ok(Legend { placed, height })
    }

    /// Width that entries below each other need, `most` at most. Remarks are broken to fit it.
    pub(crate) fn width(entries: &[Entry], most: f64) -> Result<f64, PlotError> {
        let mut width = LEAST_WIDTH;
        for entry in entries {
            let (style, room) = entry.layout();
            if !matches!(entry.key, Key::Note) {
                width = width.max(room + text_width(&entry.text, style.size)? + 1.0);
            }
        }
        Ok(width.min(most))
    }

    /// Entries side by side, in as many rows as `width` points need.
    pub(crate) fn rows(entries: Vec<Entry>, width: f64) -> Result<Self, PlotError> {
        let (mut placed, mut x, mut y) = (Vec::new(), 0.0, 0.5 * ROW);
        for entry in entries {
            let (style, room) = entry.layout();
            let needed = room + text_width(&entry.text, style.size)?;
            if x > 0.0 && x + needed > width {
                (x, y) = (0.0, y + 1.1 * ROW);
            }
            let lines = vec![entry.text.clone()];
            placed.push((entry, (x, y), lines));
            x += needed + ENTRY_GAP;
        }
        Ok(Legend {
            placed,
            height: y + 0.5 * ROW,
        })
    }

    /// Draws with the top left corner at `corner`.
    pub(crate) fn draw(&self, scene: &mut Scene, corner: Xy) {
        for (entry, at, lines) in &self.placed {
            let (x, y) = (corner.0 + at.0, corner.1 + at.1);
            draw_key(scene, entry.key, (x, y));
            let (style, room) = entry.layout();
            for (i, line) in lines.iter().enumerate() {
                scene.text(line, (x + room, y + LINE * i as f64), style);
            }
        }
    }
}

fn draw_key(scene: &mut Scene, key: Key, (left, y): Xy) {
    let (middle, right) = (left + 0.5 * KEY_WIDTH, left + KEY_WIDTH);
    match key {
        Key::Point {
            marker,
            colour,
            bar,
        } => {
            if bar {
                let pen = Pen::solid(colour, theme::BAR_WIDTH);
                scene.line(&[(middle, y - 8.0), (middle, y + 8.0)], pen);
            }
            scene.marker((middle, y), marker, colour);
        }
        Key::Hollow { marker, colour } => scene.hollow_marker((middle, y), marker, colour),
        Key::Joined { marker, pen } => {
            scene.line(&[(left, y), (right, y)], pen);
            scene.marker((middle, y), marker, pen.colour);
        }
        Key::Line(pen) => scene.line(&[(left, y), (right, y)], pen),
        Key::Arrow(pen) => scene.arrow((left, y), (right, y), pen),
        Key::Sign(draw) => draw(scene, (middle, y)),
        Key::Swatch(colour) => {
            let rect = Rect::at((left, y - SWATCH), KEY_WIDTH, 2.0 * SWATCH);
            scene.rect(rect, colour);
            scene.rect_outline(rect, Pen::faint());
        }
        Key::Note => {}
    }
}
