//! Error against run time, on logarithmic axes.

use crate::elements::axis::{Axis, Panel, X_AXIS_DEPTH};
use crate::elements::legend::{Entry, Key, Legend};
use crate::elements::scene::{Marker, Pen, Rect, Scene};
use crate::elements::series::{Look, check_finite};
use crate::elements::text::{exponent10, fixed, header};
use crate::elements::theme;
use crate::{Figure, PlotError};

/// One run of a method, or several of equal size together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedError {
    /// Seconds that it took, > 0.
    pub seconds: f64,
    /// Seconds of the fastest and of the slowest run.
    pub seconds_range: [f64; 2],
    /// Relative error, >= 0; what is zero has no place on the axis and is left out.
    pub error: f64,
    /// Standard error of `error`, >= 0.
    pub se: Option<f64>,
    /// Whether a fitted line rests on it; other points are hollow.
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

/// A way of computing, with what it cost and how far off it was.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedMethod {
    /// Text of the legend.
    pub name: String,
    /// Methods of one family share a colour.
    pub family: String,
    /// Methods of one variant share a marker and a pattern of lines.
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
/// a dotted line marks that error, and such points are hollow.
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

const PANEL_WIDTH: f64 = 620.0;
const PANEL_HEIGHT: f64 = 500.0;
const LEGEND_WIDTH: f64 = 372.0;
const LEGEND_GAP: f64 = 26.0;
/// Left of the panel: label, texts and ticks of the y axis.
const Y_AXIS_ROOM: f64 = 72.0;
/// Free space between the data and the frame, decades.
const PADDING: f64 = 0.15;
/// The axis of errors is drawn out to the reference's if that is not farther than so many decades away.
const DECADES_TO_REFERENCE: f64 = 1.0;

impl ErrorOverTime {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] if no run has an error above zero, [`PlotError::NonFinite`] and
    /// [`PlotError::OutOfRange`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.methods.iter().try_for_each(TimedMethod::check)?;
        check_range(
            "error of the reference",
            0,
            self.reference_error.unwrap_or(0.0),
            false,
        )?;
        let looks = self.looks();
        let (x, y) = self.axes()?;

        let mut scene = Scene::new(&self.title);
        let width = 2.0 * theme::MARGIN + Y_AXIS_ROOM + PANEL_WIDTH + LEGEND_GAP + LEGEND_WIDTH;
        let top = header(&mut scene, &self.subtitle, width)? + 16.0;
        let left = theme::MARGIN + Y_AXIS_ROOM;
        let frame = Rect {
            left,
            top,
            right: left + PANEL_WIDTH,
            bottom: top + PANEL_HEIGHT,
        };
        let panel = Panel::new(frame, x, y)?;
        panel.draw_grid(&mut scene);
        draw_slopes(&mut scene, &panel);
        if let Some(error) = self.reference_error {
            draw_line(
                &mut scene,
                &panel,
                |_| error,
                [panel.x.lo(), panel.x.hi()],
                reference_pen(),
            );
        }
        for (method, look) in self.methods.iter().zip(&looks) {
            method.draw_fit(&mut scene, &panel, look);
        }
        for (method, look) in self.methods.iter().zip(&looks) {
            method.draw_runs(&mut scene, &panel, look);
        }
        panel.draw_frame(&mut scene);

        let legend = Legend::new(&self.entries(&looks), LEGEND_WIDTH)?;
        legend.draw(&mut scene, (frame.right + LEGEND_GAP, top));
        scene.width = width.round() as u32;
        let low_end = (frame.bottom + X_AXIS_DEPTH).max(top + legend.height());
        scene.height = (low_end + theme::MARGIN).round() as u32;
        Ok(Figure::new(scene))
    }

    /// Both axes, around everything that has a place.
    fn axes(&self) -> Result<(Axis, Axis), PlotError> {
        let runs = || {
            let runs = self.methods.iter().flat_map(|method| &method.runs);
            runs.filter(|run| run.error > 0.0)
        };
        let errors = extent(runs().map(|run| run.error));
        let seconds =
            extent(runs().flat_map(|run| run.seconds_range.into_iter().chain([run.seconds])));
        let (Some([from, to]), Some(errors)) = (seconds, errors) else {
            return Err(PlotError::NothingToDraw {
                what: "no run with an error above zero".into(),
            });
        };
        let near =
            |error: &f64| *error > 0.0 && (errors[0] / error).log10().abs() <= DECADES_TO_REFERENCE;
        let errors = match self.reference_error.filter(near) {
            Some(reference) => [errors[0].min(reference), errors[1].max(reference)],
            None => errors,
        };
        let x = decades(from, to).with_label("run time (seconds)");
        let y =
            decades(errors[0], errors[1]).with_label("relative root-mean-square error over bins");
        Ok((x, y))
    }

    /// A colour a family, a marker and a pattern a variant, in the order in which they first come.
    fn looks(&self) -> Vec<Look> {
        fn rank<'a>(known: &mut Vec<&'a str>, name: &'a str) -> usize {
            known.iter().position(|k| *k == name).unwrap_or_else(|| {
                known.push(name);
                known.len() - 1
            })
        }
        let (mut families, mut variants) = (Vec::new(), Vec::new());
        let looks = self.methods.iter().map(|method| {
            let family = rank(&mut families, &method.family);
            let variant = rank(&mut variants, &method.variant);
            Look {
                colour: theme::METHOD_COLOURS[family % theme::METHOD_COLOURS.len()],
                marker: Marker::ALL[variant % Marker::ALL.len()],
                dash: theme::LINE_DASHES[variant % theme::LINE_DASHES.len()],
            }
        });
        looks.collect()
    }

    fn entries(&self, looks: &[Look]) -> Vec<Entry> {
        let methods = self.methods.iter().zip(looks).map(|(method, look)| Entry {
            key: Key::Fitted(*look),
            text: match method.fit {
                Some(PowerLaw {
                    slope,
                    slope_se: Some(se),
                    ..
                }) => {
                    format!(
                        "{}: slope {} ± {}",
                        method.name,
                        fixed(slope, 2),
                        fixed(se, 2)
                    )
                }
                Some(law) => format!("{}: slope {}", method.name, fixed(law.slope, 2)),
                None => format!("{}: no fit", method.name),
            },
        });
        let mut entries: Vec<Entry> = methods.collect();
        entries.push(Entry {
            key: Key::Line(slope_pen()),
            text: "slope −1/2".into(),
        });
        if self.reference_error.is_some() {
            entries.push(Entry {
                key: Key::Line(reference_pen()),
                text: "error of the reference itself".into(),
            });
        }
        let runs = || self.methods.iter().flat_map(|method| &method.runs);
        if runs().any(|run| run.se.is_some()) {
            entries.push(Entry::note(
                "Bars: ±1 standard error; fastest to slowest run.",
            ));
        }
        if runs().any(|run| !run.fitted) {
            entries.push(Entry::note("Hollow: at the reference, not fitted."));
        }
        entries
    }
}

impl TimedMethod {
    /// Refuses what has no place in a figure.
    fn check(&self) -> Result<(), PlotError> {
        let what = |quantity: &str| format!("{quantity} of method \"{}\"", self.name);
        for (index, run) in self.runs.iter().enumerate() {
            for seconds in run.seconds_range.into_iter().chain([run.seconds]) {
                check_range(&what("seconds"), index, seconds, true)?;
            }
            check_range(&what("error"), index, run.error, false)?;
            check_range(&what("standard error"), index, run.se.unwrap_or(0.0), false)?;
        }
        if let Some(law) = self.fit {
            check_finite(&what("slope"), 0, law.slope)?;
            check_range(
                &what("error in one second"),
                0,
                law.error_at_one_second,
                true,
            )?;
        }
        Ok(())
    }

    fn draw_fit(&self, scene: &mut Scene, panel: &Panel, look: &Look) {
        let fitted = self.runs.iter().filter(|run| run.fitted);
        if let (Some(law), Some(range)) = (self.fit, extent(fitted.map(|run| run.seconds))) {
            let error = |seconds: f64| law.error_at_one_second * seconds.powf(law.slope);
            draw_line(scene, panel, error, range, look.curve());
        }
    }

    fn draw_runs(&self, scene: &mut Scene, panel: &Panel, look: &Look) {
        for run in &self.runs {
            let Some(at) = panel.at(run.seconds, run.error) else {
                continue;
            };
            let [fastest, slowest] = run.seconds_range;
            let mut bars = vec![[(fastest, run.error), (slowest, run.error)]];
            if let Some(se) = run.se {
                // A bar that starts at zero or below reaches down to the lower edge.
                let low = (run.error - se).max(panel.y.lo());
                bars.push([(run.seconds, low), (run.seconds, run.error + se)]);
            }
            for [from, to] in bars {
                let ends = panel.at(from.0, from.1).zip(panel.at(to.0, to.1));
                if let Some((a, b)) = ends.and_then(|(a, b)| panel.frame.clip(a, b)) {
                    scene.line(&[a, b], look.bar());
                }
            }
            if run.fitted {
                scene.marker(at, look.marker, look.colour);
            } else {
                scene.hollow_marker(at, look.marker, look.colour);
            }
        }
    }
}

/// The part inside the panel of a line that is straight on logarithmic axes.
fn draw_line(
    scene: &mut Scene,
    panel: &Panel,
    error: impl Fn(f64) -> f64,
    seconds: [f64; 2],
    pen: Pen,
) {
    let [from, to] = seconds.map(|t| panel.at(t, error(t)));
    if let Some((a, b)) = from.zip(to).and_then(|(a, b)| panel.frame.clip(a, b)) {
        scene.line(&[a, b], pen);
    }
}

/// Lines of slope -1/2, a decade apart.
fn draw_slopes(scene: &mut Scene, panel: &Panel) {
    let seconds = [panel.x.lo(), panel.x.hi()];
    let first = exponent10(panel.y.lo() * seconds[0].sqrt());
    let last = exponent10(panel.y.hi() * seconds[1].sqrt()) + 1;
    for exponent in first..=last {
        let error = |t: f64| 10f64.powi(exponent) / t.sqrt();
        draw_line(scene, panel, error, seconds, slope_pen());
    }
}

fn slope_pen() -> Pen {
    Pen::solid(theme::FAINT, theme::GRID_WIDTH)
}

fn reference_pen() -> Pen {
    Pen {
        colour: theme::INK,
        width: theme::BAR_WIDTH,
        dash: &[1.5, 3.5],
    }
}

/// The least and the largest; none of nothing.
fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.fold(None, |range, v| {
        let [lo, hi] = range.unwrap_or([v, v]);
        Some([v.min(lo), v.max(hi)])
    })
}

/// A logarithmic axis around `lo` to `hi`, > 0, with two decades marked at least.
fn decades(lo: f64, hi: f64) -> Axis {
    let margin = 10f64.powf(PADDING);
    let (lo, hi) = (
        (lo / margin).max(f64::MIN_POSITIVE),
        (hi * margin).min(f64::MAX),
    );
    let axis = Axis::log10(lo, hi);
    if axis.major.len() > 1 {
        return axis;
    }
    let power = |exponent: i32| 10f64.powi(exponent.clamp(-307, 308));
    Axis::log10(power(exponent10(lo)), power(exponent10(hi) + 1))
}

/// Refuses infinities, NaN, and what is negative, or zero where that has no meaning.
fn check_range(what: &str, index: usize, value: f64, positive: bool) -> Result<(), PlotError> {
    check_finite(what, index, value)?;
    if value > 0.0 || (value == 0.0 && !positive) {
        return Ok(());
    }
    Err(PlotError::OutOfRange {
        what: what.to_owned(),
        range: if positive {
            "above zero"
        } else {
            "zero or more"
        },
        index,
        value,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_mark_two_decades_whatever_the_range() {
        for (lo, hi) in [
            (2.0, 3.0),
            (1.0, 1.0),
            (9e-5, 1.1e-4),
            (1e-300, 2e-300),
            (0.03, 40.0),
        ] {
            let axis = decades(lo, hi);
            assert!(axis.major.len() >= 2, "{lo} {hi}: {:?}", axis.major);
            assert!(axis.lo() <= lo && axis.hi() >= hi);
        }
    }

    #[test]
    fn colour_is_of_the_family_and_marker_of_the_variant() {
        let method = |family: &str, variant: &str| TimedMethod {
            name: format!("{family}, {variant}"),
            family: family.into(),
            variant: variant.into(),
            runs: Vec::new(),
            fit: None,
        };
        let figure = ErrorOverTime {
            title: String::new(),
            subtitle: String::new(),
            methods: vec![
                method("a", "x"),
                method("a", "y"),
                method("b", "x"),
                method("b", "y"),
            ],
            reference_error: None,
        };
        let looks = figure.looks();
        assert_eq!(looks[0].colour, looks[1].colour);
        assert_ne!(looks[0].colour, looks[2].colour);
        assert_eq!(looks[1].marker, looks[3].marker);
        assert_ne!(looks[2].dash, looks[3].dash);
    }
}
