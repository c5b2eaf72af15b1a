//! Profiles in the plane of incidence, split into parts, a panel a measurement.

use plotters::style::RGBColor;

use crate::elements::axis::{Axis, Panel, X_AXIS_DEPTH, display_exponent, per_steradian};
use crate::elements::scene::{Align, Level, Pen, Rect, Scene, TextLook, Xy};
use crate::elements::series::check_finite;
use crate::elements::text::{header, text_width, wrap};
use crate::elements::theme;
use crate::{Figure, PlotError, Sample};

/// One part of the light: its name in the legend, and its samples in each panel.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfilePart {
    /// Its name.
    pub name: String,
    /// For each panel the samples, ascending in angle; may be empty.
    pub samples: Vec<Vec<Sample>>,
}

/// Curves over the signed angle in the plane of incidence, panels side by side, with bands of two standard errors
/// to either side.
///
/// Panels share their axes, so that they can be compared; rows of panels in which a peak outshines all else share
/// logarithmic ones. A peak that is one sample wide is drawn as wide as its bin. Angles are signed as everywhere here: positive is
/// forward, so that light which goes back to where it came from is at minus the angle of incidence.
///
/// ```
/// use asperity_plot::{ProfileGrid, ProfilePart, Sample};
///
/// let samples = (-9..=9).map(|i| Sample { theta_deg: 10.0 * f64::from(i), value: 0.3, se: Some(0.01) });
/// let figure = ProfileGrid {
///     title: "A Lambertian surface".into(),
///     subtitle: String::new(),
///     quantity: "BRDF".into(),
///     panels: vec!["in the plane of incidence".into()],
///     light_deg: Some(-60.0),
///     mirror_deg: Some(60.0),
///     parts: vec![ProfilePart { name: "all".into(), samples: vec![samples.collect()] }],
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
    /// What the curves show, without its unit, 1/sr.
    pub quantity: String,
    /// Names of the panels.
    pub panels: Vec<String>,
    /// Direction of the light, signed degrees; none draws no line.
    pub light_deg: Option<f64>,
    /// Direction of reflection or refraction at a flat surface, signed degrees; none draws no line.
    pub mirror_deg: Option<f64>,
    /// The parts of the light.
    pub parts: Vec<ProfilePart>,
}

const PANEL: (f64, f64) = (268.0, 210.0);
const GAP: f64 = 40.0;
const MOST_IN_A_ROW: usize = 4;
const Y_AXIS_ROOM: f64 = 76.0;
/// Standard errors to either side of a curve.
const BAND: f64 = 2.0;
/// Share of a curve's colour in its band, the rest being white.
const TINT: f64 = 0.25;
/// From the beginning of a key of the legend to its text.
const KEY: f64 = 40.0;
/// Times the median of what is not zero that a peak hides all else from.
const OUTSHINING: f64 = 20.0;
/// Times both of its neighbours from which a sample is a peak of one bin.
const ONE_BIN: f64 = 10.0;
/// Least value of a logarithmic axis, as a share of its largest.
const LEAST: f64 = 1e-6;

impl ProfileGrid {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without panels or samples, [`PlotError::MismatchedLengths`] if a part has not as
    /// many panels as there are, [`PlotError::NonFinite`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let columns = self.panels.len().min(MOST_IN_A_ROW);
        let rows = self.panels.len().div_ceil(columns);
        let left = theme::MARGIN + Y_AXIS_ROOM;
        let width = left + columns as f64 * (PANEL.0 + GAP) - GAP + theme::MARGIN;
        let figure_width = width.max(560.0).round();
        let mut scene = Scene::new(&self.title);
        let top = header(&mut scene, &self.subtitle, figure_width)? + 10.0;
        let mut y = self.draw_legend(&mut scene, top, figure_width)?;

        let panels: Vec<usize> = (0..self.panels.len()).collect();
        let (steep, even): (Vec<&[usize]>, Vec<&[usize]>) = panels
            .chunks(columns)
            .partition(|row| outshone(&self.values(row)));
        let [steep, even] = [steep.concat(), even.concat()];
        let (linear, log) = (self.value_axis(&even), self.log_axis(&steep));
        let depth = theme::LEGEND_SIZE + 10.0 + PANEL.1;
        for (i, name) in self.panels.iter().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let lowest = row + 1 == rows || i + columns >= self.panels.len();
            let frame_top = y + theme::LEGEND_SIZE + 10.0;
            let frame_left = left + column as f64 * (PANEL.0 + GAP);
            let frame = Rect {
                left: frame_left,
                top: frame_top,
                right: frame_left + PANEL.0,
                bottom: frame_top + PANEL.1,
            };
            let look = TextLook::new(theme::LEGEND_SIZE, Align::Centre, Level::Top);
            scene.text(name, (frame.centre().0, y), look);
            let x = Axis::degrees(-90.0, 90.0);
            let x = match lowest {
                true => x.with_label("angle from the normal (°)"),
                false => x.without_texts(),
            };
            let axis = match steep.contains(&i) {
                true => log.clone(),
                false => linear.clone(),
            };
            let values = match column {
                0 => axis,
                _ => axis.without_texts(),
            };
            let panel = Panel::new(frame, x, values)?;
            self.draw_panel(&mut scene, &panel, i);
            if column + 1 == columns && row + 1 < rows {
                y += depth + GAP + 6.0;
            }
        }
        y += depth + X_AXIS_DEPTH + 10.0;
        let look = TextLook::new(theme::NOTE_SIZE, Align::Left, Level::Top).muted();
        for line in wrap(
            &self.note(),
            theme::NOTE_SIZE,
            figure_width - 2.0 * theme::MARGIN,
        )? {
            scene.text(&line, (theme::MARGIN, y), look);
            y += 1.45 * theme::NOTE_SIZE;
        }
        scene.width = figure_width as u32;
        scene.height = (y + theme::MARGIN).round() as u32;
        Ok(Figure::new(scene))
    }

    fn check(&self) -> Result<(), PlotError> {
        let mut any = false;
        for part in &self.parts {
            if part.samples.len() != self.panels.len() {
                return Err(PlotError::MismatchedLengths {
                    what: format!("part \"{}\"", part.name),
                    found: part.samples.len(),
                    expected: self.panels.len(),
                });
            }
            for (index, sample) in part.samples.iter().flatten().enumerate() {
                any = true;
                for (what, value) in [
                    ("angle", sample.theta_deg),
                    ("value", sample.value),
                    ("standard error", sample.se.unwrap_or(0.0)),
                ] {
                    check_finite(&format!("{what} of part \"{}\"", part.name), index, value)?;
                }
            }
        }
        for angle in [self.light_deg, self.mirror_deg].into_iter().flatten() {
            check_finite("direction", 0, angle)?;
        }
        if any {
            return Ok(());
        }
        Err(PlotError::NothingToDraw {
            what: "profiles without a sample".into(),
        })
    }

    /// All samples of some panels.
    fn samples<'a>(&'a self, panels: &'a [usize]) -> impl Iterator<Item = &'a Sample> + Clone {
        let of_part = |part: &'a ProfilePart| panels.iter().flat_map(|panel| &part.samples[*panel]);
        self.parts.iter().flat_map(of_part)
    }

    /// What is not zero in some panels, ascending.
    fn values(&self, panels: &[usize]) -> Vec<f64> {
        let samples = self.samples(panels).map(|s| s.value);
        let mut values: Vec<f64> = samples.filter(|v| *v > 0.0).collect();
        values.sort_by(f64::total_cmp);
        values
    }

    /// From zero, or from what noise makes of it, to the highest band.
    fn value_axis(&self, panels: &[usize]) -> Axis {
        let samples = self.samples(panels);
        // Bands wider than their value say nothing that the scale should be made for.
        let above = |s: &Sample| s.value + (BAND * s.se.unwrap_or(0.0)).min(s.value.abs());
        let hi = samples.clone().map(above).fold(0.0, f64::max);
        let lo = samples.map(|s| s.value).fold(0.0, f64::min);
        let hi = if hi > 0.0 { 1.04 * hi } else { 1.0 };
        let exponent = display_exponent(hi);
        Axis::linear(lo, hi, 5, exponent).with_label(&format!(
            "{} {}",
            self.quantity,
            per_steradian(exponent)
        ))
    }

    /// From below all but the noisiest values to above the peak.
    fn log_axis(&self, panels: &[usize]) -> Axis {
        let values = self.values(panels);
        let hi = 2.0 * values.last().copied().unwrap_or(1.0);
        let low = values.get(values.len() / 10).copied().unwrap_or(hi);
        let lo = (0.5 * low).clamp(LEAST * hi, 0.05 * hi);
        Axis::log10(lo, hi).with_label(&format!("{} (1/sr), logarithmic", self.quantity))
    }

    fn draw_panel(&self, scene: &mut Scene, panel: &Panel, index: usize) {
        panel.draw_grid(scene);
        for (angle, pen) in self.guides() {
            if let Some((x, _)) = panel.at(angle, panel.y.lo()) {
                scene.line(&[(x, panel.frame.top), (x, panel.frame.bottom)], pen);
            }
        }
        // All bands beneath all curves.
        for (part, colour) in self.parts.iter().zip(colours()) {
            for pair in outline(&part.samples[index]).windows(2) {
                let band = |s: &Sample, sign: f64| {
                    let value = s.value + sign * BAND * s.se.unwrap_or(0.0);
                    panel.at(s.theta_deg, value.clamp(panel.y.lo(), panel.y.hi()))
                };
                let corners = [
                    band(&pair[0], 1.0),
                    band(&pair[1], 1.0),
                    band(&pair[1], -1.0),
                    band(&pair[0], -1.0),
                ];
                if let [Some(a), Some(b), Some(c), Some(d)] = corners {
                    scene.polygon(vec![a, b, c, d], tint(colour));
                }
            }
        }
        for ((part, colour), dash) in self.parts.iter().zip(colours()).zip(theme::LINE_DASHES) {
            // Where there is no logarithm a curve leaves the panel below.
            let least = match panel.y.fraction(0.0) {
                Some(_) => f64::NEG_INFINITY,
                None => 1e-3 * panel.y.lo(),
            };
            let path: Vec<Xy> = outline(&part.samples[index])
                .iter()
                .filter_map(|s| panel.at(s.theta_deg, s.value.max(least)))
                .collect();
            let pen = Pen {
                colour,
                width: theme::CURVE_WIDTH,
                dash,
            };
            for piece in panel.frame.clip_path(&path) {
                scene.line(&piece, pen);
            }
        }
        panel.draw_frame(scene);
    }

    fn guides(&self) -> impl Iterator<Item = (f64, Pen)> {
        let light = self.light_deg.map(|angle| (angle, light_pen()));
        let mirror = self.mirror_deg.map(|angle| (angle, Pen::guide()));
        light.into_iter().chain(mirror)
    }

    /// Returns the y below.
    fn draw_legend(&self, scene: &mut Scene, top: f64, width: f64) -> Result<f64, PlotError> {
        let mut entries: Vec<(Pen, String)> = self
            .parts
            .iter()
            .zip(colours())
            .zip(theme::LINE_DASHES)
            .map(|((part, colour), dash)| {
                let pen = Pen {
                    colour,
                    width: theme::CURVE_WIDTH,
                    dash,
                };
                (pen, part.name.clone())
            })
            .collect();
        if self.light_deg.is_some() {
            entries.push((light_pen(), "back to the light".into()));
        }
        if self.mirror_deg.is_some() {
            entries.push((Pen::guide(), "as at a flat surface".into()));
        }
        let look = TextLook::new(theme::LEGEND_SIZE, Align::Left, Level::Middle);
        let (mut x, mut y) = (theme::MARGIN, top + 0.5 * theme::LEGEND_SIZE);
        for (pen, text) in entries {
            let needed = KEY + text_width(&text, theme::LEGEND_SIZE)?;
            if x > theme::MARGIN && x + needed > width - theme::MARGIN {
                x = theme::MARGIN;
                y += 1.7 * theme::LEGEND_SIZE;
            }
            scene.line(&[(x, y), (x + KEY - 8.0, y)], pen);
            scene.text(&text, (x + KEY, y), look);
            x += needed + 22.0;
        }
        Ok(y + 1.5 * theme::LEGEND_SIZE)
    }

    /// How to read the panels.
    fn note(&self) -> String {
        let panels: Vec<usize> = (0..self.panels.len()).collect();
        let mut note = "Angles are positive forward, away from the light.".to_owned();
        if self.samples(&panels).any(|s| s.se.is_some()) {
            note.push_str(" Bands: ±2 standard errors.");
        }
        note
    }
}

/// Whether the largest of ascending values hides the others on a linear axis.
fn outshone(values: &[f64]) -> bool {
    let median = values.get(values.len() / 2).copied().unwrap_or(0.0);
    values
        .last()
        .is_some_and(|most| *most > OUTSHINING * median)
}

/// The samples as corners of a curve: straight between them, but where one is far above both of its neighbours, which
/// only a peak narrower than a bin makes, it stands as wide as the bin.
fn outline(samples: &[Sample]) -> Vec<Sample> {
    let mut corners = Vec::with_capacity(samples.len());
    for (i, sample) in samples.iter().enumerate() {
        let neighbours = [i.checked_sub(1), Some(i + 1)].map(|k| k.and_then(|k| samples.get(k)));
        let within = || neighbours.into_iter().flatten();
        let half = within()
            .map(|s| 0.5 * (s.theta_deg - sample.theta_deg).abs())
            .fold(f64::INFINITY, f64::min);
        let alone = within().all(|s| sample.value > ONE_BIN * s.value.max(0.0));
        if !alone || !half.is_finite() {
            corners.push(*sample);
            continue;
        }
        let at = |s: &Sample, side: f64| Sample {
            theta_deg: sample.theta_deg + side * half,
            ..*s
        };
        let [before, after] = neighbours;
        corners.extend(before.map(|s| at(s, -1.0)));
        corners.extend([at(sample, -1.0), at(sample, 1.0)]);
        corners.extend(after.map(|s| at(s, 1.0)));
    }
    corners
}

fn light_pen() -> Pen {
    Pen::solid(theme::FAINT, 1.6)
}

/// Black for the whole, then colours that the colour blind tell apart.
fn colours() -> impl Iterator<Item = RGBColor> {
    std::iter::once(theme::INK).chain(theme::LINE_COLOURS)
}

fn tint(RGBColor(r, g, b): RGBColor) -> RGBColor {
    let mix = |c: u8| (TINT * f64::from(c) + (1.0 - TINT) * 255.0).round() as u8;
    RGBColor(mix(r), mix(g), mix(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(panels: usize) -> ProfileGrid {
        let sample = |theta_deg| Sample {
            theta_deg,
            value: 0.2,
            se: Some(0.01),
        };
        let samples = vec![vec![sample(-45.0), sample(0.0), sample(45.0)]; panels];
        ProfileGrid {
            title: "t".into(),
            subtitle: String::new(),
            quantity: "BRDF".into(),
            panels: vec!["a".into(); panels],
            light_deg: None,
            mirror_deg: None,
            parts: vec![ProfilePart {
                name: "all".into(),
                samples,
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
        short.parts[0].samples.pop();
        assert!(short.draw().is_err());
        let mut bad = grid(1);
        bad.parts[0].samples[0][1].value = f64::INFINITY;
        assert!(bad.draw().is_err());
        assert!(grid(0).draw().is_err());
        let mut negative = grid(1);
        negative.parts[0].samples[0][1].value = -0.1;
        assert!(negative.draw().is_ok());
    }

    fn with_peak(value: f64) -> ProfileGrid {
        let mut grid = grid(5);
        grid.parts[0].samples[4][2].value = value;
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
            with_peak(4.1).values(&[0, 1, 2, 3]),
            with_peak(4.1).values(&[4]),
        ];
        assert_eq!(rows.map(|row| outshone(&row)), [false, true]);
        // Nothing beside the peak: there is nothing to see.
        assert!(!outshone(&[9.0]) && !outshone(&[]));
    }

    #[test]
    fn a_peak_of_one_bin_is_as_wide_as_its_bin() {
        let outlined = |values: [f64; 5]| -> Vec<(f64, f64)> {
            let sample = |(i, value)| Sample {
                theta_deg: 6.0 * f64::from(i) - 12.0,
                value,
                se: None,
            };
            let samples: Vec<Sample> = (0i32..).zip(values).map(sample).collect();
            let corners = outline(&samples);
            corners.iter().map(|s| (s.theta_deg, s.value)).collect()
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
}
