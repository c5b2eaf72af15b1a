//! Scattered light over whole hemispheres, a disc a measurement, in rows and columns.

use std::f64::consts::{SQRT_2, TAU};

use crate::elements::colour_bar;
use crate::elements::disc::{disc_pixels, palette, scale_end};
use crate::elements::scene::{Align, Level, Pen, Picture, Rect, Scene, TextLook, Xy};
use crate::elements::series::check_finite;
use crate::elements::text::{header, text_width, three_digits, wrap};
use crate::elements::theme;
use crate::{Figure, PlotError, Side};

/// Which discs share their colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourScale {
    /// All.
    Common,
    /// Those of a row.
    Rows,
}

/// Scattered light over one hemisphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Hemisphere {
    /// Values of the bins in 1/sr, ring by ring from the normal of the side on which the light leaves, and within
    /// a ring by azimuth from 0.
    pub values: Vec<f64>,
    /// Azimuth of the direction towards the light, degrees: the tick mark; none where it has no meaning.
    pub light_deg: Option<f64>,
    /// Words beneath the disc. May be empty.
    pub note: String,
}

/// A matrix of hemispheres, each a disc of equal areas: as much paper as solid angle.
///
/// Discs show the hemisphere from above, azimuth 0 to the right and 90 degrees up; transmitted light is seen
/// through the surface, light straight down in the middle. The colours are *viridis*, from zero to the largest
/// value of those that share them; values below zero, which noise makes, look like zero. Where a few bins outshine
/// all others by far, as mirror peaks do, the scale ends at twice what all but 2 % of the discs stay below, or less; bins beyond have a
/// colour of their own, and the peak stands beneath the disc. Faint circles are at 30 and 60 degrees from the normal.
///
/// ```
/// use asperity_plot::{ColourScale, Hemisphere, Hemispheres, Side};
///
/// let lambert = |albedo: f64| Some(Hemisphere {
///     values: vec![albedo / std::f64::consts::PI; 6 * 12],
///     light_deg: Some(0.0),
///     note: format!("{albedo} reflected"),
/// });
/// let figure = Hemispheres {
///     title: "Two Lambertian surfaces".into(),
///     subtitle: String::new(),
///     quantity: "BRDF".into(),
///     side: Side::Reflected,
///     row_title: "angle of incidence".into(),
///     column_title: "albedo".into(),
///     rows: vec!["30°".into()],
///     columns: vec!["0.5".into(), "1".into()],
///     bins: [6, 12],
///     scale: ColourScale::Common,
///     cells: vec![lambert(0.5), lambert(1.0)],
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("BRDF (1/sr)"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Hemispheres {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// What the colours show, without its unit, 1/sr.
    pub quantity: String,
    /// Side on which the light leaves.
    pub side: Side,
    /// What rows differ in. May be empty.
    pub row_title: String,
    /// What columns differ in. May be empty.
    pub column_title: String,
    /// Names of the rows, top to bottom.
    pub rows: Vec<String>,
    /// Names of the columns, left to right.
    pub columns: Vec<String>,
    /// Rings and sectors of each hemisphere.
    pub bins: [usize; 2],
    /// Which discs share their colours.
    pub scale: ColourScale,
    /// The cells row by row; `None` where nothing was measured yet.
    pub cells: Vec<Option<Hemisphere>>,
}

/// Diameter of a disc with few columns and with many, points.
const DIAMETER: (f64, f64) = (150.0, 84.0);
/// Width that discs are made to fit into, as far as they stay large enough.
const WIDTH: f64 = 1000.0;
/// Between discs; holds the tick mark.
const GAP: f64 = 26.0;
const TICK: f64 = 10.0;
const NOTE_DEPTH: f64 = theme::NOTE_SIZE + 9.0;
const NOTE_LINE: f64 = 1.3 * theme::NOTE_SIZE;
const BAR_GAP: f64 = 20.0;
/// Right of the discs.
const BAR_ROOM: f64 = 112.0;
/// Pixels of a picture a point.
const PIXELS: f64 = 2.0;

impl Hemispheres {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without rows, columns or bins, [`PlotError::MismatchedLengths`] if cells or
    /// values are not as many as they should be, [`PlotError::NonFinite`] for values without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let columns = self.columns.len() as f64;
        let mut widest = 0.0_f64;
        for text in &self.rows {
            widest = widest.max(text_width(text, theme::TICK_SIZE)?);
        }
        let left = theme::MARGIN + theme::LABEL_SIZE + 12.0 + widest + TICK + 6.0;
        let free = WIDTH - left - BAR_ROOM;
        let diameter = (free / columns - GAP).floor().clamp(DIAMETER.1, DIAMETER.0);
        let right = left + columns * (diameter + GAP) - GAP;
        let figure_width = (right + TICK + BAR_ROOM).max(0.62 * WIDTH).round();

        let mut scene = Scene::new(&self.title);
        let mut y = header(&mut scene, &self.subtitle, figure_width)? + 8.0;
        let middle = 0.5 * (left + right);
        if !self.column_title.is_empty() {
            let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Top).muted();
            scene.text(&self.column_title, (middle, y), look);
            y += 1.5 * theme::LABEL_SIZE;
        }
        y = self.draw_column_names(&mut scene, (left, y), diameter)? + TICK + 2.0;

        let notes = self.cells.iter().flatten().any(|c| !c.note.is_empty());
        let ends: Vec<(f64, bool)> = (0..self.rows.len())
            .map(|row| match self.scale {
                ColourScale::Common => self.scale_end(0..self.rows.len()),
                ColourScale::Rows => self.scale_end(row..row + 1),
            })
            .collect();
        let clipped = ends.iter().any(|end| end.1);
        let lines = u8::from(notes) + u8::from(clipped);
        let words_depth = match lines {
            0 => 0.0,
            n => NOTE_DEPTH + f64::from(n - 1) * NOTE_LINE,
        };
        let row_height = diameter + GAP + words_depth;
        let top = y;
        for (row, name) in self.rows.iter().enumerate() {
            let centre_y = y + 0.5 * diameter;
            let look = TextLook::new(theme::TICK_SIZE, Align::Right, Level::Middle);
            scene.text(name, (left - TICK - 6.0, centre_y), look);
            let cells = &self.cells[row * self.columns.len()..][..self.columns.len()];
            for (column, cell) in cells.iter().enumerate() {
                let x = left + column as f64 * (diameter + GAP) + 0.5 * diameter;
                self.draw_disc(
                    &mut scene,
                    (x, centre_y),
                    0.5 * diameter,
                    cell.as_ref(),
                    ends[row],
                );
            }
            // A row without a disc has no colours.
            if self.scale == ColourScale::Rows && cells.iter().any(Option::is_some) {
                let place = (right + TICK + BAR_GAP, [y, y + diameter]);
                colour_bar::draw(&mut scene, place, &self.quantity, ends[row])?;
            }
            y += row_height;
        }
        y -= GAP;
        let discs = [top, y - words_depth];
        if self.scale == ColourScale::Common && self.cells.iter().any(Option::is_some) {
            let place = (right + TICK + BAR_GAP, discs);
            colour_bar::draw(&mut scene, place, &self.quantity, ends[0])?;
        }
        if !self.row_title.is_empty() {
            let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Top).muted();
            let at = (theme::MARGIN, 0.5 * (discs[0] + discs[1]));
            scene.text_upwards(&self.row_title, at, look);
        }
        y = self.draw_remarks(&mut scene, y + 10.0, figure_width, clipped)?;
        scene.width = figure_width as u32;
        scene.height = (y + theme::MARGIN).round() as u32;
        Ok(Figure::new(scene))
    }

    fn check(&self) -> Result<(), PlotError> {
        let bins = self.bins[0] * self.bins[1];
        let expected = self.rows.len() * self.columns.len();
        if expected == 0 || bins == 0 {
            return Err(PlotError::NothingToDraw {
                what: "hemispheres without rows, columns or bins".into(),
            });
        }
        if self.cells.len() != expected {
            return Err(PlotError::MismatchedLengths {
                what: "matrix of hemispheres".into(),
                found: self.cells.len(),
                expected,
            });
        }
        for cell in self.cells.iter().flatten() {
            if cell.values.len() != bins {
                return Err(PlotError::MismatchedLengths {
                    what: "hemisphere".into(),
                    found: cell.values.len(),
                    expected: bins,
                });
            }
            for (index, value) in cell.values.iter().enumerate() {
                check_finite("value of a hemisphere", index, *value)?;
            }
            check_finite("azimuth of the light", 0, cell.light_deg.unwrap_or(0.0))?;
        }
        Ok(())
    }

    /// Where the scale of some rows ends, and whether values lie beyond.
    fn scale_end(&self, rows: std::ops::Range<usize>) -> (f64, bool) {
        let n = self.columns.len();
        let cells = self.cells[rows.start * n..rows.end * n].iter().flatten();
        scale_end(self.bins, cells.map(|cell| cell.values.as_slice()))
    }

    /// Returns the y below.
    fn draw_column_names(
        &self,
        scene: &mut Scene,
        (left, top): Xy,
        diameter: f64,
    ) -> Result<f64, PlotError> {
        let look = TextLook::new(theme::TICK_SIZE, Align::Centre, Level::Top);
        let line = 1.35 * theme::TICK_SIZE;
        let names = self
            .columns
            .iter()
            .map(|name| wrap(name, theme::TICK_SIZE, diameter + GAP - 6.0))
            .collect::<Result<Vec<_>, _>>()?;
        let most = names.iter().map(Vec::len).max().unwrap_or(1);
        for (i, lines) in names.iter().enumerate() {
            let x = left + i as f64 * (diameter + GAP) + 0.5 * diameter;
            for (k, text) in lines.iter().enumerate() {
                let above = (most - lines.len() + k) as f64;
                scene.text(text, (x, top + above * line), look);
            }
        }
        Ok(top + most as f64 * line)
    }

    fn draw_disc(
        &self,
        scene: &mut Scene,
        centre: Xy,
        radius: f64,
        cell: Option<&Hemisphere>,
        (most, clipped): (f64, bool),
    ) {
        let circle = |share: f64| -> Vec<Xy> {
            (0..=90)
                .map(|i| TAU * f64::from(i) / 90.0)
                .map(|a| {
                    let r = share * radius;
                    (centre.0 + r * a.cos(), centre.1 - r * a.sin())
                })
                .collect()
        };
        let Some(cell) = cell else {
            scene.line(&circle(1.0), Pen::solid(theme::FAINT, theme::GRID_WIDTH));
            let look = TextLook::new(theme::NOTE_SIZE, Align::Centre, Level::Middle).muted();
            scene.text("not there yet", centre, look);
            return;
        };
        scene.pictures.push(Picture {
            frame: Rect {
                left: centre.0 - radius,
                top: centre.1 - radius,
                right: centre.0 + radius,
                bottom: centre.1 + radius,
            },
            columns: (2.0 * PIXELS * radius) as usize,
            pixels: disc_pixels(
                self.bins,
                &cell.values,
                (2.0 * PIXELS * radius) as usize,
                most,
            ),
            palette: palette(),
        });
        for theta in [30.0_f64, 60.0] {
            let share = SQRT_2 * (0.5 * theta.to_radians()).sin();
            scene.line(&circle(share), Pen::solid(theme::MUTED, 0.5));
        }
        scene.line(&circle(1.0), Pen::solid(theme::INK, theme::FRAME_WIDTH));
        if let Some(phi) = cell.light_deg {
            let (sin, cos) = phi.to_radians().sin_cos();
            let at = |r: f64| (centre.0 + r * cos, centre.1 - r * sin);
            let tick = [at(radius), at(radius + TICK)];
            scene.line(&tick, Pen::solid(theme::INK, 3.0));
        }
        let peak = cell.values.iter().copied().fold(0.0, f64::max);
        let peak = (clipped && peak > most).then(|| format!("peak {} /sr", three_digits(peak)));
        let note = Some(cell.note.clone()).filter(|note| !note.is_empty());
        let look = TextLook::new(theme::NOTE_SIZE, Align::Centre, Level::Top).muted();
        for (i, line) in note.into_iter().chain(peak).enumerate() {
            let below = 7.0 + NOTE_LINE * i as f64;
            scene.text(&line, (centre.0, centre.1 + radius + below), look);
        }
    }

    /// How to read the discs; returns the y below.
    fn draw_remarks(
        &self,
        scene: &mut Scene,
        top: f64,
        width: f64,
        clipped: bool,
    ) -> Result<f64, PlotError> {
        let seen = match self.side {
            Side::Reflected => "Reflected light seen from above",
            Side::Transmitted => "Transmitted light seen from above, through the surface",
        };
        let shared = match self.scale {
            ColourScale::Common => "one scale of colours for all",
            ColourScale::Rows => "a scale of colours for each row",
        };
        let ticks = match self.cells.iter().flatten().any(|c| c.light_deg.is_some()) {
            true => " The tick mark is at the azimuth of the light.",
            false => "",
        };
        let beyond = match clipped {
            true => {
                " Peaks beyond a scale of colours have one of their own, and stand beneath their discs."
            }
            false => "",
        };
        let text = format!(
            "{seen}, in equal areas; circles at 30° and 60° from the normal; {shared}.{ticks}{beyond}"
        );
        let look = TextLook::new(theme::NOTE_SIZE, Align::Left, Level::Top).muted();
        let mut y = top;
        for line in wrap(&text, theme::NOTE_SIZE, width - 2.0 * theme::MARGIN)? {
            scene.text(&line, (theme::MARGIN, y), look);
            y += 1.45 * theme::NOTE_SIZE;
        }
        Ok(y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_one(values: Vec<f64>, bins: [usize; 2]) -> Hemispheres {
        Hemispheres {
            title: "t".into(),
            subtitle: String::new(),
            quantity: "BRDF".into(),
            side: Side::Reflected,
            row_title: String::new(),
            column_title: String::new(),
            rows: vec!["r".into()],
            columns: vec!["c".into()],
            bins,
            scale: ColourScale::Common,
            cells: vec![Some(Hemisphere {
                values,
                light_deg: Some(90.0),
                note: String::new(),
            })],
        }
    }

    #[test]
    fn lengths_and_numbers_are_checked() {
        assert!(of_one(vec![1.0; 7], [2, 4]).draw().is_err());
        assert!(of_one(vec![f64::NAN; 8], [2, 4]).draw().is_err());
        assert!(of_one(vec![], [0, 4]).draw().is_err());
        let mut two = of_one(vec![1.0; 8], [2, 4]);
        two.columns.push("more".into());
        assert!(two.draw().is_err());
        two.cells.push(None);
        assert!(two.draw().unwrap().svg().unwrap().contains("not there yet"));
        // A row without a disc has no scale, be it one of its own or that of all.
        for scale in [ColourScale::Rows, ColourScale::Common] {
            let mut empty = two.clone();
            empty.scale = scale;
            empty.cells = vec![None, None];
            assert!(!empty.draw().unwrap().svg().unwrap().contains("BRDF"));
        }
        // Nothing above zero has a scale all the same.
        assert!(of_one(vec![-1.0; 8], [2, 4]).draw().is_ok());
    }
    /// One bin of 12 x 24 holds 0.04 % of the solid angle or more.
    #[test]
    fn peaks_are_named_where_a_scale_is_cut_off() {
        let svg = |peak: f64| {
            let mut values = vec![0.2; 12 * 24];
            values[100] = peak;
            of_one(values, [12, 24]).draw().unwrap().svg().unwrap()
        };
        let cut = svg(14.2);
        // At the bar and in the remark.
        assert!(cut.contains("peak 14.2 /sr") && cut.matches("beyond").count() == 2);
        let whole = svg(1.0);
        assert!(!whole.contains("peak") && !whole.contains("beyond"));
    }
}
