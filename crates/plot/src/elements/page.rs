//! Page: header, notes, and one panel with its legend.

use super::axis::Axis;
use super::curve::Curve;
use super::geometry::Rect;
use super::legend::{Entry, Legend};
use super::panel::{Panel, X_AXIS_DEPTH, y_axis_room};
use super::render::Figure;
use super::scene::{Align, Level, Scene, TextStyle};
use super::text::wrap;
use super::theme;
use crate::PlotError;

/// A scene that is filled from top to bottom.
pub(crate) struct Page {
    pub(crate) scene: Scene,
    pub(crate) width: f64,
    /// Below what is drawn so far.
    pub(crate) y: f64,
}

impl Page {
    /// A page `width` points wide with a title and a subtitle.
    pub(crate) fn new(title: &str, subtitle: &str, width: f64) -> Result<Self, PlotError> {
        let mut page = Page {
            scene: Scene::new(title),
            width: width.round(),
            y: theme::MARGIN,
        };
        let style = |size| TextStyle::new(size, Align::Left, Level::Top);
        page.lines(title, style(theme::TITLE_SIZE))?;
        page.lines(subtitle, style(theme::SUBTITLE_SIZE).muted())?;
        Ok(page)
    }

    /// Text in lines as wide as the page.
    pub(crate) fn lines(&mut self, text: &str, style: TextStyle) -> Result<(), PlotError> {
        for line in wrap(text, style.size, self.width - 2.0 * theme::MARGIN)? {
            self.scene.text(&line, (theme::MARGIN, self.y), style);
            self.y += 1.45 * style.size;
        }
        Ok(())
    }

    /// A remark in small type.
    pub(crate) fn note(&mut self, text: &str) -> Result<(), PlotError> {
        let style = TextStyle::new(theme::NOTE_SIZE, Align::Left, Level::Top);
        self.lines(text, style.muted())
    }

    /// A legend in rows as wide as the page.
    pub(crate) fn legend(&mut self, entries: Vec<Entry>) -> Result<(), PlotError> {
        let legend = Legend::rows(entries, self.width - 2.0 * theme::MARGIN)?;
        legend.draw(&mut self.scene, (theme::MARGIN, self.y));
        self.y += legend.height;
        Ok(())
    }

    /// The figure, which ends a margin below `bottom`.
    pub(crate) fn finish(mut self, bottom: f64) -> Figure {
        self.scene.width = self.width as u32;
        self.scene.height = (bottom + theme::MARGIN).round() as u32;
        Figure::new(self.scene)
    }
}

/// One panel with its legend at the right.
pub(crate) struct Chart<'a> {
    pub(crate) title: &'a str,
    pub(crate) subtitle: &'a str,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Logarithmic axis of a second panel of the same curves, below the first.
    pub(crate) log_y: Option<Axis>,
    /// Width and height of a panel.
    pub(crate) size: (f64, f64),
    pub(crate) legend_width: f64,
    pub(crate) curves: &'a [Curve],
    pub(crate) entries: Vec<Entry>,
}

impl Chart<'_> {
    pub(crate) fn draw(self) -> Result<Figure, PlotError> {
        const LEGEND_GAP: f64 = 26.0;
        let mut room = y_axis_room(&self.y)?;
        if let Some(log_y) = &self.log_y {
            room = room.max(y_axis_room(log_y)?);
        }
        let left = theme::MARGIN + room;
        let right = left + self.size.0 + LEGEND_GAP;
        let width = right + self.legend_width + theme::MARGIN;
        let mut page = Page::new(self.title, self.subtitle, width)?;
        let top = page.y + 16.0;
        let mut frame = Rect::at((left, top), self.size.0, self.size.1);
        let panels = [Some(self.y), self.log_y];
        for y in panels.into_iter().flatten() {
            Panel::new(frame, self.x.clone(), y)?.draw(&mut page.scene, self.curves);
            page.y = frame.bottom + X_AXIS_DEPTH;
            frame = Rect::at((left, page.y + 16.0), self.size.0, self.size.1);
        }
        let legend = Legend::column(self.entries, self.legend_width)?;
        legend.draw(&mut page.scene, (right, top));
        let bottom = page.y.max(top + legend.height);
        Ok(page.finish(bottom))
    }
}
