//! Group: cases that share surfaces, ready to be planned and traced.

use super::context::Context;
use super::ensemble::{EnsembleGroup, tallies};
use super::given;
use super::given_run::GivenRun;
use super::ready_group::ReadyGroup;
use super::traced_case::NumberedCase;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::limits::{check_results, most_cases};
use crate::input::settings::Settings;
use crate::input::surface_source::SurfaceSource;

/// Cases that share surfaces.
#[derive(Clone)]
pub(crate) enum Group {
    /// Of which nothing is prepared.
    Listed(SurfaceSource, Vec<NumberedCase>),
    /// On random surfaces, with their control variates.
    Prepared(Box<EnsembleGroup>),
}

impl Group {
    /// The groups of cases with equal surface sources, each in the place of its first case. Of a group with more results than memory holds
    /// at once there are several, as far as its cases do not share an effort. Cases that are complete are left out in the end,
    /// so that groups do not depend on them.
    pub(crate) fn of_cases(
        cases: &[Case],
        settings: &Settings,
        is_complete: impl Fn(usize) -> bool,
    ) -> Result<Vec<Self>, SimulateError> {
        let has_target = settings.target().is_some();
        let mut groups: Vec<(SurfaceSource, Vec<NumberedCase>)> = Vec::new();
        for (number, case) in cases.iter().enumerate() {
            let numbered = NumberedCase {
                number,
                case: case.clone(),
            };
            let alone = has_target && settings.plan_alone;
            let mut found = groups.iter_mut();
            match found.find(|(source, _)| !alone && *source == case.surface) {
                Some((_, cases)) => cases.push(numbered),
                None => groups.push((case.surface.clone(), vec![numbered])),
            }
        }
        let mut divided = Vec::new();
        for (source, mut cases) in groups {
            let spec = settings.largest_spec(cases.iter().map(|one| &one.case));
            let tallies = tallies(&source, settings);
            let most = match has_target {
                true => cases.len(),
                false => most_cases(&spec, tallies, settings.refine),
            };
            while !cases.is_empty() {
                let others = cases.split_off(most.min(cases.len()));
                cases.retain(|one| !is_complete(one.number));
                if !cases.is_empty() {
                    divided.push(Self::new(source.clone(), cases, settings)?);
                }
                cases = others;
            }
        }
        Ok(divided)
    }

    fn new(
        source: SurfaceSource,
        cases: Vec<NumberedCase>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        match &source {
            SurfaceSource::Random(_) => {}
            SurfaceSource::Given(shapes) => {
                given::check(shapes, &cases, settings)?;
                let spec = settings.largest_spec(cases.iter().map(|one| &one.case));
                let tallies = tallies(&source, settings);
                check_results(&spec, tallies, cases.len(), settings.refine)?;
            }
            SurfaceSource::Described(_) => return Err(SimulateError::DescribedSurface),
        }
        Ok(Self::Listed(source, cases))
    }

    /// With the control variates of cases on random surfaces.
    pub(crate) fn prepared(self, settings: &Settings) -> Result<Self, SimulateError> {
        Ok(match self {
            Self::Listed(source @ SurfaceSource::Random(_), cases) => {
                Self::Prepared(Box::new(EnsembleGroup::new(source, cases, settings)?))
            }
            other => other,
        })
    }

    /// The same with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        match self {
            Self::Listed(..) => self.clone(),
            Self::Prepared(group) => Self::Prepared(Box::new(group.repeated(settings))),
        }
    }

    /// Number of cases.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Listed(_, cases) => cases.len(),
            Self::Prepared(group) => group.analytic.len() + group.traced.len(),
        }
    }

    /// Rays of all cases, as far as they are planned without a pilot run.
    pub(crate) fn rays(&self, settings: &Settings) -> u64 {
        match self {
            Self::Listed(_, cases) => {
                let of_case = settings.effort.total_rays();
                of_case.saturating_mul(cases.len() as u64)
            }
            Self::Prepared(group) => group.rays(),
        }
    }

    /// Prepares an ensemble, and builds a surface that is given alone.
    pub(crate) fn build(
        self,
        settings: &Settings,
        context: Context<'_>,
    ) -> Result<Box<dyn ReadyGroup>, SimulateError> {
        let (source, cases) = match self {
            Self::Listed(source, cases) => (source, cases),
            Self::Prepared(group) => return Ok(group),
        };
        match (source.shapes(), settings.regions) {
            ([shape], None) => {
                let run = GivenRun::new(shape.clone(), cases, *settings, context)?;
                Ok(Box::new(run))
            }
            _ => Ok(Box::new(EnsembleGroup::new(source, cases, settings)?)),
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Incidence, Material};
    use asperity_synthesis::{Psd, Synthesis};

    use super::*;
    use crate::input::case::Light;
    use crate::input::settings::Effort;
    use crate::input::target::{Quantity, Target};

    /// Numbers of the cases of each group of five directions on equal surfaces.
    fn groups(effort: Effort, plan_alone: bool, is_complete: fn(usize) -> bool) -> Vec<Vec<usize>> {
        let psd = Psd::gaussian(1.0, 4.0).unwrap();
        let surfaces = Synthesis::new(psd, [32, 32], [1.0, 1.0], false).unwrap();
        let case = |i: u32| {
            let incidence = Incidence::from_degrees(f64::from(10 * i), 0.0).unwrap();
            let surface = SurfaceSource::random(surfaces.clone());
            Case::new(surface, Material::Mirror, Light::from_above(incidence))
        };
        let cases: Vec<Case> = (0..5).map(case).collect();
        let settings = Settings {
            effort,
            plan_alone,
            ..Settings::default()
        };
        let groups = Group::of_cases(&cases, &settings, is_complete).unwrap();
        let numbers = |group| match group {
            Group::Listed(_, cases) => cases.iter().map(|one| one.number).collect(),
            _ => Vec::new(),
        };
        groups.into_iter().map(numbers).collect()
    }

    #[test]
    fn groups_are_divided_where_memory_ends_whatever_cases_are_complete() {
        let rays = |surfaces| Effort::Rays {
            total: 1000 * surfaces,
            surfaces,
        };
        assert_eq!(groups(rays(100), false, |_| false), [[0, 1, 2, 3, 4]]);
        let many = rays(14_000);
        assert_eq!(
            groups(many, false, |_| false),
            [vec![0, 1], vec![2, 3], vec![4]]
        );
        assert_eq!(
            groups(many, false, |case| case == 1 || case == 4),
            [vec![0], vec![2, 3]]
        );
        // Cases that share the effort for an error stay together, unless each is to plan alone.
        let error = Effort::TargetError(Target::new(1e-3, Quantity::Bins).unwrap());
        assert_eq!(groups(error, false, |case| case == 0), [[1, 2, 3, 4]]);
        assert_eq!(groups(error, true, |case| case < 3), [[3], [4]]);
    }
}
