//! Specular table: BSDFs over the angle to the direction in which a smooth sample would send the light, and the azimuth about it.
//!
//! Azimuth 0 lies between that direction and the normal of the side. Azimuths turn counter-clockwise as seen against the light that leaves,
//! of transmitted light as mirrored at the mean plane: 90 degrees lies at y < 0 where light travels along +x.

use std::f64::consts::PI;

use asperity_numerics::elementary::{sin, sin_cos};
use asperity_optics::{azimuth, from_spherical, polar_angle};
use asperity_simulate::{Case, CaseApertures, Outcome};
use asperity_tally::Side;
use glam::DVec3;

use super::interpolation::Interpolated;

/// Step of azimuths about the specular direction, degrees.
const AZIMUTH_STEP: usize = 5;

/// Steps of the angle to the specular direction that a grid may have, hundredths of a degree.
const RADIAL_STEPS: [u32; 9] = [1, 2, 5, 10, 20, 50, 100, 200, 500];

/// Largest step near the specular direction, hundredths of a degree.
const COARSEST_CENTRE: f64 = 100.0;

/// Angle to the specular direction over the step there, where steps grow.
const STEPS_PER_ANGLE: f64 = 16.0;

/// Parts of a cell per axis for the integral over a table.
const PARTS: usize = 4;

/// Angles of a table, degrees.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SpecularGrid {
    /// Angles to the specular direction, ascending from 0.
    pub(super) radial_deg: Vec<f64>,
    /// Azimuths about it, from 0 to 180 for light that is symmetric about the plane of incidence, otherwise to 360.
    pub(super) azimuth_deg: Vec<f64>,
}

/// BSDF of one direction of light.
#[derive(Clone, Debug)]
pub(super) struct SpecularTable {
    /// Values, 1/sr, by azimuth and angle to the specular direction; 0 beyond the horizon.
    pub(super) values: Vec<f64>,
    /// Flux that they integrate to, if they are interpolated linearly.
    pub(super) flux: f64,
}

/// Polar angle from the normal of a side at which a smooth sample would send the light, radians; `None` where it sends none there.
pub(super) fn specular_theta(case: &Case, side: Side) -> Option<f64> {
    match side {
        Side::Reflected => Some(case.light.incidence.theta()),
        Side::Transmitted => Some(PI - CaseApertures::of(case).straight?.theta),
    }
}

impl SpecularGrid {
    /// A grid as fine about the specular direction as the narrowest rings of the outcomes, up to the horizon behind the normal.
    pub(super) fn of(outcomes: &[&Outcome], side: Side, farthest: f64, is_symmetric: bool) -> Self {
        let widths = outcomes.iter().flat_map(|outcome| {
            let edges = outcome.statistics.spec().grid().theta_edges_deg(side);
            edges
                .windows(2)
                .map(|pair| pair[1] - pair[0])
                .collect::<Vec<f64>>()
        });
        let finest = widths.fold(f64::INFINITY, f64::min) * 100.0;
        let finest = finest.min(COARSEST_CENTRE);
        let end = (90.0 + farthest.to_degrees()).min(180.0) * 100.0;
        let mut radial = vec![0];
        let mut last = 0;
        while f64::from(last) < end {
            let wanted = finest.max(f64::from(last) / STEPS_PER_ANGLE);
            let fitting = RADIAL_STEPS.iter().rev();
            let mut fitting = fitting.filter(|step| f64::from(**step) <= wanted);
            last += fitting.next().unwrap_or(&RADIAL_STEPS[0]);
            radial.push(last.min(18_000));
        }
        let turn = if is_symmetric { 180 } else { 360 };
        Self {
            radial_deg: radial.iter().map(|&one| f64::from(one) / 100.0).collect(),
            azimuth_deg: (0..=turn).step_by(AZIMUTH_STEP).map(f64::from).collect(),
        }
    }

    /// BSDF of an outcome about the specular direction at the polar angle `theta`, radians, of light from the azimuth `phi`, radians.
    pub(super) fn table(
        &self,
        outcome: &Outcome,
        side: Side,
        theta: f64,
        phi: f64,
    ) -> SpecularTable {
        let bsdf = Interpolated::of(outcome, side);
        let frame = Frame::new(theta, phi);
        let is_symmetric = self.azimuth_deg.last() == Some(&180.0);
        let value = |radial: f64, about: f64| {
            let at = |about: f64| {
                let direction = frame.direction(radial, about);
                match direction.z > 0.0 {
                    true => bsdf.at(polar_angle(direction), azimuth(direction)),
                    false => 0.0,
                }
            };
            let mean = match is_symmetric {
                true => 0.5 * (at(about) + at(-about)),
                false => at(about),
            };
            // A control variate may give negative values within its error
            mean.max(0.0)
        };
        let [radial, about] = [&self.radial_deg, &self.azimuth_deg].map(|all| radians(all));
        let values = about
            .iter()
            .flat_map(|about| radial.iter().map(move |radial| (*radial, *about)));
        let values: Vec<f64> = values.map(|(radial, about)| value(radial, about)).collect();
        let flux = integral(&values, &radial, &about, &frame);
        SpecularTable {
            values,
            flux: if is_symmetric { 2.0 * flux } else { flux },
        }
    }
}

/// Integral over the values of a table times the cosine, between its angles.
fn integral(values: &[f64], radial: &[f64], about: &[f64], frame: &Frame) -> f64 {
    let mut sum = 0.0;
    let within = || (0..PARTS).map(|part| (part as f64 + 0.5) / PARTS as f64);
    for j in 1..about.len() {
        for i in 1..radial.len() {
            let corner = |j: usize, i: usize| values[j * radial.len() + i];
            let corners = [
                corner(j - 1, i - 1),
                corner(j - 1, i),
                corner(j, i - 1),
                corner(j, i),
            ];
            if corners == [0.0; 4] {
                continue;
            }
            let [height, width] = [radial[i] - radial[i - 1], about[j] - about[j - 1]];
            for v in within() {
                for u in within() {
                    let [r, a] = [radial[i - 1] + u * height, about[j - 1] + v * width];
                    let along = |k: usize| corners[k] + u * (corners[k + 1] - corners[k]);
                    let value = along(0) + v * (along(2) - along(0));
                    let cosine = frame.direction(r, a).z.max(0.0);
                    sum += value * cosine * sin(r) * height * width / (PARTS * PARTS) as f64;
                }
            }
        }
    }
    sum
}

/// Axes of a table: z along the specular direction, x towards the normal, with the normal of the side along the z of their components.
struct Frame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    fn new(theta: f64, phi: f64) -> Self {
        let z = from_spherical(theta, phi + PI);
        let x = from_spherical(0.5 * PI - theta, phi);
        Self {
            x,
            y: z.cross(x),
            z,
        }
    }

    /// Direction at these angles, radians.
    fn direction(&self, radial: f64, about: f64) -> DVec3 {
        let (sin_radial, cos_radial) = sin_cos(radial);
        let (sin_about, cos_about) = sin_cos(about);
        cos_radial * self.z + sin_radial * (cos_about * self.x + sin_about * self.y)
    }
}

fn radians(degrees: &[f64]) -> Vec<f64> {
    degrees.iter().map(|one| one.to_radians()).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_PI;

    use super::*;

    #[test]
    fn azimuth_zero_leads_to_the_normal_and_a_quarter_turn_to_the_left_of_the_light() {
        let theta = 0.6;
        let frame = Frame::new(theta, 0.0);
        let near = |found: DVec3, expected: DVec3| (found - expected).length() < 1e-12;
        assert!(near(frame.direction(0.0, 0.0), from_spherical(theta, PI)));
        assert!(near(frame.direction(theta, 0.0), DVec3::Z));
        assert!(near(
            frame.direction(2.0 * theta, 0.0),
            from_spherical(theta, 0.0)
        ));
        assert!(near(frame.direction(0.5 * PI, 0.5 * PI), DVec3::Y));
        let turned = Frame::new(theta, 0.5 * PI);
        assert!(near(turned.direction(0.5 * PI, 0.5 * PI), DVec3::NEG_X));
    }

    /// Light is lost in the cells that the horizon cuts alone, which here are filled.
    #[test]
    fn a_table_of_a_lambertian_surface_has_all_its_light() {
        for theta in [0.0, 0.5, 1.3] {
            let radial: Vec<f64> = (0..=180).map(|i| f64::from(i).to_radians()).collect();
            let about: Vec<f64> = (0..=72).map(|i| f64::from(5 * i).to_radians()).collect();
            let values = vec![FRAC_1_PI; radial.len() * about.len()];
            let flux = integral(&values, &radial, &about, &Frame::new(theta, 1.0));
            assert!((flux - 1.0).abs() < 1e-4, "{theta}: {flux}");
        }
    }
}
