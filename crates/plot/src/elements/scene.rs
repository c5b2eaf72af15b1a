//! A list of shapes in points of the figure, origin at the top left, y down.
//!
//! Figures are laid out once, into a [`Scene`]; both renderers draw its items as they are, so that SVG and PNG agree.

use super::geometry::{Rect, Xy, dashes};
use super::rgb::Rgb;
use super::theme;

/// Colour, width and dash pattern of a line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    pub(crate) colour: Rgb,
    pub(crate) width: f64,
    /// Lengths on and off in points; empty for a solid line.
    pub(crate) dash: &'static [f64],
}

impl Pen {
    pub(crate) fn solid(colour: Rgb, width: f64) -> Self {
        Pen {
            colour,
            width,
            dash: &[],
        }
    }

    pub(crate) fn faint() -> Self {
        Pen::solid(theme::FAINT, 1.2)
    }

    /// The thin dashed line of a direction or a value to compare with.
    pub(crate) fn guide() -> Self {
        Pen {
            colour: theme::MUTED,
            width: 1.2,
            dash: theme::GUIDE_DASH,
        }
    }
}

/// A text of which everything is seen, and which XML admits: controls, marks of writing direction, what has no width and
/// non-characters become escapes, `\u{1b}`.
fn printable(text: &str) -> String {
    let is_hidden = |c: char| {
        c.is_control()
            || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}')
            || matches!(c, '\u{feff}' | '\u{fffe}' | '\u{ffff}')
    };
    let escape = |c: char| match is_hidden(c) {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    text.chars().map(escape).collect()
}

/// Shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
    Cross,
    Plus,
    TriangleLeft,
    TriangleRight,
}

impl Marker {
    const ALL: [Marker; 9] = [
        Marker::Circle,
        Marker::Square,
        Marker::Triangle,
        Marker::Diamond,
        Marker::TriangleDown,
        Marker::Cross,
        Marker::Plus,
        Marker::TriangleLeft,
        Marker::TriangleRight,
    ];

    /// The marker of a number; numbers wrap around.
    pub(crate) fn nth(i: usize) -> Self {
        Self::ALL[i % Self::ALL.len()]
    }
}

/// Horizontal place of a text relative to its anchor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Centre,
    Right,
}

/// Vertical place of a text relative to its anchor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    /// Tops of capitals at the anchor.
    Top,
    /// Capitals centred on the anchor.
    Middle,
    /// Baseline at the anchor.
    Baseline,
}

/// Size, colour and anchoring of a text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextStyle {
    pub(crate) size: f64,
    pub(crate) colour: Rgb,
    pub(crate) align: Align,
    pub(crate) level: Level,
}

impl TextStyle {
    pub(crate) fn new(size: f64, align: Align, level: Level) -> Self {
        TextStyle {
            size,
            colour: theme::INK,
            align,
            level,
        }
    }

    pub(crate) fn muted(self) -> Self {
        TextStyle {
            colour: theme::MUTED,
            ..self
        }
    }
}

/// Something to draw.
#[derive(Debug, Clone)]
pub(crate) enum Item {
    Line {
        path: Vec<Xy>,
        colour: Rgb,
        width: f64,
    },
    Polygon {
        corners: Vec<Xy>,
        colour: Rgb,
    },
    /// A disc, or its outline of a width.
    Circle {
        centre: Xy,
        radius: f64,
        colour: Rgb,
        width: Option<f64>,
    },
    Text(TextItem),
    /// A text that an SVG shows where the pointer rests.
    Tooltip {
        rect: Rect,
        text: String,
    },
}

impl Item {
    /// Its colour, if it is drawn.
    pub(crate) fn colour(&self) -> Option<Rgb> {
        match self {
            Item::Line { colour, .. }
            | Item::Polygon { colour, .. }
            | Item::Circle { colour, .. } => Some(*colour),
            Item::Text(text) => Some(text.colour),
            Item::Tooltip { .. } => None,
        }
    }
}

/// A text in its place.
#[derive(Debug, Clone)]
pub(crate) struct TextItem {
    pub(crate) text: String,
    /// Baseline, at the left, middle or right end of the text.
    pub(crate) anchor: Xy,
    pub(crate) align: Align,
    pub(crate) size: f64,
    pub(crate) colour: Rgb,
    /// Runs upwards instead of to the right.
    pub(crate) upwards: bool,
}

/// Pixels stretched over a rectangle, without smoothing. Drawn beneath all items.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    pub(crate) frame: Rect,
    pub(crate) columns: usize,
    /// Palette indices, top row first, `columns` to a row.
    pub(crate) pixels: Vec<u8>,
    pub(crate) palette: Vec<Rgb>,
}

/// A laid-out figure.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) title: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) items: Vec<Item>,
}

/// Corners of a cross with arms along the diagonals.
const CROSS: [Xy; 12] = [
    (0.0, -0.6),
    (0.8, -1.4),
    (1.4, -0.8),
    (0.6, 0.0),
    (1.4, 0.8),
    (0.8, 1.4),
    (0.0, 0.6),
    (-0.8, 1.4),
    (-1.4, 0.8),
    (-0.6, 0.0),
    (-1.4, -0.8),
    (-0.8, -1.4),
];
/// Corners of a cross with upright arms.
const PLUS: [Xy; 12] = [
    (-0.45, -1.5),
    (0.45, -1.5),
    (0.45, -0.45),
    (1.5, -0.45),
    (1.5, 0.45),
    (0.45, 0.45),
    (0.45, 1.5),
    (-0.45, 1.5),
    (-0.45, 0.45),
    (-1.5, 0.45),
    (-1.5, -0.45),
    (-0.45, -0.45),
];

/// Length of the head of an arrow; a shorter arrow is not drawn.
pub(crate) const ARROW_HEAD: f64 = 11.0;

/// Height of DejaVu Sans capitals over the size.
const CAP_HEIGHT: f64 = 0.729;

impl Scene {
    /// An empty scene; set the size once the layout is known.
    pub(crate) fn new(title: &str) -> Self {
        Scene {
            title: printable(title),
            width: 0,
            height: 0,
            pictures: Vec::new(),
            items: Vec::new(),
        }
    }

    /// A polyline. Dashes are cut here: the drawing library knows solid lines only.
    pub(crate) fn line(&mut self, path: &[Xy], pen: Pen) {
        let pieces = if pen.dash.is_empty() {
            vec![path.to_vec()]
        } else {
            dashes(path, pen.dash)
        };
        for path in pieces {
            if path.len() > 1 {
                self.items.push(Item::Line {
                    path,
                    colour: pen.colour,
                    width: pen.width,
                });
            }
        }
    }

    /// A filled area. Its corners are put in clockwise order: overlapping areas of opposite orders in one path would leave a hole.
    pub(crate) fn polygon(&mut self, mut corners: Vec<Xy>, colour: Rgb) {
        let next = corners.iter().cycle().skip(1);
        let cross = |(a, b): (&Xy, &Xy)| a.0 * b.1 - a.1 * b.0;
        if corners.iter().zip(next).map(cross).sum::<f64>() < 0.0 {
            corners.reverse();
        }
        self.items.push(Item::Polygon { corners, colour });
    }

    pub(crate) fn rect(&mut self, rect: Rect, colour: Rgb) {
        self.polygon(rect.corners().to_vec(), colour);
    }

    pub(crate) fn disc(&mut self, centre: Xy, radius: f64, colour: Rgb) {
        self.push_circle(centre, radius, colour, None);
    }

    pub(crate) fn circle(&mut self, centre: Xy, radius: f64, pen: Pen) {
        self.push_circle(centre, radius, pen.colour, Some(pen.width));
    }

    fn push_circle(&mut self, centre: Xy, radius: f64, colour: Rgb, width: Option<f64>) {
        self.items.push(Item::Circle {
            centre,
            radius,
            colour,
            width,
        });
    }

    pub(crate) fn rect_outline(&mut self, rect: Rect, pen: Pen) {
        let [a, b, c, d] = rect.corners();
        self.line(&[a, b, c, d, a], pen);
    }

    /// A line with a filled head whose tip is at `to`.
    pub(crate) fn arrow(&mut self, from: Xy, to: Xy, pen: Pen) {
        const HALF_WIDTH: f64 = 4.2;
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        if length < ARROW_HEAD {
            return;
        }
        let (ux, uy) = ((to.0 - from.0) / length, (to.1 - from.1) / length);
        let foot = (to.0 - ARROW_HEAD * ux, to.1 - ARROW_HEAD * uy);
        self.line(&[from, foot], pen);
        let corner = |side: f64| {
            (
                foot.0 - side * HALF_WIDTH * uy,
                foot.1 + side * HALF_WIDTH * ux,
            )
        };
        self.polygon(vec![to, corner(1.0), corner(-1.0)], pen.colour);
    }

    /// A filled marker with a hairline of white around it, so that neighbours stay apart.
    pub(crate) fn marker(&mut self, at: Xy, marker: Marker, colour: Rgb) {
        let r = theme::MARKER_RADIUS;
        self.shape(at, marker, r + 0.6, theme::WHITE);
        self.shape(at, marker, r, colour);
    }

    /// The outline of a marker, a little larger than a filled one.
    pub(crate) fn hollow_marker(&mut self, at: Xy, marker: Marker, colour: Rgb) {
        let r = theme::MARKER_RADIUS;
        self.shape(at, marker, r + 0.8, colour);
        self.shape(at, marker, r - 0.6, theme::WHITE);
    }

    fn shape(&mut self, at: Xy, marker: Marker, radius: f64, colour: Rgb) {
        // Corners of shapes of about equal area.
        let unit: &[Xy] = match marker {
            Marker::Circle => {
                self.disc(at, radius, colour);
                return;
            }
            Marker::Triangle => &[(0.0, -1.35), (1.17, 0.68), (-1.17, 0.68)],
            Marker::TriangleDown => &[(0.0, 1.35), (-1.17, -0.68), (1.17, -0.68)],
            Marker::TriangleLeft => &[(-1.35, 0.0), (0.68, -1.17), (0.68, 1.17)],
            Marker::TriangleRight => &[(1.35, 0.0), (-0.68, -1.17), (-0.68, 1.17)],
            Marker::Diamond => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
            Marker::Cross => &CROSS,
            Marker::Plus => &PLUS,
            Marker::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
        };
        let corners = unit
            .iter()
            .map(|(x, y)| (at.0 + radius * x, at.1 + radius * y))
            .collect();
        self.polygon(corners, colour);
    }

    /// Text from left to right.
    pub(crate) fn text(&mut self, text: &str, at: Xy, style: TextStyle) {
        let anchor = (at.0, at.1 + baseline_shift(style));
        self.push_text(text, anchor, style, false);
    }

    /// Text that runs upwards; its [`Level`] acts along x.
    pub(crate) fn text_upwards(&mut self, text: &str, at: Xy, style: TextStyle) {
        let anchor = (at.0 + baseline_shift(style), at.1);
        self.push_text(text, anchor, style, true);
    }

    /// A text that an SVG shows where the pointer rests on `rect`, and on nothing that is drawn later. A PNG has none.
    pub(crate) fn tooltip(&mut self, rect: Rect, text: &str) {
        let text = printable(text);
        self.items.push(Item::Tooltip { rect, text });
    }

    fn push_text(&mut self, text: &str, anchor: Xy, style: TextStyle, upwards: bool) {
        if text.is_empty() {
            return;
        }
        self.items.push(Item::Text(TextItem {
            text: printable(text),
            anchor,
            align: style.align,
            size: style.size,
            colour: style.colour,
            upwards,
        }));
    }
}

fn baseline_shift(style: TextStyle) -> f64 {
    match style.level {
        Level::Top => CAP_HEIGHT * style.size,
        Level::Middle => 0.5 * CAP_HEIGHT * style.size,
        Level::Baseline => 0.0,
    }
}
