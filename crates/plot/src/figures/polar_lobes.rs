//! Lobes around the surface, as the transmission paper draws them.

use crate::elements::axis::Axis;
use crate::elements::curve::{Curve, Style, curve_entries, draw_curves};
use crate::elements::geometry::{Rect, Xy};
use crate::elements::legend::{Entry, Key, Legend};
use crate::elements::lobe_axes::{angle_axis, of_lobe, points, value_axis};
use crate::elements::numbers::{display_exponent, fixed, per_steradian, round_step_below};
use crate::elements::page::Page;
use crate::elements::panel::{Panel, X_AXIS_DEPTH, y_axis_room};
use crate::elements::polar::{ANGLE_ROOM, HalfPlane, NumberPlace, RADIUS, polar};
use crate::elements::scene::{Align, Level, Pen, Scene, TextStyle};
use crate::elements::series::{shown, stacked};
use crate::elements::theme;
use crate::error::Valid;
use crate::{Figure, PlotError, Series, Side};

/// The half planes of a polar figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// The upper half plane.
    Reflected,
    /// The lower half plane.
    Transmitted,
    /// Both, each with its own radial scale where one side is much weaker; the factor is written next to it.
    Both,
}

impl Sides {
    fn include(self, side: Side) -> bool {
        match self {
            Sides::Both => true,
            Sides::Reflected => side == Side::Reflected,
            Sides::Transmitted => side == Side::Transmitted,
        }
    }
}

/// Cosine-weighted BSDF f |cos θₒ| as the radius, over the direction in the plane of incidence.
///
/// The surface is the horizontal line, the mean normal points up, light comes from the upper left and travels
/// towards +x. Radial numbers are true values on both sides, whatever the enlargement of one half.
/// Negative values (noise) sit at the origin, and so much of their bar as is positive is drawn. A lobe so narrow that its width is
/// hardly seen is drawn once more, over straight axes, below the legend.
///
/// ```
/// use asperity_plot::{Point, PolarLobes, Series, Side, Sides};
///
/// let lobe = |peak: f64, centre: f64| -> Vec<Point> {
///     (-90..=90)
///         .map(|t| Point::exact(t.into(), peak * (-((f64::from(t) - centre) / 15.0).powi(2)).exp()))
///         .collect()
/// };
/// let figure = PolarLobes {
///     title: "Lobes".into(),
///     subtitle: "n = 1.4, s = 3".into(),
///     theta_i_deg: 30.0,
///     sides: Sides::Both,
///     flat_reflection_deg: Some(30.0),
///     flat_refraction_deg: Some(20.9),
///     series: vec![
///         Series::model("model", 0, Side::Reflected, lobe(0.05, 30.0)),
///         Series::model("model", 0, Side::Transmitted, lobe(1.5, 20.9)),
///     ],
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("reflected, enlarged 25 times"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PolarLobes {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// Angle of incidence in degrees, in [0, 90].
    pub theta_i_deg: f64,
    /// Half planes to draw; series of other sides are left out.
    pub sides: Sides,
    /// Direction of reflection at a flat surface, signed degrees; `None` draws no line.
    pub flat_reflection_deg: Option<f64>,
    /// Direction of refraction at a flat surface, signed degrees from the downward normal; `None` draws no line.
    pub flat_refraction_deg: Option<f64>,
    /// The lobes, in order of the legend within explicit ones and models.
    pub series: Vec<Series>,
}

const FIGURE_WIDTH: f64 = 970.0;
const LEGEND_GAP: f64 = 14.0;
/// Height of the half plane that only shows the arrow.
const ARROW_ROOM: f64 = 150.0;
const CENTRE_X: f64 = theme::MARGIN + ANGLE_ROOM + RADIUS;
/// The peak is at least this many ring spacings from the origin.
const MIN_RINGS: f64 = 2.0;
/// The tip of the arrow keeps this distance from the origin, where the points of dark directions crowd.
const TIP_RADIUS: f64 = 6.0;
/// The line of the surface ends so far beyond the circle.
const SURFACE_END: f64 = 6.0;

/// Widest lobe, degrees with its neighbours, that is drawn once more.
const NARROW_DEG: f64 = 20.0;
const DETAIL_HEIGHT: f64 = 130.0;
const DETAIL_TICKS: usize = 5;
/// Between the legend and the details.
const DETAIL_GAP: f64 = 22.0;

/// Room above and below the line of the surface.
struct Heights {
    above: f64,
    below: f64,
}

impl PolarLobes {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] if no series has a point on the chosen sides, [`PlotError::OutOfRange`] for angles, values or errors without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        let series = shown(&self.series, |side| self.sides.include(side))?;
        self.check(&series)?;
        let mut page = Page::new(&self.title, &self.subtitle, FIGURE_WIDTH)?;
        let top = page.y + 12.0;
        let Heights { above, below } = self.heights();
        let origin = (CENTRE_X, top + above);
        let halves = self.halves(&series, origin);
        // One power of ten above and below; an enlarged side has small numbers, but they stay readable.
        let exponent = display_exponent(halves.iter().fold(0.0_f64, |m, h| m.max(h.full)));

        let scene = &mut page.scene;
        for half in &halves {
            half.draw_grid(scene);
        }
        self.draw_surface_and_light(scene, origin);
        let of_side = |side| stacked(series.iter().copied().filter(|s| s.side == side));
        for half in &halves {
            half.draw_side_text(scene);
            let guide = self.flat_direction(half.side, half.full);
            let mut curves = of_side(half.side);
            for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
                point.x_range = None;
            }
            draw_curves(scene, half, guide.iter().chain(&curves));
            half.draw_ring_numbers(scene, self.number_place(half.side), exponent, &curves)?;
        }

        // The legend keeps to its own column.
        let legend_left = CENTRE_X + RADIUS + ANGLE_ROOM + LEGEND_GAP;
        let entries = self.entries(&series, exponent);
        let legend = Legend::column(entries, FIGURE_WIDTH - theme::MARGIN - legend_left)?;
        let legend_top = top + 4.0;
        legend.draw(scene, (legend_left, legend_top));
        page.y = legend_top + legend.height;
        for side in halves.iter().map(|half| half.side) {
            self.draw_detail(&mut page, legend_left, side, &of_side(side))?;
        }
        let bottom = (origin.1 + below).max(page.y);
        Ok(page.finish(bottom - 0.5 * theme::MARGIN))
    }

    /// A narrow lobe over straight axes, below what the page holds so far.
    fn draw_detail(
        &self,
        page: &mut Page,
        left: f64,
        side: Side,
        curves: &[Curve],
    ) -> Result<(), PlotError> {
        let x = angle_axis(of_lobe(points(curves)), NARROW_DEG);
        if x.hi - x.lo > NARROW_DEG {
            return Ok(());
        }
        let x = Axis::linear(x.lo, x.hi, DETAIL_TICKS, 0);
        let name = match side {
            Side::Reflected => "reflected, over the angle",
            Side::Transmitted => "transmitted, over the angle",
        };
        let style = TextStyle::new(theme::LEGEND_SIZE, Align::Left, Level::Top);
        page.y += DETAIL_GAP;
        page.scene.text(name, (left, page.y), style);
        let y = value_axis(points(curves));
        let corner = (left + y_axis_room(&y)?, page.y + theme::LEGEND_SIZE + 10.0);
        let width = page.width - theme::MARGIN - corner.0;
        let frame = Rect::at(corner, width, DETAIL_HEIGHT);
        let guide = self.flat_direction(side, y.hi);
        let panel = Panel::new(frame, x.with_label("θₒ (°)"), y)?;
        panel.draw(&mut page.scene, guide.iter().chain(curves));
        page.y = frame.bottom + X_AXIS_DEPTH;
        Ok(())
    }

    fn check(&self, series: &[&Series]) -> Result<(), PlotError> {
        let what = "angle of incidence";
        Valid::SignedAngle.check(what, 0, self.theta_i_deg)?;
        Valid::NotNegative.check(what, 0, self.theta_i_deg)?;
        let flat = [self.flat_reflection_deg, self.flat_refraction_deg];
        Valid::Finite.check_all("direction at a flat surface", flat.into_iter().flatten())?;
        if series.iter().all(|s| s.points.is_empty()) {
            let what = "no points on the chosen sides of the surface";
            return Err(PlotError::nothing_to_draw(what));
        }
        Ok(())
    }

    /// Room above and below the line of the surface.
    fn heights(&self) -> Heights {
        let lobes = RADIUS + ANGLE_ROOM;
        let (above, below) = match self.sides {
            Sides::Reflected => (lobes, theme::TICK_SIZE + 24.0),
            Sides::Transmitted => (ARROW_ROOM, lobes),
            Sides::Both => (lobes, lobes),
        };
        Heights { above, below }
    }

    /// Chooses the radial scales: one round step for the stronger side, and a round enlargement for the weaker.
    fn halves(&self, series: &[&Series], origin: Xy) -> Vec<HalfPlane> {
        let sides = [Side::Reflected, Side::Transmitted].into_iter();
        let sides = sides.filter(|side| self.sides.include(*side));
        let peaks: Vec<(Side, f64)> = sides.map(|side| (side, peak(series, side))).collect();
        let strongest = peaks.iter().fold(0.0_f64, |m, (_, peak)| m.max(*peak));
        let (step, full) = match strongest {
            // Nothing leaves: any scale will do.
            0.0 => (0.25, 1.0),
            peak => {
                let step = round_step_below(peak / MIN_RINGS);
                // The outer circle may lie halfway between two rings, so that the lobe fills it.
                let half = 0.5 * step;
                (step, (1.02 * peak / half).ceil() * half)
            }
        };
        let half = |(side, peak): (Side, f64)| {
            let factor = if peak > 0.0 {
                enlargement(full / peak)
            } else {
                1.0
            };
            HalfPlane {
                side,
                origin,
                full: full / factor,
                step: step / factor,
                factor,
            }
        };
        peaks.into_iter().map(half).collect()
    }

    /// The guide line of a side, out to the radius of `full`.
    fn flat_direction(&self, side: Side, full: f64) -> Option<Curve> {
        let angle = match side {
            Side::Reflected => self.flat_reflection_deg,
            Side::Transmitted => self.flat_refraction_deg,
        };
        let name = "directions at a flat surface";
        Some(Curve::guide(
            name,
            Style::Guide,
            [(angle?, 0.0), (angle?, full)],
        ))
    }

    /// The surface, and the arrow of the light, which lies beneath the lobes: it is known, they are the result.
    fn draw_surface_and_light(&self, scene: &mut Scene, origin: Xy) {
        let reach = RADIUS + SURFACE_END;
        let ends = [(origin.0 - reach, origin.1), (origin.0 + reach, origin.1)];
        scene.line(&ends, Pen::solid(theme::INK, 1.6));
        // Far enough from the circle to leave room for the number of the outer ring.
        for (text, side, align) in [("−90°", -1.0, Align::Right), ("90°", 1.0, Align::Left)] {
            let style = TextStyle::new(theme::TICK_SIZE, align, Level::Middle);
            let gap = if side < 0.0 { 18.0 } else { 5.0 };
            scene.text(text, (origin.0 + side * (reach + gap), origin.1), style);
        }
        let start = match self.sides {
            Sides::Transmitted => (ARROW_ROOM - 12.0).min(RADIUS),
            Sides::Reflected | Sides::Both => RADIUS,
        };
        let at = |radius| polar(origin, Side::Reflected, -self.theta_i_deg, radius);
        scene.arrow(at(start), at(TIP_RADIUS), light_pen());
    }

    fn entries(&self, series: &[&Series], exponent: i32) -> Vec<Entry> {
        let of_series = series.iter().map(|s| s.curve());
        let sides = [Side::Reflected, Side::Transmitted].into_iter();
        let guides = sides
            .filter(|side| self.sides.include(*side))
            .filter_map(|side| self.flat_direction(side, 1.0));
        let curves: Vec<Curve> = of_series.chain(guides).collect();
        let theta = angle_text(self.theta_i_deg);
        let mut entries = vec![Entry::new(
            Key::Arrow(light_pen()),
            format!("incident light, θᵢ = {theta}°"),
        )];
        entries.extend(curve_entries(&curves));
        let unit = per_steradian(exponent);
        entries.push(Entry::note(format!(
            "Radius: f |cos θₒ| {unit}, the cosine-weighted BSDF."
        )));
        entries.push(Entry::note(
            "Angles: from the normal of each side, forward positive.",
        ));
        entries
    }

    /// Position of the numbers of the rings along the surface, if they have room: on its empty side if there is
    /// one, else on the backward side of the half plane, where lobes are weakest. The arrow comes from the upper
    /// left.
    fn number_place(&self, side: Side) -> NumberPlace {
        let (across, down) = match (self.sides, side) {
            (Sides::Transmitted, _) => (1.0, -1.0),
            (Sides::Both, Side::Reflected) => (-1.0, -1.0),
            _ => (-1.0, 1.0),
        };
        NumberPlace { across, down }
    }
}

/// Largest radius needed on one side: all values, and bars unless they are out of all proportion.
fn peak(series: &[&Series], side: Side) -> f64 {
    let points = || {
        let of_side = series.iter().filter(|s| s.side == side);
        of_side.flat_map(|s| &s.points)
    };
    let top = points().fold(0.0_f64, |m, p| m.max(p.y));
    let tip = points().fold(0.0_f64, |m, p| m.max(p.bar()[1]));
    if top > 0.0 { tip.min(1.3 * top) } else { tip }
}

fn light_pen() -> Pen {
    Pen::solid(theme::INK, 1.8)
}

/// The largest of 1, 5, 10, 20, 25, 40, 50, 100, ... not above `ratio`; smaller factors would only confuse.
fn enlargement(ratio: f64) -> f64 {
    let mut best = 1.0;
    for power in 0..15 {
        for mantissa in [1.0, 2.0, 2.5, 4.0, 5.0] {
            let factor = mantissa * 10f64.powi(power);
            if factor >= 5.0 && factor <= ratio * (1.0 + 1e-9) {
                best = factor;
            }
        }
    }
    best
}

/// Degrees with as many decimals as needed, three at most.
fn angle_text(degrees: f64) -> String {
    let text = fixed(degrees, 3);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enlargements_are_round_and_never_too_large() {
        for (ratio, factor) in [
            (1.0, 1.0),
            (4.9, 1.0),
            (5.0, 5.0),
            (39.0, 25.0),
            (1e30, 5e14),
        ] {
            assert_eq!(enlargement(ratio), factor, "{ratio}");
        }
    }
}
