//! Light in the plane of incidence, the input of lobes and curves.

use super::curve::{Colour, Curve, Point, Style};
use crate::PlotError;
use crate::error::Valid;

/// The side of the surface on which light leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Back into the medium of incidence, above the surface.
    Reflected,
    /// Through the surface, below it.
    Transmitted,
}

/// Origin of a series, which decides how it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Ray tracing on explicit surfaces: points with error bars, one for each bin.
    Explicit,
    /// The model of this number: a line. If it carries standard errors (a random walk), they are thin bars.
    Model(usize),
}

/// A named set of points (angle, cosine-weighted BSDF) on one side of the surface.
///
/// The points may come in any order. The number of a component decides the colour of an explicit series, the number
/// of a model that of its line, in every figure alike: see [`Colour`].
///
/// ```
/// use asperity_plot::{Point, Series, Side};
///
/// let bin = |theta: f64, mean: f64, se: f64| Point {
///     x: theta,
///     y: mean,
///     se: Some(se),
///     x_range: Some([theta - 2.5, theta + 2.5]),
/// };
/// // Component 0 is all light; this list of models has smith as number 3.
/// let explicit = Series::explicit("explicit, all orders", 0, Side::Reflected, vec![bin(27.5, 0.11, 0.01)]);
/// let model = Series::model("smith", 3, Side::Reflected, vec![Point::exact(27.5, 0.1)]);
/// assert_eq!(explicit.component, model.component);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Text of the legend.
    pub name: String,
    /// Side on which the light leaves.
    pub side: Side,
    /// Points or line.
    pub source: Source,
    /// Number of the component of light, 0 for all light. A model is compared with explicit series of its own
    /// component alone.
    pub component: usize,
    /// Signed angles and cosine-weighted BSDF in 1/sr; may be empty.
    pub points: Vec<Point>,
}

impl Series {
    /// A component of the light of explicit ray tracing.
    pub fn explicit(
        name: impl Into<String>,
        component: usize,
        side: Side,
        points: Vec<Point>,
    ) -> Self {
        Series {
            name: name.into(),
            side,
            source: Source::Explicit,
            component,
            points,
        }
    }

    /// A statistical model of all light.
    pub fn model(name: impl Into<String>, number: usize, side: Side, points: Vec<Point>) -> Self {
        Series {
            name: name.into(),
            side,
            source: Source::Model(number),
            component: 0,
            points,
        }
    }

    /// This series as that of one component of the light.
    #[must_use]
    pub fn of_component(self, component: usize) -> Self {
        Series { component, ..self }
    }

    pub(crate) fn is_model(&self) -> bool {
        matches!(self.source, Source::Model(_))
    }

    /// The series as it is drawn, its points from left to right. Components drawn with all light are hollow: where both
    /// lie at one place both can be seen.
    pub(crate) fn curve(&self) -> Curve {
        let (colour, style) = match (self.source, self.component) {
            (Source::Explicit, 0) => (Colour::Component(0), Style::Points(0)),
            (Source::Explicit, i) => (Colour::Component(i), Style::Hollow(i)),
            (Source::Model(i), _) => (Colour::Model(i), Style::Line(i)),
        };
        let mut points = self.points.clone();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        Curve {
            name: self.name.clone(),
            colour,
            style,
            points,
        }
    }

    /// Drawing order: components, then all light, then models, solid lines before dashed ones. Two lines at one place
    /// can both be seen.
    pub(crate) fn layer(&self) -> (bool, bool, std::cmp::Reverse<usize>) {
        let is_dashed = self.is_model() && self.curve().is_dashed();
        (
            self.is_model(),
            is_dashed,
            std::cmp::Reverse(self.component),
        )
    }
}

/// The series of some sides, checked, explicit ones first: in the order of a legend.
pub(crate) fn shown(
    series: &[Series],
    sides: impl Fn(Side) -> bool,
) -> Result<Vec<&Series>, PlotError> {
    for series in series {
        series.curve().check(Valid::SignedAngle)?;
    }
    let mut shown: Vec<&Series> = series.iter().filter(|s| sides(s.side)).collect();
    shown.sort_by_key(|series| series.is_model());
    Ok(shown)
}

/// The curves of some series in the order in which they are drawn.
pub(crate) fn stacked<'a>(series: impl Iterator<Item = &'a Series>) -> Vec<Curve> {
    let mut series: Vec<&Series> = series.collect();
    series.sort_by_key(|series| series.layer());
    series.into_iter().map(Series::curve).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::rgb::Rgb;
    use crate::elements::scene::Marker;
    use crate::elements::theme;

    fn model(number: usize) -> Curve {
        Series::model("m", number, Side::Reflected, vec![]).curve()
    }

    #[test]
    fn a_model_has_one_style_whatever_is_drawn_with_it() {
        let drawn_with = |others: &[Series], side| {
            let model = Series::model("b", 3, side, vec![]);
            let all: Vec<Series> = others.iter().cloned().chain([model]).collect();
            let curve = shown(&all, |_| true).unwrap().pop().unwrap().curve();
            (curve.colour.rgb(), curve.style)
        };
        let alone = drawn_with(&[], Side::Reflected);
        let others = [
            Series::explicit("rays", 0, Side::Reflected, vec![]),
            Series::model("a", 0, Side::Reflected, vec![]),
        ];
        assert_eq!(alone, drawn_with(&others, Side::Transmitted));
        assert_ne!(alone.0, model(0).colour.rgb());
        let all = others[0].curve();
        assert_eq!(all.colour.rgb(), Rgb(0, 0, 0));
    }

    #[test]
    fn twenty_models_have_twenty_looks() {
        for i in 0..20 {
            for j in 0..i {
                let (a, b) = (model(i), model(j));
                let dashes = theme::LINE_DASHES.len();
                assert!(
                    a.colour.rgb() != b.colour.rgb() || i % dashes != j % dashes,
                    "{i} {j}"
                );
            }
        }
    }

    /// CIE L*a*b* (D65) of a colour under a matrix on linear sRGB.
    fn lab(Rgb(r, g, b): Rgb, vision: [[f64; 3]; 3]) -> [f64; 3] {
        let linear = [r, g, b].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        });
        let times = |rows: [[f64; 3]; 3], v: [f64; 3]| {
            rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
        };
        let seen = times(vision, linear).map(|c| c.clamp(0.0, 1.0));
        let to_xyz = [
            [0.4339, 0.3762, 0.1899],
            [0.2126, 0.7152, 0.0722],
            [0.0177, 0.1095, 0.8728],
        ];
        let [x, y, z] = times(to_xyz, seen).map(|v| {
            if v > 0.008856 {
                v.cbrt()
            } else {
                7.787 * v + 16.0 / 116.0
            }
        });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Normal vision, and protanopia and deuteranopia by Machado, Oliveira and Fernandes (2009).
    const VISIONS: [[[f64; 3]; 3]; 3] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ],
    ];

    /// A distance of 2.3 is just noticeable side by side.
    #[test]
    fn models_and_components_differ_in_every_common_kind_of_colour_vision() {
        let models = (0..theme::MODEL_COLOURS.len()).map(Colour::Model);
        let colours: Vec<Rgb> = models
            .chain((0..4).map(Colour::Component))
            .map(Colour::rgb)
            .collect();
        for (i, a) in colours.iter().enumerate() {
            for b in &colours[..i] {
                for vision in VISIONS {
                    let [a, b] = [a, b].map(|colour| lab(*colour, vision));
                    let squares: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
                    assert!(squares.sqrt() > 15.0, "{a:?} {b:?} {vision:?}");
                }
            }
        }
    }

    /// Dashes tell models apart in grey.
    #[test]
    fn models_that_are_close_in_the_list_differ_without_their_colour() {
        for i in 0..theme::LINE_DASHES.len() {
            for j in 0..i {
                assert_ne!(model(i).pen().dash, model(j).pen().dash);
            }
        }
    }

    #[test]
    fn markers_do_not_wrap_around_with_the_colours() {
        for i in 0..=theme::PLAIN_COLOURS.len() {
            for j in 0..i {
                assert_ne!(Marker::nth(i), Marker::nth(j));
            }
        }
    }
}
