//! Lobe axes: ranges of angles and values around light in the plane of incidence.

use super::axis::{Axis, extent, per_steradian_axis};
use super::curve::{Curve, Point};

/// Label of the cosine-weighted BSDF, without its unit.
pub(crate) const WEIGHTED_BSDF: &str = "f |cos θₒ|";
/// Fraction of the peak above which a value belongs to the lobe.
pub(crate) const LOBE_FRACTION: f64 = 0.05;
/// Widest lobe that fills a panel, degrees, with its neighbours.
pub(crate) const NARROW_DEG: f64 = 45.0;
/// Number of ticks of a range of angles too narrow for ticks at round degrees.
const FINE_TICKS: usize = 6;

/// The points of some curves.
pub(crate) fn points<'a>(
    curves: impl IntoIterator<Item = &'a Curve> + Clone,
) -> impl Iterator<Item = &'a Point> + Clone {
    let curves = curves.into_iter().map(|curve| &curve.points);
    curves.flatten().collect::<Vec<_>>().into_iter()
}

/// The points that make the lobe of some: no noise, and not far below the peak.
pub(crate) fn of_lobe<'a>(
    points: impl Iterator<Item = &'a Point> + Clone,
) -> impl Iterator<Item = &'a Point> {
    let peak = points.clone().fold(0.0_f64, |most, p| most.max(p.y));
    let sure = move |p: &&Point| p.y - 2.0 * p.se.unwrap_or(0.0) >= LOBE_FRACTION * peak;
    points.filter(|p| p.y > 0.0).filter(sure)
}

/// All angles, or those around `points` and their bins if they are close together.
pub(crate) fn angle_axis<'a>(points: impl Iterator<Item = &'a Point>, widest: f64) -> Axis {
    let edges = points.flat_map(|p| p.x_range.unwrap_or([p.x, p.x]));
    let narrow = extent(edges).map(|[lo, hi]| {
        // The neighbours of the lobe are shown too.
        let room = match hi > lo {
            true => 0.3 * (hi - lo),
            false => 1.0,
        };
        match hi - lo > 4.0 {
            true => [(lo - room).floor(), (hi + room).ceil()],
            false => [lo - room, hi + room],
        }
    });
    let narrow = narrow.filter(|[lo, hi]| hi - lo <= widest);
    let [lo, hi] = narrow.unwrap_or([-90.0, 90.0]);
    let axis = Axis::degrees(lo.max(-90.0), hi.min(90.0));
    match axis.major.len() > 2 {
        true => axis,
        false => Axis::linear(axis.lo, axis.hi, FINE_TICKS, 0),
    }
}

/// From a little below zero, or from the lowest noise, to the peak.
pub(crate) fn value_axis<'a>(points: impl Iterator<Item = &'a Point> + Clone) -> Axis {
    let largest = |of: fn(&Point) -> f64| points.clone().map(of).fold(0.0_f64, f64::max);
    let (top, tip) = (largest(|p| p.y), largest(|p| p.bar()[1]));
    let (bottom, foot) = (-largest(|p| -p.y), -largest(|p| -p.bar()[0]));
    // Values always fit. A bar out of all proportion does not rule the scale, unless there are only bars.
    let reach = match top.max(-bottom) {
        0.0 => 2.0 * tip,
        reach => reach,
    };
    let hi = tip.min(top + 0.5 * reach);
    let lo = foot.max(bottom - 0.1 * reach);
    let span = hi - lo;
    let (lo, hi) = if span > 0.0 && span.is_finite() {
        (lo - 0.025 * span, hi + 0.05 * span)
    } else {
        (-0.025, 1.0)
    };
    per_steradian_axis(WEIGHTED_BSDF, lo, hi, 6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(points: &[Point]) -> [f64; 2] {
        let axis = angle_axis(of_lobe(points.iter()), NARROW_DEG);
        [axis.lo, axis.hi]
    }

    const LOBE: [(f64, f64); 3] = [(24.0, 0.1), (30.0, 1.0), (36.0, 0.1)];

    #[test]
    fn a_narrow_lobe_fills_the_axis_over_its_tails_and_over_noise() {
        let mut points = LOBE.map(|(x, y)| Point::exact(x, y)).to_vec();
        points.extend([Point::exact(-80.0, 0.04), Point::exact(80.0, 0.0)]);
        points.push(Point::with_error(-60.0, 0.3, Some(0.2)));
        assert_eq!(ends(&points), [20.0, 40.0]);
        // What is bright elsewhere belongs to what is shown.
        points.push(Point::with_error(-50.0, 0.3, Some(0.02)));
        assert_eq!(ends(&points), [-90.0, 90.0]);
        assert_eq!(ends(&[]), [-90.0, 90.0]);
    }

    #[test]
    fn the_width_of_the_narrowest_lobe_is_seen() {
        let point = Point {
            x_range: Some([29.995, 30.005]),
            ..Point::exact(30.0, 1.0)
        };
        let axis = angle_axis(of_lobe([point].iter()), NARROW_DEG);
        assert!(axis.hi - axis.lo < 0.017 && axis.major.len() >= 3);
    }
}
