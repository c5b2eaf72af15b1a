//! Replay: draws the items of a scene through the rasteriser of the drawing library.

use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, RGBColor, ShapeStyle, TextStyle};

use super::joins::{self, Pixel};
use crate::PlotError;
use crate::elements::geometry::{Xy, in_units};
use crate::elements::scene::{Align, Item, TextItem};
use crate::elements::text;

/// The rasteriser with its scale.
pub(super) struct Replay<'a> {
    pub(super) backend: BitMapBackend<'a>,
    /// Pixels per point.
    pub(super) scale: f64,
}

impl Replay<'_> {
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
            Item::Tooltip { .. } => Ok(()),
        }
        .map_err(backend_error)
    }

    fn draw_line(&mut self, path: Vec<Pixel>, style: ShapeStyle) -> Result<(), PlotError> {
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
        // The rasteriser takes the line height for the size and puts the baseline at half of it.
        let line_height = text::LINE_HEIGHT_PER_EM * item.size;
        let drop = 0.5 * line_height;
        let (x, y) = item.anchor;
        let (top, transform) = if item.upwards {
            ((x - drop, y), FontTransform::Rotate270)
        } else {
            ((x, y - drop), FontTransform::None)
        };
        let style = TextStyle::from(text::font(line_height * self.scale))
            .color(&item.colour)
            .transform(transform)
            .pos(Pos::new(h_pos, VPos::Top));
        let at = self.pixel(top);
        self.backend
            .draw_text(&item.text, &style, at)
            .map_err(backend_error)
    }

    fn pixel(&self, at: Xy) -> Pixel {
        in_units(at, self.scale)
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
