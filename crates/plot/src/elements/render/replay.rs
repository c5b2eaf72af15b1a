//! Replay: draws the items of a scene through a backend of the drawing library, so that SVG and PNG agree.

use plotters::backend::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, RGBColor, ShapeStyle, TextStyle};

use super::joins::{self, Pixel};
use crate::PlotError;
use crate::elements::geometry::Xy;
use crate::elements::scene::{Align, Item, TextItem};
use crate::elements::text;

/// A backend of the drawing library with its scale and the way in which it places text anchored at its top.
pub(super) struct Replay<'a, B> {
    pub(super) backend: &'a mut B,
    /// Units of the backend per point.
    pub(super) scale: f64,
    /// Font size as the backend counts it, over the em.
    pub(super) size_per_em: f64,
    /// Depth of the baseline below the anchor, over the em.
    pub(super) baseline_per_em: f64,
    pub(super) joins: Joins,
}

/// Who rounds the corners of lines.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Joins {
    /// The viewer of the file.
    Viewer,
    /// Discs at sharp corners.
    Discs,
}

impl<B: DrawingBackend> Replay<'_, B> {
    pub(super) fn all(&mut self, items: &[Item]) -> Result<(), PlotError> {
        text::ensure_font()?;
        items.iter().try_for_each(|item| self.draw(item))?;
        self.backend.present().map_err(backend_error)
    }

    fn draw(&mut self, item: &Item) -> Result<(), PlotError> {
        match item {
            Item::Line {
                path,
                colour,
                width,
            } => {
                let mut path: Vec<_> = path.iter().map(|at| self.pixel(*at)).collect();
                path.dedup();
                if path.len() < 2 {
                    return Ok(());
                }
                return self.draw_line(path, self.stroke(*colour, *width));
            }
            Item::Polygon { corners, colour } => {
                let style = ShapeStyle::from(*colour).filled();
                let corners: Vec<_> = corners.iter().map(|at| self.pixel(*at)).collect();
                self.backend.fill_polygon(corners, &style)
            }
            Item::Disc {
                centre,
                radius,
                colour,
            } => {
                let style = ShapeStyle::from(*colour).filled();
                let (centre, radius) = (self.pixel(*centre), self.length(*radius));
                self.backend.draw_circle(centre, radius, &style, true)
            }
            Item::Circle {
                centre,
                radius,
                colour,
                width,
            } => {
                let style = self.stroke(*colour, *width);
                let (centre, radius) = (self.pixel(*centre), self.length(*radius));
                self.backend.draw_circle(centre, radius, &style, false)
            }
            Item::Text(item) => return self.draw_text(item),
        }
        .map_err(backend_error)
    }

    fn draw_line(&mut self, path: Vec<Pixel>, style: ShapeStyle) -> Result<(), PlotError> {
        if self.joins == Joins::Viewer {
            return self.backend.draw_path(path, &style).map_err(backend_error);
        }
        let pieces = joins::gentle_pieces(&path);
        for (i, piece) in pieces.iter().enumerate() {
            if i > 0 {
                let radius = style.stroke_width / 2;
                let round = self
                    .backend
                    .draw_circle(piece[0], radius, &style.filled(), true);
                round.map_err(backend_error)?;
            }
            let drawn = self.backend.draw_path(piece.iter().copied(), &style);
            drawn.map_err(backend_error)?;
        }
        Ok(())
    }

    fn draw_text(&mut self, item: &TextItem) -> Result<(), PlotError> {
        let h_pos = match item.align {
            Align::Left => HPos::Left,
            Align::Centre => HPos::Center,
            Align::Right => HPos::Right,
        };
        let drop = self.baseline_per_em * item.size;
        let (x, y) = item.anchor;
        let (top, transform) = if item.upwards {
            ((x - drop, y), FontTransform::Rotate270)
        } else {
            ((x, y - drop), FontTransform::None)
        };
        let style = TextStyle::from(text::font(item.size * self.size_per_em * self.scale))
            .color(&item.colour)
            .transform(transform)
            .pos(Pos::new(h_pos, VPos::Top));
        let at = self.pixel(top);
        self.backend
            .draw_text(&item.text, &style, at)
            .map_err(backend_error)
    }

    fn pixel(&self, (x, y): Xy) -> (i32, i32) {
        // Saturates far outside the figure, where the library's integer arithmetic is still safe.
        let whole = |v: f64| (v * self.scale).round().clamp(-1e5, 1e5) as i32;
        (whole(x), whole(y))
    }

    fn length(&self, length: f64) -> u32 {
        (length * self.scale).round().max(1.0) as u32
    }

    fn stroke(&self, colour: RGBColor, width: f64) -> ShapeStyle {
        ShapeStyle {
            color: colour.to_rgba(),
            filled: false,
            stroke_width: self.length(width),
        }
    }
}

pub(super) fn backend_error(error: impl std::fmt::Display) -> PlotError {
    PlotError::Backend(error.to_string())
}
