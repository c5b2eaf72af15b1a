//! Directions: the outcomes of one sample as a grid over the direction of the light, as tables of ray tracers have them.

use asperity_simulate::Outcome;
use asperity_tracer::HalfSpace;

/// Outcomes of one sample at one wavelength, of light from every combination of polar angle and azimuth.
pub(super) struct Directions<'a> {
    /// Polar angles of the light, degrees, ascending.
    pub(super) theta_deg: Vec<f64>,
    /// Azimuths of the light, degrees, ascending: one, or several that divide the turn evenly from 0 on.
    pub(super) phi_deg: Vec<f64>,
    /// Outcomes by azimuth and polar angle. Light along the normal is the same at all azimuths.
    pub(super) outcomes: Vec<&'a Outcome>,
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
    /// The grid of these outcomes, at least one.
    ///
    /// # Errors
    /// A sentence on what a file of such a grid needs.
    pub(super) fn of(outcomes: &[&'a Outcome]) -> Result<Self, String> {
        let incidence = |outcome: &Outcome| outcome.case.light.incidence;
        let axis = |of: fn(&Outcome) -> f64, kept: fn(&Outcome) -> bool| {
            let mut values: Vec<f64> = outcomes
                .iter()
                .filter(|one| kept(one))
                .map(|one| of(one))
                .collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let theta_deg = axis(|one| one.case.light.incidence.theta_deg(), |_| true);
        let azimuth = |one: &Outcome| one.case.light.incidence.phi_deg();
        let mut phi_deg = axis(
            |one| one.case.light.incidence.phi_deg(),
            |one| !one.case.light.incidence.is_vertical(),
        );
        if phi_deg.is_empty() {
            phi_deg = vec![azimuth(outcomes[0])];
        }
        let step = 360.0 / phi_deg.len() as f64;
        let is_even = |(i, phi): (usize, &f64)| (phi - i as f64 * step).abs() < 1e-6;
        if phi_deg.len() > 1 && !phi_deg.iter().enumerate().all(is_even) {
            return Err(
                "needs azimuths of the light that divide the turn evenly: measure with one, or as with --phi 0:330:30"
                    .to_owned(),
            );
        }
        let mut grid = Vec::new();
        for phi in &phi_deg {
            for theta in &theta_deg {
                let mut found = outcomes.iter().filter(|one| {
                    let incidence = incidence(one);
                    incidence.theta_deg() == *theta
                        && (azimuth(one) == *phi || incidence.is_vertical())
                });
                let Some(outcome) = found.next() else {
                    return Err(format!(
                        "needs light from every combination of polar angle and azimuth, and theta {theta} deg, phi {phi} deg was not measured"
                    ));
                };
                if found.any(|other| incidence(other) == incidence(outcome)) {
                    return Err(
                        "describes one sample, and there are results of several: measure one at a time"
                            .to_owned(),
                    );
                }
                grid.push(*outcome);
            }
        }
        Ok(Self {
            theta_deg,
            phi_deg,
            outcomes: grid,
        })
    }

    /// Returns `true` if the light comes from random azimuths, so that its plane of incidence is one of symmetry.
    pub(super) fn are_symmetric(&self) -> bool {
        let lights = self.outcomes.iter().map(|outcome| outcome.case.light);
        lights.clone().all(|light| light.random_azimuth)
            && lights.clone().all(|light| !light.is_polarised())
    }
}
