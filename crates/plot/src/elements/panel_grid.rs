//! Panels of equal size in rows, each with its name above.

use super::geometry::Rect;

/// Places of the panels, in points.
pub(crate) struct PanelGrid {
    /// Left end of the first column.
    pub(crate) left: f64,
    /// Panels side by side.
    pub(crate) columns: usize,
    /// Width and height of a frame.
    pub(crate) size: (f64, f64),
    /// Between columns and between rows.
    pub(crate) gap: f64,
    /// Distance from the top of a name to the frame below it.
    pub(crate) name_depth: f64,
}

impl PanelGrid {
    /// Right end of the last column.
    pub(crate) fn right(&self) -> f64 {
        self.left + self.columns as f64 * (self.size.0 + self.gap) - self.gap
    }

    fn row_height(&self) -> f64 {
        self.name_depth + self.size.1 + self.gap + 6.0
    }

    /// Height of the rows that hold `panels` panels, without the axis below them.
    pub(crate) fn depth(&self, panels: usize) -> f64 {
        panels.div_ceil(self.columns) as f64 * self.row_height() - self.gap - 6.0
    }

    /// The frame of panel `i`.
    pub(crate) fn frame(&self, i: usize, top: f64) -> Rect {
        let (row, column) = (i / self.columns, i % self.columns);
        let x = self.left + column as f64 * (self.size.0 + self.gap);
        let y = top + row as f64 * self.row_height();
        Rect::at((x, y + self.name_depth), self.size.0, self.size.1)
    }
}
