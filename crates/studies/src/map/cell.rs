//! Cell: the results of one case, and the verdicts on them.

use asperity_analysis::Scope;
use asperity_tally::{
    Component, Entry, Estimate, Measure, Side, TallyResult, TallySpec, zero_variance_limit,
};
use serde::{Deserialize, Serialize};

use super::config::ToleranceConfig;
use super::interval::{CellVerdict, Interval, student_95};
use crate::comparison::judgement::Judgement;
use crate::comparison::models::{BATCHES_WITHOUT_SURFACES, ModelOutcome};
use crate::comparison::peak::PeakDifference;

/// Surfaces below which nothing is said of errors: signs of fewer have too few arrangements.
pub(super) const FEWEST_SURFACES: u64 = 8;

/// A lobe has a clear peak if it falls to half of it within so many degrees on either side; of a broader
/// one the total variation tells.
const CLEAR_WITHIN_DEG: f64 = 30.0;

/// Standard errors that contain 95 % of a normal distribution.
const NORMAL_95: f64 = 1.959_964;

/// The light over which a model is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ComparedLight {
    /// The light that the model describes against the same light.
    Own,
    /// All light of the model against all light: what a model leaves out counts against it.
    All,
}

impl ComparedLight {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Own, Self::All];

    /// Form of tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::All => "all",
        }
    }
}

/// One side of a cell, as numbers; flux fractions and degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellSide {
    /// The side.
    pub side: Side,
    /// Flux on explicit surfaces.
    pub explicit: f64,
    /// Flux by the model.
    pub model: f64,
    /// The first less the second.
    pub difference: f64,
    /// Its standard error.
    pub difference_se: Option<f64>,
    /// Known error of the mesh, without sign.
    pub mesh: f64,
    /// Peaks of both.
    pub peak: Option<PeakDifference>,
}

/// The distances of one model from the explicit result, in one comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellDistances {
    /// Total variation over the bins of the recorded sides.
    pub total_variation: f64,
    /// Upper limit of noise alone, with a probability of 95 %.
    pub noise_95: Option<f64>,
    /// Known error of the mesh, over all bins.
    pub mesh: f64,
    /// The sides.
    pub sides: Vec<CellSide>,
}

/// One model in a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellModel {
    /// Its name.
    pub name: String,
    /// `true` if it describes all orders of scattering.
    pub all_orders: bool,
    /// Rays that it followed.
    pub rays: u64,
    /// Over the light that it describes.
    pub own: CellDistances,
    /// Over all light.
    pub all: CellDistances,
}

/// All that was found in a cell, as the result file keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellResults {
    /// Surfaces.
    pub surfaces: u64,
    /// Rays over all of them.
    pub rays: u64,
    /// Samples of a surface along x and y.
    pub size: [usize; 2],
    /// Length units per sample along x and y.
    pub spacing: [f64; 2],
    /// Bound on the difference of the fluxes, if nothing was traced.
    pub deviation_bound: Option<f64>,
    /// Flux that was lost to numerical failure.
    pub lost: f64,
    /// Reflected and transmitted flux less what they would be if s and p were averaged at every interface, where both are traced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tracked_less_averaged: Option<[Estimate; 2]>,
    /// The models, in the order of the configuration.
    pub models: Vec<CellModel>,
}

/// One measure of a cell with its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// The cases.
    pub name: &'static str,
    /// The distance and where it lies.
    pub interval: Interval,
    /// Verdict.
    pub verdict: CellVerdict,
}

/// A cell, judged for one model and one comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedCell {
    /// Total variation first, then of each side its energy and, where there is a clear one, its peak.
    pub measures: Vec<Judged>,
    /// Verdict of all of them.
    pub verdict: CellVerdict,
}

impl JudgedCell {
    /// The measure of that name, if there is one.
    #[must_use]
    pub fn measure(&self, name: &str) -> Option<&Judged> {
        self.measures.iter().find(|measure| measure.name == name)
    }

    /// The measures that the verdict rests on, unless all are within tolerance.
    #[must_use]
    pub fn decided_by(&self) -> Vec<&'static str> {
        let decides = |m: &&Judged| m.verdict == self.verdict && m.verdict != CellVerdict::Within;
        self.measures
            .iter()
            .filter(decides)
            .map(|m| m.name)
            .collect()
    }
}

/// Name of the energy of a side among the measures.
pub(super) const fn energy_name(side: Side) -> &'static str {
    match side {
        Side::Reflected => "reflected",
        Side::Transmitted => "transmitted",
    }
}

/// Name of the peak of a side among the measures.
pub(super) const fn peak_name(side: Side) -> &'static str {
    match side {
        Side::Reflected => "reflected-peak",
        Side::Transmitted => "transmitted-peak",
    }
}

impl CellModel {
    /// In one comparison.
    #[must_use]
    pub const fn distances(&self, light: ComparedLight) -> &CellDistances {
        match light {
            ComparedLight::Own => &self.own,
            ComparedLight::All => &self.all,
        }
    }
}

/// Tracked less averaged flux of both sides, where it is kept.
fn tracked_less_averaged(spec: &TallySpec, case: &Judgement<'_>) -> Option<[Estimate; 2]> {
    let of = |side| {
        let flux = spec.flux_entry(side, Component::All);
        let entry = spec.measure_entry(flux, Measure::Averaging)?;
        Some(case.outcome.statistics.at(entry))
    };
    Some([of(Side::Reflected)?, of(Side::Transmitted)?])
}

impl CellResults {
    /// Results of a verification of one case.
    pub(super) fn of(case: &Judgement<'_>) -> Self {
        let spec = case.spec();
        let surface = &case.outcome.case.surface;
        let models = case.models.iter().map(|model| {
            let of = |component| distances(spec, case, model, component);
            CellModel {
                name: model.model.name().to_owned(),
                all_orders: model.model.scope() == Scope::AllOrders,
                rays: model.expectation.rays(),
                own: of(model.judged_component()),
                all: of(Component::All),
            }
        });
        Self {
            surfaces: case.outcome.work.realisations,
            rays: case.outcome.work.rays,
            size: surface.size().unwrap_or_default(),
            spacing: surface.spacing().unwrap_or_default(),
            deviation_bound: case.outcome.deviation_bound,
            lost: case.outcome.statistics.means().budget().lost,
            tracked_less_averaged: tracked_less_averaged(spec, case),
            models: models.collect(),
        }
    }

    /// Verdict on the distances of a model, given tolerances.
    #[must_use]
    pub fn judge(
        &self,
        model: &CellModel,
        light: ComparedLight,
        tolerances: &ToleranceConfig,
    ) -> JudgedCell {
        let distances = model.distances(light);
        let unobserved = self.unobserved(model);
        let enough = self.deviation_bound.is_some() || self.surfaces >= FEWEST_SURFACES;
        let half_width = |error: Option<f64>, mesh: f64| {
            let error = error.filter(|_| enough)?;
            Some(error.max(unobserved) + mesh)
        };
        let student = match self.deviation_bound {
            // Its errors are those of a model that was sampled in so many batches, or none.
            Some(_) => student_95(BATCHES_WITHOUT_SURFACES),
            None => student_95(self.surfaces),
        };
        // Flipped signs know the scatter of so few surfaces no better than a standard error does.
        let noise = match self.deviation_bound {
            Some(_) => distances.noise_95,
            None => distances
                .noise_95
                .zip(student)
                .map(|(n, t)| n * t / NORMAL_95),
        };
        let total = half_width(noise, distances.mesh);
        let total = Interval::about(distances.total_variation, total).not_below_zero();
        let mut measures = vec![("total-variation", total, tolerances.total_variation.0)];
        for side in &distances.sides {
            let error = |se: Option<f64>| Some(se? * student?);
            let bound = self.deviation_bound.unwrap_or(0.0);
            let energy = error(side.difference_se).map(|error| error + bound);
            let energy = half_width(energy, side.mesh);
            measures.push((
                energy_name(side.side),
                Interval::about(side.difference, energy),
                tolerances.energy.0,
            ));
            let clear = |peak: &&PeakDifference| peak.half_width_deg <= CLEAR_WITHIN_DEG;
            if let Some(peak) = side.peak.as_ref().filter(clear) {
                let error = error(peak.se_deg).filter(|_| enough);
                let half_width = error.map(|error| error + peak.unresolved_deg);
                let difference = peak.explicit_deg - peak.model_deg;
                measures.push((
                    peak_name(side.side),
                    Interval::about(difference, half_width),
                    tolerances.peak.0,
                ));
            }
        }
        let measures: Vec<Judged> = measures
            .into_iter()
            .map(|(name, interval, tolerance)| Judged {
                name,
                interval,
                verdict: interval.verdict(tolerance),
            })
            .collect();
        let verdict = CellVerdict::of_all(measures.iter().map(|measure| measure.verdict));
        JudgedCell { measures, verdict }
    }

    /// Upper limit of the flux into a direction that no ray took.
    fn unobserved(&self, model: &CellModel) -> f64 {
        [self.rays, model.rays]
            .iter()
            .filter(|rays| **rays > 0)
            .map(|rays| zero_variance_limit(*rays as f64))
            .sum()
    }
}

/// The distances of one model over one component of the light.
fn distances(
    spec: &TallySpec,
    case: &Judgement<'_>,
    model: &ModelOutcome,
    component: Component,
) -> CellDistances {
    let compared = model.compared_or_all(component);
    let mesh = |entry: Entry| case.outcome.errors.at(entry).mesh.map_or(0.0, f64::abs);
    let material = case.outcome.case.material;
    let transmits = material.transmitting_index().is_some();
    let bins = spec.recorded_entries(component);
    let total = compared.comparison.total_variation;
    let noise_95 = match case.outcome.deviation_bound {
        // The bound holds for sums over any bins; the noise of a model adds to it.
        Some(bound) => Some(bound + noise_of_model(model, spec, component)),
        None => total.noise_95,
    };
    CellDistances {
        total_variation: total.observed,
        noise_95,
        mesh: 0.5 * bins.iter().map(mesh).sum::<f64>(),
        sides: compared
            .sides
            .iter()
            .filter(|of| transmits || of.side == Side::Reflected)
            .map(|of| {
                let entry = spec.flux_entry(of.side, component);
                let se_of_model = model.expectation.statistics().at(entry).se;
                CellSide {
                    side: of.side,
                    explicit: of.explicit,
                    model: of.model,
                    difference: of.difference.mean,
                    difference_se: match case.outcome.deviation_bound {
                        Some(_) => se_of_model,
                        None => of.difference.se,
                    },
                    mesh: mesh(entry),
                    peak: of.peak.map(|peak| match case.outcome.deviation_bound {
                        Some(bound) => PeakDifference {
                            se_deg: certain_peak(model, bound, of.explicit),
                            ..peak
                        },
                        None => peak,
                    }),
                }
            })
            .collect(),
    }
}

/// The error of a peak where nothing was traced: none, if neither the model has noise nor a hundredth of
/// the side's light can have gone elsewhere, which moves a peak by some hundredth of a bin.
fn certain_peak(model: &ModelOutcome, bound: f64, flux: f64) -> Option<f64> {
    (model.expectation.is_exact() && bound <= 0.01 * flux).then_some(0.0)
}

/// Upper limit, at 95 %, of the total variation that the noise of a sampled model adds.
fn noise_of_model(model: &ModelOutcome, spec: &TallySpec, component: Component) -> f64 {
    let statistics = model.expectation.statistics();
    let se = |entry| statistics.at(entry).se.unwrap_or(0.0);
    let student = student_95(BATCHES_WITHOUT_SURFACES).unwrap_or(f64::INFINITY);
    0.5 * student * spec.recorded_entries(component).iter().map(se).sum::<f64>()
}

#[cfg(test)]
mod tests;
