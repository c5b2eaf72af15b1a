//! Outcome of a table: its points.

use asperity_analysis::HemisphericalEnergy;
use asperity_results::ResultSet;
use asperity_simulate::{Case, Outcome};
use asperity_tally::{Component, Estimate, Side, TallyResult};
use rayon::prelude::*;

use super::config::{AlbedoConfig, Axes};
use super::single::single_scattering;
use crate::error::StudyError;
use crate::verify::plan::Plan;

/// One point of a table: one material, roughness and cosine of incidence.
#[derive(Clone, Copy)]
pub struct AlbedoPoint<'a> {
    /// The case.
    pub case: &'a Case,
    /// Roughness.
    pub alpha: f64,
    /// Cosine of incidence.
    pub cos: f64,
    /// The light of all orders on explicit surfaces; `None` where the run ended before.
    pub outcome: Option<&'a Outcome>,
    /// Single scattering by Smith's model.
    pub single: HemisphericalEnergy,
}

impl AlbedoPoint<'_> {
    /// Directional albedo of all orders on `side`, a fraction of the incident flux; `None` where the run ended before.
    #[must_use]
    pub fn flux(&self, side: Side) -> Option<Estimate> {
        Some(self.outcome?.statistics.flux(side, Component::All))
    }

    /// Directional albedo of single scattering on `side`.
    #[must_use]
    pub const fn single(&self, side: Side) -> f64 {
        match side {
            Side::Reflected => self.single.reflected,
            Side::Transmitted => self.single.transmitted,
        }
    }

    /// Ratio of the light of all orders to single scattering on `side`, by which renderers compensate energy; 1 where single scattering
    /// sends no light. `None` if the point was not traced.
    #[must_use]
    pub fn ratio(&self, side: Side) -> Option<f64> {
        let (all, single) = (self.flux(side)?.mean, self.single(side));
        Some(if single == 0.0 { 1.0 } else { all / single })
    }
}

/// Albedo tables, possibly incomplete.
pub struct AlbedoOutcome<'a> {
    /// The configuration.
    pub config: &'a AlbedoConfig,
    /// The points, by roughness, material and cosine in that order of nesting.
    pub plan: &'a Plan,
    /// Results.
    pub found: &'a ResultSet<'a>,
    pub(super) axes: &'a Axes,
    /// Single scattering of each point.
    single: Vec<HemisphericalEnergy>,
}

impl<'a> AlbedoOutcome<'a> {
    pub(super) fn new(
        config: &'a AlbedoConfig,
        axes: &'a Axes,
        plan: &'a Plan,
        found: &'a ResultSet<'_>,
    ) -> Result<Self, StudyError> {
        let single = plan.cases.par_iter().map(single_scattering);
        Ok(Self {
            config,
            plan,
            found,
            axes,
            single: single.collect::<Result<_, _>>()?,
        })
    }

    /// Number of materials, each with a table.
    #[must_use]
    pub fn materials(&self) -> usize {
        self.axes.materials(self.plan)
    }

    /// Name of a material by its number, as in `n = 1.5`.
    #[must_use]
    pub fn material(&self, material: usize) -> String {
        self.point(material, 0, 0).case.panel_label()
    }

    /// The point of a material, roughness and cosine, each by number.
    #[must_use]
    pub fn point(&self, material: usize, alpha: usize, cos: usize) -> AlbedoPoint<'_> {
        let row = alpha * self.materials() + material;
        let number = row * self.axes.cosines.len() + cos;
        AlbedoPoint {
            case: &self.plan.cases[number],
            alpha: self.axes.alphas[alpha],
            cos: self.axes.cosines[cos],
            outcome: self.found.case(number).map(|found| &found.outcome),
            single: self.single[number],
        }
    }

    /// The points of a material and roughness, in the order of the cosines.
    pub(super) fn row(
        &self,
        material: usize,
        alpha: usize,
    ) -> impl Iterator<Item = AlbedoPoint<'_>> {
        (0..self.axes.cosines.len()).map(move |cos| self.point(material, alpha, cos))
    }

    /// The points of a material, in the order of roughness and cosine.
    pub(super) fn table(&self, material: usize) -> impl Iterator<Item = AlbedoPoint<'_>> {
        let alphas = 0..self.axes.alphas.len();
        alphas.flat_map(move |alpha| self.row(material, alpha))
    }

    /// All points, table by table.
    pub(super) fn points(&self) -> impl Iterator<Item = AlbedoPoint<'_>> {
        (0..self.materials()).flat_map(|material| self.table(material))
    }

    /// Returns `true` if every point was found.
    pub(super) fn is_complete(&self) -> bool {
        self.points().all(|point| point.outcome.is_some())
    }

    /// Sides on which light of a material leaves.
    pub(super) fn sides(&self, material: usize) -> &'static [Side] {
        let case = self.point(material, 0, 0).case;
        match case.material.transmitting_index() {
            Some(_) => &Side::BOTH,
            None => &[Side::Reflected],
        }
    }
}
