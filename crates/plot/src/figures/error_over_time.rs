//! Error against run time, on logarithmic axes.

use crate::elements::axis::{Axis, extent};
use crate::elements::curve::{Colour, Curve, Point, Style, curve_entries};
use crate::elements::legend::{Entry, Key, Legend};
use crate::elements::numbers::{exponent10, fixed};
use crate::elements::page::Chart;
use crate::error::Valid;
use crate::{Figure, PlotError};

/// One run of a method, or several of equal size together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedError {
    /// Seconds that it took, > 0.
    pub seconds: f64,
    /// Seconds of the fastest and of the slowest run.
    pub seconds_range: [f64; 2],
    /// Relative error, >= 0; zero has no place on a logarithmic axis and is left out.
    pub error: f64,
    /// Standard error of `error`, >= 0.
    pub se: Option<f64>,
    /// `true` if the fitted line uses it; other points are hollow.
    pub fitted: bool,
}

/// `error = error_at_one_second * seconds^slope`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Slope on logarithmic axes; -1/2 for independent samples.
    pub slope: f64,
    /// Standard error of the slope.
    pub slope_se: Option<f64>,
    /// The error reached in one second, > 0.
    pub error_at_one_second: f64,
}

/// A method of computing, with its run times and errors.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedMethod {
    /// Text of the legend.
    pub name: String,
    /// Methods of one family share a colour.
    pub family: String,
    /// Methods of one variant share a marker and a pattern of lines; those of one family do where there is one variant alone.
    pub variant: String,
    /// Its runs, in any order; may be empty.
    pub runs: Vec<TimedError>,
    /// The line through the runs that are fitted; drawn over these alone.
    pub fit: Option<PowerLaw>,
}

/// Relative error over seconds, both logarithmic, with fitted lines.
///
/// Thin lines fall as 1 / sqrt(seconds). Bars show a standard error up and down, and left and right the
/// fastest and the slowest run. A point at the error of the reference itself says nothing about its method:
/// a dashed line marks that error, and such points are hollow.
///
/// ```
/// use asperity_plot::{ErrorOverTime, PowerLaw, TimedError, TimedMethod};
///
/// let runs = [0.1_f64, 1.0, 10.0].map(|seconds| TimedError {
///     seconds,
///     seconds_range: [0.9 * seconds, 1.2 * seconds],
///     error: 1e-2 / seconds.sqrt(),
///     se: Some(1e-3 / seconds.sqrt()),
///     fitted: true,
/// });
/// let figure = ErrorOverTime {
///     title: "Run time against error".into(),
///     subtitle: "s = 3, n = 1.5".into(),
///     methods: vec![TimedMethod {
///         name: "plain, random".into(),
///         family: "plain".into(),
///         variant: "random".into(),
///         runs: runs.to_vec(),
///         fit: Some(PowerLaw { slope: -0.5, slope_se: None, error_at_one_second: 1e-2 }),
///     }],
///     reference_error: Some(5e-4),
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("plain, random: slope −0.50"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorOverTime {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// The methods, in the order of the legend.
    pub methods: Vec<TimedMethod>,
    /// Relative error of the reference that errors are measured against, >= 0.
    pub reference_error: Option<f64>,
}

const PANEL: (f64, f64) = (620.0, 500.0);
const LEGEND_WIDTH: f64 = 408.0;
/// The axis of errors is drawn out to the reference's if that is not farther than so many decades away.
const DECADES_TO_REFERENCE: f64 = 1.0;

impl ErrorOverTime {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] if no run has an error above zero, [`PlotError::OutOfRange`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.methods.iter().try_for_each(TimedMethod::check)?;
        let reference = self.reference_error.unwrap_or(0.0);
        Valid::NotNegative.check("error of the reference", 0, reference)?;
        let Axes { x, y } = self.axes()?;

        // Lines beneath runs, and the entries of the legend by method.
        let styles = self.styles();
        let methods = || self.methods.iter().zip(&styles);
        let mut curves = slopes(&x, &y);
        let drawn = |error: &f64| (y.lo..=y.hi).contains(error);
        curves.extend(self.reference_error.filter(drawn).map(|error| {
            let ends = [(x.lo, error), (x.hi, error)];
            Curve::guide("error of the reference itself", Style::Guide, ends)
        }));
        let guides = curve_entries(&curves);
        curves.extend(methods().map(|(method, style)| method.fitted_line(*style)));
        let mut entries = Vec::new();
        for (method, style) in methods() {
            let [fitted, hollow] = method.runs(*style);
            let key = Key::Joined {
                marker: fitted.marker(),
                pen: method.fitted_line(*style).pen(),
            };
            entries.push(Entry::new(key, method.legend_text()));
            curves.extend([fitted, hollow]);
        }
        entries.extend(guides);
        entries.extend(self.notes());
        Chart {
            title: &self.title,
            subtitle: &self.subtitle,
            x,
            y,
            log_y: None,
            size: PANEL,
            legend_width: Legend::width(&entries, LEGEND_WIDTH)?,
            curves: &curves,
            entries,
        }
        .draw()
    }

    /// Both axes, around everything that has a place.
    fn axes(&self) -> Result<Axes, PlotError> {
        let runs = || {
            let runs = self.methods.iter().flat_map(|method| &method.runs);
            runs.filter(|run| run.error > 0.0)
        };
        let errors = extent(runs().map(|run| run.error));
        let seconds = extent(runs().flat_map(TimedError::all_seconds));
        let (Some(seconds), Some([least, largest])) = (seconds, errors) else {
            return Err(PlotError::nothing_to_draw(
                "no run with an error above zero",
            ));
        };
        let near =
            |error: &f64| *error > 0.0 && (least / error).log10().abs() <= DECADES_TO_REFERENCE;
        let reference = self.reference_error.filter(near).unwrap_or(least);
        let errors = [least.min(reference), largest.max(reference)];
        Ok(Axes {
            x: Axis::decades_around(seconds).with_label("run time (seconds)"),
            y: Axis::decades_around(errors).with_label("relative root-mean-square error over bins"),
        })
    }

    /// The styles of the methods: families and variants are numbered in the order in which they first come. Where all are of one
    /// variant, markers and patterns tell families apart, in greys too.
    fn styles(&self) -> Vec<MethodStyle> {
        fn rank<'a>(known: &mut Vec<&'a str>, name: &'a str) -> usize {
            known.iter().position(|k| *k == name).unwrap_or_else(|| {
                known.push(name);
                known.len() - 1
            })
        }
        let (mut families, mut variants) = (Vec::new(), Vec::new());
        let ranks = self.methods.iter().map(|method| {
            (
                rank(&mut families, &method.family),
                rank(&mut variants, &method.variant),
            )
        });
        let ranks: Vec<_> = ranks.collect();
        let style = |(family, variant)| MethodStyle {
            colour: Colour::Nth(family),
            variant: if variants.len() > 1 { variant } else { family },
        };
        ranks.into_iter().map(style).collect()
    }

    fn notes(&self) -> Vec<Entry> {
        let runs = || self.methods.iter().flat_map(|method| &method.runs);
        let mut notes = Vec::new();
        if runs().any(|run| run.se.is_some()) {
            notes.push("Bars: ±1 standard error; fastest to slowest run.");
        }
        if runs().any(|run| !run.fitted) {
            notes.push("Hollow: at the reference, not fitted.");
        }
        notes.into_iter().map(Entry::note).collect()
    }
}

/// Style of the runs of a method.
#[derive(Clone, Copy)]
struct MethodStyle {
    /// Colour of its family.
    colour: Colour,
    /// Number of the marker and of the dash pattern.
    variant: usize,
}

struct Axes {
    x: Axis,
    y: Axis,
}

impl TimedError {
    fn all_seconds(&self) -> impl Iterator<Item = f64> {
        self.seconds_range.into_iter().chain([self.seconds])
    }
}

impl TimedMethod {
    /// Refuses numbers without meaning.
    fn check(&self) -> Result<(), PlotError> {
        let what = |quantity: &str| format!("{quantity} of method \"{}\"", self.name);
        for (index, run) in self.runs.iter().enumerate() {
            for seconds in run.all_seconds() {
                Valid::Positive.check(&what("seconds"), index, seconds)?;
            }
            Valid::NotNegative.check(&what("error"), index, run.error)?;
            Valid::NotNegative.check(&what("standard error"), index, run.se.unwrap_or(0.0))?;
        }
        if let Some(law) = self.fit {
            Valid::Finite.check(&what("slope"), 0, law.slope)?;
            Valid::Positive.check(&what("error in one second"), 0, law.error_at_one_second)?;
        }
        Ok(())
    }

    fn legend_text(&self) -> String {
        let Some(law) = self.fit else {
            return format!("{}: no fit", self.name);
        };
        let slope = format!("{}: slope {}", self.name, fixed(law.slope, 2));
        match law.slope_se {
            Some(se) => format!("{slope} ± {}", fixed(se, 2)),
            None => slope,
        }
    }

    /// Over the runs that are fitted; without a point if there is no fit.
    fn fitted_line(&self, MethodStyle { colour, variant }: MethodStyle) -> Curve {
        let fitted = self.runs.iter().filter(|run| run.fitted);
        let ends = extent(fitted.map(|run| run.seconds));
        let ends = self.fit.zip(ends).map(|(law, ends)| {
            let error = |seconds: f64| law.error_at_one_second * seconds.powf(law.slope);
            ends.map(|seconds| Point::exact(seconds, error(seconds)))
        });
        Curve {
            name: String::new(),
            colour,
            style: Style::Line(variant),
            points: ends.into_iter().flatten().collect(),
        }
    }

    /// The runs that are fitted, and the others as hollow points.
    fn runs(&self, MethodStyle { colour, variant }: MethodStyle) -> [Curve; 2] {
        [
            (true, Style::Points(variant)),
            (false, Style::Hollow(variant)),
        ]
        .map(|(fitted, style)| {
            let runs = self.runs.iter().filter(|run| run.fitted == fitted);
            let point = |run: &TimedError| Point {
                x: run.seconds,
                y: run.error,
                se: run.se,
                x_range: Some(run.seconds_range),
            };
            Curve {
                name: String::new(),
                colour,
                style,
                points: runs.map(point).collect(),
            }
        })
    }
}

/// Lines of slope -1/2, a decade apart, of which the first has a name.
fn slopes(x: &Axis, y: &Axis) -> Vec<Curve> {
    let first = exponent10(y.lo * x.lo.sqrt());
    let last = exponent10(y.hi * x.hi.sqrt()) + 1;
    let line = |exponent: i32| {
        let ends = [x.lo, x.hi].map(|t| (t, 10f64.powi(exponent) / t.sqrt()));
        let name = if exponent == first {
            "slope −1/2"
        } else {
            ""
        };
        Curve::guide(name, Style::Faint, ends)
    };
    (first..=last).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_methods(names: &[[&str; 2]]) -> ErrorOverTime {
        let method = |[family, variant]: &[&str; 2]| TimedMethod {
            name: format!("{family}, {variant}"),
            family: (*family).into(),
            variant: (*variant).into(),
            runs: Vec::new(),
            fit: None,
        };
        ErrorOverTime {
            title: String::new(),
            subtitle: String::new(),
            methods: names.iter().map(method).collect(),
            reference_error: None,
        }
    }

    #[test]
    fn colour_is_of_the_family_and_marker_of_the_variant() {
        let styles = of_methods(&[["a", "x"], ["a", "y"], ["b", "x"], ["b", "y"]]).styles();
        assert_eq!(styles[0].colour, styles[1].colour);
        assert_ne!(styles[0].colour, styles[2].colour);
        assert_eq!(styles[1].variant, styles[3].variant);
        assert_ne!(styles[2].variant, styles[3].variant);
    }

    #[test]
    fn markers_tell_families_of_a_single_variant_apart() {
        let styles = of_methods(&[["a", "x"], ["b", "x"], ["a", "x"]]).styles();
        assert_ne!(styles[0].variant, styles[1].variant);
        assert_eq!(styles[0].variant, styles[2].variant);
    }
}
