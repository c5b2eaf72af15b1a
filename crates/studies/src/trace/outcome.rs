//! Outcome of traced surfaces: results of the engine, and the comparison with models.

use asperity_simulate::{AbsorbedMap, Case, LightPaths, Outcome, StoppedBy, Stopping};
use asperity_tally::TallySpec;

use super::comparison::TraceComparison;
use super::plan::PlannedTrace;
use crate::config::lobes::BinnedLobe;
use crate::report::appearance::SampleLight;
use crate::report::energies::{lost_warning, more_rays_warning};
use crate::report::headline::{CaseLight, of_light};

/// Results of all cases on given surfaces.
pub struct TraceOutcomes<'a> {
    /// The results of each case, as far as there are any.
    pub each: Vec<TraceOutcome<'a>>,
    /// The cases that were planned.
    pub(super) planned: &'a [Case],
    pub(super) seconds: f64,
}

impl<'a> TraceOutcomes<'a> {
    /// The results of the engine.
    pub(super) fn outcomes(&self) -> Vec<&'a Outcome> {
        self.each.iter().map(|one| one.outcome).collect()
    }

    /// The results as samples whose appearance is judged.
    pub(super) fn sample_lights(&self) -> impl Iterator<Item = SampleLight<'a>> {
        self.each.iter().map(TraceOutcome::sample_light)
    }

    /// The results of the case of that number; `None` if a stop came before it.
    pub(super) fn case(&self, number: usize) -> Option<&TraceOutcome<'a>> {
        self.each.iter().find(|one| one.outcome.number == number)
    }
}

/// Headline of some cases, of which there is at least one.
pub(super) fn headline_of(each: &[TraceOutcome<'_>]) -> Vec<String> {
    let cases = each.iter().map(|one| CaseLight {
        outcome: one.outcome,
        judgement: one.comparison.as_ref().map(|of| &of.judgement),
        validity: one.study.validity,
        sample: one.sample_light(),
    });
    let cases: Vec<CaseLight<'_>> = cases.collect();
    of_light(&cases, each[0].study.config.run.max_order)
}

/// Results of one case on given surfaces.
pub struct TraceOutcome<'a> {
    /// The case, as it was planned.
    pub study: &'a PlannedTrace,
    /// Results of the engine.
    pub outcome: &'a Outcome,
    /// The surface against models; `None` without any, or if a stop came before.
    pub comparison: Option<TraceComparison<'a>>,
    /// Paths of single rays on the first surface, if they were requested.
    pub paths: Option<LightPaths>,
    /// Light that each cell absorbs; `None` if it was not requested, or a stop came before.
    pub absorbed: Option<AbsorbedMap>,
    /// Reason that ended the run before all that was planned was done.
    pub stopped_by: Option<StoppedBy>,
}

impl<'a> TraceOutcome<'a> {
    /// The results as a sample whose appearance is judged.
    pub(super) fn sample_light(&self) -> SampleLight<'a> {
        let study = self.study;
        SampleLight::new(self.outcome, study.validity, study.config.output.coherent)
    }

    /// Returns `true` if a stop came before the comparison that was requested.
    pub(super) const fn lacks_comparison(&self) -> bool {
        self.comparison.is_none() && self.study.comparison.is_some()
    }

    /// Tally spec of the statistics.
    pub(super) const fn spec(&self) -> &TallySpec {
        self.outcome.statistics.spec()
    }

    /// The lobes of single scattering next to the bins.
    pub(super) fn lobes(&self) -> Vec<BinnedLobe> {
        BinnedLobe::of_lobes(self.study.lobes, self.spec())
    }

    /// End of the run, if it had a target or was cut short.
    #[must_use]
    pub fn stopping(&self) -> Option<&Stopping> {
        let has_target = self.study.config.run.target_error.is_some();
        let stopping = &self.outcome.stopping;
        (has_target || stopping.is_cut_short()).then_some(stopping)
    }

    /// Warnings for the reader, one sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.study.warnings.clone();
        warnings.extend(lost_warning(&self.outcome.statistics));
        let run = &self.study.config.run;
        warnings.extend(more_rays_warning(run, self.outcome.work.rays));
        let stopping = self.stopping().into_iter();
        warnings.extend(stopping.flat_map(|stopping| stopping.warnings.clone()));
        let comparison = self.comparison.as_ref();
        warnings.extend(comparison.and_then(TraceComparison::rim_warning));
        if self.lacks_comparison() {
            warnings.push(
                "the run was ended before the surface was compared with models; the same command resumes it"
                    .to_owned(),
            );
        }
        warnings.extend(self.absorbed_map_warning());
        warnings.extend(self.outcome.errors.mesh_warning().map(str::to_owned));
        warnings.extend(self.lobes().iter().filter_map(BinnedLobe::warning));
        warnings
    }
}
