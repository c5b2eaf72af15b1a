//! Directions: the outcomes of one sample as a grid over wavelength and direction of the light, as tables of renderers and ray tracers have them.

use asperity_results::CaseResult;
use asperity_simulate::Outcome;
use asperity_tracer::HalfSpace;

use super::axes::Axes;
use super::measurement::Measurement;

/// Coordinates in which outcomes of one sample may differ.
const OF_ONE_SAMPLE: [&str; 4] = ["from", "wavelength_nm", "theta_deg", "phi_deg"];

/// Fewest polar angles of the light, and the last one, degrees, that keep the error of readers between them small.
const ENOUGH: (usize, f64) = (16, 85.0);

/// Outcomes of one sample, of light from every combination of polar angle and azimuth at every wavelength.
pub(super) struct Directions<'a> {
    /// Wavelengths, nm, ascending; one `None` for results without a wavelength.
    pub(super) wavelengths_nm: Vec<Option<f64>>,
    /// Polar angles of the light, degrees, ascending.
    pub(super) theta_deg: Vec<f64>,
    /// Azimuths of the light, degrees, ascending: one, or several that divide the turn evenly from 0 on.
    pub(super) phi_deg: Vec<f64>,
    /// Outcomes by wavelength, azimuth and polar angle, the last fastest. Light along the normal is the same at all azimuths.
    pub(super) outcomes: Vec<&'a Outcome>,
}

/// Checks that light is unpolarised, and comes from one direction at a time.
///
/// # Errors
/// A sentence on what a file of such light needs.
pub(super) fn check_light(cases: &[CaseResult]) -> Result<(), String> {
    let mut lights = cases.iter().map(|case| case.outcome.case.light);
    if lights.clone().any(|light| light.is_polarised()) {
        return Err("is of unpolarised light: measure without --stokes".to_owned());
    }
    match lights.any(|light| light.spread.is_some()) {
        true => Err(
            "is of light from one direction at a time: measure without --light-spread".to_owned(),
        ),
        false => Ok(()),
    }
}

/// The outcomes of a measurement of one sample, as [`check_light`] has them.
///
/// # Errors
/// A sentence on what a file of one sample needs.
pub(super) fn of_one_sample(measurement: &Measurement) -> Result<Vec<&Outcome>, String> {
    check_light(&measurement.cases)?;
    let axes = Axes::of(&measurement.cases).axes;
    let differing = axes
        .iter()
        .find(|axis| !OF_ONE_SAMPLE.contains(&axis.name.as_str()));
    if let Some(axis) = differing {
        return Err(format!(
            "describes one sample, and these results differ in {}: measure one at a time",
            axis.name
        ));
    }
    if measurement.cases.len() < measurement.planned {
        return Err("needs results of all directions, and this run is unfinished: give its command again to resume it".to_owned());
    }
    let outcomes = measurement.cases.iter().map(|case| &case.outcome);
    Ok(outcomes.collect())
}

/// Outcomes of light from above, or from below where there are no others.
pub(super) fn from_one_side<'a>(outcomes: &[&'a Outcome]) -> Vec<&'a Outcome> {
    let from = |half_space| {
        let mut found = outcomes.to_vec();
        found.retain(|outcome| outcome.case.light.from == half_space);
        found
    };
    let above = from(HalfSpace::Above);
    match above.is_empty() {
        true => from(HalfSpace::Below),
        false => above,
    }
}

impl<'a> Directions<'a> {
    /// The grid of these outcomes of one sample, at least one.
    ///
    /// # Errors
    /// A sentence on what a file of such a grid needs.
    pub(super) fn of(outcomes: &[&'a Outcome]) -> Result<Self, String> {
        let theta = |one: &Outcome| one.case.light.incidence.theta_deg();
        let azimuth = |one: &Outcome| one.case.light.incidence.phi_deg();
        let is_vertical = |one: &Outcome| one.case.light.incidence.is_vertical();
        let wavelength = |one: &Outcome| one.case.at.wavelength_nm();
        let mut wavelengths_nm: Vec<Option<f64>> =
            outcomes.iter().map(|one| wavelength(one)).collect();
        wavelengths_nm.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        wavelengths_nm.dedup();
        let theta_deg = ascending(outcomes.iter().map(|one| theta(one)));
        let oblique = outcomes.iter().filter(|one| !is_vertical(one));
        let mut phi_deg = ascending(oblique.map(|one| azimuth(one)));
        if phi_deg.is_empty() {
            phi_deg = vec![azimuth(outcomes[0])];
        }
        let step = 360.0 / phi_deg.len() as f64;
        let is_even = |(i, phi): (usize, &f64)| (phi - i as f64 * step).abs() < 1e-6;
        if phi_deg.len() > 1 && !phi_deg.iter().enumerate().all(is_even) {
            return Err(
                "needs azimuths of the light that divide the turn evenly: measure with one, or as with --phi 0:345:15"
                    .to_owned(),
            );
        }
        let mut grid = Vec::new();
        for &nm in &wavelengths_nm {
            for &phi in &phi_deg {
                for &polar in &theta_deg {
                    let here = outcomes.iter().filter(|one| {
                        wavelength(one) == nm
                            && theta(one) == polar
                            && (azimuth(one) == phi || is_vertical(one))
                    });
                    let own = here.clone().find(|one| azimuth(one) == phi);
                    let found = own.or(here.clone().next()).ok_or_else(|| {
                        let at = nm.map_or(String::new(), |nm| format!(" at {nm} nm"));
                        format!(
                            "needs light from every combination of polar angle and azimuth, and theta {polar} deg, phi {phi} deg{at} was not measured"
                        )
                    })?;
                    grid.push(*found);
                }
            }
        }
        Ok(Self {
            wavelengths_nm,
            theta_deg,
            phi_deg,
            outcomes: grid,
        })
    }

    /// Note on readers that interpolate between the polar angles of the light, where these are few or end far from the horizon; `preset` has enough.
    pub(super) fn sparse_note(&self, preset: &str) -> Option<String> {
        let farthest = self.theta_deg[self.theta_deg.len() - 1];
        let (count, last) = ENOUGH;
        (self.theta_deg.len() < count || farthest < last).then(|| {
            format!(
                "measured up to {farthest} deg, beyond which readers extrapolate: for small errors measure at {count} angles or more, dense up to 88 degrees, as --for {preset} does"
            )
        })
    }

    /// Returns `true` if the light comes from random azimuths, so that its plane of incidence is one of symmetry.
    pub(super) fn are_symmetric(&self) -> bool {
        let mut lights = self.outcomes.iter().map(|outcome| outcome.case.light);
        lights.all(|light| light.random_azimuth)
    }
}

/// Values in ascending order, each once.
fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
