//! Surfaces side by side, shaded.

use crate::elements::geometry::Rect;
use crate::elements::page::Page;
use crate::elements::panel_grid::PanelGrid;
use crate::elements::rgb::Rgb;
use crate::elements::scene::{Align, Level, Picture, TextStyle};
use crate::elements::theme;
use crate::error::{Valid, check_length};
use crate::{Figure, PlotError};

/// One surface of [`Reliefs`].
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    /// Its name.
    pub caption: String,
    /// Heights, row-major, `ny` rows of `nx`, in the unit of the spacing.
    pub heights: Vec<f64>,
    /// `[ny, nx]`, at least 2 each.
    pub shape: [usize; 2],
    /// Length units per sample along both axes, above 0.
    pub spacing: f64,
}

/// Surfaces from above, side by side, shaded by Lambert's law under a light from the upper left; the first row is on top.
///
/// Slopes of each are scaled to the same root mean square, so that gentle and steep surfaces show alike. Tiles repeat across their borders.
///
/// ```
/// use asperity_plot::{Relief, Reliefs};
///
/// let wave = |i: i32| 0.3 * (0.4 * f64::from(i % 32)).sin();
/// let relief = Relief {
///     caption: "grooves".into(),
///     heights: (0..1024).map(wave).collect(),
///     shape: [32, 32],
///     spacing: 1.0,
/// };
/// let figure = Reliefs {
///     title: "Two surfaces".into(),
///     subtitle: String::new(),
///     columns: 2,
///     panels: vec![relief.clone(), relief],
/// };
/// assert!(figure.draw()?.svg()?.contains("grooves"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Reliefs {
    /// First line of the figure.
    pub title: String,
    /// Second line. May be empty.
    pub subtitle: String,
    /// Panels side by side, at least 1.
    pub columns: usize,
    /// The surfaces.
    pub panels: Vec<Relief>,
}

/// Side of a panel, points.
const SIDE: f64 = 192.0;
const GAP: f64 = 10.0;
const NAME_DEPTH: f64 = 20.0;

/// Root mean square slope that surfaces are scaled to.
const SLOPE: f64 = 0.45;

/// Towards the light, a unit vector: to the right, downwards, up. Not along a diagonal, so that the four sides of pyramids differ.
const LIGHT: [f64; 3] = [-0.6, -0.36, 0.714_422_843];

impl Reliefs {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without columns or panels, or for less than 2 x 2 samples; [`PlotError::MismatchedLengths`] if heights do
    /// not fill their shape; [`PlotError::OutOfRange`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        if self.columns == 0 || self.panels.is_empty() {
            return Err(PlotError::nothing_to_draw(
                "reliefs without columns or panels",
            ));
        }
        self.panels.iter().try_for_each(Relief::check)?;
        let layout = PanelGrid {
            left: theme::MARGIN,
            columns: self.columns,
            size: (SIDE, SIDE),
            gap: GAP,
            name_depth: NAME_DEPTH,
        };
        let width = layout.right() + theme::MARGIN;
        let mut page = Page::new(&self.title, &self.subtitle, width)?;
        let top = page.y + 8.0;
        for (i, relief) in self.panels.iter().enumerate() {
            let frame = layout.frame(i, top);
            let style = TextStyle::new(theme::LEGEND_SIZE, Align::Left, Level::Top);
            let place = (frame.left, frame.top - NAME_DEPTH + 2.0);
            page.scene.text(&relief.caption, place, style);
            page.scene.pictures.push(relief.picture(frame));
        }
        Ok(page.finish(top + layout.depth(self.panels.len())))
    }
}

impl Relief {
    fn check(&self) -> Result<(), PlotError> {
        let [ny, nx] = self.shape;
        if nx < 2 || ny < 2 {
            let what = format!("a relief of {ny} rows and {nx} columns");
            return Err(PlotError::nothing_to_draw(what));
        }
        check_length("relief", self.heights.len(), nx.saturating_mul(ny))?;
        Valid::Finite.check_all("height", self.heights.iter().copied())?;
        Valid::Positive.check_all("spacing", [self.spacing])
    }

    fn picture(&self, frame: Rect) -> Picture {
        let slopes = self.slopes();
        let square = slopes.iter().map(|[x, y]| x * x + y * y).sum::<f64>() / slopes.len() as f64;
        let scale = match square > 0.0 {
            true => SLOPE / square.sqrt(),
            false => 0.0,
        };
        let shade = |[x, y]: &[f64; 2]| {
            let [x, y] = [scale * x, scale * y];
            let [lx, ly, lz] = LIGHT;
            let cosine = (lz - lx * x - ly * y) / (1.0 + x * x + y * y).sqrt();
            (255.0 * cosine.clamp(0.0, 1.0)).round() as u8
        };
        Picture {
            frame,
            columns: self.shape[1],
            pixels: slopes.iter().map(shade).collect(),
            palette: (0..=255).map(|grey| Rgb(grey, grey, grey)).collect(),
        }
    }

    /// Slopes to the right and downwards, of every sample.
    fn slopes(&self) -> Vec<[f64; 2]> {
        let [ny, nx] = self.shape;
        let at = |ix: usize, iy: usize| self.heights[(iy % ny) * nx + ix % nx];
        let slope = |ix: usize, iy: usize| {
            let rise = [
                at(ix + 1, iy) - at(ix + nx - 1, iy),
                at(ix, iy + 1) - at(ix, iy + ny - 1),
            ];
            rise.map(|rise| rise / (2.0 * self.spacing))
        };
        let rows = (0..ny).flat_map(|iy| (0..nx).map(move |ix| (ix, iy)));
        rows.map(|(ix, iy)| slope(ix, iy)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relief(heights: Vec<f64>) -> Relief {
        Relief {
            caption: "ridge".into(),
            heights,
            shape: [2, 4],
            spacing: 0.5,
        }
    }

    /// A ridge along y: its left flank faces the light.
    #[test]
    fn what_faces_the_light_is_bright() {
        let picture =
            relief([[0.0, 1.0, 2.0, 1.0]; 2].concat()).picture(Rect::at((0.0, 0.0), 1.0, 1.0));
        let [valley, left, ridge, right] = [0, 1, 2, 3].map(|i| picture.pixels[i]);
        assert!(
            left > valley && valley == ridge && ridge > right,
            "{:?}",
            picture.pixels
        );
        let flat = relief(vec![3.0; 8]).picture(Rect::at((0.0, 0.0), 1.0, 1.0));
        assert!(
            flat.pixels.iter().all(|grey| *grey == 182),
            "{:?}",
            flat.pixels
        );
    }

    #[test]
    fn what_has_no_meaning_is_refused() {
        let draw = |panels: Vec<Relief>, columns: usize| {
            let figure = Reliefs {
                title: "a".into(),
                subtitle: String::new(),
                columns,
                panels,
            };
            figure.draw().map(|_| ())
        };
        assert!(draw(vec![relief(vec![1.0; 8])], 2).is_ok());
        assert!(draw(vec![relief(vec![1.0; 8])], 0).is_err());
        assert!(draw(Vec::new(), 2).is_err());
        assert!(draw(vec![relief(vec![1.0; 7])], 2).is_err());
        assert!(draw(vec![relief(vec![f64::NAN; 8])], 2).is_err());
    }
}
