//! A list of shapes in points of the figure, origin at the top left, y down.
//!
//! Figures are laid out once, into a [`Scene`]; the two renderers only replay it, so that SVG and PNG agree.

use plotters::style::RGBColor;

use crate::elements::theme;

/// A place in the figure, points.
pub(crate) type Xy = (f64, f64);

/// A rectangle in points; `top < bottom`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rect {
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(crate) fn centre(&self) -> Xy {
        (
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        )
    }

    pub(crate) fn corners(&self) -> [Xy; 4] {
        [
            (self.left, self.top),
            (self.right, self.top),
            (self.right, self.bottom),
            (self.left, self.bottom),
        ]
    }

    /// The part of the segment `a b` inside the rectangle (Liang and Barsky 1984).
    pub(crate) fn clip(&self, a: Xy, b: Xy) -> Option<(Xy, Xy)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let edges = [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ];
        let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
        for (p, q) in edges {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                t0 = t0.max(q / p);
            } else {
                t1 = t1.min(q / p);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        (t0 <= t1).then(|| (at(t0), at(t1)))
    }

    /// The pieces of a polyline inside the rectangle.
    pub(crate) fn clip_path(&self, path: &[Xy]) -> Vec<Vec<Xy>> {
        let mut pieces: Vec<Vec<Xy>> = Vec::new();
        for ends in path.windows(2) {
            let Some((a, b)) = self.clip(ends[0], ends[1]) else {
                continue;
            };
            match pieces.last_mut() {
                Some(piece) if piece.last() == Some(&a) => piece.push(b),
                _ => pieces.push(vec![a, b]),
            }
        }
        pieces
    }
}

/// Colour, width and pattern of a line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    pub(crate) colour: RGBColor,
    pub(crate) width: f64,
    /// Lengths on and off in points; empty for a solid line.
    pub(crate) dash: &'static [f64],
}

impl Pen {
    pub(crate) fn solid(colour: RGBColor, width: f64) -> Self {
        Pen {
            colour,
            width,
            dash: &[],
        }
    }

    /// The thin dashed line of what light would do at a flat surface.
    pub(crate) fn guide() -> Self {
        Pen {
            colour: theme::MUTED,
            width: 1.2,
            dash: theme::GUIDE_DASH,
        }
    }
}

/// A character that XML admits: controls and non-characters become the replacement character.
fn printable(c: char) -> char {
    if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') {
        char::REPLACEMENT_CHARACTER
    } else {
        c
    }
}

/// Shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
}

impl Marker {
    pub(crate) const ALL: [Marker; 4] = [
        Marker::Circle,
        Marker::Square,
        Marker::Triangle,
        Marker::Diamond,
    ];
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
pub(crate) struct TextLook {
    pub(crate) size: f64,
    pub(crate) colour: RGBColor,
    pub(crate) align: Align,
    pub(crate) level: Level,
}

impl TextLook {
    pub(crate) fn new(size: f64, align: Align, level: Level) -> Self {
        TextLook {
            size,
            colour: theme::INK,
            align,
            level,
        }
    }

    pub(crate) fn muted(self) -> Self {
        TextLook {
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
        colour: RGBColor,
        width: f64,
    },
    Polygon {
        corners: Vec<Xy>,
        colour: RGBColor,
    },
    Disc {
        centre: Xy,
        radius: f64,
        colour: RGBColor,
    },
    Text {
        text: String,
        /// Baseline, at the left, middle or right end of the text.
        anchor: Xy,
        align: Align,
        size: f64,
        colour: RGBColor,
        /// Runs upwards instead of to the right.
        upwards: bool,
    },
}

/// Pixels stretched over a rectangle, without smoothing. Drawn beneath all items.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    pub(crate) frame: Rect,
    pub(crate) columns: usize,
    /// Palette indices, top row first, `columns` to a row.
    pub(crate) pixels: Vec<u8>,
    pub(crate) palette: Vec<RGBColor>,
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

/// Height of DejaVu Sans capitals over the size.
const CAP_HEIGHT: f64 = 0.729;

impl Scene {
    /// An empty scene; set the size once the layout is known.
    pub(crate) fn new(title: &str) -> Self {
        Scene {
            title: title.chars().map(printable).collect(),
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

    pub(crate) fn polygon(&mut self, corners: Vec<Xy>, colour: RGBColor) {
        self.items.push(Item::Polygon { corners, colour });
    }

    pub(crate) fn rect_outline(&mut self, rect: Rect, pen: Pen) {
        let [a, b, c, d] = rect.corners();
        self.line(&[a, b, c, d, a], pen);
    }

    /// A filled marker with a hairline of white around it, so that neighbours stay apart.
    pub(crate) fn marker(&mut self, at: Xy, marker: Marker, colour: RGBColor) {
        let r = theme::MARKER_RADIUS;
        self.shape(at, marker, r + 0.6, theme::WHITE);
        self.shape(at, marker, r, colour);
    }

    /// The outline of a marker, a little larger than a filled one.
    pub(crate) fn hollow_marker(&mut self, at: Xy, marker: Marker, colour: RGBColor) {
        let r = theme::MARKER_RADIUS;
        self.shape(at, marker, r + 0.8, colour);
        self.shape(at, marker, r - 0.6, theme::WHITE);
    }

    fn shape(&mut self, at: Xy, marker: Marker, radius: f64, colour: RGBColor) {
        // Corners of shapes of about equal area.
        let unit: &[Xy] = match marker {
            Marker::Circle => {
                self.items.push(Item::Disc {
                    centre: at,
                    radius,
                    colour,
                });
                return;
            }
            Marker::Triangle => &[(0.0, -1.35), (1.17, 0.68), (-1.17, 0.68)],
            Marker::Diamond => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
            Marker::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
        };
        let corners = unit
            .iter()
            .map(|(x, y)| (at.0 + radius * x, at.1 + radius * y))
            .collect();
        self.polygon(corners, colour);
    }

    /// Text from left to right.
    pub(crate) fn text(&mut self, text: &str, at: Xy, look: TextLook) {
        let anchor = (at.0, at.1 + baseline_shift(look));
        self.push_text(text, anchor, look, false);
    }

    /// Text that runs upwards; its [`Level`] acts along x.
    pub(crate) fn text_upwards(&mut self, text: &str, at: Xy, look: TextLook) {
        let anchor = (at.0 + baseline_shift(look), at.1);
        self.push_text(text, anchor, look, true);
    }

    fn push_text(&mut self, text: &str, anchor: Xy, look: TextLook, upwards: bool) {
        self.items.push(Item::Text {
            text: text.chars().map(printable).collect(),
            anchor,
            align: look.align,
            size: look.size,
            colour: look.colour,
            upwards,
        });
    }
}

fn baseline_shift(look: TextLook) -> f64 {
    match look.level {
        Level::Top => CAP_HEIGHT * look.size,
        Level::Middle => 0.5 * CAP_HEIGHT * look.size,
        Level::Baseline => 0.0,
    }
}

/// Cuts a polyline into the "on" pieces of a pattern.
fn dashes(path: &[Xy], pattern: &[f64]) -> Vec<Vec<Xy>> {
    let mut pieces: Vec<Vec<Xy>> = Vec::new();
    let (mut index, mut left) = (0, pattern[0]);
    let mut piece: Vec<Xy> = path.first().copied().into_iter().collect();
    for ends in path.windows(2) {
        let (mut a, b) = (ends[0], ends[1]);
        loop {
            let rest = (b.0 - a.0).hypot(b.1 - a.1);
            if rest <= left {
                left -= rest;
                if index % 2 == 0 {
                    piece.push(b);
                }
                break;
            }
            let t = left / rest;
            a = (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1));
            if index % 2 == 0 {
                piece.push(a);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![a];
            }
            index = (index + 1) % pattern.len();
            left = pattern[index];
        }
    }
    pieces.push(piece);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect {
        left: 0.0,
        top: 0.0,
        right: 10.0,
        bottom: 10.0,
    };

    #[test]
    fn clipping_keeps_the_inside_and_splits_at_the_border() {
        let path = [
            (-5.0, 5.0),
            (5.0, 5.0),
            (5.0, 50.0),
            (8.0, 50.0),
            (8.0, 1.0),
        ];
        let pieces = UNIT.clip_path(&path);
        assert_eq!(
            pieces,
            vec![
                vec![(0.0, 5.0), (5.0, 5.0), (5.0, 10.0)],
                vec![(8.0, 10.0), (8.0, 1.0)]
            ]
        );
    }

    #[test]
    fn dashes_cover_their_share_of_the_path() {
        let path: Vec<Xy> = (0..=100).map(|i| (f64::from(i), 0.0)).collect();
        let drawn: f64 = dashes(&path, &[3.0, 2.0])
            .iter()
            .map(|piece| piece[piece.len() - 1].0 - piece[0].0)
            .sum();
        assert!((drawn - 60.0).abs() < 1e-9, "{drawn}");
    }
}
