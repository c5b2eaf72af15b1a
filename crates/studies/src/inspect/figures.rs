//! The figures of an inspected surface.

use asperity_plot::{Colour, Curve, CurveAxis, Curves, LogCurves, Point, Style};
use asperity_surface::LengthUnit;

use super::{Texture, ggx, normal};

/// Densities below this part of the largest are rounding, and are not drawn.
const DRAWN: f64 = 1e-14;

/// Points of the smooth curve beside a histogram, less one.
const STEPS: usize = 200;

impl Texture {
    /// Spectrum; `None` if it is zero.
    pub(super) fn spectrum_figure(&self, name: &str) -> Option<LogCurves> {
        let rows = || self.spectrum.iter();
        let peak = rows().fold(0.0_f64, |peak, row| peak.max(row.ring.density));
        let is_shown = move |density: &f64| *density > DRAWN * peak && *density > 0.0;
        let measured = rows().filter(|row| is_shown(&row.ring.density));
        let measured: Vec<Point> = measured
            .map(|row| Point::exact(row.ring.k, row.ring.density))
            .collect();
        if measured.is_empty() {
            return None;
        }
        let requested = rows().filter_map(|row| {
            let density = row.requested.filter(is_shown)?;
            Some(Point::exact(row.ring.k, density))
        });
        let requested: Vec<Point> = requested.collect();
        let mut curves = vec![line("this surface", 0, measured)];
        if !requested.is_empty() {
            curves.push(line("requested", 1, requested));
        }
        Some(LogCurves {
            title: "Power spectral density, mean over azimuths".into(),
            subtitle: name.to_owned(),
            x: format!("wave vector k (rad/{})", self.length()),
            y: format!("W ({}⁴)", self.length()),
            curves,
            notes: Vec::new(),
        })
    }

    pub(super) fn correlation_figure(&self, name: &str) -> Curves {
        let points = |values: &[f64], spacing: f64| -> Vec<Point> {
            let lags = values.iter().enumerate();
            let normalised = |(i, value): (usize, &f64)| {
                Point::exact(i as f64 * spacing, value / (self.sq * self.sq))
            };
            lags.map(normalised).collect()
        };
        let [dx, dy] = self.spacing;
        Curves {
            title: "Autocorrelation of heights over Sq²".into(),
            subtitle: name.to_owned(),
            x: axis(&format!("lag ({})", self.length())),
            y: axis("C / Sq²"),
            curves: vec![
                line("along x", 0, points(&self.correlation.along_x, dx)),
                line("along y", 1, points(&self.correlation.along_y, dy)),
            ],
            notes: Vec::new(),
        }
    }

    pub(super) fn heights_figure(&self, name: &str) -> Curves {
        let found = self.heights.middles().map(|(x, y)| Point::exact(x, y));
        let ends = [
            self.heights.lowest,
            self.heights.lowest + self.heights.width * self.heights.densities.len() as f64,
        ];
        Curves {
            title: "Heights about their mean".into(),
            subtitle: name.to_owned(),
            x: axis(&format!("height ({})", self.length())),
            y: axis(&format!("probability density (1/{})", self.length())),
            curves: vec![
                line("samples", 0, found.collect()),
                beside("normal, same Sq", ends, self.sq * self.sq),
            ],
            notes: Vec::new(),
        }
    }

    pub(super) fn slopes_figure(&self, name: &str) -> Curves {
        let [x, y] = &self.slopes;
        let found = |of: &asperity_surface::Histogram| -> Vec<Point> {
            of.middles().map(|(x, y)| Point::exact(x, y)).collect()
        };
        let outside = x.outside.max(y.outside);
        let notes = match outside > 0.0 {
            true => vec![format!("Steeper: up to {outside:.1e} of the facets.")],
            false => Vec::new(),
        };
        Curves {
            title: "Slopes of the facets".into(),
            subtitle: name.to_owned(),
            x: axis("slope"),
            y: axis("probability density"),
            curves: [("along x", found(x)), ("along y", found(y))]
                .into_iter()
                .enumerate()
                .map(|(axis, (name, points))| of_axis(name, axis, 0, points))
                .chain(self.slope_densities(x.lowest))
                .collect(),
            notes,
        }
    }

    /// Densities to compare slopes with, from `lowest` to its opposite: normal ones, and those of GGX where they were requested.
    fn slope_densities(&self, lowest: f64) -> Vec<Curve> {
        let mut curves = Vec::new();
        for (axis, mean_square) in self.mean_square_slopes.into_iter().enumerate() {
            let name = ["normal, same rms along x", "normal, same rms along y"][axis];
            if mean_square > 0.0 {
                let points = sampled([lowest, -lowest], |slope| normal(slope, mean_square));
                curves.push(of_axis(name, axis, 2, points));
            }
        }
        let Some(alpha) = self.ggx_alpha else {
            return curves;
        };
        let names = match alpha[0] == alpha[1] {
            true => vec!["GGX, requested"],
            false => vec!["GGX, requested along x", "GGX, requested along y"],
        };
        for (axis, name) in names.into_iter().enumerate() {
            let points = sampled([lowest, -lowest], |slope| ggx(slope, alpha[axis]));
            curves.push(of_axis(name, 2 + axis, 1, points));
        }
        curves
    }

    /// The unit as labels have it.
    const fn length(&self) -> &'static str {
        match self.unit {
            LengthUnit::Arbitrary => "length unit",
            LengthUnit::Micrometre => "µm",
            unit => unit.symbol(),
        }
    }
}

fn axis(label: &str) -> CurveAxis {
    CurveAxis {
        label: label.to_owned(),
        range: None,
    }
}

fn line(name: &str, number: usize, points: Vec<Point>) -> Curve {
    Curve {
        name: name.to_owned(),
        colour: Colour::Nth(number),
        style: Style::Line(number),
        points,
    }
}

/// A line in the colour of an axis, with a dash pattern for what it is.
fn of_axis(name: &str, axis: usize, dashes: usize, points: Vec<Point>) -> Curve {
    Curve {
        name: name.to_owned(),
        colour: Colour::Nth(axis),
        style: Style::Line(dashes),
        points,
    }
}

/// The normal density, as a value to compare with.
fn beside(name: &str, range: [f64; 2], mean_square: f64) -> Curve {
    Curve {
        name: name.to_owned(),
        colour: Colour::Nth(0),
        style: Style::Guide,
        points: sampled(range, |value| normal(value, mean_square)),
    }
}

/// Points of a smooth curve.
fn sampled([from, to]: [f64; 2], density: impl Fn(f64) -> f64) -> Vec<Point> {
    let at = |i: usize| from + (to - from) * i as f64 / STEPS as f64;
    let point = |i: usize| Point::exact(at(i), density(at(i)));
    (0..=STEPS).map(point).collect()
}
