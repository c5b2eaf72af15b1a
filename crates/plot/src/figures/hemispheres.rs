//! Scattered light over whole hemispheres, one disc per measurement, in rows and columns.

use std::f64::consts::SQRT_2;

use crate::elements::axis::{Axis, per_steradian_axis};
use crate::elements::colour_scale::{ColourScale, bar_ticks, draw_bar};
use crate::elements::disc;
use crate::elements::disc_bins::DiscBins;
use crate::elements::geometry::{Rect, Xy};
use crate::elements::matrix::{ColumnName, stacked_at_bottom};
use crate::elements::numbers::per_steradian;
use crate::elements::page::Page;
use crate::elements::scene::{Align, Level, Pen, Picture, Scene, TextStyle};
use crate::elements::text::{widest, wrap};
use crate::elements::theme;
use crate::error::{Valid, check_length};
use crate::{Figure, PlotError, Side};

/// Discs that share their colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SharedColours {
    /// All.
    Common,
    /// Hemispheres of a row.
    Rows,
    /// All but the first, which hold ratios from -1 to 1 to it: blue and darker below zero, orange and lighter above. The first has a scale of
    /// its own.
    OverFirst {
        /// Title of the scale of ratios.
        name: &'static str,
    },
}

/// Scattered light over one hemisphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Hemisphere {
    /// Its bins.
    pub bins: DiscBins,
    /// Values of the bins in 1/sr, ring by ring from the normal of the side on which the light leaves, and within
    /// a ring by azimuth from the first edge; `None` leaves a bin blank.
    pub values: Vec<Option<f64>>,
    /// Numbers of the bins that rest on few rays: they are drawn, but do not stretch the scale.
    pub few_rays: Vec<usize>,
    /// Azimuth of the direction towards the light, degrees: the tick mark; `None` where it has no meaning.
    pub light_deg: Option<f64>,
    /// Words beneath the disc. May be empty.
    pub note: String,
}

impl Hemisphere {
    /// The values, without those of bins of few rays.
    fn values_of_many_rays(&self) -> Vec<Option<f64>> {
        let mut values = self.values.clone();
        for bin in &self.few_rays {
            if let Some(value) = values.get_mut(*bin) {
                *value = None;
            }
        }
        values
    }
}

/// A matrix of hemispheres, each a disc of equal areas: as much paper as solid angle.
///
/// Discs show the hemisphere from above, azimuth 0 to the right and 90 degrees up; transmitted light is seen
/// through the surface, light straight down in the middle. The colours of values in 1/sr are *viridis*, from zero to the
/// largest value of those that share them; values below zero, which come from noise, have the colour of zero. Where a small part of
/// the hemisphere outshines the rest by far, as mirror peaks and lobes at grazing angles do, the scale is logarithmic, over four decades
/// at most, and bins without light are white. Faint circles are at 30 and 60 degrees from the normal. Discs of a single column without
/// a name stand side by side.
///
/// ```
/// use asperity_plot::{DiscBins, SharedColours, Hemisphere, Hemispheres, Side};
///
/// let lambert = |albedo: f64| Some(Hemisphere {
///     bins: DiscBins::equal([6, 12]),
///     values: vec![Some(albedo / std::f64::consts::PI); 6 * 12],
///     few_rays: vec![],
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
///     colours: SharedColours::Common,
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
    /// Quantity that the colours show, without its unit, 1/sr.
    pub quantity: String,
    /// Side on which the light leaves.
    pub side: Side,
    /// Quantity that rows differ in. May be empty.
    pub row_title: String,
    /// Quantity that columns differ in. May be empty.
    pub column_title: String,
    /// Names of the rows, top to bottom.
    pub rows: Vec<String>,
    /// Names of the columns, left to right.
    pub columns: Vec<String>,
    /// Discs that share their colours.
    pub colours: SharedColours,
    /// The cells row by row; `None` where nothing was measured yet.
    pub cells: Vec<Option<Hemisphere>>,
}

/// Diameter of a disc with few columns and with many, points.
const DIAMETER: (f64, f64) = (150.0, 84.0);
/// Diameter of a disc of one column alone, by how many of them stand side by side.
const ALONE: [f64; 3] = [280.0, 210.0, 170.0];
/// Width that discs are made to fit into, as far as they stay large enough.
const WIDTH: f64 = 1000.0;
/// Between discs; holds the tick mark.
const GAP: f64 = 26.0;
const TICK: f64 = 10.0;
const NOTE_DEPTH: f64 = theme::NOTE_SIZE + 9.0;
const BAR_GAP: f64 = 20.0;
const BAR_WIDTH: f64 = 16.0;
/// Right of the discs.
const BAR_ROOM: f64 = 112.0;
/// Pixels of a picture per point.
const PIXELS: f64 = 2.0;

/// Places of the discs.
struct Layout {
    /// `true` if the discs of one column stand side by side, with the names of their rows above them.
    folded: bool,
    left: f64,
    /// Discs side by side.
    across: usize,
    diameter: f64,
    /// Distance from one disc to the next, along a row and from row to row.
    pitch: (f64, f64),
    /// Height of the words beneath a disc.
    words: f64,
}

impl Hemispheres {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without rows, columns or bins, [`PlotError::MismatchedLengths`] if cells or
    /// values are not as many as they should be, [`PlotError::OutOfRange`] for values without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let layout = self.layout()?;
        let width = (layout.right() + TICK + BAR_ROOM).max(0.62 * WIDTH);
        let mut page = Page::new(&self.title, &self.subtitle, width)?;
        page.y += 8.0;
        self.draw_column_names(&mut page, &layout)?;

        let top = page.y;
        let rows = self.cells.len().div_ceil(layout.across) as f64;
        let bottom = top + (rows - 1.0) * layout.pitch.1 + layout.diameter;
        let scales = self.scales();
        for (number, (cell, scale)) in self.cells.iter().zip(&scales).enumerate() {
            let centre = layout.centre(number, top);
            self.draw_cell(&mut page.scene, centre, 0.5 * layout.diameter, cell, *scale);
        }
        for (row, name) in self.rows.iter().enumerate() {
            let (x, y) = layout.centre(row * self.columns.len(), top);
            let radius = 0.5 * layout.diameter;
            let (at, align, level) = match layout.folded {
                true => ((x, y - radius - TICK - 4.0), Align::Centre, Level::Baseline),
                false => ((x - radius - TICK - 6.0, y), Align::Right, Level::Middle),
            };
            let style = TextStyle::new(theme::TICK_SIZE, align, level);
            page.scene.text(name, at, style);
        }
        self.draw_colour_bars(&mut page.scene, &layout, [top, bottom], &scales)?;
        if !layout.folded {
            let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Top).muted();
            let at = (theme::MARGIN, 0.5 * (top + bottom));
            page.scene.text_upwards(&self.row_title, at, style);
        }
        page.y = bottom + layout.words + 10.0;
        page.note(&self.remarks(&scales))?;
        let end = page.y;
        Ok(page.finish(end))
    }

    fn check(&self) -> Result<(), PlotError> {
        let cells = self.rows.len() * self.columns.len();
        if cells == 0 {
            let what = "hemispheres without rows or columns";
            return Err(PlotError::nothing_to_draw(what));
        }
        check_length("matrix of hemispheres", self.cells.len(), cells)?;
        for cell in self.cells.iter().flatten() {
            cell.bins.check()?;
            check_length("hemisphere", cell.values.len(), cell.bins.len())?;
            let values = cell.values.iter().copied().flatten();
            Valid::Finite.check_all("value of a hemisphere", values)?;
            Valid::Finite.check_all("azimuth of the light", cell.light_deg)?;
        }
        Ok(())
    }

    /// Returns `true` if there is one column without a name.
    fn is_folded(&self) -> bool {
        matches!(self.columns.as_slice(), [name] if name.is_empty())
    }

    fn layout(&self) -> Result<Layout, PlotError> {
        let notes = self.cells.iter().flatten().any(|c| !c.note.is_empty());
        let words = if notes { NOTE_DEPTH } else { 0.0 };
        let left = theme::MARGIN + theme::LABEL_SIZE + 12.0 + TICK + 6.0;
        let own_bars = self.colours == SharedColours::Rows;
        if self.is_folded() {
            let rows = self.rows.len().div_ceil(ALONE.len());
            let across = self.rows.len().div_ceil(rows);
            let diameter = ALONE[across - 1];
            let bar = if own_bars { TICK + BAR_ROOM } else { 0.0 };
            let name = theme::TICK_SIZE + TICK + 4.0;
            return Ok(Layout {
                folded: true,
                left: theme::MARGIN + TICK,
                across,
                diameter,
                pitch: (diameter + GAP + bar, diameter + GAP + words + name),
                words,
            });
        }
        let left = left + widest(&self.rows, theme::TICK_SIZE)?;
        let columns = self.columns.len() as f64;
        let free = WIDTH - left - BAR_ROOM;
        let diameter = (free / columns - GAP).floor();
        let diameter = diameter.clamp(DIAMETER.1, DIAMETER.0);
        Ok(Layout {
            folded: false,
            left,
            across: self.columns.len(),
            diameter,
            pitch: (diameter + GAP, diameter + GAP + words),
            words,
        })
    }

    /// The scale of each cell; `None` if nothing that shares it is above zero.
    fn scales(&self) -> Vec<Option<ColourScale>> {
        let shared = |cells: &[Option<Hemisphere>]| {
            let discs = || cells.iter().flatten();
            let sure: Vec<Vec<Option<f64>>> =
                discs().map(Hemisphere::values_of_many_rays).collect();
            let bins = || discs().map(|cell| &cell.bins);
            let of_sure = disc::scale(bins().zip(sure.iter().map(Vec::as_slice)));
            let of_all = || disc::scale(bins().zip(discs().map(|cell| cell.values.as_slice())));
            vec![of_sure.or_else(of_all); cells.len()]
        };
        match self.colours {
            SharedColours::Common => shared(&self.cells),
            SharedColours::Rows => {
                let rows = self.cells.chunks(self.columns.len());
                rows.flat_map(shared).collect()
            }
            SharedColours::OverFirst { .. } => {
                let mut scales = shared(&self.cells[..1]);
                scales.resize(self.cells.len(), Some(ColourScale::RATIOS));
                scales
            }
        }
    }

    fn draw_column_names(&self, page: &mut Page, layout: &Layout) -> Result<(), PlotError> {
        let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Top).muted();
        let title = match layout.folded {
            true => &self.row_title,
            false => &self.column_title,
        };
        if !title.is_empty() {
            let middle = 0.5 * (layout.left + layout.right());
            page.scene.text(title, (middle, page.y), style);
            page.y += 1.5 * theme::LABEL_SIZE;
        }
        if layout.folded {
            // The names of the first row of discs.
            page.y += theme::TICK_SIZE + TICK + 4.0;
            return Ok(());
        }
        let room = layout.diameter + GAP - 6.0;
        let names = self.columns.iter().enumerate().map(|(i, name)| {
            let lines = wrap(name, theme::TICK_SIZE, room)?;
            let (x, _) = layout.centre(i, 0.0);
            Ok(ColumnName { x, lines })
        });
        let names = names.collect::<Result<Vec<_>, PlotError>>()?;
        let depth = stacked_at_bottom(&mut page.scene, page.y, &names, theme::TICK_SIZE);
        page.y += depth + TICK + 2.0;
        Ok(())
    }

    fn draw_cell(
        &self,
        scene: &mut Scene,
        centre: Xy,
        radius: f64,
        cell: &Option<Hemisphere>,
        scale: Option<ColourScale>,
    ) {
        let Some(cell) = cell else {
            scene.circle(centre, radius, Pen::solid(theme::FAINT, theme::GRID_WIDTH));
            let style = TextStyle::new(theme::NOTE_SIZE, Align::Centre, Level::Middle).muted();
            scene.text("not measured yet", centre, style);
            return;
        };
        let lit = cell.values.iter().any(Option::is_some);
        if let Some(scale) = scale.filter(|_| lit) {
            let columns = (2.0 * PIXELS * radius) as usize;
            scene.pictures.push(Picture {
                frame: Rect::around(centre, radius, radius),
                columns,
                pixels: disc::pixels(&cell.bins, &cell.values, columns, &scale),
                palette: disc::palette(&scale),
            });
        } else {
            // Without a value above zero there is no scale: colours would have no meaning.
            let style = TextStyle::new(theme::NOTE_SIZE, Align::Centre, Level::Middle).muted();
            scene.text("no light", centre, style);
        }
        for theta in [30.0_f64, 60.0] {
            let fraction = SQRT_2 * (0.5 * theta.to_radians()).sin();
            scene.circle(centre, fraction * radius, Pen::solid(theme::MUTED, 0.5));
        }
        scene.circle(centre, radius, Pen::solid(theme::INK, theme::FRAME_WIDTH));
        if let Some(phi) = cell.light_deg {
            let (sin, cos) = phi.to_radians().sin_cos();
            let at = |r: f64| (centre.0 + r * cos, centre.1 - r * sin);
            let tick = [at(radius), at(radius + TICK)];
            scene.line(&tick, Pen::solid(theme::INK, 3.0));
        }
        let style = TextStyle::new(theme::NOTE_SIZE, Align::Centre, Level::Top).muted();
        scene.text(&cell.note, (centre.0, centre.1 + radius + 7.0), style);
    }

    /// The bars of all scales between `top` and `bottom`, right of the discs; `scales` are those of the cells.
    fn draw_colour_bars(
        &self,
        scene: &mut Scene,
        layout: &Layout,
        [top, bottom]: [f64; 2],
        scales: &[Option<ColourScale>],
    ) -> Result<(), PlotError> {
        let left = layout.right() + TICK + BAR_GAP;
        let bar = |from: f64, to: f64| Rect::at((left, from), BAR_WIDTH, to - from);
        match self.colours {
            SharedColours::Common => self.draw_colour_bar(scene, bar(top, bottom), scales[0]),
            SharedColours::Rows => {
                let columns = self.columns.len();
                for (number, scale) in scales.iter().enumerate().skip(columns - 1).step_by(columns)
                {
                    let (x, y) = layout.centre(number, top);
                    let corner = (
                        x + 0.5 * layout.diameter + TICK + BAR_GAP,
                        y - 0.5 * layout.diameter,
                    );
                    let bar = Rect::at(corner, BAR_WIDTH, layout.diameter);
                    self.draw_colour_bar(scene, bar, *scale)?;
                }
                Ok(())
            }
            SharedColours::OverFirst { name } => {
                let middle = 0.5 * (top + bottom);
                self.draw_colour_bar(scene, bar(top, middle - 0.5 * GAP), scales[0])?;
                let ratios = bar(middle + 0.5 * GAP, bottom);
                let ColourScale { lo, hi, .. } = ColourScale::RATIOS;
                let axis = bar_ticks(ratios.height(), |n| Axis::linear(lo, hi, n, 0));
                draw_bar(scene, ratios, ColourScale::RATIOS.colours, &axis, &[name])
            }
        }
    }

    /// The bar of a scale of values in 1/sr, if there is one.
    fn draw_colour_bar(
        &self,
        scene: &mut Scene,
        bar: Rect,
        scale: Option<ColourScale>,
    ) -> Result<(), PlotError> {
        let Some(ColourScale {
            lo,
            hi,
            log,
            colours,
        }) = scale
        else {
            return Ok(());
        };
        let axis = match log {
            true => {
                Axis::log10(lo, hi).with_label(&format!("{} {}", self.quantity, per_steradian(0)))
            }
            false => bar_ticks(bar.height(), |n| {
                per_steradian_axis(&self.quantity, lo, hi, n)
            }),
        };
        draw_bar(scene, bar, colours, &axis, &[&axis.label])
    }

    /// Remarks on reading the discs.
    fn remarks(&self, scales: &[Option<ColourScale>]) -> String {
        let seen = match self.side {
            Side::Reflected => "Reflected light seen from above",
            Side::Transmitted => "Transmitted light seen from above, through the surface",
        };
        let shared = match self.colours {
            SharedColours::Common => "one colour scale for all",
            SharedColours::Rows if self.is_folded() => "a colour scale for each disc",
            SharedColours::Rows => "one colour scale per row",
            SharedColours::OverFirst { .. } => {
                "the first disc has a colour scale of its own, the others share one, on which grey is zero, and darker is below"
            }
        };
        let logarithmic = match scales.iter().flatten().any(|scale| scale.log) {
            true => ", logarithmic where a peak would hide the rest",
            false => "",
        };
        let ticks = match self.cells.iter().flatten().any(|c| c.light_deg.is_some()) {
            true => " The tick mark is at the azimuth of the light.",
            false => "",
        };
        let mut cells = self.cells.iter().zip(scales);
        let is_blank = cells.any(|(cell, scale)| {
            let values = cell.iter().flat_map(|cell| &cell.values);
            values
                .into_iter()
                .any(|value| !disc::is_shown(*value, *scale))
        });
        let blank = match (is_blank, self.colours) {
            (false, _) => "",
            (true, SharedColours::OverFirst { .. }) => {
                " Bins without light, or with too few rays for a ratio, are left white."
            }
            (true, _) => " Bins without light are left white.",
        };
        format!(
            "{seen}, in equal areas, azimuth 0° to the right and 90° up; circles at 30° and 60° from the normal; \
             {shared}{logarithmic}.{ticks}{blank}"
        )
    }
}

impl Layout {
    /// Middle of a disc, by its number.
    fn centre(&self, number: usize, top: f64) -> Xy {
        let (row, column) = (number / self.across, number % self.across);
        let radius = 0.5 * self.diameter;
        (
            self.left + column as f64 * self.pitch.0 + radius,
            top + row as f64 * self.pitch.1 + radius,
        )
    }

    /// Right end of the last disc of a row.
    fn right(&self) -> f64 {
        self.left + (self.across - 1) as f64 * self.pitch.0 + self.diameter
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
            colours: SharedColours::Common,
            cells: vec![Some(Hemisphere {
                bins: DiscBins::equal(bins),
                values: values.into_iter().map(Some).collect(),
                few_rays: vec![],
                light_deg: Some(90.0),
                note: String::new(),
            })],
        }
    }

    #[test]
    fn bins_of_few_rays_do_not_stretch_the_scale() {
        let mut values = vec![1.0; 8];
        values[3] = 6.0;
        let mut figure = of_one(values, [2, 4]);
        let top = |figure: &Hemispheres| figure.scales()[0].as_ref().map(|scale| scale.hi);
        assert_eq!(top(&figure), Some(6.0));
        let set = |figure: &mut Hemispheres, bins: Vec<usize>| {
            figure.cells[0].as_mut().unwrap().few_rays = bins;
        };
        set(&mut figure, vec![3]);
        assert_eq!(top(&figure), Some(1.0));
        // If all bins rest on few rays, the scale covers all of them.
        set(&mut figure, (0..8).collect());
        assert_eq!(top(&figure), Some(6.0));
    }

    #[test]
    fn discs_of_one_column_without_a_name_stand_side_by_side() {
        let size = |rows: usize, name: &str| {
            let mut figure = of_one(vec![1.0; 8], [2, 4]);
            figure.colours = SharedColours::Rows;
            figure.columns = vec![name.into()];
            figure.rows = vec!["r".into(); rows];
            figure.cells = vec![figure.cells[0].clone(); rows];
            figure.row_title = "angle".into();
            let remarks = figure.remarks(&figure.scales());
            assert_eq!(remarks.contains("for each disc"), name.is_empty());
            let figure = figure.draw().unwrap();
            // The title of rows runs upwards beside those of bars where there are rows
            let upwards = figure.svg().unwrap().matches("rotate(").count();
            assert_eq!(upwards, rows + usize::from(!name.is_empty()));
            figure.size()
        };
        assert!(size(4, "").1 < size(4, "n").1 && size(4, "").0 > size(4, "n").0);
        let (width, height) = size(6, "");
        assert!(width > height, "{width} {height}");
        // One disc fills a good part of its page.
        assert!(size(1, "").1 > size(1, "n").1);
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
        assert!(
            two.draw()
                .unwrap()
                .svg()
                .unwrap()
                .contains("not measured yet")
        );
        // A row without a disc has no scale, neither its own nor a common one.
        for scale in [SharedColours::Rows, SharedColours::Common] {
            let mut empty = two.clone();
            empty.colours = scale;
            empty.cells = vec![None, None];
            assert!(!empty.draw().unwrap().svg().unwrap().contains("BRDF"));
        }
        // Without a value above zero colours would have no meaning.
        let dark = of_one(vec![-1.0; 8], [2, 4]).draw().unwrap();
        assert!(dark.svg().unwrap().contains("no light"));
    }

    fn ratios(first: Option<f64>, second: Option<f64>) -> Hemispheres {
        let mut figure = of_one(vec![0.0; 8], [2, 4]);
        let mut second_cell = figure.cells[0].clone();
        for (cell, value) in [(&mut figure.cells[0], first), (&mut second_cell, second)] {
            cell.as_mut().unwrap().values = vec![value; 8];
        }
        figure.cells.push(second_cell);
        figure.columns.push("second".into());
        figure.colours = SharedColours::OverFirst { name: "over all" };
        figure
    }

    #[test]
    fn ratios_have_a_scale_around_zero_and_the_first_disc_its_own() {
        let figure = ratios(Some(0.3), Some(0.0));
        let own = Some(ColourScale::linear(0.0, 0.3));
        assert_eq!(figure.scales(), [own, Some(ColourScale::RATIOS)]);
        let svg = figure.draw().unwrap().svg().unwrap();
        for text in ["BRDF (", "over all", "−1.0", "grey is zero"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("left white") && !svg.contains("no light"));
        let svg = |first, second| ratios(first, second).draw().unwrap().svg().unwrap();
        let dark = svg(Some(0.0), None);
        assert_eq!(dark.matches("no light").count(), 2);
        // A bin whose ratios rest on too few rays has light, but no ratio.
        let blank = svg(Some(0.3), None);
        assert!(blank.contains("left white") && blank.contains("few rays"));
    }

    /// One bin of 12 x 24 holds 0.04 % of the solid angle or more.
    #[test]
    fn scales_are_logarithmic_where_a_peak_would_hide_the_rest() {
        let svg = |peak: f64| {
            let mut values = vec![0.2; 12 * 24];
            values[100] = peak;
            of_one(values, [12, 24]).draw().unwrap().svg().unwrap()
        };
        let log = svg(14.2);
        assert!(log.contains("logarithmic") && log.contains("10²"));
        assert!(!svg(1.0).contains("logarithmic"));
    }
}
