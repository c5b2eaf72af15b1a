//! The plots of an attenuation run.

use asperity_analysis::{
    SlopeCovariance, smith_lit, smith_lit_as_printed, smith_visibility, v_cavity_lit,
};
use asperity_optics::from_spherical;
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};
use asperity_simulate::{counted, short};
use asperity_surface::{Border, LengthUnit};
use asperity_tally::Estimate;

use super::heights::BINS;
use super::{AttenuationOutcome, AttenuationRow};

/// A plot; `None` if the results cannot fill it.
type Plot = fn(&AttenuationOutcome<'_>) -> Option<Curves>;

/// All plots, by name of their files.
pub(super) const FIGURES: [(&str, Plot); 4] = [
    ("attenuation_theta", |found| {
        (found.study.lights.len() > 1).then(|| over_theta(found))
    }),
    ("attenuation_models", |found| {
        (found.study.lights.len() > 1).then(|| models_over_theta(found))
    }),
    ("attenuation_sigma", |found| {
        (found.study.surfaces.len() > 1).then(|| over_sigma(found))
    }),
    ("visibility", |found| {
        (!found.visibility.is_empty()).then(|| visibility(found))
    }),
];

const THETA: &str = "polar angle of the light θᵢ (°)";
const FRACTIONS: Option<[f64; 2]> = Some([0.0, 1.04]);
const LIT: &str = "fraction of all points that are lit";
const AS_PRINTED: &str = "Smith as the 2019 paper prints it";
const SMITH_STYLE: Style = Style::Line(0);
const V_CAVITY_STYLE: Style = Style::Line(1);
const PRINTED_STYLE: Style = Style::Line(3);
const XU_SUN_STYLE: Style = Style::Hollow(3);

/// The lit fraction over theta, a curve per sigma.
fn over_theta(outcome: &AttenuationOutcome<'_>) -> Curves {
    let surfaces = &outcome.study.surfaces;
    let last = (surfaces.len().max(2) - 1) as f64;
    let curves = surfaces.iter().enumerate().map(|(i, surfaces)| {
        let name = format!("σ = {}", short(surfaces.sigma));
        let colour = Colour::Ramp(i as f64 / last);
        let points = lit_over_theta(outcome, surfaces.sigma);
        curve(name, colour, Style::Joined(i), points)
    });
    Curves {
        title: "Geometric attenuation of explicit surfaces".into(),
        subtitle: subtitle(outcome),
        x: axis(THETA, Some([0.0, 90.0])),
        y: axis(LIT, FRACTIONS),
        log_from: None,
        curves: curves.collect(),
        notes: Vec::new(),
    }
}

/// The lit fraction over theta against models, for some sigma.
fn models_over_theta(outcome: &AttenuationOutcome<'_>) -> Curves {
    let phi = outcome.study.lights[0].phi();
    // Points come first in the legend.
    let mut curves = Vec::new();
    for (i, &number) in outcome.study.models_at.iter().enumerate() {
        let surfaces = &outcome.study.surfaces[number];
        let (sigma, slopes) = (surfaces.sigma, &surfaces.slopes);
        let colour = Colour::Nth(i);
        let name = format!("explicit, σ = {}", short(sigma));
        let points = lit_over_theta(outcome, sigma);
        curves.insert(i, curve(name, colour, Style::Points(i), points));
        let wi = |theta: f64| from_spherical(theta.to_radians(), phi);
        let degrees = || (0..180).map(|i| 0.5 * f64::from(i));
        let smith = degrees().map(|x| Point::exact(x, smith_lit(slopes, wi(x))));
        let v_cavity = degrees().map(|x| Point::exact(x, v_cavity_lit(slopes, wi(x))));
        let printed = degrees().map(|x| Point::exact(x, smith_lit_as_printed(sigma, wi(x))));
        curves.push(curve("", colour, SMITH_STYLE, smith));
        curves.push(curve("", colour, V_CAVITY_STYLE, v_cavity));
        curves.push(curve("", colour, PRINTED_STYLE, printed));
    }
    let models = [
        ("Smith", SMITH_STYLE),
        ("V-cavity", V_CAVITY_STYLE),
        (AS_PRINTED, PRINTED_STYLE),
    ];
    Curves {
        title: "Geometric attenuation: explicit surfaces against models".into(),
        subtitle: subtitle(outcome),
        x: axis(THETA, Some([0.0, 90.0])),
        y: axis(LIT, FRACTIONS),
        curves: with_models(curves, &models),
        log_from: None,
        notes: ["Colours: σ. Patterns: model.".into()]
            .into_iter()
            .chain(left_out(
                "σ",
                "",
                &outcome.study.models_at,
                outcome.study.surfaces.iter().map(|surfaces| surfaces.sigma),
            ))
            .collect(),
    }
}

/// The lit fraction over sigma against Smith's, for some angles.
fn over_sigma(outcome: &AttenuationOutcome<'_>) -> Curves {
    let surface = &outcome.study.config.surface;
    let sigmas = || outcome.study.surfaces.iter().map(|surfaces| surfaces.sigma);
    let least = sigmas().fold(f64::INFINITY, f64::min);
    let most = sigmas().fold(0.0, f64::max);
    let fine = || steps([least, most]);
    let mut curves = Vec::new();
    for (i, &number) in outcome.study.over_sigma_at.iter().enumerate() {
        let light = outcome.study.lights[number];
        let (theta, wi) = (light.theta_deg(), light.wi());
        let colour = Colour::Nth(i);
        let name = format!("explicit, θᵢ = {}°", short(theta));
        let points = lit(outcome, |row| (row.light == light).then_some(row.sigma));
        curves.insert(i, curve(name, colour, Style::Points(i), points));
        let smith = |sigma: f64| {
            let slopes = SlopeCovariance::isotropic(surface.tau.0 / sigma).ok()?;
            Some(Point::exact(sigma, smith_lit(&slopes, wi)))
        };
        let printed = |sigma: f64| Point::exact(sigma, smith_lit_as_printed(sigma, wi));
        curves.push(curve("", colour, SMITH_STYLE, fine().filter_map(smith)));
        curves.push(curve("", colour, PRINTED_STYLE, fine().map(printed)));
    }
    let unit = match surface.unit {
        LengthUnit::Arbitrary => "length units",
        LengthUnit::Micrometre => "µm",
        unit => unit.symbol(),
    };
    let models = [("Smith", SMITH_STYLE), (AS_PRINTED, PRINTED_STYLE)];
    Curves {
        title: "Geometric attenuation over roughness".into(),
        subtitle: subtitle(outcome),
        x: axis(format!("root mean square height σ ({unit})"), None),
        y: axis(LIT, FRACTIONS),
        curves: with_models(curves, &models),
        log_from: None,
        notes: ["Colours: θᵢ. Patterns: model.".into()]
            .into_iter()
            .chain(left_out(
                "θᵢ",
                "°",
                &outcome.study.over_sigma_at,
                outcome.study.lights.iter().map(|light| light.theta_deg()),
            ))
            .collect(),
    }
}

/// The visibility over height on the surfaces of the first sigma, a colour per angle.
fn visibility(outcome: &AttenuationOutcome<'_>) -> Curves {
    let surfaces = &outcome.study.surfaces[0];
    let smoothness = outcome.study.config.surface.tau.0 / surfaces.sigma;
    let mut curves = Vec::new();
    let of_lights = outcome.visibility.chunks(BINS).zip(&outcome.study.lights);
    for (i, (rows, light)) in of_lights.enumerate() {
        let colour = Colour::Nth(i);
        let points = rows.iter().filter_map(|row| {
            let shown = row.visibility.filter(|_| row.points >= MIN_POINTS)?;
            let middle = 0.5 * (row.height_min + row.height_max);
            Some(point(middle, shown))
        });
        let name = format!(
            "θᵢ = {}°: tan θᵢ / s = {}",
            short((10.0 * light.theta_deg()).round() / 10.0),
            short((1000.0 * rows[0].x).round() / 1000.0)
        );
        curves.insert(i, curve(name, colour, Style::Points(i), points));
        let wi = from_spherical(light.theta(), 0.0);
        let heights = steps([-1.0, 1.0]).map(|step| HIGHEST * step);
        let smith = heights.map(|h| Point::exact(h, smith_visibility(&surfaces.slopes, wi, h)));
        curves.push(curve("", colour, SMITH_STYLE, smith));
        let at_zero = rows.iter().filter_map(|row| row.xu_sun);
        let at_zero = at_zero.map(|visibility| Point::exact(0.0, visibility));
        curves.push(curve("", colour, XU_SUN_STYLE, at_zero));
    }
    let models = [
        ("Smith: Φ(h / σ) to the power Λ(θᵢ)", SMITH_STYLE),
        ("Xu and Sun, Eq. 24, at height zero", XU_SUN_STYLE),
    ];
    Curves {
        title: "Visibility over height, of points that face the light".into(),
        subtitle: format!("{}, s = {}", subtitle(outcome), short(smoothness)),
        x: axis("height h / σ", Some([-HIGHEST - 0.1, HIGHEST + 0.1])),
        y: axis("visibility V(h, θᵢ)", FRACTIONS),
        log_from: None,
        curves: with_models(curves, &models),
        notes: vec![
            "Points: explicit surfaces, bins of σ / 4.".into(),
            "Colours: θᵢ.".into(),
        ],
    }
}

/// End of the axis of heights, in sigma.
const HIGHEST: f64 = 3.5;

/// Points of a surface in a bin below which it is not drawn.
const MIN_POINTS: f64 = 20.0;

/// Steps of a fine line.
const STEPS: u32 = 200;

/// Points of a fine line over a range.
fn steps([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    (0..=STEPS).map(move |i| from + (to - from) * f64::from(i) / f64::from(STEPS))
}

fn curve(
    name: impl Into<String>,
    colour: Colour,
    style: Style,
    points: impl IntoIterator<Item = Point>,
) -> Curve {
    Curve {
        name: name.into(),
        colour,
        style,
        points: points.into_iter().collect(),
    }
}

/// Curves, and entries of models in black: there the pattern tells the model, and the colour something else.
fn with_models(mut curves: Vec<Curve>, models: &[(&str, Style)]) -> Vec<Curve> {
    let entries = models.iter();
    curves.extend(entries.map(|(name, style)| curve(*name, Colour::Component(0), *style, [])));
    curves
}

/// Remark on the values that are not drawn, if there are any: `Not drawn: θᵢ = 30°, 75°.`
fn left_out(
    symbol: &str,
    unit: &str,
    drawn: &[usize],
    values: impl Iterator<Item = f64>,
) -> Option<String> {
    let values = values
        .enumerate()
        .filter(|(number, _)| !drawn.contains(number));
    let values: Vec<String> = values.map(|(_, value)| short(value) + unit).collect();
    (!values.is_empty()).then(|| format!("Not drawn: {symbol} = {}.", values.join(", ")))
}

fn axis(label: impl Into<String>, range: Option<[f64; 2]>) -> CurveAxis {
    let label = label.into();
    CurveAxis { label, range }
}

fn point(x: f64, estimate: Estimate) -> Point {
    Point::with_error(x, estimate.mean, estimate.se)
}

/// Lit fractions of the rows that have a place, from left to right.
fn lit(
    outcome: &AttenuationOutcome<'_>,
    place: impl Fn(&AttenuationRow) -> Option<f64>,
) -> Vec<Point> {
    let rows = outcome.of_first_view();
    let points = rows.filter_map(|row| Some(point(place(row)?, row.lit)));
    let mut points: Vec<Point> = points.collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    points
}

fn lit_over_theta(outcome: &AttenuationOutcome<'_>, sigma: f64) -> Vec<Point> {
    lit(outcome, |row| {
        (row.sigma == sigma).then(|| row.light.theta_deg())
    })
}

fn subtitle(outcome: &AttenuationOutcome<'_>) -> String {
    let surface = &outcome.study.config.surface;
    let border = match surface.border {
        Border::Periodic => String::new(),
        other => format!(", {other} border"),
    };
    format!(
        "τ = {}, spacing {}, {} of {} points, seed {}{border}",
        short(surface.tau.0),
        short(surface.spacing.xy()[0].0),
        counted(outcome.work.realisations, "surface"),
        outcome.work.points,
        outcome.study.config.run.seed
    )
}
