//! Legends, set beside the data and never over them.

use crate::PlotError;
use crate::elements::scene::{Align, Level, Pen, Scene, TextLook, Xy};
use crate::elements::series::{Look, Series, SeriesKind};
use crate::elements::text::wrap;
use crate::elements::theme;

/// What stands left of a text in the legend.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Key {
    /// A point, with its error bar if there is one.
    Point { look: Look, bar: bool },
    /// A hollow point.
    Hollow(Look),
    /// A point on its fitted line.
    Fitted(Look),
    /// A line.
    Line(Pen),
    /// A line that ends in an arrow head.
    Arrow(Pen),
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
    pub(crate) fn note(text: impl Into<String>) -> Self {
        Entry {
            key: Key::Note,
            text: text.into(),
        }
    }
}

/// One entry for each different series that `shown` admits, points first.
pub(crate) fn series_entries(
    series: &[Series],
    looks: &[Look],
    shown: impl Fn(&Series) -> bool,
) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for kind in [SeriesKind::Explicit, SeriesKind::Model] {
        let mut names: Vec<&str> = Vec::new();
        for (s, look) in series.iter().zip(looks) {
            if s.kind != kind || !shown(s) || names.contains(&s.name.as_str()) {
                continue;
            }
            names.push(&s.name);
            let key = match kind {
                SeriesKind::Explicit => Key::Point {
                    look: *look,
                    bar: s.samples.iter().any(|sample| sample.se.is_some()),
                },
                SeriesKind::Model => Key::Line(look.curve()),
            };
            entries.push(Entry {
                key,
                text: s.name.clone(),
            });
        }
    }
    entries
}

/// Remarks on what bars mean, where there are bars.
pub(crate) fn bar_notes(
    series: &[Series],
    horizontal: bool,
    shown: impl Fn(&Series) -> bool,
) -> Vec<Entry> {
    let mut notes = Vec::new();
    let shown = || series.iter().filter(|s| shown(s));
    if shown().any(|s| s.samples.iter().any(|sample| sample.se.is_some())) {
        notes.push(Entry::note("Bars: ±1 standard error."));
    }
    if horizontal && shown().any(|s| s.bin_width_deg.is_some()) {
        notes.push(Entry::note("Horizontal bars: width of a bin."));
    }
    notes
}

const KEY_WIDTH: f64 = 34.0;
const KEY_GAP: f64 = 9.0;
const ROW: f64 = 20.0;
const LINE: f64 = 16.0;

/// Entries broken into lines, ready to be measured and drawn.
pub(crate) struct Legend {
    rows: Vec<(Key, Vec<String>)>,
}

impl Legend {
    /// Breaks the texts to fit `width` points, keys included.
    pub(crate) fn new(entries: &[Entry], width: f64) -> Result<Self, PlotError> {
        let rows = entries
            .iter()
            .map(|entry| {
                let (size, room) = match entry.key {
                    Key::Note => (theme::NOTE_SIZE, width),
                    _ => (theme::LEGEND_SIZE, width - KEY_WIDTH - KEY_GAP),
                };
                Ok((entry.key, wrap(&entry.text, size, room)?))
            })
            .collect::<Result<_, PlotError>>()?;
        Ok(Legend { rows })
    }

    /// Height in points.
    pub(crate) fn height(&self) -> f64 {
        self.rows
            .iter()
            .map(|(_, lines)| row_height(lines.len()))
            .sum()
    }

    /// Draws with the top left corner at `corner`.
    pub(crate) fn draw(&self, scene: &mut Scene, corner: Xy) {
        let mut top = corner.1;
        for (key, lines) in &self.rows {
            let y = top + 0.5 * ROW;
            draw_key(scene, *key, (corner.0, y));
            let look = TextLook::new(theme::LEGEND_SIZE, Align::Left, Level::Middle);
            let (look, x) = match key {
                Key::Note => {
                    let small = TextLook::new(theme::NOTE_SIZE, Align::Left, Level::Middle);
                    (small.muted(), corner.0)
                }
                _ => (look, corner.0 + KEY_WIDTH + KEY_GAP),
            };
            for (i, line) in lines.iter().enumerate() {
                scene.text(line, (x, y + LINE * i as f64), look);
            }
            top += row_height(lines.len());
        }
    }
}

fn row_height(lines: usize) -> f64 {
    ROW + LINE * lines.saturating_sub(1) as f64
}

fn draw_key(scene: &mut Scene, key: Key, (left, y): Xy) {
    let (middle, right) = (left + 0.5 * KEY_WIDTH, left + KEY_WIDTH);
    match key {
        Key::Point { look, bar } => {
            if bar {
                scene.line(&[(middle, y - 8.0), (middle, y + 8.0)], look.bar());
            }
            scene.marker((middle, y), look.marker, look.colour);
        }
        Key::Hollow(look) => scene.hollow_marker((middle, y), look.marker, look.colour),
        Key::Fitted(look) => {
            scene.line(&[(left, y), (right, y)], look.curve());
            scene.marker((middle, y), look.marker, look.colour);
        }
        Key::Line(pen) => scene.line(&[(left, y), (right, y)], pen),
        Key::Arrow(pen) => arrow(scene, (left, y), (right, y), pen),
        Key::Note => {}
    }
}

/// A line with a filled head whose tip is at `to`.
pub(crate) fn arrow(scene: &mut Scene, from: Xy, to: Xy, pen: Pen) {
    const LENGTH: f64 = 11.0;
    const HALF_WIDTH: f64 = 4.2;
    let length = (to.0 - from.0).hypot(to.1 - from.1);
    if length < LENGTH {
        return;
    }
    let (ux, uy) = ((to.0 - from.0) / length, (to.1 - from.1) / length);
    let foot = (to.0 - LENGTH * ux, to.1 - LENGTH * uy);
    scene.line(&[from, foot], pen);
    scene.polygon(
        vec![
            to,
            (foot.0 - HALF_WIDTH * uy, foot.1 + HALF_WIDTH * ux),
            (foot.0 + HALF_WIDTH * uy, foot.1 - HALF_WIDTH * ux),
        ],
        pen.colour,
    );
}
