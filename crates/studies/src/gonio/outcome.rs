//! Outcome of a measurement: the results of its directions.

use asperity_results::ResultSet;
use asperity_simulate::{Case, Lobe, Outcome};
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Estimate, Measure, Side, TallyResult, TallySpec, TallyStatistics};

use super::components;
use super::config::GonioConfig;
use super::sample::Sample;
use crate::config::lobes::BinnedLobe;
use crate::output::{EstimateWithLimit, over, projected_solid_angle};
use crate::report::appearance::SampleLight;
use crate::report::flux_basis::FluxBasis;
use crate::report::shown_case::ShownCase;
use crate::validity::Validity;
use crate::verify::plan::Plan;

/// One direction of a measurement: a case, and what was found of it.
#[derive(Clone, Copy)]
pub struct Direction<'a> {
    /// Number of its setting.
    pub setting: usize,
    /// The case, with the direction towards the light.
    pub case: &'a Case,
    /// Its tally spec, with its own bins.
    pub spec: TallySpec,
    /// Results; `None` where the run ended before.
    pub outcome: Option<&'a Outcome>,
    lobes: [Option<Lobe>; 2],
}

impl Direction<'_> {
    /// Its lobes, next to its bins.
    pub(super) fn lobes(&self) -> Vec<BinnedLobe> {
        BinnedLobe::of_lobes(self.lobes, &self.spec)
    }

    /// Statistics of its light.
    pub(super) fn statistics(&self) -> Option<&TallyStatistics> {
        self.outcome.map(|outcome| &outcome.statistics)
    }

    /// Flux of a component that left on `side`; `None` if it is not recorded or was not measured.
    pub(super) fn flux(&self, component: Component, side: Side) -> Option<EstimateWithLimit> {
        let outcome = self.outcome.filter(|_| self.spec.records(side))?;
        let flux = outcome.statistics.flux(side, component);
        Some(FluxBasis::of(outcome).flux(side, flux))
    }

    /// Flux of a component into bin `bin` of the grid; `None` if its side is not recorded or it was not measured.
    pub(super) fn bin(&self, component: Component, bin: usize) -> Option<Estimate> {
        let recorded = self.spec.recorded_bins().contains(&bin);
        let statistics = self.statistics().filter(|_| recorded)?;
        Some(statistics.at(self.spec.grid_entries(component).get(bin)))
    }

    /// Flux that left on `side` less what it would be if s and p were averaged, if that is kept and the direction was measured.
    pub(super) fn tracked_less_averaged(&self, side: Side) -> Option<Estimate> {
        let flux = self.spec.flux_entry(side, Component::All);
        let entry = self.spec.measure_entry(flux, Measure::Averaging)?;
        Some(self.statistics()?.at(entry))
    }

    /// BSDF of all light in bin `bin` of the grid.
    pub(super) fn bsdf(&self, bin: usize) -> Option<Estimate> {
        let flux = self.bin(Component::All, bin)?;
        Some(over(flux, projected_solid_angle(&self.spec.grid(), bin)))
    }

    /// Flux of a component into in-plane bin `i` of `side`; `None` if it is not recorded or was not measured.
    pub(super) fn in_plane(&self, component: Component, side: Side, i: usize) -> Option<Estimate> {
        let statistics = self.statistics().filter(|_| self.spec.records(side))?;
        Some(components::in_plane(statistics, side, component, i))
    }

    /// Flux that was absorbed, truncated and lost.
    pub(super) fn endings(&self) -> Option<[EstimateWithLimit; 3]> {
        let outcome = self.outcome?;
        let (support, budget) = (FluxBasis::of(outcome), outcome.statistics.budget());
        Some([
            support.absorbed(budget.absorbed),
            support.ended(budget.truncated),
            support.ended(budget.lost),
        ])
    }
}

/// A measurement, as far as it has come.
pub struct GonioOutcome<'a> {
    /// The configuration.
    pub config: &'a GonioConfig,
    /// The given surfaces, if there are any.
    pub sample: Option<&'a Sample>,
    /// The cases: by setting, polar angle and azimuth, in that order of nesting.
    pub plan: &'a Plan,
    /// Results.
    pub found: &'a ResultSet<'a>,
    /// Polar angles of the light, degrees, as in the configuration.
    pub thetas: Vec<f64>,
    /// Azimuths of the light, degrees.
    pub phis: Vec<f64>,
    /// Numbers of the polar angle and of the azimuth of the directions of a setting.
    pub(super) pairs: Vec<[usize; 2]>,
}

impl<'a> GonioOutcome<'a> {
    /// Tally spec of all directions that have no bins of their own.
    #[must_use]
    pub const fn spec(&self) -> &'a TallySpec {
        &self.plan.settings.tally
    }

    /// Unit of the lengths of all surfaces.
    #[must_use]
    pub fn unit(&self) -> LengthUnit {
        self.plan
            .cases
            .first()
            .map_or_else(LengthUnit::default, |case| case.at.unit)
    }

    /// The directions.
    pub fn directions(&self) -> impl ExactSizeIterator<Item = Direction<'a>> + Clone {
        (0..self.plan.cases.len()).map(|number| self.numbered(number))
    }

    /// Directions that are still to be found.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.directions()
            .filter(|one| one.outcome.is_none())
            .count()
    }

    /// Lengths of the surface of a direction against the wavelength, where their unit is known.
    pub(super) fn validity(&self, direction: &Direction<'_>) -> Option<Validity> {
        let case = direction.case;
        let wavelength = self.config.light.wavelength_nm();
        match &self.sample {
            Some(one) => {
                let (lengths, of_bottom) = (one.lengths.as_ref()?, one.of_bottom.as_ref());
                Validity::new(lengths, of_bottom, case, &direction.spec, wavelength)
            }
            None => Validity::of_random(case, &direction.spec, wavelength),
        }
    }

    /// A direction as a sample whose appearance is judged; `None` if it was not measured.
    pub(super) fn sample_light(&self, direction: &Direction<'a>) -> Option<SampleLight<'a>> {
        let validity = self.validity(direction);
        let chosen = self.config.output.coherent;
        Some(SampleLight::new(direction.outcome?, validity, chosen))
    }

    /// All that were measured as such samples.
    pub(super) fn sample_lights(&self) -> impl Iterator<Item = SampleLight<'a>> {
        self.directions().filter_map(|one| self.sample_light(&one))
    }

    /// A direction as tables and figures of single cases show it; `None` if it was not measured.
    pub(super) fn shown(&self, direction: &Direction<'a>) -> Option<ShownCase<'a>> {
        Some(ShownCase {
            outcome: direction.outcome?,
            judgement: None,
            surfaces: self.sample.map(|sample| sample.name.as_str()),
            seed: self.config.run.seed,
            max_order: self.config.run.max_order,
        })
    }

    pub(super) const fn per_setting(&self) -> usize {
        self.pairs.len()
    }

    /// Place of a direction among all settings, polar angles and azimuths, measured or not.
    pub(super) fn place(&self, number: usize) -> usize {
        let [theta, phi] = self.pairs[number % self.per_setting()];
        let setting = number / self.per_setting();
        (setting * self.thetas.len() + theta) * self.phis.len() + phi
    }

    /// The directions of a setting and polar angle.
    pub(super) fn ring(&self, setting: usize, theta: usize) -> impl Iterator<Item = Direction<'a>> {
        let pairs = self.pairs.iter().enumerate();
        let of_ring = pairs.filter(move |(_, pair)| pair[0] == theta);
        of_ring.map(move |(number, _)| self.numbered(setting * self.per_setting() + number))
    }

    /// A case of each setting.
    pub(super) fn settings(&self) -> impl ExactSizeIterator<Item = &'a Case> {
        self.plan
            .cases
            .chunks(self.per_setting())
            .map(|cases| &cases[0])
    }

    pub(super) fn numbered(&self, number: usize) -> Direction<'a> {
        let case = &self.plan.cases[number];
        Direction {
            setting: number / self.per_setting(),
            case,
            spec: self.plan.settings.spec_of(case),
            outcome: self.found.case(number).map(|found| &found.outcome),
            lobes: self.plan.lobes[number],
        }
    }

    /// The direction of a setting, polar angle and azimuth, each by number; the first azimuth is one of every polar angle.
    pub(super) fn direction(&self, setting: usize, theta: usize, phi: usize) -> Direction<'a> {
        let number = self.pairs.iter().position(|pair| *pair == [theta, phi]);
        self.numbered(setting * self.per_setting() + number.unwrap_or(0))
    }
}
