//! Profiles in the plane of incidence by component of light, one panel per measurement.

use crate::elements::axis::{Axis, extent, per_steradian_axis};
use crate::elements::curve::{Colour, Curve, Point, Style, curve_entries};
use crate::elements::directions::Directions;
use crate::elements::legend::{Entry, Key};
use crate::elements::lobe_axes::{LOBE_FRACTION, NARROW_DEG, angle_axis};
use crate::elements::page::Page;
use crate::elements::panel::{Panel, X_AXIS_DEPTH};
use crate::elements::panel_grid::PanelGrid;
use crate::elements::scene::{Align, Level, TextStyle};
use crate::elements::theme;
use crate::error::{Valid, check_length};
use crate::{Figure, PlotError};

/// One component of the light: its name in the legend, and its points in each panel.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileComponent {
    /// Its name.
    pub name: String,
    /// For each panel the points, ascending in angle; may be empty.
    pub points: Vec<Vec<Point>>,
}

/// Curves over the signed angle in the plane of incidence, panels side by side, with bands of one standard error to
/// either side.
///
/// Panels share their axes, so that they can be compared; rows of panels in which a peak outshines all else share
/// logarithmic ones. Angles are all there are, or those of a narrow lobe. A peak that is one point wide is drawn as wide as its bin. Angles are signed as everywhere here:
/// positive is forward, so that light which goes back to where it came from is at minus the angle of incidence.
///
/// ```
/// use asperity_plot::{Point, ProfileComponent, ProfileGrid};
///
/// let points = (-9..=9).map(|i| Point::with_error(10.0 * f64::from(i), 0.3, Some(0.01)));
/// let figure = ProfileGrid {
///     title: "A Lambertian surface".into(),
///     subtitle: String::new(),
///     quantity: "BRDF".into(),
///     panels: vec!["in the plane of incidence".into()],
///     light_deg: Some(-60.0),
///     mirror_deg: Some(60.0),
///     components: vec![ProfileComponent { name: "all".into(), points: vec![points.collect()] }],
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("BRDF (1/sr)"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileGrid {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// Quantity that the curves show, without its unit, 1/sr.
    pub quantity: String,
    /// Names of the panels.
    pub panels: Vec<String>,
    /// Direction of the light, signed degrees; `None` draws no line.
    pub light_deg: Option<f64>,
    /// Direction of reflection or refraction at a flat surface, signed degrees; `None` draws no line.
    pub mirror_deg: Option<f64>,
    /// The components of the light, by their number: all light first.
    pub components: Vec<ProfileComponent>,
}

const PANEL: (f64, f64) = (268.0, 210.0);
/// Width of a panel that stands alone.
const SINGLE_PANEL_WIDTH: f64 = 440.0;
const GAP: f64 = 40.0;
const MOST_IN_A_ROW: usize = 4;
const Y_AXIS_ROOM: f64 = 76.0;
/// Distance from the name of a panel to its frame.
const NAME_DEPTH: f64 = theme::LEGEND_SIZE + 10.0;
/// Times the median of what is not zero that a peak hides all else from.
const OUTSHINING: f64 = 20.0;
/// Times both of its neighbours from which a point is a peak of one bin.
const ONE_BIN: f64 = 10.0;
/// Least value of a logarithmic axis, as a fraction of its largest.
const LEAST: f64 = 1e-6;

impl ProfileGrid {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without panels or points, [`PlotError::MismatchedLengths`] if a component has
    /// not as many panels as there are, [`PlotError::OutOfRange`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let layout = self.layout();
        let page_width = (layout.right() + theme::MARGIN).max(560.0);
        let mut page = Page::new(&self.title, &self.subtitle, page_width)?;
        page.y += 8.0;
        let mut curves: Vec<Curve> = self.curves(0, -f64::MAX).collect();
        curves.extend(self.directions().guides(0.0, 1.0));
        let (notes, entries): (Vec<_>, Vec<_>) = curve_entries(&curves)
            .into_iter()
            .partition(|entry| matches!(entry.key, Key::Note));
        page.legend(entries)?;

        let top = page.y + 12.0;
        let axes = self.axes(layout.columns);
        for i in 0..self.panels.len() {
            self.draw_panel(&mut page, i, &layout, top, &axes)?;
        }
        page.y = top + layout.depth(self.panels.len()) + X_AXIS_DEPTH + 10.0;
        page.note(&self.remarks(&notes))?;
        let bottom = page.y;
        Ok(page.finish(bottom))
    }

    fn layout(&self) -> PanelGrid {
        let size = match self.panels.len() {
            1 => (SINGLE_PANEL_WIDTH, PANEL.1),
            _ => PANEL,
        };
        let name_depth = match self.panels.iter().all(String::is_empty) {
            true => 0.0,
            false => NAME_DEPTH,
        };
        PanelGrid {
            left: theme::MARGIN + Y_AXIS_ROOM,
            columns: self.panels.len().min(MOST_IN_A_ROW),
            size,
            gap: GAP,
            name_depth,
        }
    }

    /// The axes. Rows of panels in which a peak hides all else are logarithmic.
    fn axes(&self, columns: usize) -> Axes {
        let panels: Vec<usize> = (0..self.panels.len()).collect();
        let (steep, even): (Vec<&[usize]>, Vec<&[usize]>) = panels
            .chunks(columns)
            .partition(|row| outshone(&self.positive_values(row)));
        let [steep, even] = [steep.concat(), even.concat()];
        let (linear, log) = (self.linear_axis(&even), self.log_axis(&steep));
        let seen = |panels, least: f64| self.points(panels).filter(move |p| p.y > least);
        let of_even = seen(&even, LOBE_FRACTION * linear.hi);
        let angles = angle_axis(of_even.chain(seen(&steep, log.lo)), NARROW_DEG);
        Axes {
            angles,
            linear,
            log,
            steep,
        }
    }

    /// Panel `i` with its name.
    fn draw_panel(
        &self,
        page: &mut Page,
        i: usize,
        layout: &PanelGrid,
        top: f64,
        axes: &Axes,
    ) -> Result<(), PlotError> {
        let frame = layout.frame(i, top);
        let style = TextStyle::new(theme::LEGEND_SIZE, Align::Centre, Level::Top);
        let above = (frame.centre().0, frame.top - layout.name_depth);
        page.scene.text(&self.panels[i], above, style);
        let label = match i + layout.columns >= self.panels.len() {
            true => "angle from the normal θₒ (°)",
            false => "",
        };
        let angles = axes.angles.clone().with_label(label);
        let values = match i % layout.columns {
            0 => axes.of(i).clone(),
            _ => axes.of(i).clone().without_texts(),
        };
        let panel = Panel::new(frame, angles, values)?;
        let guides = self.directions().guides(panel.y.lo, panel.y.hi);
        let least = match axes.is_log(i) {
            true => 1e-3 * panel.y.lo,
            false => -f64::MAX,
        };
        let curves: Vec<Curve> = guides.chain(self.curves(i, least)).collect();
        panel.draw(&mut page.scene, &curves);
        Ok(())
    }

    /// Remarks on reading the panels; `notes` are those of the legend.
    fn remarks(&self, notes: &[Entry]) -> String {
        let mut remarks = "Angles are positive forward, away from the light.".to_owned();
        for note in notes {
            remarks = format!("{remarks} {}", note.text);
        }
        if self.is_symmetric() {
            remarks.push_str(" Left and right show the same values, averaged over azimuth.");
        }
        remarks
    }

    fn check(&self) -> Result<(), PlotError> {
        for component in &self.components {
            let what = format!("component \"{}\"", component.name);
            check_length(&what, component.points.len(), self.panels.len())?;
        }
        for panel in 0..self.panels.len() {
            let mut curves = self.curves(panel, -f64::MAX);
            curves.try_for_each(|curve| curve.check(Valid::SignedAngle))?;
        }
        let directions = [self.light_deg, self.mirror_deg];
        Valid::Finite.check_all("direction", directions.into_iter().flatten())?;
        let all: Vec<usize> = (0..self.panels.len()).collect();
        if self.points(&all).next().is_none() {
            return Err(PlotError::nothing_to_draw("profiles without a point"));
        }
        Ok(())
    }

    /// The curves of a panel; dashed components are drawn above all light, so that both show where they agree. Values below
    /// `least` become it: on a logarithmic axis a curve leaves the panel below.
    fn curves(&self, panel: usize, least: f64) -> impl Iterator<Item = Curve> {
        let raised = move |mut point: Point| {
            point.y = if point.y < least { least } else { point.y };
            point
        };
        let components = self.components.iter().enumerate();
        components.map(move |(i, component)| Curve {
            name: component.name.clone(),
            colour: Colour::Component(i),
            style: Style::Band(i),
            points: outline(&component.points[panel])
                .into_iter()
                .map(raised)
                .collect(),
        })
    }

    fn directions(&self) -> Directions {
        Directions {
            light_deg: self.light_deg,
            flat_deg: self.mirror_deg,
            flat_name: "reflection at a flat surface",
        }
    }

    /// Returns `true` if each value stands at the opposite angle as well, as for vertical light averaged over azimuth.
    fn is_symmetric(&self) -> bool {
        let profiles = self.components.iter().flat_map(|c| &c.points);
        profiles.filter(|points| points.len() > 1).all(|points| {
            let mut pairs = points.iter().zip(points.iter().rev());
            pairs.all(|(a, b)| a.y == b.y && (a.x + b.x).abs() < 1e-9)
        })
    }

    /// All points of some panels.
    fn points<'a>(&'a self, panels: &'a [usize]) -> impl Iterator<Item = &'a Point> + Clone {
        let components = self.components.iter();
        components.flat_map(|component| panels.iter().flat_map(|panel| &component.points[*panel]))
    }

    /// Values above zero in some panels, ascending.
    fn positive_values(&self, panels: &[usize]) -> Vec<f64> {
        let values = self.points(panels).map(|p| p.y);
        let mut values: Vec<f64> = values.filter(|v| *v > 0.0).collect();
        values.sort_by(f64::total_cmp);
        values
    }

    /// From zero, or from what noise makes of it, to the highest band.
    fn linear_axis(&self, panels: &[usize]) -> Axis {
        // Bands wider than their value say nothing that the scale should be made for.
        let above = |p: &Point| p.y + p.se.unwrap_or(0.0).min(p.y.abs());
        let ends = self.points(panels).flat_map(|p| [p.y, above(p)]);
        let [lo, hi] = extent(ends.chain([0.0])).unwrap_or([0.0, 1.0]);
        let hi = if hi > 0.0 { 1.04 * hi } else { 1.0 };
        per_steradian_axis(&self.quantity, lo, hi, 5)
    }

    /// From below all but the noisiest values to above the peak.
    fn log_axis(&self, panels: &[usize]) -> Axis {
        let values = self.positive_values(panels);
        let hi = 2.0 * values.last().copied().unwrap_or(1.0);
        let low = values.get(values.len() / 10).copied().unwrap_or(hi);
        let lo = (0.5 * low).clamp(LEAST * hi, 0.05 * hi);
        Axis::log10(lo, hi).with_label(&format!("{} (1/sr), logarithmic", self.quantity))
    }
}

/// The axes: of angles, of values one for all linear panels and one for all logarithmic ones.
struct Axes {
    angles: Axis,
    linear: Axis,
    log: Axis,
    /// Numbers of the logarithmic panels.
    steep: Vec<usize>,
}

impl Axes {
    fn is_log(&self, panel: usize) -> bool {
        self.steep.contains(&panel)
    }

    fn of(&self, panel: usize) -> &Axis {
        match self.is_log(panel) {
            true => &self.log,
            false => &self.linear,
        }
    }
}

/// Returns `true` if the largest of ascending values hides the others on a linear axis.
fn outshone(values: &[f64]) -> bool {
    let median = values.get(values.len() / 2).copied().unwrap_or(0.0);
    values
        .last()
        .is_some_and(|most| *most > OUTSHINING * median)
}

/// The points as corners of a curve: straight between them, but where one is far above both of its neighbours, which
/// only a peak narrower than a bin makes, it stands as wide as the bin.
fn outline(points: &[Point]) -> Vec<Point> {
    let mut corners = Vec::with_capacity(points.len());
    for (i, point) in points.iter().enumerate() {
        let neighbours = [i.checked_sub(1), Some(i + 1)].map(|k| k.and_then(|k| points.get(k)));
        let within = || neighbours.into_iter().flatten();
        let half = within()
            .map(|s| 0.5 * (s.x - point.x).abs())
            .fold(f64::INFINITY, f64::min);
        let alone = within().all(|s| point.y > ONE_BIN * s.y.max(0.0));
        if !alone || !half.is_finite() {
            corners.push(*point);
            continue;
        }
        let at = |s: &Point, side: f64| Point {
            // The bin of the last point ends at the horizon.
            x: (point.x + side * half).clamp(-90.0, 90.0),
            ..*s
        };
        let [before, after] = neighbours;
        corners.extend(before.map(|s| at(s, -1.0)));
        corners.extend([at(point, -1.0), at(point, 1.0)]);
        corners.extend(after.map(|s| at(s, 1.0)));
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(panels: usize) -> ProfileGrid {
        let sample = |x| Point::with_error(x, 0.2, Some(0.01));
        let points = vec![vec![sample(-45.0), sample(0.0), sample(40.0)]; panels];
        ProfileGrid {
            title: "t".into(),
            subtitle: String::new(),
            quantity: "BRDF".into(),
            panels: vec!["a".into(); panels],
            light_deg: None,
            mirror_deg: None,
            components: vec![ProfileComponent {
                name: "all".into(),
                points,
            }],
        }
    }

    #[test]
    fn panels_go_on_below() {
        let [one, four, five] = [1, 4, 5].map(|n| grid(n).draw().unwrap().size());
        assert!(one.0 < four.0 && one.1 == four.1);
        assert!(five.0 == four.0 && five.1 > four.1);
    }

    #[test]
    fn lengths_and_numbers_are_checked() {
        let mut short = grid(2);
        short.components[0].points.pop();
        assert!(short.draw().is_err());
        let mut bad = grid(1);
        bad.components[0].points[0][1].y = f64::INFINITY;
        assert!(bad.draw().is_err());
        assert!(grid(0).draw().is_err());
        let mut negative = grid(1);
        negative.components[0].points[0][1].y = -0.1;
        assert!(negative.draw().is_ok());
    }

    fn with_peak(value: f64) -> ProfileGrid {
        let mut grid = grid(5);
        grid.components[0].points[4][2].y = value;
        grid
    }

    #[test]
    fn rows_that_a_peak_hides_are_logarithmic() {
        let count = |value| {
            let svg = with_peak(value).draw().unwrap().svg().unwrap();
            svg.matches("logarithmic").count()
        };
        // The median of the second row is 0.2.
        assert_eq!([count(0.2), count(3.9), count(4.1)], [0, 0, 1]);
        let rows = [
            with_peak(4.1).positive_values(&[0, 1, 2, 3]),
            with_peak(4.1).positive_values(&[4]),
        ];
        assert_eq!(rows.map(|row| outshone(&row)), [false, true]);
        // Nothing but the peak: there is nothing to see.
        assert!(!outshone(&[9.0]) && !outshone(&[]));
    }

    #[test]
    fn a_peak_of_one_bin_is_as_wide_as_its_bin() {
        let outlined = |values: [f64; 5]| -> Vec<(f64, f64)> {
            let sample = |(i, value)| Point::exact(6.0 * f64::from(i) - 12.0, value);
            let points: Vec<Point> = (0i32..).zip(values).map(sample).collect();
            let corners = outline(&points);
            corners.iter().map(|s| (s.x, s.y)).collect()
        };
        let corners = outlined([0.0, 0.0, 5.0, 0.2, 0.1]);
        let peak = [(-3.0, 0.0), (-3.0, 5.0), (3.0, 5.0), (3.0, 0.2)];
        assert_eq!(corners[2..6], peak);
        assert_eq!(corners.len(), 8);
        // At the end of the range as well; a lobe of several bins stays a curve.
        assert_eq!(
            outlined([0.0, 0.0, 0.0, 0.0, 1.0])[4..],
            [(9.0, 0.0), (9.0, 1.0), (15.0, 1.0)]
        );
        assert_eq!(outlined([0.1, 2.0, 5.0, 2.0, 0.1]).len(), 5);
        assert_eq!(outlined([0.0; 5]).len(), 5);
    }

    #[test]
    fn mirrored_profiles_are_said_to_be() {
        let says = |grid: &ProfileGrid| {
            let svg = grid.draw().unwrap().svg().unwrap();
            svg.contains("averaged over azimuth")
        };
        let mut grid = grid(1);
        assert!(!says(&grid));
        grid.components[0].points[0][2].x = 45.0;
        assert!(says(&grid));
        grid.components[0].points[0][2].y = 0.3;
        assert!(!says(&grid));
    }

    /// A peak in the last bin, whose mean angle is nearer to the horizon than to the bin before.
    #[test]
    fn a_peak_at_the_horizon_stays_within_it() {
        let points = [(-40.0, 0.0), (85.0, 0.0), (88.7, 1.0)];
        let points = points
            .map(|(x, y)| Point::with_error(x, y, Some(0.01)))
            .to_vec();
        let corners = outline(&points);
        assert!(corners.iter().all(|corner| corner.x <= 90.0));
        let mut profiles = grid(1);
        profiles.components[0].points = vec![points];
        profiles.draw().unwrap();
    }
}
