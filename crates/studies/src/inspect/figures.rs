//! The figures of an inspected surface.

use std::f64::consts::E;

use asperity_plot::{Colour, Curve, CurveAxis, Curves, LogCurves, Point, Style};
use asperity_surface::{Histogram, LengthUnit};

use super::{Texture, ggx, normal};

/// Densities below this part of the largest are rounding, and are not drawn.
const DRAWN: f64 = 1e-14;

/// Autocorrelations are drawn over as many lengths of decay.
const DECAYS: usize = 5;

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
        let [dx, dy] = self.spacing;
        let of = &self.correlation;
        let ends = [(&of.along_x, dx), (&of.along_y, dy)];
        let end = ends.map(|(values, spacing)| spacing * shown_lags(values) as f64);
        let end = end[0].max(end[1]);
        let points = |values: &[f64], spacing: f64| -> Vec<Point> {
            let lags = values.iter().enumerate();
            let lags = lags.map(|(i, value)| (i as f64 * spacing, value));
            let lags = lags.take_while(|(lag, _)| *lag <= end);
            let normalised =
                lags.map(|(lag, value)| Point::exact(lag, value / (self.sq * self.sq)));
            normalised.collect()
        };
        let mut curves = vec![
            line("along x", 0, points(&of.along_x, dx)),
            line("along y", 1, points(&of.along_y, dy)),
        ];
        if let Some(psd) = &self.requested {
            let along = |cos: f64, sin: f64| {
                let variance = psd.autocorrelation(0.0, 0.0);
                sampled([0.0, end], |lag| {
                    psd.autocorrelation(lag * cos, lag * sin) / variance
                })
            };
            if psd.is_isotropic() {
                curves.push(of_axis("requested", 2, 3, along(1.0, 0.0)));
            } else {
                curves.push(of_axis("requested along x", 0, 3, along(1.0, 0.0)));
                curves.push(of_axis("requested along y", 1, 3, along(0.0, 1.0)));
            }
        }
        Curves {
            title: "Autocorrelation of heights over Sq²".into(),
            subtitle: name.to_owned(),
            x: axis(&format!("lag ({})", self.length())),
            y: axis("C / Sq²"),
            log_from: None,
            curves,
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
            log_from: lowest([&self.heights]),
            curves: vec![
                line("samples", 0, found.collect()),
                beside("normal, same Sq", ends, self.sq * self.sq),
            ],
            notes: Vec::new(),
        }
    }

    pub(super) fn slopes_figure(&self, name: &str) -> Curves {
        let [x, y] = &self.slopes;
        let found = |of: &Histogram| -> Vec<Point> {
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
            log_from: lowest([x, y]),
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

/// Lags that show how an autocorrelation decays: five times as many as it takes to fall to 1/e.
fn shown_lags(values: &[f64]) -> usize {
    let fallen = values.iter().position(|value| *value < values[0] / E);
    let shown = fallen.map_or(values.len(), |lags| DECAYS * lags);
    shown.clamp(1, values.len().max(2) - 1)
}

/// The least density of a bin that is not empty.
fn lowest<'a>(histograms: impl IntoIterator<Item = &'a Histogram>) -> Option<f64> {
    let densities = histograms.into_iter().flat_map(|of| &of.densities);
    densities
        .copied()
        .filter(|density| *density > 0.0)
        .reduce(f64::min)
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
