//! Directions: the cases of one sample as a grid over wavelength and direction of the light, as tables of renderers and ray tracers have them.

use asperity_tracer::HalfSpace;

use super::planned::OfCase;

/// Fewest polar angles of the light, and the last one, degrees, that keep the error of readers between them small.
const ENOUGH: (usize, f64) = (16, 85.0);

/// Outcomes of one sample, or plans of them, of light from every combination of polar angle and azimuth at every wavelength.
pub(super) struct Directions<T> {
    /// Wavelengths, nm, ascending; one `None` for results without a wavelength.
    pub(super) wavelengths_nm: Vec<Option<f64>>,
    /// Polar angles of the light, degrees, ascending.
    pub(super) theta_deg: Vec<f64>,
    /// Azimuths of the light, degrees, ascending: one, or several that divide the turn evenly from 0 on.
    pub(super) phi_deg: Vec<f64>,
    /// Outcomes by wavelength, azimuth and polar angle, the last fastest. Light along the normal is the same at all azimuths.
    pub(super) outcomes: Vec<T>,
}

/// Outcomes of light from above, or from below where there are no others.
pub(super) fn from_one_side<T: OfCase + Copy>(outcomes: &[T]) -> Vec<T> {
    let from = |half_space| {
        let mut found = outcomes.to_vec();
        found.retain(|outcome| outcome.case().light.from == half_space);
        found
    };
    let above = from(HalfSpace::Above);
    match above.is_empty() {
        true => from(HalfSpace::Below),
        false => above,
    }
}

/// Azimuths of oblique light, degrees, ascending.
pub(super) fn azimuths_deg<T: OfCase>(outcomes: &[T]) -> Vec<f64> {
    let incidences = outcomes.iter().map(|one| one.case().light.incidence);
    let oblique = incidences.filter(|incidence| !incidence.is_vertical());
    ascending(oblique.map(|incidence| incidence.phi_deg()))
}

impl<T: OfCase + Copy> Directions<T> {
    /// The grid of these outcomes of one sample, at least one.
    ///
    /// # Errors
    /// A sentence on what a file of such a grid needs.
    pub(super) fn of(outcomes: &[T]) -> Result<Self, String> {
        let theta = |one: &T| one.case().light.incidence.theta_deg();
        let azimuth = |one: &T| one.case().light.incidence.phi_deg();
        let is_vertical = |one: &T| one.case().light.incidence.is_vertical();
        let wavelength = |one: &T| one.case().at.wavelength_nm();
        let mut wavelengths_nm: Vec<Option<f64>> = outcomes.iter().map(wavelength).collect();
        wavelengths_nm.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        wavelengths_nm.dedup();
        let theta_deg = ascending(outcomes.iter().map(theta));
        let mut phi_deg = azimuths_deg(outcomes);
        if phi_deg.is_empty() {
            phi_deg = vec![azimuth(&outcomes[0])];
        }
        let step = 360.0 / phi_deg.len() as f64;
        let is_even = |(i, phi): (usize, &f64)| (phi - i as f64 * step).abs() < 1e-6;
        if phi_deg.len() > 1 && !phi_deg.iter().enumerate().all(is_even) {
            return Err(
                "needs one azimuth of the light, or several that divide the turn evenly from 0 on, as --phi 0:345:15"
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

    /// Checks that light comes from several polar angles; `preset` has enough.
    ///
    /// # Errors
    /// A sentence without its subject, the format.
    pub(super) fn check_polar_angles(&self, preset: &str) -> Result<(), String> {
        match self.theta_deg.len() {
            1 => Err(format!(
                "needs light from several polar angles: measure with gonio --for {preset}, without --theta"
            )),
            _ => Ok(()),
        }
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
        let mut lights = self.outcomes.iter().map(|outcome| outcome.case().light);
        lights.all(|light| light.random_azimuth)
    }
}

/// Values in ascending order, each once.
pub(super) fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
