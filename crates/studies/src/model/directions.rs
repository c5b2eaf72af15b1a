//! A model at single directions: in the plane of incidence, or over the sphere.

use asperity_optics::Incidence;
use asperity_tally::Side;

use super::config::Selection;
use super::error::EvaluationError;
use super::evaluation::Evaluation;
use crate::output::{Column, Table};
use crate::report::views::Csv;

/// Most rows of one table.
pub(super) const MAX_ROWS: f64 = 1e7;

/// Distance between directions unless one is given, degrees.
const DEFAULT_STEP: f64 = 1.0;

/// A direction in which light leaves.
#[derive(Clone, Copy, Debug)]
struct Outgoing {
    side: Side,
    theta_deg: f64,
    phi_deg: f64,
}

/// A model at single directions.
pub(super) struct Directions {
    about: About,
    rows: Vec<Row>,
}

/// Text printed with the values.
pub(super) struct About {
    /// The model.
    pub(super) description: &'static str,
    pub(super) notes: Vec<String>,
}

struct Row {
    direction: Outgoing,
    bsdf: f64,
}

impl Directions {
    /// The values that `bsdf` has by polar angle and azimuth, radians.
    pub(super) fn of(
        selection: &Selection,
        incidence: Incidence,
        about: About,
        bsdf: impl Fn(f64, f64) -> f64,
    ) -> Result<Self, EvaluationError> {
        let directions = directions(selection, incidence)?.into_iter();
        Ok(Self::at(directions, about, bsdf))
    }

    /// The values at the multiples of the step from one polar angle to another, on the side of the light, at one azimuth, degrees.
    pub(super) fn along(
        selection: &Selection,
        [from, to]: [f64; 2],
        phi_deg: f64,
        about: About,
        bsdf: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let step = selection.step.unwrap_or(DEFAULT_STEP);
        let within = move |angle: &f64| (from - 1e-9..=to + 1e-9).contains(angle);
        let angles = multiples(step, 90.0).into_iter().filter(within);
        let direction = |theta_deg: f64| Outgoing {
            side: Side::Reflected,
            theta_deg,
            phi_deg: phi_deg.rem_euclid(360.0),
        };
        Self::at(angles.map(direction), about, bsdf)
    }

    fn at(
        directions: impl Iterator<Item = Outgoing>,
        about: About,
        bsdf: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let row = |direction: Outgoing| {
            let [theta, phi] = [direction.theta_deg, direction.phi_deg].map(f64::to_radians);
            Row {
                direction,
                bsdf: bsdf(theta, phi),
            }
        };
        Self {
            about,
            rows: directions.map(row).collect(),
        }
    }
}

fn table() -> Table<'static, Row> {
    Table::new()
        .column(Column::new(
            "side",
            "side on which light leaves",
            |row: &Row| row.direction.side.to_string(),
        ))
        .column(
            Column::new(
                "theta_deg",
                "polar angle of the direction from +z",
                |row: &Row| row.direction.theta_deg,
            )
            .unit("deg"),
        )
        .column(
            Column::new("phi_deg", "azimuth of the direction", |row: &Row| {
                row.direction.phi_deg
            })
            .unit("deg"),
        )
        .column(Column::new("bsdf", "BSDF", |row: &Row| row.bsdf).unit("1/sr"))
}

impl Evaluation for Directions {
    fn table(&self) -> Csv<'_> {
        table().with_rows(&self.rows)
    }

    fn is_listed(&self) -> bool {
        true
    }

    fn rows(&self) -> (usize, &'static str) {
        (self.rows.len(), "directions")
    }

    fn notes(&self) -> &[String] {
        &self.about.notes
    }

    fn description(&self) -> &'static str {
        self.about.description
    }
}

/// The requested directions.
fn directions(
    selection: &Selection,
    incidence: Incidence,
) -> Result<Vec<Outgoing>, EvaluationError> {
    let step = selection.step.unwrap_or(DEFAULT_STEP);
    let rows = match selection.sphere {
        true => 64_800.0 / (step * step),
        false => 360.0 / step,
    };
    if rows > MAX_ROWS {
        return Err(EvaluationError::TooManyRows {
            step,
            rows,
            most: MAX_ROWS,
        });
    }
    Ok(match selection.sphere {
        true => sphere(step),
        false => in_plane(step, incidence),
    })
}

/// Multiples of `step` below `end`, degrees.
fn multiples(step: f64, end: f64) -> Vec<f64> {
    let count = (end / step).ceil() as usize;
    let multiples = (0..count).map(|i| i as f64 * step);
    multiples.filter(|&angle| angle < end - 1e-9).collect()
}

/// The polar angle from +z of an angle from the normal of a side, degrees.
fn polar_angle(side: Side, from_normal: f64) -> f64 {
    match side {
        Side::Reflected => from_normal,
        Side::Transmitted => 180.0 - from_normal,
    }
}

/// On each side, from backward grazing through the normal to forward grazing. Directions in the surface itself
/// are left out, since a BSDF has no value there.
fn in_plane(step: f64, incidence: Incidence) -> Vec<Outgoing> {
    let backward = incidence.phi_deg();
    let forward = (backward + 180.0).rem_euclid(360.0);
    let angles = multiples(step, 90.0);
    let of_side = |side| {
        let direction = move |phi_deg| {
            move |&angle: &f64| Outgoing {
                side,
                theta_deg: polar_angle(side, angle),
                phi_deg,
            }
        };
        let backward = angles.iter().skip(1).rev().map(direction(backward));
        backward.chain(angles.iter().map(direction(forward)))
    };
    Side::BOTH.into_iter().flat_map(of_side).collect()
}

/// By polar angle from +z, then by azimuth; directions in the surface itself are left out.
fn sphere(step: f64) -> Vec<Outgoing> {
    let azimuths = multiples(step, 360.0);
    let angles = multiples(step, 90.0);
    let reflected = angles.iter().map(|&angle| (Side::Reflected, angle));
    let transmitted = angles.iter().rev().map(|&angle| (Side::Transmitted, angle));
    let ring = |(side, angle): (Side, f64)| {
        azimuths.iter().map(move |&phi_deg| Outgoing {
            side,
            theta_deg: polar_angle(side, angle),
            phi_deg,
        })
    };
    reflected.chain(transmitted).flat_map(ring).collect()
}
