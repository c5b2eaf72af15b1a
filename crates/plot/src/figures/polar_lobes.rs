//! Lobes around the surface, as the transmission paper draws them.

use crate::elements::axis::{
    decimals, display_exponent, per_steradian, round_step_below, scale_down,
};
use crate::elements::legend::{Entry, Key, Legend, arrow, bar_notes, series_entries};
use crate::elements::scene::{Align, Level, Pen, Rect, Scene, TextLook, Xy};
use crate::elements::series::{Look, check_finite, looks};
use crate::elements::text::{fixed, header, text_width};
use crate::elements::theme;
use crate::{Figure, PlotError, Sample, Series, SeriesKind, Side};

/// The half planes of a polar figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// The upper half plane.
    Reflected,
    /// The lower half plane.
    Transmitted,
    /// Both, each with its own radial scale where one side is much weaker; the factor is written beside it.
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

/// Intensity f |cos θₒ| as the radius, over the direction in the plane of incidence.
///
/// The surface is the horizontal line, the mean normal points up, light comes from the upper left and travels
/// towards +x. Radial numbers are true intensities on both sides, whatever the enlargement of one half.
/// Negative values (noise) sit at the origin, and so much of their bar as is positive is drawn.
///
/// ```
/// use asperity_plot::{PolarLobes, Sample, Series, Side, Sides};
///
/// let lobe = |peak: f64, centre: f64| -> Vec<Sample> {
///     (-90..=90)
///         .map(|t| Sample::exact(t.into(), peak * (-((f64::from(t) - centre) / 15.0).powi(2)).exp()))
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
///         Series::model("model", Side::Reflected, lobe(0.05, 30.0)),
///         Series::model("model", Side::Transmitted, lobe(1.5, 20.9)),
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
    /// Direction of reflection at a flat surface, signed degrees; none draws no line.
    pub flat_reflection_deg: Option<f64>,
    /// Direction of refraction at a flat surface, signed degrees from the downward normal; none draws no line.
    pub flat_refraction_deg: Option<f64>,
    /// The lobes, in order of the legend within each kind.
    pub series: Vec<Series>,
}

const FIGURE_WIDTH: f64 = 960.0;
const RADIUS: f64 = 285.0;
/// Room around the circle for the texts of angles.
const ANGLE_ROOM: f64 = 40.0;
const LEGEND_GAP: f64 = 16.0;
/// Height of the half plane that only shows the arrow.
const ARROW_ROOM: f64 = 150.0;
const CENTRE_X: f64 = theme::MARGIN + ANGLE_ROOM + RADIUS;
/// At least so many ring spacings fit below the peak.
const RINGS: f64 = 2.5;
/// The tip of the arrow keeps this distance from the origin, where the points of dark directions crowd.
const TIP_RADIUS: f64 = 6.0;

/// One half plane and its radial scale.
struct Half {
    side: Side,
    /// Intensity at the outer ring.
    full: f64,
    /// Radial enlargement against the other side.
    factor: f64,
}

impl PolarLobes {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] if no series has a sample on the chosen sides, [`PlotError::NonFinite`] and
    /// [`PlotError::OutOfRange`] for angles, values or errors without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let shown = |s: &Series| self.sides.include(s.side);
        let looks = looks(&self.series);
        let (halves, step) = self.scales();

        let mut scene = Scene::new(&self.title);
        let top = header(&mut scene, &self.subtitle, FIGURE_WIDTH)? + 12.0;
        let above = match self.sides {
            Sides::Transmitted => ARROW_ROOM,
            Sides::Reflected | Sides::Both => RADIUS + ANGLE_ROOM,
        };
        let below = match self.sides {
            Sides::Reflected => theme::TICK_SIZE + 24.0,
            Sides::Transmitted | Sides::Both => RADIUS + ANGLE_ROOM,
        };
        let origin = (CENTRE_X, top + above);

        for half in &halves {
            draw_grid(&mut scene, origin, half, step);
        }
        self.draw_flat_directions(&mut scene, origin);
        let surface = Pen::solid(theme::INK, 1.6);
        let reach = RADIUS + 6.0;
        scene.line(
            &[(origin.0 - reach, origin.1), (origin.0 + reach, origin.1)],
            surface,
        );
        for (text, x, align) in [
            ("−90°", origin.0 - reach - 5.0, Align::Right),
            ("90°", origin.0 + reach + 5.0, Align::Left),
        ] {
            let look = TextLook::new(theme::TICK_SIZE, align, Level::Middle);
            scene.text(text, (x, origin.1), look);
        }

        // Numbers lie beneath arrow and lobes, whose points they must not hide.
        // One power of ten above and below; an enlarged side has small numbers, but they stay readable.
        let exponent = display_exponent(halves.iter().fold(0.0_f64, |m, h| m.max(h.full)));
        for half in &halves {
            self.draw_ring_numbers(&mut scene, origin, half, step, exponent)?;
            self.draw_side_text(&mut scene, origin, half);
        }

        // The arrow lies beneath the lobes: it is known, they are the result.
        let incident = Pen::solid(theme::INK, 1.8);
        let start = if self.sides == Sides::Transmitted {
            (ARROW_ROOM - 12.0).min(RADIUS)
        } else {
            RADIUS
        };
        let from = polar(origin, Side::Reflected, -self.theta_i_deg, start);
        let tip = polar(origin, Side::Reflected, -self.theta_i_deg, TIP_RADIUS);
        arrow(&mut scene, from, tip, incident);

        for half in &halves {
            for kind in [SeriesKind::Explicit, SeriesKind::Model] {
                for (series, look) in self.series.iter().zip(&looks) {
                    if series.side == half.side && series.kind == kind {
                        draw_lobe(&mut scene, origin, half, series, look);
                    }
                }
            }
        }

        // The legend keeps to its own column.
        let mut entries = series_entries(&self.series, &looks, shown);
        entries.push(Entry {
            key: Key::Arrow(incident),
            text: format!("incident light, θᵢ = {}°", angle_text(self.theta_i_deg)),
        });
        if self.flat_lines().next().is_some() {
            entries.push(Entry {
                key: Key::Line(Pen::guide()),
                text: "directions at a flat surface".into(),
            });
        }
        entries.push(Entry::note(format!(
            "Radius: f |cos θₒ| {}.",
            per_steradian(exponent)
        )));
        entries.push(Entry::note(
            "Angles: from the normal of each side, forward positive.",
        ));
        entries.extend(bar_notes(&self.series, false, shown));
        let legend_left = CENTRE_X + RADIUS + ANGLE_ROOM + LEGEND_GAP;
        let legend = Legend::new(&entries, FIGURE_WIDTH - theme::MARGIN - legend_left)?;
        let legend_top = top + 4.0;
        legend.draw(&mut scene, (legend_left, legend_top));

        let bottom = (origin.1 + below).max(legend_top + legend.height());
        scene.width = FIGURE_WIDTH as u32;
        scene.height = (bottom + 0.5 * theme::MARGIN).round() as u32;
        Ok(Figure::new(scene))
    }

    fn check(&self) -> Result<(), PlotError> {
        check_finite("angle of incidence", 0, self.theta_i_deg)?;
        if !(0.0..=90.0 + 1e-6).contains(&self.theta_i_deg) {
            return Err(PlotError::OutOfRange {
                what: "angle of incidence".into(),
                range: "in [0, 90] degrees",
                index: 0,
                value: self.theta_i_deg,
            });
        }
        let flat = [self.flat_reflection_deg, self.flat_refraction_deg];
        for (index, angle) in flat.into_iter().flatten().enumerate() {
            check_finite("direction at a flat surface", index, angle)?;
        }
        for series in &self.series {
            series.check()?;
        }
        let any = |s: &Series| self.sides.include(s.side) && !s.samples.is_empty();
        if !self.series.iter().any(any) {
            return Err(PlotError::NothingToDraw {
                what: "no samples on the chosen sides of the surface".into(),
            });
        }
        Ok(())
    }

    /// Chooses the radial scales: one round step for the stronger side, and a round enlargement for the weaker.
    fn scales(&self) -> (Vec<Half>, f64) {
        let sides = [Side::Reflected, Side::Transmitted]
            .into_iter()
            .filter(|side| self.sides.include(*side));
        let peaks: Vec<(Side, f64)> = sides.map(|side| (side, self.peak(side))).collect();
        let strongest = peaks.iter().fold(0.0_f64, |m, (_, peak)| m.max(*peak));
        let (step, full) = match strongest {
            // Nothing leaves: any scale will do.
            0.0 => (0.25, 1.0),
            peak => {
                let step = round_step_below(peak / RINGS);
                (step, (1.02 * peak / step).ceil() * step)
            }
        };
        let halves = peaks
            .into_iter()
            .map(|(side, peak)| {
                let factor = if peak > 0.0 {
                    enlargement(full / peak)
                } else {
                    1.0
                };
                Half {
                    side,
                    full: full / factor,
                    factor,
                }
            })
            .collect();
        (halves, step)
    }

    /// Largest radius needed on one side: all values, and bars unless they are out of all proportion.
    fn peak(&self, side: Side) -> f64 {
        let samples = || {
            self.series
                .iter()
                .filter(|s| s.side == side)
                .flat_map(|s| &s.samples)
        };
        let top = samples().fold(0.0_f64, |m, s| m.max(s.value));
        let tip = samples().fold(0.0_f64, |m, s| m.max(s.value + s.se.unwrap_or(0.0)));
        if top > 0.0 { tip.min(1.3 * top) } else { tip }
    }

    fn flat_lines(&self) -> impl Iterator<Item = (Side, f64)> {
        [
            (Side::Reflected, self.flat_reflection_deg),
            (Side::Transmitted, self.flat_refraction_deg),
        ]
        .into_iter()
        .filter(|(side, _)| self.sides.include(*side))
        .filter_map(|(side, angle)| angle.map(|a| (side, a)))
    }

    fn draw_flat_directions(&self, scene: &mut Scene, origin: Xy) {
        for (side, angle) in self.flat_lines() {
            scene.line(&[origin, polar(origin, side, angle, RADIUS)], Pen::guide());
        }
    }

    /// Numbers of the rings, along the surface: on its empty side if there is one, else on the backward side of
    /// the half plane, where lobes are weakest.
    fn draw_ring_numbers(
        &self,
        scene: &mut Scene,
        origin: Xy,
        half: &Half,
        step: f64,
        exponent: i32,
    ) -> Result<(), PlotError> {
        let step = step / half.factor;
        let decimals = decimals(scale_down(step, exponent));
        // The arrow comes from the upper left; nothing else is ever in a half plane without lobes.
        let (across, down) = match (self.sides, half.side) {
            (Sides::Transmitted, _) => (1.0, -1.0),
            (Sides::Both, Side::Reflected) => (-1.0, -1.0),
            _ => (-1.0, 1.0),
        };
        for i in 1..=ring_count(half, step) {
            let value = i as f64 * step;
            let text = fixed(scale_down(value, exponent), decimals);
            let at = (
                origin.0 + across * value / half.full * RADIUS,
                origin.1 + down * (0.75 * theme::NOTE_SIZE + 2.0),
            );
            let half_width = 0.5 * text_width(&text, theme::NOTE_SIZE)? + 2.0;
            let half_height = 0.5 * theme::NOTE_SIZE + 1.0;
            let plate = Rect {
                left: at.0 - half_width,
                top: at.1 - half_height,
                right: at.0 + half_width,
                bottom: at.1 + half_height,
            };
            scene.polygon(plate.corners().to_vec(), theme::WHITE);
            let look = TextLook::new(theme::NOTE_SIZE, Align::Centre, Level::Middle);
            scene.text(&text, at, look.muted());
        }
        Ok(())
    }

    /// Names a half plane in the corner outside its circle.
    fn draw_side_text(&self, scene: &mut Scene, origin: Xy, half: &Half) {
        let mut text = match half.side {
            Side::Reflected => "reflected".to_owned(),
            Side::Transmitted => "transmitted".to_owned(),
        };
        if half.factor > 1.0 {
            text = format!("{text}, enlarged {:.0} times", half.factor);
        }
        let (y, level) = match half.side {
            Side::Reflected => (origin.1 - RADIUS - ANGLE_ROOM + 10.0, Level::Top),
            Side::Transmitted => (origin.1 + RADIUS + ANGLE_ROOM - 10.0, Level::Baseline),
        };
        let look = TextLook::new(theme::LABEL_SIZE, Align::Left, level);
        scene.text(&text, (theme::MARGIN, y), look);
    }
}

/// The largest of 1, 5, 10, 20, 25, 50, 100, ... not above `ratio`; factors of two would only confuse.
fn enlargement(ratio: f64) -> f64 {
    let mut best = 1.0;
    for power in 0..15 {
        for mantissa in [1.0, 2.0, 2.5, 5.0] {
            let factor = mantissa * 10f64.powi(power);
            if factor >= 5.0 && factor <= ratio * (1.0 + 1e-9) {
                best = factor;
            }
        }
    }
    best
}

fn ring_count(half: &Half, step: f64) -> usize {
    ((half.full / step * (1.0 + 1e-9)) as usize).min(20)
}

/// Place at a signed angle and a radius in points.
fn polar(origin: Xy, side: Side, theta_deg: f64, radius: f64) -> Xy {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    let up = match side {
        Side::Reflected => -1.0,
        Side::Transmitted => 1.0,
    };
    (origin.0 + radius * sin, origin.1 + up * radius * cos)
}

/// Rings at multiples of the step, spokes each 30 degrees, and their angles.
fn draw_grid(scene: &mut Scene, origin: Xy, half: &Half, step: f64) {
    let grid = Pen::solid(theme::GRID, 1.0);
    let step = step / half.factor;
    let arc = |radius: f64| -> Vec<Xy> {
        (-45..=45)
            .map(|t| polar(origin, half.side, 2.0 * f64::from(t), radius))
            .collect()
    };
    for i in 1..=ring_count(half, step) {
        scene.line(&arc(i as f64 * step / half.full * RADIUS), grid);
    }
    for i in -2..=2 {
        let theta = 30.0 * f64::from(i);
        let end = polar(origin, half.side, theta, RADIUS);
        scene.line(&[origin, end], grid);
        let at = polar(origin, half.side, theta, RADIUS + 17.0);
        let look = TextLook::new(theme::TICK_SIZE, Align::Centre, Level::Middle);
        scene.text(&format!("{}°", fixed(theta, 0)), at, look);
    }
    scene.line(&arc(RADIUS), Pen::solid(theme::MUTED, theme::FRAME_WIDTH));
}

fn draw_lobe(scene: &mut Scene, origin: Xy, half: &Half, series: &Series, look: &Look) {
    let place = |theta: f64, value: f64| {
        let radius = (value / half.full).clamp(0.0, 1.0) * RADIUS;
        polar(origin, half.side, theta, radius)
    };
    let samples = series.sorted();
    let bar = |scene: &mut Scene, sample: &Sample, pen: Pen| {
        if let Some(se) = sample.se {
            let low = place(sample.theta_deg, sample.value - se);
            let high = place(sample.theta_deg, sample.value + se);
            scene.line(&[low, high], pen);
        }
    };
    match series.kind {
        SeriesKind::Explicit => {
            for sample in &samples {
                bar(scene, sample, look.bar());
            }
            for sample in &samples {
                let at = place(sample.theta_deg, sample.value);
                scene.marker(at, look.marker, look.colour);
            }
        }
        SeriesKind::Model => {
            for sample in &samples {
                bar(
                    scene,
                    sample,
                    Pen::solid(look.colour, 0.5 * theme::BAR_WIDTH),
                );
            }
            let path: Vec<Xy> = samples
                .iter()
                .map(|s| place(s.theta_deg, s.value))
                .collect();
            scene.line(&path, look.curve());
        }
    }
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
    fn forward_light_goes_right_and_transmitted_light_down() {
        let (x, y) = polar((0.0, 0.0), Side::Transmitted, 30.0, 1.0);
        assert!(x > 0.49 && y > 0.8);
        let (x, y) = polar((0.0, 0.0), Side::Reflected, -30.0, 1.0);
        assert!(x < -0.49 && y < -0.8);
    }

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
