//! A half plane of directions: the angle from the normal and a value as the radius.

use super::curve::{Curve, Plane};
use super::geometry::{Rect, Xy};
use super::numbers::{decimals, fixed, scale_down};
use super::scene::{Align, Level, Pen, Scene, TextStyle};
use super::series::Side;
use super::text::text_width;
use super::theme;
use crate::PlotError;

/// Radius of the outer ring.
pub(crate) const RADIUS: f64 = 285.0;
/// Room around the circle for the texts of angles.
pub(crate) const ANGLE_ROOM: f64 = 48.0;
const MOST_RINGS: usize = 20;

/// One half plane and its radial scale.
pub(crate) struct HalfPlane {
    pub(crate) side: Side,
    pub(crate) origin: Xy,
    /// Value at the outer ring.
    pub(crate) full: f64,
    /// Difference of values between rings.
    pub(crate) step: f64,
    /// Radial enlargement against the other side.
    pub(crate) factor: f64,
}

/// Position of the numbers of the rings along the surface.
#[derive(Clone, Copy)]
pub(crate) struct NumberPlace {
    /// 1 to the right of the origin, -1 to the left.
    pub(crate) across: f64,
    /// 1 below the surface, -1 above.
    pub(crate) down: f64,
}

impl NumberPlace {
    /// On the other side of the origin.
    fn opposite(self) -> Self {
        Self {
            across: -self.across,
            ..self
        }
    }
}

/// The number of a ring, on a plate that keeps it readable.
struct RingNumber {
    text: String,
    plate: Rect,
}

impl Plane for HalfPlane {
    fn at(&self, theta_deg: f64, value: f64) -> Option<Xy> {
        // Compared first: the quotient of infinite or vanishing scales is not a number.
        let fraction = match value >= self.full {
            true => 1.0,
            false => (value / self.full).max(0.0),
        };
        Some(polar(self.origin, self.side, theta_deg, fraction * RADIUS))
    }

    fn floor(&self) -> f64 {
        0.0
    }

    fn clip(&self, a: Xy, b: Xy) -> Option<(Xy, Xy)> {
        Some((a, b))
    }

    fn clip_path(&self, path: &[Xy]) -> Vec<Vec<Xy>> {
        vec![path.to_vec()]
    }

    fn contains(&self, _: Xy) -> bool {
        true
    }
}

impl HalfPlane {
    fn rings(&self) -> impl Iterator<Item = f64> {
        let count = ((self.full / self.step * (1.0 + 1e-9)) as usize).min(MOST_RINGS);
        let step = self.step;
        (1..=count).map(move |i| i as f64 * step)
    }

    /// Rings at multiples of the step, spokes each 30 degrees, and their angles.
    pub(crate) fn draw_grid(&self, scene: &mut Scene) {
        let grid = Pen::solid(theme::GRID, 1.0);
        let at = |theta, radius| polar(self.origin, self.side, theta, radius);
        let arc = |radius: f64| -> Vec<Xy> {
            (-45..=45).map(|t| at(2.0 * f64::from(t), radius)).collect()
        };
        for value in self.rings() {
            scene.line(&arc(value / self.full * RADIUS), grid);
        }
        let style = TextStyle::new(theme::TICK_SIZE, Align::Centre, Level::Middle);
        for theta in [-60.0, -30.0, 0.0, 30.0, 60.0] {
            scene.line(&[self.origin, at(theta, RADIUS)], grid);
            scene.text(
                &format!("{}°", fixed(theta, 0)),
                at(theta, RADIUS + 17.0),
                style,
            );
        }
        scene.line(&arc(RADIUS), Pen::solid(theme::MUTED, theme::FRAME_WIDTH));
    }

    /// Numbers of the rings along the surface: at `place`, or at its opposite if more of them have room there. A
    /// number that would hide a point is left out.
    pub(crate) fn draw_ring_numbers(
        &self,
        scene: &mut Scene,
        place: NumberPlace,
        exponent: i32,
        curves: &[Curve],
    ) -> Result<(), PlotError> {
        let points: Vec<Xy> = curves
            .iter()
            .flat_map(|curve| curve.places(self).flatten())
            .collect();
        let mut numbers = self.ring_numbers(place, exponent, &points)?;
        let opposite = self.ring_numbers(place.opposite(), exponent, &points)?;
        if opposite.len() > numbers.len() {
            numbers = opposite;
        }
        for number in numbers {
            scene.rect(number.plate, theme::WHITE);
            let style = TextStyle::new(theme::NOTE_SIZE, Align::Centre, Level::Middle);
            scene.text(&number.text, number.plate.centre(), style.muted());
        }
        Ok(())
    }

    /// The numbers that hide no point.
    fn ring_numbers(
        &self,
        place: NumberPlace,
        exponent: i32,
        points: &[Xy],
    ) -> Result<Vec<RingNumber>, PlotError> {
        let decimals = decimals(scale_down(self.step, exponent));
        let mut numbers = Vec::new();
        for value in self.rings() {
            let text = fixed(scale_down(value, exponent), decimals);
            let at = (
                self.origin.0 + place.across * value / self.full * RADIUS,
                self.origin.1 + place.down * (0.75 * theme::NOTE_SIZE + 2.0),
            );
            let half_width = 0.5 * text_width(&text, theme::NOTE_SIZE)? + 2.0;
            let plate = Rect::around(at, half_width, 0.5 * theme::NOTE_SIZE + 1.0);
            if !points.iter().any(|point| plate.contains(*point)) {
                numbers.push(RingNumber { text, plate });
            }
        }
        Ok(numbers)
    }

    /// Names the half plane in the corner outside its circle.
    pub(crate) fn draw_side_text(&self, scene: &mut Scene) {
        let reach = RADIUS + ANGLE_ROOM - 10.0;
        let (name, y, level) = match self.side {
            Side::Reflected => ("reflected", self.origin.1 - reach, Level::Top),
            Side::Transmitted => ("transmitted", self.origin.1 + reach, Level::Baseline),
        };
        let text = match self.factor > 1.0 {
            true => format!("{name}, enlarged {:.0} times", self.factor),
            false => name.to_owned(),
        };
        let style = TextStyle::new(theme::LABEL_SIZE, Align::Left, level);
        scene.text(&text, (theme::MARGIN, y), style);
    }
}

/// Place at a signed angle and a radius in points.
pub(crate) fn polar(origin: Xy, side: Side, theta_deg: f64, radius: f64) -> Xy {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    let up = match side {
        Side::Reflected => -1.0,
        Side::Transmitted => 1.0,
    };
    (origin.0 + radius * sin, origin.1 + up * radius * cos)
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
}
