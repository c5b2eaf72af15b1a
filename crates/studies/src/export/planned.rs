//! Planned: what formats need of the cases of a measurement, before rays are traced and after.
//!
//! Errors are sentences without their subject, the format.

use asperity_simulate::{Case, Outcome};
use asperity_tally::{Side, TallySpec};
use asperity_tracer::HalfSpace;

use super::axes::Axes;

/// Coordinates in which cases of one sample may differ.
const OF_ONE_SAMPLE: [&str; 4] = ["from", "wavelength_nm", "theta_deg", "phi_deg"];

/// A case, and what is recorded of it.
#[derive(Clone, Copy)]
pub(super) struct Planned<'a> {
    pub(super) case: &'a Case,
    pub(super) spec: TallySpec,
}

impl<'a> From<&'a Outcome> for Planned<'a> {
    fn from(outcome: &'a Outcome) -> Self {
        Self {
            case: &outcome.case,
            spec: *outcome.statistics.spec(),
        }
    }
}

/// Access to the case of a plan or of an outcome.
pub(super) trait OfCase {
    fn case(&self) -> &Case;
}

impl OfCase for Planned<'_> {
    fn case(&self) -> &Case {
        self.case
    }
}

impl OfCase for &Outcome {
    fn case(&self) -> &Case {
        &self.case
    }
}

/// Checks that light is unpolarised.
pub(super) fn check_unpolarised(cases: &[Planned]) -> Result<(), String> {
    match cases.iter().any(|one| one.case.light.is_polarised()) {
        true => Err("is of unpolarised light: measure without --stokes".to_owned()),
        false => Ok(()),
    }
}

/// Checks that light is unpolarised, and comes from one direction at a time.
pub(super) fn check_light(cases: &[Planned]) -> Result<(), String> {
    check_unpolarised(cases)?;
    match cases.iter().any(|one| one.case.light.spread.is_some()) {
        true => Err(
            "is of light from one direction at a time: measure without --light-spread".to_owned(),
        ),
        false => Ok(()),
    }
}

/// Checks that all cases are of one sample.
pub(super) fn check_one_sample(cases: &[Planned]) -> Result<(), String> {
    let all: Vec<&Case> = cases.iter().map(|one| one.case).collect();
    let axes = Axes::of(&all).axes;
    let is_other = |name: &str| !OF_ONE_SAMPLE.contains(&name);
    match axes.iter().find(|axis| is_other(&axis.name)) {
        Some(axis) => Err(format!(
            "describes one sample, and these results differ in {}: measure one at a time",
            axis.name
        )),
        None => Ok(()),
    }
}

/// Checks that the cases are reflection of light from above, from one direction at a time, by one sample.
pub(super) fn check_reflection(cases: &[Planned]) -> Result<(), String> {
    check_light(cases)?;
    check_one_sample(cases)?;
    let mut lights = cases.iter().map(|one| one.case.light);
    if lights.any(|light| light.from != HalfSpace::Above) {
        return Err("holds reflection of light from above: measure with --from above".to_owned());
    }
    match cases.iter().all(|one| one.spec.records(Side::Reflected)) {
        true => Ok(()),
        false => Err("holds reflected light: measure with --side both or reflected".to_owned()),
    }
}
