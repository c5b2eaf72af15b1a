//! Emissivity of opaque bodies: against the polar angle, and over the hemisphere.
//!
//! The hemispherical emissivity is the mean of the directional one over `sin^2 theta`. Each polar angle counts for the part of the hemisphere that
//! is nearest to it, and azimuths count alike: the midpoint rule, exact to second order in the distance between angles.

use asperity_numerics::elementary::{hypot, sin};
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Figure, PlotError, Point, Style};
use asperity_tally::Estimate;

use super::distinction::{Distinction, labelled};
use super::outcome::GonioOutcome;
use crate::output::{Column, EstimateWithLimit, Table};
use crate::report::spectrum::{emissivity, weighted_sum};
use crate::report::views::Csv;

/// Fewest polar angles of which the hemisphere is made.
const MIN_ANGLES: usize = 3;

/// Least value of the last of them, degrees: it stands for all that are lower.
const MIN_LAST_DEG: f64 = 75.0;

/// Emissivity of one setting.
pub(super) struct SettingEmissivity {
    number: usize,
    label: String,
    /// Wavelength in vacuum, nanometres, where the material depends on it.
    wavelength: Option<f64>,
    /// Mean over the azimuths of the light, by polar angle in degrees, ascending.
    by_theta: Vec<(f64, Estimate)>,
}

impl SettingEmissivity {
    /// The emissivity of each opaque setting that was measured at [`MIN_ANGLES`] polar angles or more.
    pub(super) fn of(outcome: &GonioOutcome<'_>) -> Vec<Self> {
        let distinction = Distinction::of(outcome.settings());
        let settings = distinction.labels.iter().enumerate();
        let settings = settings.filter_map(|(number, label)| {
            let case = outcome.settings().nth(number)?;
            let by_theta = by_theta(outcome, number)?;
            (by_theta.len() >= MIN_ANGLES).then(|| Self {
                number,
                label: labelled(&distinction.title, label),
                wavelength: case.at.wavelength_nm(),
                by_theta,
            })
        });
        settings.collect()
    }

    /// Hemispherical emissivity; `None` if no angle is near the horizon. Standard errors add, since directions share their surfaces; that of the
    /// angles is the difference between two rules of the same order.
    fn hemispherical(&self) -> Option<Estimate> {
        let angles: Vec<f64> = self.by_theta.iter().map(|(theta, _)| *theta).collect();
        let reaches = *angles.last()? >= MIN_LAST_DEG;
        let by = |middle: fn(f64, f64) -> f64| {
            let all = self.by_theta.iter().map(|(_, one)| *one);
            weighted_sum(hemisphere_weights(&angles, middle).into_iter().zip(all))
        };
        let (nearest, other) = (by(between_angles), by(between_parts));
        reaches.then(|| Estimate {
            mean: nearest.mean,
            se: nearest.se.map(|se| hypot(se, nearest.mean - other.mean)),
        })
    }
}

fn square_of_sine(theta_deg: f64) -> f64 {
    sin(theta_deg.to_radians()).powi(2)
}

/// Part of the hemisphere, by `sin^2 theta`, within the angle in the middle between two, degrees.
fn between_angles(first: f64, second: f64) -> f64 {
    square_of_sine(0.5 * (first + second))
}

/// The middle between the parts of the hemisphere within two angles, degrees.
fn between_parts(first: f64, second: f64) -> f64 {
    0.5 * (square_of_sine(first) + square_of_sine(second))
}

/// Weights of ascending polar angles, degrees, in a mean over `sin^2 theta`, with edges in the `middle` between neighbours.
fn hemisphere_weights(angles: &[f64], middle: fn(f64, f64) -> f64) -> Vec<f64> {
    let middles = angles.windows(2).map(|pair| middle(pair[0], pair[1]));
    let edges: Vec<f64> = [0.0].into_iter().chain(middles).chain([1.0]).collect();
    edges.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// The emissivity by polar angle; `None` where a direction is missing or the body is not opaque.
fn by_theta(outcome: &GonioOutcome<'_>, setting: usize) -> Option<Vec<(f64, Estimate)>> {
    let of_theta = |theta: usize| {
        let found = outcome.ring(setting, theta);
        let found = found.map(|direction| emissivity(direction.outcome?));
        let found = found.collect::<Option<Vec<Estimate>>>()?;
        let phis = found.len();
        let mean = weighted_sum(found.into_iter().map(|one| (1.0 / phis as f64, one)));
        Some((outcome.thetas[theta], mean))
    };
    let all = (0..outcome.thetas.len()).map(of_theta);
    let mut all = all.collect::<Option<Vec<_>>>()?;
    all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    Some(all)
}

/// One row of emissivity.csv.
struct Row {
    setting: usize,
    wavelength: Option<f64>,
    theta: f64,
    emissivity: Estimate,
    hemispherical: Option<Estimate>,
}

/// emissivity.csv: a row per opaque setting and polar angle.
pub(super) fn emissivity_table<'a>(settings: &[SettingEmissivity]) -> Option<Csv<'a>> {
    let rows: Vec<Row> = settings
        .iter()
        .flat_map(|one| {
            let hemispherical = one.hemispherical();
            one.by_theta.iter().map(move |&(theta, emissivity)| Row {
                setting: one.number,
                wavelength: one.wavelength,
                theta,
                emissivity,
                hemispherical,
            })
        })
        .collect();
    let table = Table::new()
        .column(Column::new(
            "setting",
            "number of the setting",
            |row: &Row| row.setting,
        ))
        .column(
            Column::new("wavelength_nm", "wavelength in vacuum", |row: &Row| {
                row.wavelength
            })
            .unit("nm"),
        )
        .column(Column::new("theta_deg", "polar angle", |row: &Row| row.theta).unit("deg"))
        .column(Column::estimate(
            "emissivity",
            "1 less the directional-hemispherical reflectance, mean over azimuths",
            |row: &Row| Some(row.emissivity),
        ))
        .column(Column::estimate(
            "hemispherical_emissivity",
            "mean over sin^2 theta of all polar angles",
            |row: &Row| row.hemispherical,
        ));
    (!rows.is_empty()).then(|| table.with_rows(rows))
}

/// Lines of the report, one per setting.
pub(super) fn emissivity_lines(settings: &[SettingEmissivity]) -> Vec<String> {
    let line = |one: &SettingEmissivity| {
        let hemispherical = EstimateWithLimit::from(one.hemispherical()?);
        let angles = one.by_theta.len();
        let label = match one.label.as_str() {
            "" => String::new(),
            label => format!("{label}: "),
        };
        Some(format!(
            "{label}hemispherical emissivity {} from {angles} polar angles",
            hemispherical.text()
        ))
    };
    settings.iter().filter_map(line).collect()
}

/// The emissivity of opaque settings against the polar angle.
pub(super) fn emissivity_figure(
    settings: &[SettingEmissivity],
    subtitle: String,
) -> Result<Option<Figure>, PlotError> {
    if settings.is_empty() {
        return Ok(None);
    }
    let place = |i: usize| i as f64 / (settings.len() - 1).max(1) as f64;
    let curves = settings.iter().enumerate().map(|(i, one)| Curve {
        name: match one.label.as_str() {
            "" => "emissivity".to_owned(),
            label => label.to_owned(),
        },
        colour: Colour::Ramp(place(i)),
        style: Style::Joined(i),
        points: one
            .by_theta
            .iter()
            .map(|(theta, emissivity)| Point {
                se: emissivity.se,
                ..Point::exact(*theta, emissivity.mean)
            })
            .collect(),
    });
    let figure = Curves {
        title: "Directional emissivity: 1 less the directional-hemispherical reflectance"
            .to_owned(),
        subtitle,
        x: CurveAxis {
            label: "polar angle (degrees)".to_owned(),
            range: Some([0.0, 90.0]),
        },
        y: CurveAxis {
            label: "emissivity".to_owned(),
            range: None,
        },
        log_from: None,
        curves: curves.collect(),
        notes: Vec::new(),
    };
    figure.draw().map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of `cos theta` over `sin^2 theta`: 2/3; the midpoint rule converges to it at second order.
    #[test]
    fn the_hemisphere_is_weighted_by_projected_solid_angle() {
        let error = |step: usize| {
            let angles: Vec<f64> = (step / 2..90).step_by(step).map(|i| i as f64).collect();
            let weights = hemisphere_weights(&angles, between_angles);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let cosines = angles.iter().map(|theta| theta.to_radians().cos());
            let mean: f64 = weights.iter().zip(cosines).map(|(w, cos)| w * cos).sum();
            (mean - 2.0 / 3.0).abs()
        };
        assert!(
            error(10) < 2e-3 && error(2) < 1e-4,
            "{} {}",
            error(10),
            error(2)
        );
    }
}
