//! The plots of an attenuation run.

use asperity_analysis::{
    SlopeCovariance, smith_lit, smith_lit_as_printed, smith_visibility, v_cavity_lit,
};
use asperity_optics::{Incidence, from_spherical};
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};
use asperity_simulate::{counted, short};
use asperity_surface::LengthUnit;
use asperity_tally::Estimate;

use super::{AttenuationOutcome, AttenuationRow, VisibilityRow};

/// Names of all plots.
pub(super) const NAMES: [&str; 4] = [
    "attenuation_theta",
    "attenuation_models",
    "attenuation_sigma",
    "visibility",
];

/// All plots that the results can fill, by name of their files.
pub(super) fn figures(outcome: &AttenuationOutcome) -> Vec<(&'static str, Curves)> {
    let lights = distinct(outcome.rows.iter().map(|row| row.theta));
    let sigmas = distinct(outcome.rows.iter().map(|row| row.sigma));
    let mut figures = Vec::new();
    if lights.len() > 1 {
        figures.push(("attenuation_theta", over_theta(outcome, &sigmas)));
        figures.push(("attenuation_models", models_over_theta(outcome)));
    }
    if sigmas.len() > 1 {
        figures.push(("attenuation_sigma", over_sigma(outcome)));
    }
    if !outcome.visibility.is_empty() {
        figures.push(("visibility", visibility(outcome)));
    }
    figures
}

const THETA: &str = "polar angle of the light θᵢ (°)";
const LIT: &str = "fraction of all points that are lit";

/// The lit fraction over theta, a curve per sigma.
fn over_theta(outcome: &AttenuationOutcome, sigmas: &[f64]) -> Curves {
    let curves = sigmas.iter().enumerate().map(|(i, &sigma)| Curve {
        name: format!("σ = {}", short(sigma)),
        colour: ramp(i, sigmas.len()),
        style: Style::Joined(i),
        points: measured(of_sigma(outcome, sigma), |row| (row.theta, row.lit)),
    });
    Curves {
        title: "Geometric attenuation of explicit surfaces".into(),
        subtitle: subtitle(outcome),
        x: axis(THETA, Some([0.0, 90.0])),
        y: axis(LIT, Some([0.0, 1.04])),
        curves: curves.collect(),
        notes: Vec::new(),
    }
}

/// The lit fraction over theta against models, for some sigma.
fn models_over_theta(outcome: &AttenuationOutcome) -> Curves {
    let tau = outcome.config.surface.tau.0;
    let phi = outcome.config.light.phi.0.to_radians();
    let (mut curves, mut lines) = (Vec::new(), Vec::new());
    for (i, &sigma) in outcome.models_at.iter().enumerate() {
        let colour = Colour::Nth(i);
        curves.push(Curve {
            name: format!("explicit, σ = {}", short(sigma)),
            colour,
            style: Style::Points(i),
            points: measured(of_sigma(outcome, sigma), |row| (row.theta, row.lit)),
        });
        let Ok(slopes) = SlopeCovariance::isotropic(tau / sigma) else {
            continue;
        };
        let line = |dash: usize, of: &dyn Fn(f64) -> f64| Curve {
            name: String::new(),
            colour,
            style: Style::Line(dash),
            points: degrees()
                .map(|theta| Point::exact(theta, of(theta.to_radians())))
                .collect(),
        };
        let w = |theta: f64| from_spherical(theta, phi);
        lines.push(line(0, &|theta| smith_lit(&slopes, w(theta))));
        lines.push(line(1, &|theta| v_cavity_lit(&slopes, w(theta))));
        lines.push(line(3, &|theta| smith_lit_as_printed(sigma, w(theta))));
    }
    // Points come first in the legend.
    curves.append(&mut lines);
    curves.extend(model_entries(&[
        ("Smith", Style::Line(0)),
        ("V-cavity", Style::Line(1)),
        (AS_PRINTED, Style::Line(3)),
    ]));
    Curves {
        title: "Geometric attenuation: explicit surfaces against models".into(),
        subtitle: subtitle(outcome),
        x: axis(THETA, Some([0.0, 90.0])),
        y: axis(LIT, Some([0.0, 1.04])),
        curves,
        notes: vec!["Colours: σ. Patterns: model.".into()],
    }
}

/// The lit fraction over sigma against Smith's, for some angles.
fn over_sigma(outcome: &AttenuationOutcome) -> Curves {
    let tau = outcome.config.surface.tau.0;
    let phi = outcome.config.light.phi.0;
    let (mut curves, mut lines) = (Vec::new(), Vec::new());
    let sigmas = distinct(outcome.rows.iter().map(|row| row.sigma));
    let (least, most) = sigmas
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(a, b), &s| (a.min(s), b.max(s)));
    let fine =
        move || (0..=STEPS).map(move |i| least + (most - least) * f64::from(i) / f64::from(STEPS));
    for (i, &theta) in outcome.over_sigma_at.iter().enumerate() {
        let colour = Colour::Nth(i);
        let rows = lights(outcome).filter(|row| row.theta == theta);
        curves.push(Curve {
            name: format!("explicit, θᵢ = {}°", short(theta)),
            colour,
            style: Style::Points(i),
            points: measured(rows, |row| (row.sigma, row.lit)),
        });
        let Ok(wi) = Incidence::from_degrees(theta, phi).map(Incidence::wi) else {
            continue;
        };
        let smith = |sigma: f64| {
            let slopes = SlopeCovariance::isotropic(tau / sigma).ok()?;
            Some(Point::exact(sigma, smith_lit(&slopes, wi)))
        };
        let printed = |sigma: f64| Point::exact(sigma, smith_lit_as_printed(sigma, wi));
        lines.push(Curve {
            name: String::new(),
            colour,
            style: Style::Line(0),
            points: fine().filter_map(smith).collect(),
        });
        lines.push(Curve {
            name: String::new(),
            colour,
            style: Style::Line(3),
            points: fine().map(printed).collect(),
        });
    }
    curves.append(&mut lines);
    curves.extend(model_entries(&[
        ("Smith", Style::Line(0)),
        (AS_PRINTED, Style::Line(3)),
    ]));
    Curves {
        title: "Geometric attenuation over roughness".into(),
        subtitle: subtitle(outcome),
        x: axis(&sigma_label(outcome.config.surface.unit), None),
        y: axis(LIT, Some([0.0, 1.04])),
        curves,
        notes: vec!["Colours: θᵢ. Patterns: model.".into()],
    }
}

/// The visibility over height on the surfaces of the first sigma, a colour an angle.
fn visibility(outcome: &AttenuationOutcome) -> Curves {
    let rows = &outcome.visibility;
    let sigma = rows[0].sigma;
    let of_sigma = || rows.iter().filter(|row| row.sigma == sigma);
    let smoothness = outcome.config.surface.tau.0 / sigma;
    let thetas = distinct(of_sigma().map(|row| row.theta));
    let (mut curves, mut lines) = (Vec::new(), Vec::new());
    for (i, &theta) in thetas.iter().enumerate() {
        let of_light: Vec<&VisibilityRow> = of_sigma().filter(|row| row.theta == theta).collect();
        let colour = Colour::Nth(i);
        let middle = |row: &VisibilityRow| 0.5 * (row.height_min + row.height_max);
        let points = of_light.iter().filter_map(|row| {
            let shown = row.visibility.filter(|_| row.points >= FEWEST_POINTS)?;
            Some(point(middle(row), shown))
        });
        curves.push(Curve {
            name: format!(
                "θᵢ = {}°: tan θᵢ / s = {}",
                short((10.0 * theta).round() / 10.0),
                short(round3(of_light[0].x))
            ),
            colour,
            style: Style::Points(0),
            points: points.collect(),
        });
        lines.extend(smith_line(smoothness, theta, colour));
        let at_zero = of_light.iter().filter_map(|row| row.xu_sun);
        lines.push(Curve {
            name: String::new(),
            colour,
            style: Style::Hollow(3),
            points: at_zero.map(|v| Point::exact(0.0, v)).collect(),
        });
    }
    curves.append(&mut lines);
    curves.extend(model_entries(&[
        ("Smith: Φ(h / σ) to the power Λ(θᵢ)", Style::Line(0)),
        ("Xu and Sun, Eq. 24, at height zero", Style::Hollow(3)),
    ]));
    Curves {
        title: "Visibility over height, of points that face the light".into(),
        subtitle: format!("{}, s = {}", subtitle(outcome), short(smoothness)),
        x: axis("height h / σ", Some([-HIGHEST - 0.1, HIGHEST + 0.1])),
        y: axis("visibility V(h, θᵢ)", Some([0.0, 1.04])),
        curves,
        notes: vec![
            "Points: explicit surfaces, bins of σ / 4.".into(),
            "Colours: θᵢ.".into(),
        ],
    }
}

/// Smith's visibility over height, of light at `theta` degrees.
fn smith_line(smoothness: f64, theta: f64, colour: Colour) -> Option<Curve> {
    let slopes = SlopeCovariance::isotropic(smoothness).ok()?;
    let light = Incidence::from_degrees(theta, 0.0).ok()?;
    let heights = (0..=STEPS).map(|k| HIGHEST * (2.0 * f64::from(k) / f64::from(STEPS) - 1.0));
    Some(Curve {
        name: String::new(),
        colour,
        style: Style::Line(0),
        points: heights
            .map(|h| Point::exact(h, smith_visibility(&slopes, light.wi(), h)))
            .collect(),
    })
}

const AS_PRINTED: &str = "Smith as the 2019 paper prints it";

/// Entries of models in the legend, in black: there the pattern tells the model, and the colour something else.
fn model_entries(models: &[(&str, Style)]) -> Vec<Curve> {
    let entry = |(name, style): &(&str, Style)| Curve {
        name: (*name).to_owned(),
        colour: Colour::Component(0),
        style: *style,
        points: Vec::new(),
    };
    models.iter().map(entry).collect()
}

/// Steps of a fine line.
const STEPS: u32 = 200;

/// End of the axis of heights, in sigma.
const HIGHEST: f64 = 3.5;

/// Points of a surface in a bin below which it is not drawn.
const FEWEST_POINTS: f64 = 20.0;

fn degrees() -> impl Iterator<Item = f64> {
    (0..180).map(|i| 0.5 * f64::from(i))
}

fn round3(value: f64) -> f64 {
    (1000.0 * value).round() / 1000.0
}

fn ramp(i: usize, count: usize) -> Colour {
    Colour::Ramp(i as f64 / (count.max(2) - 1) as f64)
}

fn axis(label: &str, range: Option<[f64; 2]>) -> CurveAxis {
    CurveAxis {
        label: label.into(),
        range,
    }
}

fn point(x: f64, estimate: Estimate) -> Point {
    Point::with_error(x, estimate.mean, estimate.se)
}

/// Rows of the first view, which the lit fraction does not depend on.
fn lights(outcome: &AttenuationOutcome) -> impl Iterator<Item = &AttenuationRow> {
    let view = outcome.rows[0].view_theta;
    outcome
        .rows
        .iter()
        .filter(move |row| row.view_theta == view)
}

fn of_sigma(outcome: &AttenuationOutcome, sigma: f64) -> impl Iterator<Item = &AttenuationRow> {
    lights(outcome).filter(move |row| row.sigma == sigma)
}

/// Measured points from left to right.
fn measured<'a>(
    rows: impl Iterator<Item = &'a AttenuationRow>,
    of: impl Fn(&AttenuationRow) -> (f64, Estimate),
) -> Vec<Point> {
    let mut points: Vec<Point> = rows
        .map(|row| {
            let (x, estimate) = of(row);
            point(x, estimate)
        })
        .collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    points
}

/// Values in the order in which they first come.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut seen: Vec<f64> = Vec::new();
    for value in values {
        if !seen.contains(&value) {
            seen.push(value);
        }
    }
    seen
}

fn subtitle(outcome: &AttenuationOutcome) -> String {
    let surface = &outcome.config.surface;
    let border = match surface.border {
        asperity_surface::Border::Periodic => String::new(),
        other => format!(", {other} border"),
    };
    format!(
        "τ = {}, spacing {}, {} of {} points{border}",
        short(surface.tau.0),
        short(surface.spacing.xy()[0].0),
        counted(outcome.work.realisations, "surface"),
        outcome.work.points
    )
}

/// The axis of root mean square heights.
fn sigma_label(unit: LengthUnit) -> String {
    let unit = match unit {
        LengthUnit::Arbitrary => "length units",
        LengthUnit::Micrometre => "µm",
        unit => unit.symbol(),
    };
    format!("root mean square height σ ({unit})")
}
