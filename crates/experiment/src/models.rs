//! Models beside the explicit surfaces of a case.

use std::f64::consts::PI;

use asperity_analysis::{
    Comparison, Effort, Expectation, Expected, Grouping, ModelError, ScatteringModel, Scope,
    Verdict, compare, create_model, expect, verdicts,
};
use asperity_tally::{Azimuth, BatchStatistics, Estimate, Layout, Share, Side};
use rayon::prelude::*;

use crate::case::Case;
use crate::config::VerifyConfig;
use crate::ensemble::Ensemble;
use crate::method::Method;
use crate::side_difference::{SideDifference, side_differences};
use crate::verify::{VerifyError, slopes};

/// Rays that a bin must hold, found or expected, to enter a test. Where rings are spread evenly over
/// azimuth, a bin stands for its ring, and the rays of the ring count.
const ENOUGH_RAYS: f64 = 20.0;

/// Batches of a model that is sampled beside a single surface.
pub(crate) const BATCHES_WITHOUT_SURFACES: u64 = 16;

/// A share of the light beside a model.
#[derive(Clone, Debug)]
pub struct ComparedShare {
    /// Over the bins of the sides asked for.
    pub comparison: Comparison,
    /// What follows from it; `None` where the model makes no claim.
    pub verdict: Option<Verdict>,
    /// Energies and peaks of the sides asked for; none of multiple scattering alone.
    pub sides: Vec<SideDifference>,
}

/// One model beside the explicit surfaces of a case.
pub struct ModelOutcome {
    /// The model.
    pub model: Box<dyn ScatteringModel>,
    /// What it expects.
    pub expectation: Expectation,
    /// Light scattered once.
    pub single: ComparedShare,
    /// Light scattered more often, if the model describes it.
    pub multiple: Option<ComparedShare>,
    /// All light, whether or not the model describes it.
    pub total: ComparedShare,
}

impl ModelOutcome {
    /// A share of the light; `None` for multiple scattering that the model does not describe.
    #[must_use]
    pub const fn compared(&self, share: Share) -> Option<&ComparedShare> {
        match share {
            Share::Single => Some(&self.single),
            Share::Multiple => self.multiple.as_ref(),
            Share::Total => Some(&self.total),
        }
    }

    /// The share by which the model is judged: all that it describes.
    #[must_use]
    pub fn judged_share(&self) -> Share {
        match self.model.scope() {
            Scope::AllOrders => Share::Total,
            _ => Share::Single,
        }
    }

    /// The comparison with all light that the model describes.
    #[must_use]
    pub fn judged(&self) -> &ComparedShare {
        match self.judged_share() {
            Share::Total => &self.total,
            _ => &self.single,
        }
    }

    /// The flux that the model expects on `side`, if it describes that share.
    #[must_use]
    pub fn energy(&self, share: Share, side: Side) -> Option<Estimate> {
        let layout = self.expectation.layout();
        let entry = match share {
            Share::Single => layout.order(side, 1),
            Share::Multiple => layout.multiple(side),
            Share::Total => side.index(),
        };
        self.expectation
            .describes(share)
            .then(|| self.expectation.statistics().estimate(entry))
    }

    fn claimed(&mut self) -> impl Iterator<Item = &mut ComparedShare> {
        let all_orders = self.model.scope() == Scope::AllOrders;
        std::iter::once(&mut self.single)
            .chain(self.multiple.as_mut())
            .chain(Some(&mut self.total).filter(|_| all_orders))
    }
}

/// The model of that name for the surfaces and the material of `case`.
pub(crate) fn model_of(name: &str, case: &Case) -> Result<Box<dyn ScatteringModel>, ModelError> {
    create_model(name, slopes(&case.psd)?, case.material)
}

/// Compares every model of the configuration with the surfaces of a case.
///
/// Each share that a model claims is a test of its own; the level is shared among all tests of the
/// case. Returns the models and the number of tests.
pub(crate) fn compare_models(
    config: &VerifyConfig,
    layout: &Layout,
    (case, method): (&Case, &Method),
    ensemble: &Ensemble,
    statistics: &BatchStatistics,
) -> Result<(Vec<ModelOutcome>, usize), VerifyError> {
    let mut models = config
        .compare
        .models
        .par_iter()
        .map(|name| {
            let model = model_of(name, case)?;
            let beside = Beside {
                config,
                layout,
                case,
                method,
                ensemble,
                statistics,
            };
            beside.compare(model)
        })
        .collect::<Result<Vec<_>, VerifyError>>()?;
    let mut claims: Vec<&mut ComparedShare> =
        models.iter_mut().flat_map(ModelOutcome::claimed).collect();
    let comparisons: Vec<&Comparison> = claims.iter().map(|claim| &claim.comparison).collect();
    let found = verdicts(&comparisons, config.compare.alpha);
    let tests = found.len();
    for (claim, verdict) in claims.iter_mut().zip(found) {
        claim.verdict = Some(verdict);
    }
    Ok((models, tests))
}

/// What a model stands beside.
struct Beside<'a> {
    config: &'a VerifyConfig,
    layout: &'a Layout,
    case: &'a Case,
    method: &'a Method,
    ensemble: &'a Ensemble,
    statistics: &'a BatchStatistics,
}

impl Beside<'_> {
    fn compare(&self, model: Box<dyn ScatteringModel>) -> Result<ModelOutcome, VerifyError> {
        let surfaces = self.ensemble.records.len() as u64;
        let effort = Effort {
            rays: self.config.compare.model_rays.0,
            batches: match surfaces {
                0 | 1 => BATCHES_WITHOUT_SURFACES,
                _ => surfaces,
            },
            seed: self.config.run.seed,
        };
        let azimuth = if self.config.free_azimuth(self.case) {
            Azimuth::Free
        } else {
            Azimuth::From(self.case.incidence.phi() + PI)
        };
        let expectation = expect(
            model.as_ref(),
            self.case.incidence,
            self.layout,
            azimuth,
            effort,
        );
        let against = |share| self.against(&expectation, share);
        let ((single, total), multiple) = rayon::join(
            || rayon::join(|| against(Share::Single), || against(Share::Total)),
            || {
                let described = expectation.describes(Share::Multiple);
                described.then(|| against(Share::Multiple)).transpose()
            },
        );
        Ok(ModelOutcome {
            single: single?,
            multiple: multiple?,
            total: total?,
            expectation,
            model,
        })
    }

    /// One share of the light beside what the model expects of it.
    fn against(
        &self,
        expectation: &Expectation,
        share: Share,
    ) -> Result<ComparedShare, VerifyError> {
        let layout = self.layout;
        let asked = layout.asked_bins();
        fn of_record<'a>(layout: &Layout, share: Share, record: &'a [f64]) -> &'a [f64] {
            &record[layout.bins(share)][layout.asked_bins()]
        }
        let surfaces: Vec<Vec<f64>> = self
            .ensemble
            .records
            .iter()
            .map(|record| of_record(layout, share, record).to_vec())
            .collect();
        let mean = of_record(layout, share, expectation.statistics().means());
        let batches: Vec<&[f64]> = expectation
            .records()
            .iter()
            .map(|record| of_record(layout, share, record))
            .collect();
        let expected = if batches.len() == surfaces.len() && !expectation.is_exact() {
            Expected::Batches(&batches)
        } else {
            Expected::Exact(mean)
        };
        let hits = |share| &self.statistics.means()[layout.hits(share)][asked.clone()];
        let (single, multiple) = (hits(Share::Single), hits(Share::Multiple));
        let rays = self.ensemble.work.rays as f64;
        let bins_of_a_value = if self.config.free_azimuth(self.case) {
            layout.grid().n_phi() as f64
        } else {
            1.0
        };
        // Few rays are far from symmetric about their mean, be they the surfaces' or the model's.
        let of_model = |share| &expectation.statistics().means()[layout.hits(share)][asked.clone()];
        let (single_of_model, multiple_of_model) =
            (of_model(Share::Single), of_model(Share::Multiple));
        let model_counts = |i: usize| {
            let found = match share {
                Share::Single => single_of_model[i],
                Share::Multiple => multiple_of_model[i],
                Share::Total => single_of_model[i] + multiple_of_model[i],
            };
            let rays = expectation.rays() as f64;
            !expectation.samples(share) || found * rays * bins_of_a_value >= ENOUGH_RAYS
        };
        let enough: Vec<bool> = (0..mean.len())
            .map(|i| {
                let found = match share {
                    Share::Single => single[i],
                    Share::Multiple => multiple[i],
                    Share::Total => single[i] + multiple[i],
                };
                // Under a control a ray counts only if it deviates from what is expected.
                let counted = match self.method.control {
                    Some(_) => found,
                    None => found.max(mean[i]),
                };
                counted * rays * bins_of_a_value >= ENOUGH_RAYS && model_counts(i)
            })
            .collect();
        let comparison = compare(
            &surfaces,
            expected,
            &enough,
            &rings_and_sides(layout),
            self.config.run.seed,
        )?;
        let sides = match share {
            Share::Multiple => Vec::new(),
            _ => side_differences(
                layout,
                share,
                &self.ensemble.records,
                expectation,
                self.config.free_azimuth(self.case),
            ),
        };
        Ok(ComparedShare {
            comparison,
            verdict: None,
            sides,
        })
    }
}

/// Sums of bins in which a deviation is tested beside the bins: rings of equal polar angle, and whole
/// sides, which are the energies. Bins count from the first that is asked for.
fn rings_and_sides(layout: &Layout) -> [Grouping; 2] {
    let grid = layout.grid();
    let groups = |of_each: usize| -> Vec<Vec<usize>> {
        (0..layout.asked_bins().len())
            .step_by(of_each)
            .map(|i| (i..i + of_each).collect())
            .collect()
    };
    [
        Grouping {
            name: "rings",
            groups: groups(grid.n_phi()),
        },
        Grouping {
            name: "sides",
            groups: groups(grid.bins_per_side()),
        },
    ]
}
